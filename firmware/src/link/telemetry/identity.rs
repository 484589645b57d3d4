//! The vehicle's identity, for clients that request it first.

#![expect(deprecated, reason = "PROTOCOL_VERSION: clients still ask for it")]

use mavlink::dialects::common::{AUTOPILOT_VERSION_DATA, MavProtocolCapability, PROTOCOL_VERSION_DATA};

/// This firmware's version, as MAVLink packs it: major, minor, patch, and a type (0: development).
const FIRMWARE_VERSION: u32 = number(env!("CARGO_PKG_VERSION_MAJOR")) << 24
    | number(env!("CARGO_PKG_VERSION_MINOR")) << 16
    | number(env!("CARGO_PKG_VERSION_PATCH")) << 8;

/// A decimal number, as cargo writes them.
const fn number(text: &str) -> u32 {
    match u32::from_str_radix(text, 10) {
        Ok(number) => number,
        Err(_) => panic!("cargo's version numbers are numbers"),
    }
}

/// What it understands: versions 1 and 2, parameters as floats, setpoints, COMMAND_INT, missions. No files.
pub fn autopilot_version() -> AUTOPILOT_VERSION_DATA {
    AUTOPILOT_VERSION_DATA {
        capabilities: MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_MAVLINK2
            | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST
            | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_COMMAND_INT
            | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_MISSION_INT
            | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED,
        flight_sw_version: FIRMWARE_VERSION,
        ..AUTOPILOT_VERSION_DATA::DEFAULT
    }
}

/// Versions of MAVLink: 1 and 2.
pub fn protocol_version() -> PROTOCOL_VERSION_DATA {
    PROTOCOL_VERSION_DATA { version: 200, min_version: 100, max_version: 200, ..PROTOCOL_VERSION_DATA::DEFAULT }
}
