//! The messages that are read and written, by number, and what is said in more than one of them. Where the fields lie stands
//! with whoever reads or writes them.

/// Who is there and how it does; read (ground stations' only) and written.
pub const HEARTBEAT: u32 = 0;
/// Load, battery, the line's losses; written.
pub const SYS_STATUS: u32 = 1;
/// Read and answered.
pub const PING: u32 = 4;
/// Read.
pub const PARAM_REQUEST_READ: u32 = 20;
/// Read.
pub const PARAM_REQUEST_LIST: u32 = 21;
/// Written.
pub const PARAM_VALUE: u32 = 22;
/// Read.
pub const PARAM_SET: u32 = 23;
/// Written.
pub const ATTITUDE_QUATERNION: u32 = 31;
/// Written.
pub const LOCAL_POSITION_NED: u32 = 32;
/// Read.
pub const COMMAND_LONG: u32 = 76;
/// Written.
pub const COMMAND_ACK: u32 = 77;
/// Read.
pub const SET_POSITION_TARGET_LOCAL_NED: u32 = 84;
/// Written to a simulator.
pub const HIL_ACTUATOR_CONTROLS: u32 = 93;
/// Read from a simulator.
pub const HIL_SENSOR: u32 = 107;
/// Read.
pub const ATT_POS_MOCAP: u32 = 138;
/// Written.
pub const STATUSTEXT: u32 = 253;
/// Read. Its number exists in version 2 only.
pub const ODOMETRY: u32 = 331;

/// How many bytes the fields of the messages take that are read, extensions left out.
pub const LENGTHS: [(u32, usize); 9] = [
    (HEARTBEAT, 9),
    (PING, 14),
    (PARAM_REQUEST_READ, 20),
    (PARAM_REQUEST_LIST, 2),
    (PARAM_SET, 23),
    (COMMAND_LONG, 33),
    (SET_POSITION_TARGET_LOCAL_NED, 53),
    (HIL_SENSOR, 64),
    (ATT_POS_MOCAP, 36),
];

/// MAV_MODE_FLAG, as far as it is used.
pub mod mode {
    /// The motors turn.
    pub const ARMED: u8 = 128;
    /// Hardware in the loop.
    pub const HIL: u8 = 32;
    /// Stabilised.
    pub const STABILIZE: u8 = 16;
    /// Flies by setpoints.
    pub const GUIDED: u8 = 8;
    /// Something is being tested.
    pub const TEST: u8 = 2;
    /// The custom mode counts.
    pub const CUSTOM: u8 = 1;
}

/// MAV_PARAM_TYPE_REAL32: the type of every parameter.
pub const REAL32: u8 = 9;

/// MAV_FRAME_LOCAL_NED: north, east, down from where the vehicle started.
pub const LOCAL_NED: u8 = 1;
