//! What may be set: names, ranges, defaults, units.

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
    /// The voltage at which the rotors' greatest thrust was measured; commands are corrected by the voltage there is. 0 for never.
    /// Taken over at once.
    BatteryNominal,
    /// What a pose takes at least from the camera to the vehicle, where its sender does not answer TIMESYNC. Taken over at once.
    PoseDelay,
    /// Below this voltage the vehicle lands, whoever would like to fly on; 0 never does. Taken over at once.
    BatteryCritical,
    /// What the motors idle at, as a part of the command's range. Taken over at once.
    MotorIdle,
    /// How high a take-off goes that names no height. Rows of flight settings are taken over at the next boot.
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
    /// Where nothing else was set.
    pub default: f32,
    /// The unit, if it has one.
    pub unit: &'static str,
    /// Only whole numbers make sense.
    pub whole: bool,
}

const fn row(
    parameter: Name,
    name: &'static str,
    [least, most]: [f32; 2],
    default: f32,
    unit: &'static str,
    whole: bool,
) -> Row {
    Row { parameter, name, least, most, default, unit, whole }
}

/// Every parameter. Storage knows them by their place here: add at the end, remove none.
#[rustfmt::skip]
pub const PARAMETERS: [Row; 38] = [
    row(Name::SystemId,        "SYS_ID",       [1.0, 255.0], 1.0,  "",    true),
    row(Name::TelemetryRate,   "TLM_RATE",     [10.0, 50.0], 25.0, "Hz",  true),
    row(Name::HorizontalSpeed, "GOV_SPEED_XY", [0.1, 20.0],  5.0,  "m/s", false),
    row(Name::VerticalSpeed,   "GOV_SPEED_Z",  [0.1, 10.0],  2.0,  "m/s", false),
    row(Name::BatteryLow,      "BAT_LOW",      [0.0, 60.0],  0.0,  "V",   false),
    row(Name::Imu1GyroX,       "IMU1_GYRO_X",  [-0.05, 0.05], 0.0,  "rad/s", false),
    row(Name::Imu1GyroY,       "IMU1_GYRO_Y",  [-0.05, 0.05], 0.0,  "rad/s", false),
    row(Name::Imu1GyroZ,       "IMU1_GYRO_Z",  [-0.05, 0.05], 0.0,  "rad/s", false),
    row(Name::Imu1OffsetX,     "IMU1_ACC_X",   [-1.0, 1.0],   0.0,  "m/s^2", false),
    row(Name::Imu1OffsetY,     "IMU1_ACC_Y",   [-1.0, 1.0],   0.0,  "m/s^2", false),
    row(Name::Imu1OffsetZ,     "IMU1_ACC_Z",   [-1.0, 1.0],   0.0,  "m/s^2", false),
    row(Name::Imu1ScaleX,      "IMU1_SCALE_X", [0.95, 1.05],  1.0,  "",      false),
    row(Name::Imu1ScaleY,      "IMU1_SCALE_Y", [0.95, 1.05],  1.0,  "",      false),
    row(Name::Imu1ScaleZ,      "IMU1_SCALE_Z", [0.95, 1.05],  1.0,  "",      false),
    row(Name::Imu1LevelX,      "IMU1_LEVEL_X", [-0.09, 0.09], 0.0,  "",      false),
    row(Name::Imu1LevelY,      "IMU1_LEVEL_Y", [-0.09, 0.09], 0.0,  "",      false),
    row(Name::Imu2GyroX,       "IMU2_GYRO_X",  [-0.05, 0.05], 0.0,  "rad/s", false),
    row(Name::Imu2GyroY,       "IMU2_GYRO_Y",  [-0.05, 0.05], 0.0,  "rad/s", false),
    row(Name::Imu2GyroZ,       "IMU2_GYRO_Z",  [-0.05, 0.05], 0.0,  "rad/s", false),
    row(Name::Imu2OffsetX,     "IMU2_ACC_X",   [-1.0, 1.0],   0.0,  "m/s^2", false),
    row(Name::Imu2OffsetY,     "IMU2_ACC_Y",   [-1.0, 1.0],   0.0,  "m/s^2", false),
    row(Name::Imu2OffsetZ,     "IMU2_ACC_Z",   [-1.0, 1.0],   0.0,  "m/s^2", false),
    row(Name::Imu2ScaleX,      "IMU2_SCALE_X", [0.95, 1.05],  1.0,  "",      false),
    row(Name::Imu2ScaleY,      "IMU2_SCALE_Y", [0.95, 1.05],  1.0,  "",      false),
    row(Name::Imu2ScaleZ,      "IMU2_SCALE_Z", [0.95, 1.05],  1.0,  "",      false),
    row(Name::Imu2LevelX,      "IMU2_LEVEL_X", [-0.09, 0.09], 0.0,  "",      false),
    row(Name::Imu2LevelY,      "IMU2_LEVEL_Y", [-0.09, 0.09], 0.0,  "",      false),
    row(Name::ThrustCurve,     "THR_CURVE",    [0.0, 1.0],    0.0,  "",      false),
    row(Name::BatteryNominal,  "BAT_NOMINAL",  [0.0, 60.0],   0.0,  "V",     false),
    row(Name::PoseDelay,       "POSE_DELAY",   [0.0, 150.0],  0.0,  "ms",    false),
    row(Name::BatteryCritical, "BAT_CRIT",     [0.0, 60.0],   0.0,  "V",     false),
    row(Name::MotorIdle,       "MOT_IDLE",     [0.0, 0.1],    0.03, "",      false),
    row(Name::TakeOffHeight,   "TKO_ALT",      [0.5, 50.0],   1.5,  "m",     false),
    row(Name::LandingSpeed,    "LAND_SPEED",   [0.1, 2.0],    0.5,  "m/s",   false),
    row(Name::GroundStationPatience, "GCS_WAIT", [2.5, 600.0], 10.0, "s",    false),
    row(Name::FenceRadius,     "FENCE_RADIUS", [2.0, 10_000.0], 100.0, "m",  false),
    row(Name::FenceHeight,     "FENCE_HEIGHT", [2.0, 10_000.0], 50.0, "m",   false),
    row(Name::TrackingErrorMax, "TRACK_ERR",   [0.5, 100.0],  3.0,  "m",     false),
];

impl Name {
    /// Its row.
    #[must_use]
    pub fn row(self) -> &'static Row {
        // The table is in the order of the names; a test holds it to that.
        &PARAMETERS[self as usize]
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
        // NaN is in no range; a whole number in this one survives the way to an integer and back.
        (self.least..=self.most).contains(&value) && (!self.whole || value as u32 as f32 == value)
    }
}
