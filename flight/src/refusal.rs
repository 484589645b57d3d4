//! Why a vehicle may not fly, and why a request is refused, in words.
//!
//! Each fits the 50 characters of a MAVLink STATUSTEXT; longer names (of inequalities, of fields) are cut to fit.

use super::mission::MissionRefusal;
use super::rotor_check::RotorFault;
use controller_core::certificate::certified::Refused;
use controller_core::error::ParameterError;
use core::fmt;
use estimation::estimator::Fault;
use estimation::imu::ImuFault;

/// Why a pilot can never arm until it is made anew, with another configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Grounded {
    /// This inequality of the certificate fails.
    Inequality(&'static str),
    /// This parameter is one that the certificate, the governor or the law cannot work with.
    Parameter(&'static str),
    /// The configuration has no rotors.
    NoRotors,
}

impl From<ParameterError> for Grounded {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error.field)
    }
}

impl From<&Refused> for Grounded {
    fn from(refused: &Refused) -> Self {
        match refused {
            Refused::Fails(certificate) => {
                let failed = certificate.inequalities().find(|inequality| !inequality.holds());
                Self::Inequality(failed.map_or("", |inequality| inequality.name))
            }
            Refused::Undefined(error) => Self::Parameter(error.field),
        }
    }
}

impl fmt::Display for Grounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Inequality(name) => write!(f, "Not certified: {name:.35}"),
            Self::Parameter(field) => write!(f, "Cannot fly with {field:.34}"),
            Self::NoRotors => f.write_str("Cannot fly: the configuration has no rotors"),
        }
    }
}

/// What is stored over a restart and guards flights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Stored {
    /// The key that frames are signed with.
    SigningKey,
    /// The parameter of this name, of at most 16 characters; or all of them.
    Parameter(&'static str),
}

