//! Whom a message is for.

use crate::link::set_mode::SetMode;
use mavlink::dialects::common::{
    COMMAND_INT_DATA, COMMAND_LONG_DATA, LOG_ERASE_DATA, LOG_REQUEST_DATA_DATA, LOG_REQUEST_END_DATA,
    LOG_REQUEST_LIST_DATA, MISSION_ACK_DATA, MISSION_CLEAR_ALL_DATA, MISSION_COUNT_DATA, MISSION_REQUEST_DATA,
    MISSION_REQUEST_INT_DATA, MISSION_REQUEST_LIST_DATA, MISSION_SET_CURRENT_DATA, PARAM_REQUEST_LIST_DATA,
    PARAM_REQUEST_READ_DATA, PARAM_SET_DATA, SET_GPS_GLOBAL_ORIGIN_DATA, SET_POSITION_TARGET_LOCAL_NED_DATA,
    SETUP_SIGNING_DATA,
};

/// A message with a target.
pub(super) trait Addressed {
    /// System and component.
    fn target(&self) -> (u8, u8);
}

macro_rules! addressed {
    ($($message:ty),*) => {
        $(impl Addressed for $message {
            fn target(&self) -> (u8, u8) {
                (self.target_system, self.target_component)
            }
        })*
    };
}

addressed! {
    COMMAND_INT_DATA, COMMAND_LONG_DATA, LOG_ERASE_DATA, LOG_REQUEST_DATA_DATA, LOG_REQUEST_END_DATA,
    LOG_REQUEST_LIST_DATA, MISSION_ACK_DATA, MISSION_CLEAR_ALL_DATA, MISSION_COUNT_DATA, MISSION_REQUEST_DATA,
    MISSION_REQUEST_INT_DATA, MISSION_REQUEST_LIST_DATA, MISSION_SET_CURRENT_DATA, PARAM_REQUEST_LIST_DATA,
    PARAM_REQUEST_READ_DATA, PARAM_SET_DATA, SET_POSITION_TARGET_LOCAL_NED_DATA, SETUP_SIGNING_DATA
}

impl Addressed for SET_GPS_GLOBAL_ORIGIN_DATA {
    fn target(&self) -> (u8, u8) {
        (self.target_system, 0)
    }
}

impl Addressed for SetMode {
    fn target(&self) -> (u8, u8) {
        (self.system, 0)
    }
}
