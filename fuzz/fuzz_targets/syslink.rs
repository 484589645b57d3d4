//! Bytes of a radio chip, and frames whose sums are right. Whatever comes, a frame is understood once what came before
//! it can no longer be the beginning of one, the battery is a voltage, and a packet is one that came.

#![no_main]

use arbitrary::Arbitrary;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::syslink::Wire;
use firmware::syslink::frame::{FRAME_MAX_BYTES, Frame};
use firmware::syslink::parser::Parser;
use firmware::syslink::receive::Listener;
use libfuzzer_sys::fuzz_target;

/// In no frame's beginning.
const QUIET: u8 = 0x55;

#[derive(Debug, Arbitrary)]
enum Event {
    /// Bytes as they are.
    Bytes(Vec<u8>),
    /// A frame.
    Frame { kind: u8, data: Vec<u8> },
    /// Bytes that begin none, as many as the longest frame has.
    Quiet,
}

fuzz_target!(|events: Vec<Event>| {
    let wire: Wire<NoopRawMutex> = Wire::new();
    let (mut listener, mut parser) = (Listener::new(&wire), Parser::new());
    let mut found = vec![];
    // What came, and how many of its frames' bytes.
    let (mut bytes_in, mut bytes_out) = (0, 0);
    // Whether bytes that are no frame may have been the beginning of one.
    let mut whole = true;
    for (now, event) in events.into_iter().enumerate() {
        let (bytes, sent) = match event {
            Event::Bytes(bytes) => (bytes, None),
            Event::Frame { kind, data } => match Frame::new(kind, &data) {
                Some(frame) => (frame.to_bytes().to_vec(), Some(frame)),
                None => continue,
            },
            Event::Quiet => (vec![QUIET; FRAME_MAX_BYTES], None),
        };
        listener.feed(&bytes, now as u64);
        found.clear();
        parser.feed(&bytes, |frame| found.push(frame));
        bytes_in += bytes.len();
        bytes_out += found.iter().map(|frame| frame.to_bytes().len()).sum::<usize>();
        let dropped = parser.dropped();
        assert!(dropped.frames <= dropped.bytes);
        let waiting = bytes_in - bytes_out - dropped.bytes as usize;
        assert!(waiting < FRAME_MAX_BYTES, "{waiting} bytes wait");
        if let Some(sent) = &sent {
            assert!(!whole || found == [sent.clone()], "{sent:?}: {found:?}");
        }
        whole = waiting == 0;
        assert!(wire.voltage().is_none_or(|voltage| voltage.value.is_finite() && voltage.value >= 0.0));
        assert!(wire.strength().is_none_or(|strength| (-255..=0).contains(&strength.value)));
        assert_eq!(wire.dropped(), Some(dropped));
    }
});
