//! Requests for logs: listed, read in any order, erased. Only while disarmed, a request at another time is refused in
//! words.

use super::Receiver;
use crate::link::frame::Frame;
use crate::shared::{CardState, Event, Reply, Severity};
use embassy_sync::blocking_mutex::raw::RawMutex;
use mavlink::dialects::common::{LOG_ERASE_DATA, LOG_REQUEST_DATA_DATA, LOG_REQUEST_END_DATA, LOG_REQUEST_LIST_DATA};

impl<M: RawMutex> Receiver<'_, M> {
    /// Whether logs may be handed out; reports it if not.
    fn may_read(&mut self, frame: &Frame<'_>) -> bool {
        let is_armed = self.shared.is_armed();
        if is_armed {
            self.refused();
            self.log_refused.warn(self.shared, frame.time, "Log: not while armed");
        }
        !is_armed
    }

    pub(super) fn list_recordings(&mut self, frame: &Frame<'_>, message: &LOG_REQUEST_LIST_DATA) {
        // A client that gets an empty list stops; one that wants a part and gets nothing repeats its request, and gets
        // it after landing.
        let list = Reply::Logs { first: message.start, last: message.end };
        self.shared.reply(if self.may_read(frame) { list } else { Reply::NoLogs });
    }

    pub(super) fn read_recording(&mut self, frame: &Frame<'_>, message: &LOG_REQUEST_DATA_DATA) {
        if self.may_read(frame) {
            self.shared.reply(Reply::LogData { id: message.id, offset: message.ofs, count: message.count });
        }
    }

    pub(super) fn end_reading(&mut self, _: &Frame<'_>, _: &LOG_REQUEST_END_DATA) {
        self.shared.reply(Reply::LogEnd);
    }

    /// The recorder's recording goes; files stay, because nothing on a vehicle deletes a file.
    pub(super) fn erase_recordings(&mut self, frame: &Frame<'_>, _: &LOG_ERASE_DATA) {
        if self.may_read(frame) {
            self.shared.recorder().erase();
            if self.shared.card().state() == CardState::Ready {
                let words = "Log: files stay on the card; delete them there";
                self.shared.announce(Event::new(Severity::Information, words));
            }
        }
    }
}
