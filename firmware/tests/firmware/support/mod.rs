//! An encoder that is not ours (the `mavlink` crate's own), flash that fails, and a clock that goes as fast as the
//! tests do.

pub mod bodies;
pub mod card;
pub mod chip;
pub mod desk;
pub mod line;
pub mod receiver;
pub mod simulator;

use core::cell::{Cell, RefCell};
use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};
use firmware::hardware::Clock;
use firmware::link::frame::Parser;
use mavlink::{MAVLinkV1MessageRaw, MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, MessageData};

/// The time between control ticks, us.
pub const PERIOD_US: u64 = 10_000;

/// The ground station of the tests.
pub const GROUND: MavHeader = MavHeader { system_id: 255, component_id: 190, sequence: 0 };

/// A version 2 frame.
pub fn v2<D: MessageData>(sequence: u8, message: &D) -> Vec<u8> {
    let mut raw = MAVLinkV2MessageRaw::new();
    raw.serialize_message_data(MavHeader { sequence, ..GROUND }, message);
    raw.raw_bytes().to_vec()
}

/// A version 2 frame of this sender's.
pub fn from<D: MessageData>(system_id: u8, component_id: u8, sequence: u8, message: &D) -> Vec<u8> {
    let mut raw = MAVLinkV2MessageRaw::new();
    raw.serialize_message_data(MavHeader { system_id: system_id.into(), component_id, sequence }, message);
    raw.raw_bytes().to_vec()
}

/// A version 1 frame.
pub fn v1<D: MessageData>(sequence: u8, message: &D) -> Vec<u8> {
    let mut raw = MAVLinkV1MessageRaw::new();
    raw.serialize_message_data(MavHeader { sequence, ..GROUND }, message);
    raw.raw_bytes().to_vec()
}

/// A version 2 frame around any payload.
pub fn v2_of_payload(sequence: u8, message: u32, extra_crc: u8, payload: &[u8]) -> Vec<u8> {
    let [low, middle, high, _] = message.to_le_bytes();
    let length = u8::try_from(payload.len()).unwrap();
    let mut frame = vec![0xFD, length, 0, 0, sequence, 255, 190, low, middle, high];
    frame.extend(payload);
    let checksum = mavlink::calculate_crc(&frame[1..], extra_crc);
    frame.extend(checksum.to_le_bytes());
    frame
}

/// A frame whose payload has the four bytes at `offset` replaced.
pub fn patched<D: MessageData>(message: &D, offset: usize, value: f32) -> Vec<u8> {
    let mut payload = [0; 255];
    let _ = message.ser(MavlinkVersion::V1, &mut payload);
    payload[offset..offset + 4].copy_from_slice(&value.to_le_bytes());
    v2_of_payload(9, D::ID, D::EXTRA_CRC, &payload[..D::ENCODED_LEN])
}

/// A frame with extension fields behind those that the message's type has.
pub fn extended<D: MessageData>(message: &D, extensions: &[u8]) -> Vec<u8> {
    let mut payload = [0; 255];
    let _ = message.ser(MavlinkVersion::V1, &mut payload);
    let end = D::ENCODED_LEN + extensions.len();
    payload[D::ENCODED_LEN..end].copy_from_slice(extensions);
    v2_of_payload(9, D::ID, D::EXTRA_CRC, &payload[..end])
}

/// Time that the test advances, us.
#[derive(Default)]
pub struct Simulated(pub Cell<u64>);

impl Clock for Simulated {
    fn now(&self) -> u64 {
        self.0.get()
    }

    async fn until(&self, time: u64) {
        core::future::poll_fn(|_| if self.0.get() >= time { Poll::Ready(()) } else { Poll::Pending }).await;
    }
}

impl Simulated {
    /// Polls `task` once a millisecond for `duration` (us), after `each` has run. The task must not end.
    pub fn run<F: Future>(&self, duration: u64, task: F, mut each: impl FnMut(u64)) {
        let mut task = pin!(task);
        let mut context = Context::from_waker(Waker::noop());
        let end = self.0.get() + duration;
        while self.0.get() < end {
            each(self.0.get());
            assert!(task.as_mut().poll(&mut context).is_pending(), "the task ended");
            self.0.set(self.0.get() + 1000);
        }
    }
}

/// Everything of one type in what was written.
pub fn sent<D: MessageData>(written: &RefCell<Vec<u8>>) -> Vec<D> {
    let mut parser = Parser::new();
    let mut found = Vec::new();
    for &byte in written.borrow().iter() {
        let frame = parser.push(byte, 0);
        found.extend(frame.and_then(|frame| frame.decode()));
    }
    assert_eq!(parser.discarded(), 0);
    found
}
