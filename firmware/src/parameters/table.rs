//! What may be set: names, ranges, defaults, units.

use crate::outputs;
use controller_core::tuning::Percent;

/// The parameters, in the table's order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[repr(u8)]
pub enum Name {
    /// MAVLink system id of this vehicle. Taken over at once.
    SystemId,
    /// How often attitude and position are sent. Taken over at once.
    TelemetryRate,
    /// The governor's horizontal speed limit. Taken over at the next boot.
    HorizontalSpeed,
    /// The governor's vertical speed limit. Taken over at the next boot.
    VerticalSpeed,
    /// Below this voltage the vehicle warns, and lands once; 0 never does. Taken over at once.
    BatteryLow,
    /// Along x: gyro bias of the first IMU. Rows of an IMU are taken over at the next boot.
    Imu1GyroX,
    /// Along y: gyro bias of the first IMU.
    Imu1GyroY,
    /// Along z: gyro bias of the first IMU.
    Imu1GyroZ,
    /// Along x: accelerometer offset of the first IMU.
    Imu1OffsetX,
    /// Along y: accelerometer offset of the first IMU.
    Imu1OffsetY,
    /// Along z: accelerometer offset of the first IMU.
    Imu1OffsetZ,
    /// Along x: accelerometer scale of the first IMU.
    Imu1ScaleX,
    /// Along y: accelerometer scale of the first IMU.
    Imu1ScaleY,
    /// Along z: accelerometer scale of the first IMU.
    Imu1ScaleZ,
    /// Along x: how much of gravity the first IMU feels there in the level vehicle, by that along z.
    Imu1LevelX,
    /// Along y: how much of gravity the first IMU feels there in the level vehicle, by that along z.
    Imu1LevelY,
    /// Along x: gyro bias of the second IMU.
    Imu2GyroX,
    /// Along y: gyro bias of the second IMU.
    Imu2GyroY,
    /// Along z: gyro bias of the second IMU.
    Imu2GyroZ,
    /// Along x: accelerometer offset of the second IMU.
    Imu2OffsetX,
    /// Along y: accelerometer offset of the second IMU.
    Imu2OffsetY,
    /// Along z: accelerometer offset of the second IMU.
    Imu2OffsetZ,
    /// Along x: accelerometer scale of the second IMU.
    Imu2ScaleX,
    /// Along y: accelerometer scale of the second IMU.
    Imu2ScaleY,
    /// Along z: accelerometer scale of the second IMU.
    Imu2ScaleZ,
    /// Along x: how much of gravity the second IMU feels there in the level vehicle, by that along z.
    Imu2LevelX,
    /// Along y: how much of gravity the second IMU feels there in the level vehicle, by that along z.
    Imu2LevelY,
    /// a of the motors' thrust curve a u + (1 - a) u^2 over the command u. Taken over at the next boot.
    ThrustCurve,
    /// The voltage at which the rotors' greatest thrust was measured; commands are corrected by the voltage there is. 0
    /// for never. Taken over at once.
    BatteryNominal,
    /// What a pose takes at least from the camera to the vehicle, where its sender does not answer TIMESYNC. Taken over
    /// at once.
    PoseDelay,
    /// Below this voltage the vehicle lands, whatever is requested; 0 never does. Taken over at once.
    BatteryCritical,
    /// What the motors idle at, as a part of the command's range. Taken over at once.
    MotorIdle,
    /// How high a take-off goes that names no height. Rows of flight settings are taken over at once.
    TakeOffHeight,
    /// How fast a landing goes down.
    LandingSpeed,
    /// How long the ground station may be silent before a vehicle that holds lands.
    GroundStationPatience,
    /// The fence: how far from where it was armed the vehicle may go.
    FenceRadius,
    /// The fence: how high above that place.
    FenceHeight,
    /// How far from its reference the vehicle may be for longer than 5 s before it lands.
    TrackingErrorMax,
    /// The configuration that the following rows were tuned on. Read-only.
    TunedOn,
    /// Mass. The rows from here to the last gain are certified when they are set, and taken over at the next boot: see
    /// [`super::tuned`].
    Mass,
    /// Limit of the thrust.
    ThrustMax,
    /// Limit of the torque about body x.
    TorqueMaxX,
    /// Limit of the torque about body y.
    TorqueMaxY,
    /// Limit of the torque about body z.
    TorqueMaxZ,
    /// Reference bound: horizontal acceleration.
    AccelerationAcross,
    /// Reference bound: vertical acceleration.
    AccelerationVertical,
    /// Reference bound: jerk.
    Jerk,
    /// Reference bound: snap.
    Snap,
    /// Reference bound: rate of the heading.
    HeadingRate,
    /// Reference bound: second derivative of the heading's direction.
    HeadingAcceleration,
    /// Least thrust of each rotor.
    RotorThrustMin,
    /// Greatest thrust of each rotor.
    RotorThrustMax,
    /// Gain on attitude errors, percent of the built one.
    GainAttitude,
    /// Gain on body rates, percent of the built one.
    GainRate,
    /// Gain on horizontal position errors, percent of the built one.
    GainPositionAcross,
    /// Gain on horizontal velocity errors, percent of the built one.
    GainVelocityAcross,
    /// Gain on errors in height, percent of the built one.
    GainPositionVertical,
    /// Gain on vertical velocity errors, percent of the built one.
    GainVelocityVertical,
    /// Which output each rotor's controller is wired to, a digit a rotor: see [`outputs::wiring`]. Taken over at the
    /// next boot.
    MotorOrder,
    /// The serial line's baud rate. Taken over at the next boot.
    SerialRate,
    /// Whether what is not signed is refused, once there is a key. Taken over at once.
    SignedOnly,
}

