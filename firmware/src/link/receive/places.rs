//! Places and missions in: an origin is kept, missions are refused.

#![expect(deprecated, reason = "superseded messages: clients still send them")]

use super::Receiver;
use crate::link::frame::Frame;
use crate::link::origin::Origin;
use crate::link::telemetry::kind::Kind;
use crate::shared::Reply;
use embassy_sync::blocking_mutex::raw::RawMutex;
use mavlink::dialects::common::{
    MISSION_CLEAR_ALL_DATA, MISSION_COUNT_DATA, MISSION_REQUEST_LIST_DATA, MavMissionResult, SET_GPS_GLOBAL_ORIGIN_DATA,
};

impl<M: RawMutex> Receiver<'_, M> {
    pub(super) fn set_origin(&mut self, frame: &Frame<'_>, message: &SET_GPS_GLOBAL_ORIGIN_DATA) {
        let SET_GPS_GLOBAL_ORIGIN_DATA { latitude, longitude, altitude, target_system } = *message;
        if !self.is_addressed(target_system, 0) {
            return;
        }
        match Origin::new(latitude, longitude, altitude) {
            Some(origin) => {
                self.shared.origin.put(origin, frame.time);
                self.shared.reply(Reply::Message(Kind::GlobalOrigin));
            }
            None => self.refused(),
        }
    }

    /// Missions are not flown here: whoever sends one is told.
    pub(super) fn mission_count(&mut self, frame: &Frame<'_>, message: &MISSION_COUNT_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            let result = MavMissionResult::MAV_MISSION_UNSUPPORTED;
            self.shared.reply(Reply::Mission(frame.header.system, frame.header.component, result));
        }
    }

    pub(super) fn mission_list(&mut self, frame: &Frame<'_>, message: &MISSION_REQUEST_LIST_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            self.shared.reply(Reply::NoMission(frame.header.system, frame.header.component));
        }
    }

    /// There is none: that is what was wanted.
    pub(super) fn mission_clear(&mut self, frame: &Frame<'_>, message: &MISSION_CLEAR_ALL_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            let result = MavMissionResult::MAV_MISSION_ACCEPTED;
            self.shared.reply(Reply::Mission(frame.header.system, frame.header.component, result));
        }
    }
}
