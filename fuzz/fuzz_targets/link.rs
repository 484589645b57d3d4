//! Bytes on the link, and frames whose checksums are right but whose numbers are anything. Whatever comes, a pose that is handed
//! on is made of numbers and never twice of one time, and so is a setpoint made of them as far as the governor is concerned.

#![no_main]

use arbitrary::Arbitrary;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::link::frame::Parser;
use firmware::link::receive::Receiver;
use firmware::shared::Shared;
use libfuzzer_sys::fuzz_target;
use mavlink::dialects::common::MavMessage;
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, Message};

/// The messages that the vehicle listens to: HEARTBEAT, PING, PARAM_REQUEST_READ, PARAM_REQUEST_LIST, PARAM_SET, COMMAND_LONG,
/// SET_POSITION_TARGET_LOCAL_NED, TIMESYNC, ATT_POS_MOCAP, ODOMETRY, COMMAND_INT, SET_GPS_GLOBAL_ORIGIN, MISSION_REQUEST_LIST,
/// MISSION_COUNT, MISSION_CLEAR_ALL, LOG_REQUEST_LIST, LOG_REQUEST_DATA, LOG_ERASE, LOG_REQUEST_END,
/// FILE_TRANSFER_PROTOCOL.
const LISTENED: [u32; 20] = [0, 4, 20, 21, 23, 76, 84, 111, 138, 331, 75, 48, 43, 44, 45, 117, 119, 121, 122, 110];

#[derive(Debug, Arbitrary)]
enum Event {
    /// Bytes as they are.
    Bytes(Vec<u8>),
    /// A message with this payload, from one of a few senders.
    Message { which: u8, sender: u8, sequence: u8, payload: Vec<u8> },
    /// The last message again.
    Again,
    /// Time passes, us.
    Wait(u32),
}

fuzz_target!(|events: Vec<Event>| {
    let shared: Shared<NoopRawMutex> = Shared::new();
    let (mut parser, mut receiver) = (Parser::new(), Receiver::new(&shared));
    let mut now = 1_000_000_u64;
    let mut last = Vec::new();
    let mut times = Vec::new();
    for event in events {
        let bytes = match event {
            Event::Bytes(bytes) => bytes,
            Event::Message { which, sender, sequence, mut payload } => {
                payload.resize(255, 0);
                let message = LISTENED[usize::from(which) % LISTENED.len()];
                if let Ok(message) = MavMessage::parse(MavlinkVersion::V2, message, &payload) {
                    let mut frame = MAVLinkV2MessageRaw::new();
                    let header = MavHeader { system_id: u32::from(250 + sender % 4), component_id: 1, sequence };
                    frame.serialize_message(header, &message);
                    last = frame.raw_bytes().to_vec();
                }
                last.clone()
            }
            Event::Again => last.clone(),
            Event::Wait(time) => {
                now += u64::from(time);
                continue;
            }
        };
        now += bytes.len() as u64 * 11;
        parser.feed(&bytes, now, &mut |frame| receiver.take(frame));
        while let Some(pose) = shared.poses.take() {
            let value = &pose.value;
            let numbers = value.position().iter().chain(value.attitude().coords.iter()).all(|x| x.is_finite());
            assert!(numbers && (value.attitude().norm() - 1.0).abs() < 1e-3, "{pose:?}");
            assert!(pose.time <= now, "a pose of a time to come: {pose:?} at {now}");
            assert!(!times.contains(&pose.time), "a time served twice: {pose:?}");
            times.push(pose.time);
        }
        while shared.requests.take().is_some() {}
        let _ = shared.disarm.take();
    }
});