/// One row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Which.
    pub parameter: Name,
    /// Its MAVLink name, at most 16 bytes.
    pub name: &'static str,
    /// The least value allowed.
    pub least: f32,
    /// The greatest.
    pub most: f32,
    /// Where nothing else was set; no number where that is the built configuration's.
    pub default: f32,
    /// The unit, if it has one.
    pub unit: &'static str,
    /// Allowed are the least and what is so many steps above it; 0: everything in between.
    pub step: f32,
}

const fn row(
    parameter: Name,
    name: &'static str,
    [least, most]: [f32; 2],
    default: f32,
    unit: &'static str,
    step: f32,
) -> Row {
    Row { parameter, name, least, most, default, unit, step }
}

/// A row that stands for something of the built configuration: no number is as built.
const AS_BUILT: f32 = f32::NAN;

/// A row of a figure of the configuration.
const fn built(parameter: Name, name: &'static str, range: [f32; 2], unit: &'static str) -> Row {
    row(parameter, name, range, AS_BUILT, unit, 0.0)
}

/// A row of a factor on a gain of the configuration.
const fn gain(parameter: Name, name: &'static str) -> Row {
    let (least, step) = (Percent::FACTOR_MIN_PERCENT as f32, Percent::FACTOR_STEP_PERCENT as f32);
    row(parameter, name, [least, least + step * (Percent::COUNT - 1) as f32], AS_BUILT, "%", step)
}

