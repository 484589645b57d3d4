//! Messages that only other vehicles use: reported once for each.

#![expect(deprecated, reason = "superseded messages: clients still send them")]

use super::Receiver;
use crate::link::frame::Frame;
use crate::shared::{Event, Severity};
use embassy_sync::blocking_mutex::raw::RawMutex;
use flight::{SETPOINT_AGE_MAX_US, Stamped};
use mavlink::MessageData;
use mavlink::dialects::common::{
    GPS_INPUT_DATA, MANUAL_CONTROL_DATA, MISSION_WRITE_PARTIAL_LIST_DATA, RC_CHANNELS_OVERRIDE_DATA,
    REQUEST_DATA_STREAM_DATA, SET_ACTUATOR_CONTROL_TARGET_DATA, SET_ATTITUDE_TARGET_DATA, SET_HOME_POSITION_DATA,
    SET_POSITION_TARGET_GLOBAL_INT_DATA, VISION_SPEED_ESTIMATE_DATA,
};

/// Messages that others use: number, at which byte of the payload the target system is, name. The setpoints first,
/// then what else is flown.
const NOT_USED: [(u32, usize, &str); 10] = [
    (SET_ATTITUDE_TARGET_DATA::ID, 36, SET_ATTITUDE_TARGET_DATA::NAME),
    (SET_POSITION_TARGET_GLOBAL_INT_DATA::ID, 50, SET_POSITION_TARGET_GLOBAL_INT_DATA::NAME),
    (SET_ACTUATOR_CONTROL_TARGET_DATA::ID, 41, SET_ACTUATOR_CONTROL_TARGET_DATA::NAME),
    (MANUAL_CONTROL_DATA::ID, 10, MANUAL_CONTROL_DATA::NAME),
    (RC_CHANNELS_OVERRIDE_DATA::ID, 16, RC_CHANNELS_OVERRIDE_DATA::NAME),
    (SET_HOME_POSITION_DATA::ID, 52, SET_HOME_POSITION_DATA::NAME),
    (MISSION_WRITE_PARTIAL_LIST_DATA::ID, 4, MISSION_WRITE_PARTIAL_LIST_DATA::NAME),
    (REQUEST_DATA_STREAM_DATA::ID, 2, REQUEST_DATA_STREAM_DATA::NAME),
    (VISION_SPEED_ESTIMATE_DATA::ID, FOR_ALL, VISION_SPEED_ESTIMATE_DATA::NAME),
    (GPS_INPUT_DATA::ID, FOR_ALL, GPS_INPUT_DATA::NAME),
];
const SETPOINT_MESSAGES: usize = 3;
const FLOWN_MESSAGES: usize = 5;
/// Behind every payload: for every system.
const FOR_ALL: usize = 255;

impl<M: RawMutex> Receiver<'_, M> {
    /// Explains a message that is not understood.
    pub(super) fn foreign(&mut self, frame: &Frame<'_>) {
        // Zeros at the end are cut off.
        let byte = |place: usize| frame.payload.get(place).copied().unwrap_or(0);
        let found = NOT_USED.iter().enumerate().find(|(_, (message, ..))| *message == frame.message);
        let Some((index, &(.., name))) = found.filter(|(_, (_, target, _))| self.is_target((byte(*target), 0))) else {
            return;
        };
        self.refused();
        if index < SETPOINT_MESSAGES {
            self.foreign.setpoint = Some(Stamped { value: name, time: frame.time });
        }
        if self.foreign.explained >> index & 1 == 0 {
            self.foreign.explained |= 1 << index;
            let what = if index < FLOWN_MESSAGES { "flown" } else { "used" };
            self.shared.announce(Event::new(Severity::Warning, format_args!("Not {what}: {name}")));
        }
    }

    /// The setpoints that come at `now`, us, and cannot be flown.
    pub(super) fn unflown(&self, now: u64) -> Option<&'static str> {
        let recent = self.foreign.setpoint.filter(|setpoint| setpoint.age(now) <= SETPOINT_AGE_MAX_US);
        recent.map(|setpoint| setpoint.value)
    }
}
