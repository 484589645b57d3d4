//! A receiver fed with frames, and everything it may change.

use super::v2;
use controller_core::estimator::PoseMeasurement;
use controller_core::flight::Stamped;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::link::frame::Parser;
use firmware::link::receive::Receiver;
use firmware::shared::{Report, Shared, Text};
use mavlink::MessageData;

/// What a single-threaded test shares.
pub type Local = Shared<NoopRawMutex>;

/// A receiver with its parser.
pub struct Fed<'a> {
    parser: Parser,
    receiver: Receiver<'a, NoopRawMutex>,
    sequence: u8,
}

impl<'a> Fed<'a> {
    /// Nothing received yet.
    pub fn new(shared: &'a Local) -> Self {
        Self { parser: Parser::new(), receiver: Receiver::new(shared), sequence: 0 }
    }

    /// Receives bytes at `now`, us.
    pub fn bytes(&mut self, bytes: &[u8], now: u64) {
        for &byte in bytes {
            let mut next = self.parser.push(byte, now);
            while let Some(frame) = next {
                self.receiver.take(&frame);
                next = self.parser.next_frame();
            }
        }
    }

    /// Receives a message at `now`, us.
    pub fn message<D: MessageData>(&mut self, message: &D, now: u64) {
        self.sequence = self.sequence.wrapping_add(1);
        self.bytes(&v2(self.sequence, message), now);
    }
}

/// Events announced so far, taken away.
pub fn texts(shared: &Local) -> Vec<String> {
    std::iter::from_fn(|| shared.events.take()).map(|event| Text::new(event).as_str().to_owned()).collect()
}

/// The last of the poses that wait for control, taken away with the others.
pub fn newest(shared: &Local) -> Option<Stamped<PoseMeasurement>> {
    std::iter::from_fn(|| shared.poses.take()).last()
}

/// Control's report, in this mode.
pub fn report(shared: &Local, mode: controller_core::flight::Mode, time: u64) {
    shared.report.put(Report { mode, ..Report::NONE }, time);
}
