//! Missions in: items are taken one after the other, and only all of them together replace those that there were.
//!
//! ```text
//! MISSION_COUNT n -> MISSION_REQUEST_INT 0 -> item 0 -> ... -> item n - 1 -> MISSION_ACK
//! ```
//!
//! One client uploads at a time. The next item is requested again while it does not come, by the clock of whatever
//! frames come; an item of another number is dropped. After [`ITEM_TIMEOUT_US`] without the right one the upload is
//! given up, and the items that there were stay. A frame that the line delivers twice counts once. No mission is
//! changed while it is flown. The fence and the rally points are empty lists.

use super::Receiver;
use super::senders::Sender;
use super::upload::Upload;
use crate::link::command::Call;
use crate::link::frame::Frame;
use crate::link::mission::{Item, ItemRefusal, MISSION_CAPACITY, SentItem};
use crate::link::mission_lists::list_of;
use crate::link::origin::Origin;
use crate::shared::{Event, MissionList, QueuedRequest, Reply, Severity};
use core::fmt::Display;
use embassy_sync::blocking_mutex::raw::RawMutex;
use flight::{MissionRefusal, Request};
use mavlink::MessageData;
use mavlink::dialects::common::{
    MISSION_ACK_DATA, MISSION_CLEAR_ALL_DATA, MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MISSION_REQUEST_DATA,
    MISSION_REQUEST_INT_DATA, MISSION_REQUEST_LIST_DATA, MISSION_SET_CURRENT_DATA, MavCmd, MavMissionResult,
};
use nalgebra::Vector3;

/// How long an item is waited for before it is requested again, and how long in all: five times more, as the
/// protocol has it (<https://mavlink.io/en/services/mission.html>).
const ITEM_RETRY_INTERVAL_US: u64 = 250_000;
const ITEM_TIMEOUT_US: u64 = 1_500_000;

/// MAV_MISSION_TYPE: the mission, and all lists.
const LIST_MISSION: u8 = 0;
const LIST_ALL: u8 = 255;