/// Why a request or a setpoint was refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// Nothing certified to fly with.
    Grounded(Grounded),
    /// The motors turn already.
    AlreadyArmed,
    /// The vehicle was stopped in flight or crashed, and has not been disarmed since.
    Stopped,
    /// The kill switch is on.
    Killed,
    /// Flash is being written, which may stall the processor; or a changed configuration is certified; or a restart is
    /// under way.
    Busy,
    /// This was stored and cannot be read any more; a default would be weaker than what the operator chose.
    Lost(Stored),
    /// The clock's crystal does not run.
    ClockDoubtful,
    /// Commands do not reach the motors.
    MotorsFail,
    /// A rotor was found to fail since the boot.
    RotorLost,
    /// A rotor does not idle as the others do.
    Rotor(RotorFault),
    /// The battery is low.
    BatteryLow,
    /// The battery is to be watched, and there is no reading of it.
    BatteryMissing,
    /// Motors stop in the air by force only.
    InTheAir,
    /// Only an armed vehicle on the ground takes off.
    NotIdling,
    /// It takes off already, to another height.
    TakingOff,
    /// It has taken off.
    Flies,
    /// Only in the air there is somewhere to hold or land.
    NotInTheAir,
    /// A landing goes on until a hold request.
    Landing,
    /// It goes down by the IMU alone, without a position to hold or fly to.
    WithoutPose,
    /// The cause of its landing persists.
    MustLand,
    /// No setpoint that may be flown came in the last second.
    NoSetpoints,
    /// A height of no take-off: not in 0.5 m to 50 m.
    TakeOffHeight,
    /// The point is outside the fence.
    OutsideFence,
    /// No policy is built in.
    NoPolicy,
    /// The law that flies carries no policy.
    NoPolicyUnderLaw,
    /// An item of the mission cannot be flown.
    Mission(MissionRefusal),
    /// A motor test was running; the request has ended it.
    MotorTestRunning,
    /// A disarm command came in the same tick.
    DisarmCommanded,
    /// No IMU increment under [`super::rules::IMU_AGE_MAX_US`] old.
    ImuStale,
    /// Gyro or accelerometer fails, or did within a second.
    Imu(ImuFault),
    /// The estimate is not healthy: its worst fault.
    Estimator(Fault),
    /// For less than [`super::SETTLED_AFTER_US`] the estimate has been healthy and every pose believed.
    PosesUnsettled,
    /// The vehicle moves, at 0.2 m/s or 0.2 rad/s or more.
    Moving,
    /// Gravity is 10 degrees or more elsewhere for the accelerometer, or not there at all.
    Gravity,
    /// Body z is 30 degrees or more from up.
    Tilted,
    /// The ground station has been silent for [`super::rules::GROUND_STATION_TIMEOUT_US`].
    GroundStationSilent,
    /// The governor cannot start at the vehicle: the field to blame.
    Reference(&'static str),
    /// The vehicle has fewer rotors.
    NoSuchRotor,
    /// A test level outside (0, [`super::rules::MOTOR_TEST_LEVEL_MAX`]].
    MotorTestLevel,
    /// A test duration outside (0, [`super::rules::MOTOR_TEST_MAX_US`]].
    MotorTestDuration,
    /// A setpoint with a field that is not finite or out of range.
    Setpoint(&'static str),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Grounded(grounded) => return grounded.fmt(f),
            Self::Reference(field) => return write!(f, "Refused: no start at this {field:.24}"),
            Self::Setpoint(field) => return write!(f, "Refused: {field:.28} out of range"),
            Self::Mission(refusal) => return write!(f, "Mission refused: {refusal}"),
            Self::Rotor(fault) => {
                return write!(f, "Refused: rotor {} {}", fault.rotor + 1, fault.deviation.text());
            }
            Self::Lost(Stored::Parameter(name)) => return write!(f, "Refused: {name:.16} lost; set again"),
            Self::Lost(Stored::SigningKey) => "Refused: signing key lost; set it over USB",
            Self::AlreadyArmed => "Refused: armed already",
            Self::Stopped => "Refused: stopped in flight; disarm first",
            Self::Killed => "Refused: the kill switch is on",
            Self::Busy => "Refused: parameters in work, or a restart",
            Self::ClockDoubtful => "Refused: the clock's crystal does not run",
            Self::MotorsFail => "Refused: the motors' frames do not go out",
            Self::RotorLost => "Refused: a rotor failed; repair it and restart",
            Self::BatteryLow => "Refused: the battery is low",
            Self::BatteryMissing => "Refused: battery to be watched is not measured",
            Self::InTheAir => "Refused: in the air; land, or disarm by force",
            Self::NotIdling => "Refused: arm on the ground first",
            Self::TakingOff => "Refused: taking off to another height",
            Self::Flies => "Refused: it has taken off",
            Self::NotInTheAir => "Refused: not in the air",
            Self::Landing => "Refused: it lands; let it hold first",
            Self::WithoutPose => "Refused: without a pose it can only go down",
            Self::MustLand => "Refused: what made it land is still so",
            Self::NoSetpoints => "Refused: no usable setpoint in the last second",
            Self::TakeOffHeight => "Refused: take-off height not in 0.5 to 50 m",
            Self::NoPolicy => "Refused: no policy is built in",
            Self::NoPolicyUnderLaw => "Refused: the paper's law carries no policy",
            Self::OutsideFence => "Refused: outside the fence",
            Self::MotorTestRunning => "Refused: a motor test was running",
            Self::DisarmCommanded => "Refused: disarm commanded",
            Self::ImuStale => "Refused: no IMU sample for 20 ms",
            Self::Imu(fault) => fault.text(),
            Self::Estimator(fault) => fault.text(),
            Self::PosesUnsettled => "Refused: poses not believed for a whole second",
            Self::Moving => "Refused: the vehicle moves",
            Self::Gravity => "Refused: gravity is not what accelerometer says",
            Self::Tilted => "Refused: tilted by 30 degrees or more",
            Self::GroundStationSilent => "Refused: no ground station for 2.5 s",
            Self::NoSuchRotor => "Motor test refused: no such rotor",
            Self::MotorTestLevel => "Motor test refused: level not in 0 to 15 %",
            Self::MotorTestDuration => "Motor test refused: duration not in 0 to 2 s",
        })
    }
}

#[cfg(test)]
mod tests;
