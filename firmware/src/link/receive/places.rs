//! Places, missions and files in: an origin is kept, missions and files are refused.

#![expect(deprecated, reason = "superseded messages: clients still send them")]

use super::Receiver;
use crate::link::files::FileRequest;
use crate::link::frame::Frame;
use crate::link::origin::Origin;
use crate::link::plans::list_of;
use crate::link::telemetry::kind::Kind;
use crate::shared::{MissionList, Reply};
use embassy_sync::blocking_mutex::raw::RawMutex;
use mavlink::MessageData;
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
                self.shared.origin().put(origin, frame.time);
                self.shared.reply(Reply::Message(Kind::GlobalOrigin));
            }
            None => self.refused(),
        }
    }

    /// Missions are not flown here: their sender is answered so.
    pub(super) fn mission_count(&mut self, frame: &Frame<'_>, message: &MISSION_COUNT_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            self.shared.reply(Reply::Mission(asked(frame, message), MavMissionResult::MAV_MISSION_UNSUPPORTED));
        }
    }

    pub(super) fn mission_list(&mut self, frame: &Frame<'_>, message: &MISSION_REQUEST_LIST_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            self.shared.reply(Reply::NoMission(asked(frame, message)));
        }
    }

    /// There is no mission: accepted.
    pub(super) fn mission_clear(&mut self, frame: &Frame<'_>, message: &MISSION_CLEAR_ALL_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            self.shared.reply(Reply::Mission(asked(frame, message), MavMissionResult::MAV_MISSION_ACCEPTED));
        }
    }

    /// There are no files either.
    pub(super) fn file(&mut self, frame: &Frame<'_>) {
        if let Some((request, _)) =
            FileRequest::of(frame).filter(|(_, [system, component])| self.is_addressed(*system, *component))
        {
            self.shared.reply(Reply::NoFiles(request));
        }
    }
}

/// The client, and its list.
fn asked<D: MessageData>(frame: &Frame<'_>, _: &D) -> MissionList {
    MissionList { sender: (frame.header.system, frame.header.component), list: list_of::<D>(frame) }
}
