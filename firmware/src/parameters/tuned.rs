//! The parameters that the certificate depends on: what they change, and whether it may fly.
//!
//! ```text
//! built configuration, parameters -> Tuning -> constructors -> loops judged by the build? -> Certified
//! ```
//!
//! It runs twice: when one of them is set, on all of them as they would be then; and at boot, on what was stored. What
//! flies is the second one's, so a change counts from the next boot. A parameter that was never set is as built,
//! whatever was built.
//!
//! What motors idle at, and their curve, make a least thrust of each rotor: the configuration has that one, or what it
//! was built or tuned to have if that is greater.
//!
//! Certifying takes long (`docs/firmware.md`), and a stack like that of booting. It runs in the link's task, below
//! control, which keeps its time; and arming is refused meanwhile.

use super::table::Name;
use controller_core::allocation::{Motor, ThrustCurve};
use controller_core::certificate::Certificate;
use controller_core::certificate::inequality::Inequality;
use controller_core::configuration::Configuration;
use controller_core::error::{ParameterError, Reason};
use controller_core::tuning::judged::JudgedLoops;
use controller_core::tuning::{Factors, Figures, Percent, Tuning};
use core::fmt;

/// What was built, or what a desktop read of a scenario file.
#[derive(Debug)]
pub struct Built {
    /// The configuration.
    pub configuration: Configuration,
    /// What turns its rotors.
    pub motor: Motor,
    /// Which factors on its gains have sampled loops with margin.
    pub loops: &'static JudgedLoops,
    /// A number that other configurations have not, below 2^24.
    pub identity: u32,
    /// The time between control ticks, us.
    pub period: u64,
    /// Whether its sampled loops have margin for notches on the gyro that follow the rotors.
    pub follows_rotors: bool,
}

/// Why tuned parameters may not fly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unfit {
    /// There is no such configuration, or its loops were not judged.
    Parameter(ParameterError),
    /// This inequality of its certificate fails before all others.
    Inequality(Inequality),
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameter(error) => write!(f, "{error}"),
            Self::Inequality(Inequality { name, required, available, .. }) => {
                write!(f, "{name}: needs {:.3}, has {:.3}", *required as f32, *available as f32)
            }
        }
    }
}

/// What loops without margin are called.
const LOOPS: ParameterError = ParameterError { field: "sampled loops", reason: Reason::WithoutMargin };

impl Built {
    /// The configuration with these values of the parameters; a NaN means as built.
    /// Errors: values that the constructors refuse; or gains whose loops the build found without margin.
    #[inline(never)] // its stack must not be beside that of certifying
    pub fn tuned(&self, value: impl Fn(Name) -> f32) -> Result<Configuration, ParameterError> {
        let mut tuning = Tuning { figures: Figures::from_configuration(&self.configuration), factors: Factors::BUILT };
        for name in Name::tuned() {
            let value = value(name);
            if value.is_nan() {
                continue;
            }
            if let Some(figure) = figure(&mut tuning.figures, name) {
                *figure = value;
            } else if let Some(factor) = factor(&mut tuning.factors, name) {
                // None that the table allows.
                *factor = Percent::new(value).ok_or(LOOPS)?;
            }
        }
        // No rotor may be asked for less than what its motor makes when it idles.
        let [min, max] = &mut tuning.figures.rotor_thrust;
        *min = min.max(ThrustCurve::new(*max, self.motor(&value))?.thrust_min());
        if !self.loops.hold(&tuning.factors) {
            return Err(LOOPS);
        }
        tuning.apply(&self.configuration)
    }

    /// The motors with these values; a NaN means as built.
    pub fn motor(&self, value: impl Fn(Name) -> f32) -> Motor {
        let set = |name, built| Some(value(name)).filter(|value| !value.is_nan()).unwrap_or(built);
        let Motor { linear, idle } = self.motor;
        Motor { linear: set(Name::ThrustCurve, linear), idle: set(Name::MotorIdle, idle) }
    }

    /// Whether the configuration with these values may fly.
    #[inline(never)] // its stack is that of booting
    pub fn judge(&self, value: impl Fn(Name) -> f32) -> Result<(), Unfit> {
        let configuration = self.tuned(value).map_err(Unfit::Parameter)?;
        // What `Certified` is made of at boot, without the copies that only a pilot needs.
        let certificate = Certificate::new(&configuration).map_err(Unfit::Parameter)?;
        match certificate.inequalities().find(|inequality| !inequality.holds()) {
            Some(inequality) => Err(Unfit::Inequality(*inequality)),
            None => Ok(()),
        }
    }

    /// The value of a parameter as built; none of one that is no part of the configuration.
    pub fn value(&self, name: Name) -> Option<f32> {
        let mut figures = Figures::from_configuration(&self.configuration);
        let factor = factor(&mut Factors::BUILT.clone(), name).map(|factor| factor.percent());
        match name {
            Name::ThrustCurve => Some(self.motor.linear),
            Name::MotorIdle => Some(self.motor.idle),
            _ => figure(&mut figures, name).copied().or(factor),
        }
    }
}

/// The figure of a parameter, if it is one.
fn figure(figures: &mut Figures, name: Name) -> Option<&mut f32> {
    let Figures { mass, thrust_max, torque_max, bounds, rotor_thrust: [min, max] } = figures;
    Some(match name {
        Name::Mass => mass,
        Name::ThrustMax => thrust_max,
        Name::TorqueMaxX => &mut torque_max.x,
        Name::TorqueMaxY => &mut torque_max.y,
        Name::TorqueMaxZ => &mut torque_max.z,
        Name::AccelerationAcross => &mut bounds.horizontal_acceleration,
        Name::AccelerationVertical => &mut bounds.vertical_acceleration,
        Name::Jerk => &mut bounds.jerk,
        Name::Snap => &mut bounds.snap,
        Name::HeadingRate => &mut bounds.heading_rate,
        Name::HeadingAcceleration => &mut bounds.heading_second_derivative,
        Name::RotorThrustMin => min,
        Name::RotorThrustMax => max,
        _ => return None,
    })
}

/// The factor of a parameter, if it is one.
fn factor(factors: &mut Factors, name: Name) -> Option<&mut Percent> {
    Some(match name {
        Name::GainAttitude => &mut factors.attitude,
        Name::GainRate => &mut factors.rate,
        Name::GainPositionAcross => &mut factors.position_across,
        Name::GainVelocityAcross => &mut factors.velocity_across,
        Name::GainPositionVertical => &mut factors.position_vertical,
        Name::GainVelocityVertical => &mut factors.velocity_vertical,
        _ => return None,
    })
}