impl<M: RawMutex> Receiver<'_, M> {
    pub(super) fn mission_count(&mut self, frame: &Frame<'_>, message: &MISSION_COUNT_DATA) {
        if self.is_repeated(frame) {
            return;
        }
        let list = requested_list(frame, message);
        let result = if list.list != LIST_MISSION {
            MavMissionResult::MAV_MISSION_UNSUPPORTED
        } else if let Err(result) = self.may_change(list.sender) {
            result
        } else if usize::from(message.count) > MISSION_CAPACITY {
            self.warn(format_args!("Mission: {} items, {MISSION_CAPACITY} at most", message.count));
            MavMissionResult::MAV_MISSION_NO_SPACE
        } else if message.count == 0 {
            self.change(&[]);
            MavMissionResult::MAV_MISSION_ACCEPTED
        } else {
            self.upload = Upload {
                client: Some(list.sender),
                count: message.count,
                progressed: frame.time,
                last: self.upload.last,
                taken: self.upload.taken,
                ..Upload::default()
            };
            return self.request_next(list.sender, frame.time);
        };
        self.shared.reply(Reply::Mission(list, result));
    }

    /// MISSION_ITEM_INT and MISSION_ITEM.
    pub(super) fn mission_item(&mut self, frame: &Frame<'_>) {
        let sent = SentItem::read(frame.payload, frame.message == MISSION_ITEM_INT_DATA::ID);
        if !self.is_target(sent.target.into()) || self.is_repeated(frame) {
            return;
        }
        let list = MissionList { sender: sender(frame), list: sent.list };
        let result = if sent.list != LIST_MISSION {
            MavMissionResult::MAV_MISSION_UNSUPPORTED
        } else if self.upload.client == Some(list.sender) {
            if usize::from(sent.sequence) != self.upload.items.len() {
                self.upload.is_out_of_sequence = true;
                return;
            }
            (self.upload.progressed, self.upload.is_out_of_sequence) = (frame.time, false);
            match self.take_item(&sent) {
                Ok(false) => return self.request_next(list.sender, frame.time),
                Ok(true) => self.finish(list.sender),
                Err(refusal) => {
                    self.upload.client = None;
                    self.warn(format_args!("Mission item {}: {refusal}", sent.sequence));
                    refusal.result()
                }
            }
        } else if self.upload.client.is_none()
            && self.upload.taken == Some(list.sender)
            && sent.sequence.checked_add(1) == Some(self.upload.count)
        {
            // The last answer was lost.
            MavMissionResult::MAV_MISSION_ACCEPTED
        } else {
            MavMissionResult::MAV_MISSION_INVALID_SEQUENCE
        };
        self.shared.reply(Reply::Mission(list, result));
    }

    /// Takes the next item; whether it was the last.
    fn take_item(&mut self, sent: &SentItem) -> Result<bool, ItemRefusal> {
        let is_last = sent.sequence.checked_add(1) == Some(self.upload.count);
        let item = sent.item(is_last)?;
        self.check_item(&item).map_err(ItemRefusal::Flight)?;
        // There is room for as many as were announced.
        let _ = self.upload.items.push(item);
        Ok(is_last)
    }

    /// Replaces the items that there were.
    fn finish(&mut self, client: Sender) -> MavMissionResult {
        self.upload.client = None;
        if let Err(result) = self.may_change(client) {
            return result;
        }
        self.upload.taken = Some(client);
        self.change(&self.upload.items);
        self.shared.announce(Event::new(Severity::Information, format_args!("Mission: {} items", self.upload.count)));
        MavMissionResult::MAV_MISSION_ACCEPTED
    }

    /// Other items, from the first of which a mission then begins.
    fn change(&self, items: &[Item]) {
        self.shared.mission().replace(items);
        self.shared.request(QueuedRequest { request: Request::SetMissionItem(0), order: None, setpoints: None });
    }

    /// Requests an item again that has not come by `now`, us, or gives the upload up.
    pub(super) fn retry_upload(&mut self, now: u64) {
        let Some(client) = self.upload.client else { return };
        if now.saturating_sub(self.upload.progressed) < ITEM_TIMEOUT_US {
            if now.saturating_sub(self.upload.requested) >= ITEM_RETRY_INTERVAL_US {
                self.request_next(client, now);
            }
            return;
        }
        self.upload.client = None;
        let (result, words) = if self.upload.is_out_of_sequence {
            (MavMissionResult::MAV_MISSION_INVALID_SEQUENCE, "Mission: not the items requested, nothing changed")
        } else {
            (MavMissionResult::MAV_MISSION_OPERATION_CANCELLED, "Mission: upload broken off, nothing changed")
        };
        self.warn(words);
        self.shared.reply(Reply::Mission(MissionList { sender: client, list: LIST_MISSION }, result));
    }

    /// A client breaks its upload off.
    pub(super) fn mission_ack(&mut self, frame: &Frame<'_>, _: &MISSION_ACK_DATA) {
        if self.upload.client == Some(sender(frame)) && list_of::<MISSION_ACK_DATA>(frame) == LIST_MISSION {
            self.upload.client = None;
        }
    }

    pub(super) fn mission_list(&mut self, frame: &Frame<'_>, message: &MISSION_REQUEST_LIST_DATA) {
        let list = requested_list(frame, message);
        let count = if list.list == LIST_MISSION { self.shared.mission().count() } else { 0 };
        self.shared.reply(Reply::MissionCount(list, count));
    }

    pub(super) fn mission_request(&mut self, frame: &Frame<'_>, message: &MISSION_REQUEST_DATA) {
        self.send_item(requested_list(frame, message), message.seq, false);
    }

    pub(super) fn mission_request_int(&mut self, frame: &Frame<'_>, message: &MISSION_REQUEST_INT_DATA) {
        self.send_item(requested_list(frame, message), message.seq, true);
    }

    fn send_item(&self, list: MissionList, number: u16, is_int: bool) {
        let exists = list.list == LIST_MISSION && number < self.shared.mission().count();
        self.shared.reply(match exists {
            true => Reply::MissionItem { list, number, is_int },
            false => Reply::Mission(list, MavMissionResult::MAV_MISSION_INVALID_SEQUENCE),
        });
    }

    /// The older way to send command 224, and answered as that.
    pub(super) fn mission_set_current(&mut self, frame: &Frame<'_>, message: &MISSION_SET_CURRENT_DATA) {
        let command = MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT;
        let parameters = [f32::from(message.seq), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        self.call(frame, &Call { command, parameters, place: None });
    }

    pub(super) fn mission_clear(&mut self, frame: &Frame<'_>, message: &MISSION_CLEAR_ALL_DATA) {
        let list = requested_list(frame, message);
        let result = match list.list {
            LIST_MISSION | LIST_ALL => self.may_change(list.sender).err().unwrap_or_else(|| {
                self.change(&[]);
                MavMissionResult::MAV_MISSION_ACCEPTED
            }),
            // They are empty already.
            _ => MavMissionResult::MAV_MISSION_ACCEPTED,
        };
        self.shared.reply(Reply::Mission(list, result));
    }

    /// Whether the whole mission may be flown from here.
    /// Errors: the first item that may not, and why.
    pub(super) fn check_mission(&self) -> Result<(), (u16, MissionRefusal)> {
        let mission = self.shared.mission();
        let count = mission.count();
        if count == 0 {
            return Err((0, MissionRefusal::NoItem));
        }
        (0..count).try_for_each(|number| {
            let item = mission.item(number).ok_or((number, MissionRefusal::NoItem))?;
            self.check_item(&item).map_err(|refusal| (number, refusal))
        })
    }

    /// Whether an item may be flown, as far as it is known where home is.
    fn check_item(&self, item: &Item) -> Result<(), MissionRefusal> {
        let Some(home) = self.shared.report().get().and_then(|report| report.value.home) else { return Ok(()) };
        let origin = self.shared.origin().get().map_or_else(Origin::default, |origin| origin.value);
        let home_ned: Vector3<f32> = crate::frames::world(&home);
        item.placed(&origin, &home_ned).check(&home, &self.shared.parameters().flight_settings())
    }

    /// Whether this client may change the mission now.
    fn may_change(&self, client: Sender) -> Result<(), MavMissionResult> {
        let is_flown = self.shared.report().get().is_some_and(|report| report.value.mission.is_flown);
        if is_flown {
            self.warn("Mission: not changed while it is flown");
        } else if self.upload.client.is_some_and(|other| other != client) {
            self.warn("Mission: another station sends one");
        } else {
            return Ok(());
        }
        Err(MavMissionResult::MAV_MISSION_DENIED)
    }

    fn request_next(&mut self, client: Sender, now: u64) {
        self.upload.requested = now;
        let list = MissionList { sender: client, list: LIST_MISSION };
        self.shared.reply(Reply::MissionRequest(list, self.upload.items.len() as u16));
    }

    /// Whether this frame of an upload was the last one as well.
    fn is_repeated(&mut self, frame: &Frame<'_>) -> bool {
        let this = Some((frame.header.sequence, frame.checksum));
        let is_again = self.upload.last == this;
        self.upload.last = this;
        if is_again {
            self.traffic.repeated = self.traffic.repeated.wrapping_add(1);
        }
        is_again
    }

    fn warn(&self, words: impl Display) {
        self.shared.announce(Event::new(Severity::Warning, words));
    }
}

fn sender(frame: &Frame<'_>) -> Sender {
    (frame.header.system, frame.header.component)
}

/// The client, and its list.
fn requested_list<D: MessageData>(frame: &Frame<'_>, _: &D) -> MissionList {
    MissionList { sender: sender(frame), list: list_of::<D>(frame) }
}