/// Every parameter. Storage knows them by their place here: add at the end, remove none.
#[rustfmt::skip]
pub const PARAMETERS: [Row; 61] = [
    row(Name::SystemId,        "SYS_ID",       [1.0, 255.0], 1.0,  "",    1.0),
    row(Name::TelemetryRate,   "TLM_RATE",     [10.0, 50.0], 25.0, "Hz",  1.0),
    row(Name::HorizontalSpeed, "GOV_SPEED_XY", [0.1, 20.0],  5.0,  "m/s", 0.0),
    row(Name::VerticalSpeed,   "GOV_SPEED_Z",  [0.1, 10.0],  2.0,  "m/s", 0.0),
    row(Name::BatteryLow,      "BAT_LOW",      [0.0, 60.0],  0.0,  "V",   0.0),
    row(Name::Imu1GyroX,       "IMU1_GYRO_X",  [-0.05, 0.05], 0.0,  "rad/s", 0.0),
    row(Name::Imu1GyroY,       "IMU1_GYRO_Y",  [-0.05, 0.05], 0.0,  "rad/s", 0.0),
    row(Name::Imu1GyroZ,       "IMU1_GYRO_Z",  [-0.05, 0.05], 0.0,  "rad/s", 0.0),
    row(Name::Imu1OffsetX,     "IMU1_ACC_X",   [-1.0, 1.0],   0.0,  "m/s^2", 0.0),
    row(Name::Imu1OffsetY,     "IMU1_ACC_Y",   [-1.0, 1.0],   0.0,  "m/s^2", 0.0),
    row(Name::Imu1OffsetZ,     "IMU1_ACC_Z",   [-1.0, 1.0],   0.0,  "m/s^2", 0.0),
    row(Name::Imu1ScaleX,      "IMU1_SCALE_X", [0.95, 1.05],  1.0,  "",      0.0),
    row(Name::Imu1ScaleY,      "IMU1_SCALE_Y", [0.95, 1.05],  1.0,  "",      0.0),
    row(Name::Imu1ScaleZ,      "IMU1_SCALE_Z", [0.95, 1.05],  1.0,  "",      0.0),
    row(Name::Imu1LevelX,      "IMU1_LEVEL_X", [-0.09, 0.09], 0.0,  "",      0.0),
    row(Name::Imu1LevelY,      "IMU1_LEVEL_Y", [-0.09, 0.09], 0.0,  "",      0.0),
    row(Name::Imu2GyroX,       "IMU2_GYRO_X",  [-0.05, 0.05], 0.0,  "rad/s", 0.0),
    row(Name::Imu2GyroY,       "IMU2_GYRO_Y",  [-0.05, 0.05], 0.0,  "rad/s", 0.0),
    row(Name::Imu2GyroZ,       "IMU2_GYRO_Z",  [-0.05, 0.05], 0.0,  "rad/s", 0.0),
    row(Name::Imu2OffsetX,     "IMU2_ACC_X",   [-1.0, 1.0],   0.0,  "m/s^2", 0.0),
    row(Name::Imu2OffsetY,     "IMU2_ACC_Y",   [-1.0, 1.0],   0.0,  "m/s^2", 0.0),
    row(Name::Imu2OffsetZ,     "IMU2_ACC_Z",   [-1.0, 1.0],   0.0,  "m/s^2", 0.0),
    row(Name::Imu2ScaleX,      "IMU2_SCALE_X", [0.95, 1.05],  1.0,  "",      0.0),
    row(Name::Imu2ScaleY,      "IMU2_SCALE_Y", [0.95, 1.05],  1.0,  "",      0.0),
    row(Name::Imu2ScaleZ,      "IMU2_SCALE_Z", [0.95, 1.05],  1.0,  "",      0.0),
    row(Name::Imu2LevelX,      "IMU2_LEVEL_X", [-0.09, 0.09], 0.0,  "",      0.0),
    row(Name::Imu2LevelY,      "IMU2_LEVEL_Y", [-0.09, 0.09], 0.0,  "",      0.0),
    row(Name::ThrustCurve,     "THR_CURVE",    [0.0, 1.0],    0.0,  "",      0.0),
    row(Name::BatteryNominal,  "BAT_NOMINAL",  [0.0, 60.0],   0.0,  "V",     0.0),
    row(Name::PoseDelay,       "POSE_DELAY",   [0.0, 150.0],  0.0,  "ms",    0.0),
    row(Name::BatteryCritical, "BAT_CRIT",     [0.0, 60.0],   0.0,  "V",     0.0),
    row(Name::MotorIdle,       "MOT_IDLE",     [0.0, 0.1],    0.03, "",      0.0),
    row(Name::TakeOffHeight,   "TKO_ALT",      [0.5, 50.0],   1.5,  "m",     0.0),
    row(Name::LandingSpeed,    "LAND_SPEED",   [0.1, 2.0],    0.5,  "m/s",   0.0),
    row(Name::GroundStationPatience, "GCS_WAIT", [2.5, 600.0], 10.0, "s",    0.0),
    row(Name::FenceRadius,     "FENCE_RADIUS", [2.0, 10_000.0], 100.0, "m",  0.0),
    row(Name::FenceHeight,     "FENCE_HEIGHT", [2.0, 10_000.0], 50.0, "m",   0.0),
    row(Name::TrackingErrorMax, "TRACK_ERR",   [0.5, 100.0],  3.0,  "m",     0.0),
    row(Name::TunedOn,         "CFG_ID",       [0.0, 16_777_215.0], 0.0, "", 1.0),
    built(Name::Mass,                 "MASS",         [0.01, 100.0],  "kg"),
    built(Name::ThrustMax,            "THR_MAX",      [0.1, 10_000.0], "N"),
    built(Name::TorqueMaxX,           "TRQ_MAX_X",    [0.001, 1_000.0], "N m"),
    built(Name::TorqueMaxY,           "TRQ_MAX_Y",    [0.001, 1_000.0], "N m"),
    built(Name::TorqueMaxZ,           "TRQ_MAX_Z",    [0.001, 1_000.0], "N m"),
    built(Name::AccelerationAcross,   "REF_ACC_XY",   [0.01, 50.0],   "m/s^2"),
    built(Name::AccelerationVertical, "REF_ACC_Z",    [0.01, 9.0],    "m/s^2"),
    built(Name::Jerk,                 "REF_JERK",     [0.01, 500.0],  "m/s^3"),
    built(Name::Snap,                 "REF_SNAP",     [0.01, 5_000.0], "m/s^4"),
    built(Name::HeadingRate,          "REF_YAW_RATE", [0.01, 20.0],   "rad/s"),
    built(Name::HeadingAcceleration,  "REF_YAW_ACC",  [0.01, 500.0],  "1/s^2"),
    built(Name::RotorThrustMin,       "ROT_THR_MIN",  [0.0, 1_000.0], "N"),
    built(Name::RotorThrustMax,       "ROT_THR_MAX",  [0.01, 10_000.0], "N"),
    gain(Name::GainAttitude,          "GAIN_ATT_P"),
    gain(Name::GainRate,              "GAIN_ATT_D"),
    gain(Name::GainPositionAcross,    "GAIN_XY_P"),
    gain(Name::GainVelocityAcross,    "GAIN_XY_D"),
    gain(Name::GainPositionVertical,  "GAIN_Z_P"),
    gain(Name::GainVelocityVertical,  "GAIN_Z_D"),
    row(Name::MotorOrder,      "MOT_ORDER",    [1234.0, 4321.0], 1234.0, "", 1.0),
    // Multiples of 57,600, the greatest by default.
    row(Name::SerialRate,      "SER_BAUD",     [57_600.0, 921_600.0], 921_600.0, "", 57_600.0),
    row(Name::SignedOnly,      "SIGN_ONLY",    [0.0, 1.0],   1.0,  "",    1.0),
];

