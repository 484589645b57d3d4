//! Commands that were delivered twice.
//!
//! A command sent again on purpose carries a new sequence number and acts again. The same frame twice may be the link's
//! doing, and must not start a second motor test, nor arm what was disarmed in between: it is acknowledged once more,
//! and does nothing. One that goes on being delivered acts once a second.

use super::frame::{Frame, Header};
use heapless::Deque;

/// How long the same frame again is a repetition. Its sequence number returns after 256 frames, which take longer.
const REPETITION_MAX_US: u64 = 1_000_000;

/// Commands that are remembered to detect repetitions.
const COMMANDS_REMEMBERED: usize = 8;

/// The frames that were acted on last.
#[derive(Debug, Default)]
pub struct Repetitions(Deque<Delivered, COMMANDS_REMEMBERED>);

/// A frame that was acted on, with the number of its command.
#[derive(Debug)]
struct Delivered {
    header: Header,
    checksum: u16,
    command: u16,
    time: u64,
}

/// The kind of a command's frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Delivery {
    /// One to act on.
    New,
    /// One again that was acted on.
    Again,
    /// The same, and its sender has sent that command in another frame since.
    Overtaken,
}

impl Repetitions {
    /// The kind of this frame of a command.
    pub fn check(&mut self, frame: &Frame<'_>, command: u16) -> Delivery {
        let Frame { header, checksum, time, .. } = *frame;
        let is_same = |before: &Delivered| {
            (before.header, before.checksum) == (header, checksum)
                && time.saturating_sub(before.time) < REPETITION_MAX_US
        };
        if let Some(place) = self.0.iter().position(is_same) {
            let sender = (header.system, header.component);
            let is_later =
                |later: &Delivered| ((later.header.system, later.header.component), later.command) == (sender, command);
            let is_overtaken = self.0.iter().skip(place + 1).any(is_later);
            return if is_overtaken { Delivery::Overtaken } else { Delivery::Again };
        }
        if self.0.is_full() {
            self.0.pop_front();
        }
        // There is room for it now.
        let _ = self.0.push_back(Delivered { header, checksum, command, time });
        Delivery::New
    }
}
