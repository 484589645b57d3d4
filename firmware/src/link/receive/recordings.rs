//! The flight recorder, asked for its last recording: listed, read in any order, erased. There is never more than number 0.

use super::Receiver;
use crate::link::frame::Frame;
use crate::shared::Reply;
use embassy_sync::blocking_mutex::raw::RawMutex;
use mavlink::dialects::common::{LOG_ERASE_DATA, LOG_REQUEST_DATA_DATA, LOG_REQUEST_END_DATA, LOG_REQUEST_LIST_DATA};

impl<M: RawMutex> Receiver<'_, M> {
    pub(super) fn list_recordings(&mut self, _: &Frame<'_>, message: &LOG_REQUEST_LIST_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            self.shared.reply(Reply::Recording);
        }
    }

    pub(super) fn read_recording(&mut self, _: &Frame<'_>, message: &LOG_REQUEST_DATA_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            match message.id {
                0 => self.shared.reply(Reply::RecordingData { offset: message.ofs, count: message.count }),
                _ => self.refused(),
            }
        }
    }

    pub(super) fn end_reading(&mut self, _: &Frame<'_>, message: &LOG_REQUEST_END_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            self.shared.reply(Reply::RecordingData { offset: 0, count: 0 });
        }
    }

    pub(super) fn erase_recordings(&mut self, _: &Frame<'_>, message: &LOG_ERASE_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            self.shared.recorder.erase();
        }
    }
}
