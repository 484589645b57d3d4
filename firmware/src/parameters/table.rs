//! What may be set: names, ranges, defaults, units.

use crate::outputs;
use controller_core::allocation::curve::IDLE_MAX;
use controller_core::tuning::Percent;

/// One row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Which.
    pub parameter: Name,
    /// Its MAVLink name, at most 16 bytes.
    pub name: &'static str,
    /// The range.
    pub min: f32,
    /// See [`Self::min`].
    pub max: f32,
    /// The default; NaN for the built configuration's value.
    pub default: f32,
    /// The unit, if it has one.
    pub unit: &'static str,
    /// The allowed values are whole steps above the minimum; 0: all in the range.
    pub step: f32,
}

const fn row(
    parameter: Name,
    name: &'static str,
    [min, max]: [f32; 2],
    default: f32,
    unit: &'static str,
    step: f32,
) -> Row {
    Row { parameter, name, min, max, default, unit, step }
}

/// A row that stands for something of the built configuration: NaN means as built.
const AS_BUILT: f32 = f32::NAN;

/// A row of a figure of the configuration.
const fn built(parameter: Name, name: &'static str, range: [f32; 2], unit: &'static str) -> Row {
    row(parameter, name, range, AS_BUILT, unit, 0.0)
}

/// A row of a factor on a gain of the configuration.
const fn gain(parameter: Name, name: &'static str) -> Row {
    let (min, step) = (Percent::FACTOR_MIN_PERCENT as f32, Percent::FACTOR_STEP_PERCENT as f32);
    row(parameter, name, [min, min + step * (Percent::COUNT - 1) as f32], AS_BUILT, "%", step)
}