impl Name {
    /// Its row.
    #[must_use]
    pub fn row(self) -> &'static Row {
        // The table is in the order of the names; a test holds it to that.
        &PARAMETERS[self as usize]
    }

    /// Whether it stands for something of the built configuration.
    #[must_use]
    pub fn is_tuned(self) -> bool {
        (Self::Mass as u8..=Self::GainVelocityVertical as u8).contains(&(self as u8))
    }

    /// Every one that does.
    pub fn tuned() -> impl Iterator<Item = Self> {
        PARAMETERS.iter().map(|row| row.parameter).filter(|name| name.is_tuned())
    }

    /// The parameter of this MAVLink name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        PARAMETERS.iter().find(|row| row.name == name).map(|row| row.parameter)
    }

    /// The parameter in this place of the table.
    #[must_use]
    pub fn from_index(index: usize) -> Option<Self> {
        PARAMETERS.get(index).map(|row| row.parameter)
    }
}

impl Row {
    /// Whether it may have this value.
    #[must_use]
    pub fn allows(&self, value: f32) -> bool {
        // NaN is in no range; a whole number of steps survives the way to an integer and back.
        let steps = (value - self.least) / self.step;
        (self.least..=self.most).contains(&value)
            && (self.step == 0.0 || steps as u32 as f32 == steps)
            && (self.parameter != Name::MotorOrder || outputs::wiring(value).is_some())
    }
}
