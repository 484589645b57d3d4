//! What each port is about.

/// Texts for the operator.
pub const CONSOLE: u8 = 0;
/// [Parameters](super::parameters).
pub const PARAMETERS: u8 = 2;
/// The oldest [setpoints](super::setpoint): roll, pitch, yaw, thrust.
pub const COMMANDER: u8 = 3;
/// [Memories](super::memories).
pub const MEMORY: u8 = 4;
/// The [log](super::log).
pub const LOG: u8 = 5;
/// [Poses](super::localisation).
pub const LOCALISATION: u8 = 6;
/// [Setpoints](super::setpoint) of every other kind.
pub const SETPOINT: u8 = 7;
/// [Commands that name a place and a time](super::high_level).
pub const HIGH_LEVEL: u8 = 8;
/// The [supervisor](super::supervisor).
pub const SUPERVISOR: u8 = 9;
/// The [platform](super::platform).
pub const PLATFORM: u8 = 13;
/// The link itself.
pub const LINK: u8 = 15;

/// Every port on which a vehicle listens.
pub const ALL: [u8; 10] =
    [PARAMETERS, COMMANDER, MEMORY, LOG, LOCALISATION, SETPOINT, HIGH_LEVEL, SUPERVISOR, PLATFORM, LINK];