/// The parameters' names, and the table of their rows.
macro_rules! parameters {
    ($($(#[$doc:meta])* $parameter:ident: $row:ident($name:literal $(, $argument:expr)*);)*) => {
        /// The parameters, in the table's order.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[cfg_attr(target_os = "none", derive(defmt::Format))]
        #[repr(u8)]
        pub enum Name {
            $(#[doc = concat!("`", $name, "`.\n\n")] $(#[$doc])* $parameter,)*
        }

        /// Every parameter.
        pub const PARAMETERS: [Row; [$(Name::$parameter),*].len()] =
            [$($row(Name::$parameter, $name $(, $argument)*)),*];
    };
}

// Storage knows them by their place here: add at the end, remove none.
parameters! {
    /// MAVLink system id of this vehicle. Taken over at once.
    SystemId: row("SYS_ID", [1.0, 255.0], 1.0, "", 1.0);
    /// How often attitude and position are sent. Taken over at once.
    TelemetryRate: row("TLM_RATE", [10.0, 50.0], 25.0, "Hz", 1.0);
    /// The governor's horizontal speed limit. Taken over at the next boot.
    HorizontalSpeed: row("GOV_SPEED_XY", [0.1, 20.0], 5.0, "m/s", 0.0);
    /// The governor's vertical speed limit. Taken over at the next boot.
    VerticalSpeed: row("GOV_SPEED_Z", [0.1, 10.0], 2.0, "m/s", 0.0);
    /// Below this voltage the vehicle warns, and lands once; 0 never does. Taken over at once.
    BatteryLow: row("BAT_LOW", [0.0, 60.0], 0.0, "V", 0.0);
    // Of an inertial sensor: gyro bias; accelerometer offset and scale; and the horizontal part of gravity in the level
    // vehicle, as a share of the vertical one. Taken over at the next boot.
    Imu1GyroX: row("IMU1_GYRO_X", [-0.05, 0.05], 0.0, "rad/s", 0.0);
    Imu1GyroY: row("IMU1_GYRO_Y", [-0.05, 0.05], 0.0, "rad/s", 0.0);
    Imu1GyroZ: row("IMU1_GYRO_Z", [-0.05, 0.05], 0.0, "rad/s", 0.0);
    Imu1OffsetX: row("IMU1_ACC_X", [-1.0, 1.0], 0.0, "m/s^2", 0.0);
    Imu1OffsetY: row("IMU1_ACC_Y", [-1.0, 1.0], 0.0, "m/s^2", 0.0);
    Imu1OffsetZ: row("IMU1_ACC_Z", [-1.0, 1.0], 0.0, "m/s^2", 0.0);
    Imu1ScaleX: row("IMU1_SCALE_X", [0.95, 1.05], 1.0, "", 0.0);
    Imu1ScaleY: row("IMU1_SCALE_Y", [0.95, 1.05], 1.0, "", 0.0);
    Imu1ScaleZ: row("IMU1_SCALE_Z", [0.95, 1.05], 1.0, "", 0.0);
    Imu1LevelX: row("IMU1_LEVEL_X", [-0.09, 0.09], 0.0, "", 0.0);
    Imu1LevelY: row("IMU1_LEVEL_Y", [-0.09, 0.09], 0.0, "", 0.0);
    Imu2GyroX: row("IMU2_GYRO_X", [-0.05, 0.05], 0.0, "rad/s", 0.0);
    Imu2GyroY: row("IMU2_GYRO_Y", [-0.05, 0.05], 0.0, "rad/s", 0.0);
    Imu2GyroZ: row("IMU2_GYRO_Z", [-0.05, 0.05], 0.0, "rad/s", 0.0);
    Imu2OffsetX: row("IMU2_ACC_X", [-1.0, 1.0], 0.0, "m/s^2", 0.0);
    Imu2OffsetY: row("IMU2_ACC_Y", [-1.0, 1.0], 0.0, "m/s^2", 0.0);
    Imu2OffsetZ: row("IMU2_ACC_Z", [-1.0, 1.0], 0.0, "m/s^2", 0.0);
    Imu2ScaleX: row("IMU2_SCALE_X", [0.95, 1.05], 1.0, "", 0.0);
    Imu2ScaleY: row("IMU2_SCALE_Y", [0.95, 1.05], 1.0, "", 0.0);
    Imu2ScaleZ: row("IMU2_SCALE_Z", [0.95, 1.05], 1.0, "", 0.0);
    Imu2LevelX: row("IMU2_LEVEL_X", [-0.09, 0.09], 0.0, "", 0.0);
    Imu2LevelY: row("IMU2_LEVEL_Y", [-0.09, 0.09], 0.0, "", 0.0);
    /// a of the motors' thrust curve a u + (1 - a) u^2 over the command u. Taken over at the next boot.
    ThrustCurve: built("THR_CURVE", [0.0, 1.0], "");
    /// The voltage at which the rotors' greatest thrust was measured; commands are corrected by the voltage there is. 0
    /// for never. Taken over at once.
    BatteryNominal: row("BAT_NOMINAL", [0.0, 60.0], 0.0, "V", 0.0);
    /// What a pose takes at least from the camera to the vehicle, where its sender does not answer TIMESYNC. Taken over
    /// at once.
    PoseDelay: row("POSE_DELAY", [0.0, 150.0], 0.0, "ms", 0.0);
    /// Below this voltage the vehicle lands, whatever is requested; 0 never does. Taken over at once.
    BatteryCritical: row("BAT_CRIT", [0.0, 60.0], 0.0, "V", 0.0);
    /// What the motors idle at, on the ground and in flight, as a part of the command's range. Certified and taken over
    /// as the rows from mass on.
    MotorIdle: built("MOT_IDLE", [0.0, IDLE_MAX], "");
    /// How high a take-off goes that names no height. Rows of flight settings are taken over at once.
    TakeOffHeight: row("TKO_ALT", [0.5, 50.0], 1.5, "m", 0.0);
    /// How fast a landing goes down.
    LandingSpeed: row("LAND_SPEED", [0.1, 2.0], 0.5, "m/s", 0.0);
    /// How long the ground station may be silent before a vehicle that holds lands.
    GroundStationPatience: row("GCS_WAIT", [2.5, 600.0], 10.0, "s", 0.0);
    /// The fence: how far from where it was armed the vehicle may go.
    FenceRadius: row("FENCE_RADIUS", [2.0, 10_000.0], 100.0, "m", 0.0);
    /// The fence: how high above that place.
    FenceHeight: row("FENCE_HEIGHT", [2.0, 10_000.0], 50.0, "m", 0.0);
    /// How far from its reference the vehicle may be for longer than 5 s before it lands.
    TrackingErrorMax: row("TRACK_ERR", [0.5, 100.0], 3.0, "m", 0.0);
    /// The configuration that the following rows, and motors, were tuned on. Read-only.
    TunedOn: row("CFG_ID", [0.0, 16_777_215.0], 0.0, "", 1.0);
    /// Mass. The rows from here to the last gain are certified when they are set, and taken over at the next boot: see
    /// [`super::tuned`].
    Mass: built("MASS", [0.01, 100.0], "kg");
    /// Limit of the thrust.
    ThrustMax: built("THR_MAX", [0.1, 10_000.0], "N");
    /// Limit of the torque about body x.
    TorqueMaxX: built("TRQ_MAX_X", [0.001, 1_000.0], "N m");
    /// Limit of the torque about body y.
    TorqueMaxY: built("TRQ_MAX_Y", [0.001, 1_000.0], "N m");
    /// Limit of the torque about body z.
    TorqueMaxZ: built("TRQ_MAX_Z", [0.001, 1_000.0], "N m");
    /// Reference bound: horizontal acceleration.
    AccelerationAcross: built("REF_ACC_XY", [0.01, 50.0], "m/s^2");
    /// Reference bound: vertical acceleration.
    AccelerationVertical: built("REF_ACC_Z", [0.01, 9.0], "m/s^2");
    /// Reference bound: jerk.
    Jerk: built("REF_JERK", [0.01, 500.0], "m/s^3");
    /// Reference bound: snap.
    Snap: built("REF_SNAP", [0.01, 5_000.0], "m/s^4");
    /// Reference bound: rate of the heading.
    HeadingRate: built("REF_YAW_RATE", [0.01, 20.0], "rad/s");
    /// Reference bound: second derivative of the heading's direction.
    HeadingAcceleration: built("REF_YAW_ACC", [0.01, 500.0], "1/s^2");
    /// Least thrust of each rotor.
    RotorThrustMin: built("ROT_THR_MIN", [0.0, 1_000.0], "N");
    /// Greatest thrust of each rotor.
    RotorThrustMax: built("ROT_THR_MAX", [0.01, 10_000.0], "N");
    /// Gain on attitude errors, percent of the built one.
    GainAttitude: gain("GAIN_ATT_P");
    /// Gain on body rates, percent of the built one.
    GainRate: gain("GAIN_ATT_D");
    /// Gain on horizontal position errors, percent of the built one.
    GainPositionAcross: gain("GAIN_XY_P");
    /// Gain on horizontal velocity errors, percent of the built one.
    GainVelocityAcross: gain("GAIN_XY_D");
    /// Gain on errors in height, percent of the built one.
    GainPositionVertical: gain("GAIN_Z_P");
    /// Gain on vertical velocity errors, percent of the built one.
    GainVelocityVertical: gain("GAIN_Z_D");
    /// Which output each rotor's controller is wired to, a digit a rotor: see [`outputs::wiring`]. Taken over at the
    /// next boot.
    MotorOrder: row("MOT_ORDER", [1234.0, 4321.0], 1234.0, "", 1.0);
    // Multiples of 57,600, the greatest by default.
    /// The serial line's baud rate. Taken over at the next boot.
    SerialRate: row("SER_BAUD", [57_600.0, 921_600.0], 921_600.0, "", 57_600.0);
    /// Whether what is not signed is refused, once there is a key. Taken over at once.
    SignedOnly: row("SIGN_ONLY", [0.0, 1.0], 1.0, "", 1.0);
    /// Whether the card takes the raw gyro, where there is one: see [`crate::recorder::gyro`]. Taken over at the next
    /// boot.
    LogGyro: row("LOG_GYRO", [0.0, 1.0], 0.0, "", 1.0);
    /// How the motors' controllers are spoken to: 0 DShot300; 1 both ways, they answer how fast their motors turn; 2
    /// the same, and they are asked for temperature, voltage and current. Taken over at the next boot.
    MotorProtocol: row("MOT_DSHOT", [0.0, 2.0], 0.0, "", 1.0);
    /// The motors' magnetic poles. Taken over at once.
    MotorPoles: row("MOT_POLES", [2.0, 60.0], 14.0, "", 2.0);
    /// The channel of a radio that carries packets, above 2,400 MHz. This row and the next two are taken over at the
    /// next boot.
    RadioChannel: row("RADIO_CHAN", [0.0, 125.0], 80.0, "MHz", 1.0);
    /// Its data rate: 0 250 kbit/s; 1 1 Mbit/s; 2 2 Mbit/s.
    RadioDataRate: row("RADIO_RATE", [0.0, 2.0], 2.0, "", 1.0);
    // A value holds 24 bits, an address 40.
    /// The last byte of its address, whose other four are 0xE7: 231 is 0xE7 as well.
    RadioAddress: row("RADIO_ADDR", [0.0, 255.0], 231.0, "", 1.0);
}

impl Name {
    /// Its row.
    pub fn row(self) -> &'static Row {
        // The table is in the order of the names; a test holds it to that.
        &PARAMETERS[self as usize]
    }

    /// Whether it stands for something of the built configuration.
    pub fn is_tuned(self) -> bool {
        matches!(self, Self::ThrustCurve | Self::MotorIdle)
            || (Self::Mass as u8..=Self::GainVelocityVertical as u8).contains(&(self as u8))
    }

    /// Every one that does.
    pub fn tuned() -> impl Iterator<Item = Self> {
        PARAMETERS.iter().map(|row| row.parameter).filter(|name| name.is_tuned())
    }

    /// The parameter of this MAVLink name.
    pub fn from_name(name: &str) -> Option<Self> {
        PARAMETERS.iter().find(|row| row.name == name).map(|row| row.parameter)
    }

    /// The parameter in this place of the table.
    pub fn from_index(index: usize) -> Option<Self> {
        PARAMETERS.get(index).map(|row| row.parameter)
    }
}

impl Row {
    /// Whether it may have this value.
    pub fn allows(&self, value: f32) -> bool {
        // NaN is in no range; a whole number of steps survives the way to an integer and back.
        let steps = (value - self.min) / self.step;
        (self.min..=self.max).contains(&value)
            && (self.step == 0.0 || steps as u32 as f32 == steps)
            && (self.parameter != Name::MotorOrder || outputs::wiring(value).is_some())
    }
}
