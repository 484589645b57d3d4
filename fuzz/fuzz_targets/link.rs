//! Bytes on the link, and frames whose checksums are right but whose numbers are anything. Whatever comes, a pose that
//! is handed on is made of numbers and never twice of one time, and so is a setpoint made of them as far as the
//! governor is concerned. And whatever parameters were set, a vehicle could fly with what was taken.

#![no_main]

use arbitrary::Arbitrary;
use controller_core::tuning::judged::JudgedLoops;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::link::frame::Parser;
use firmware::link::receive::Receiver;
use firmware::parameters::table::{Name, PARAMETERS};
use firmware::parameters::tuned::Built;
use firmware::shared::Shared;
use libfuzzer_sys::fuzz_target;
use mavlink::dialects::common::{MavMessage, MavParamType, PARAM_SET_DATA};
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, Message};
use std::sync::OnceLock;

/// The messages that the vehicle listens to: HEARTBEAT, PING, PARAM_REQUEST_READ, PARAM_REQUEST_LIST, PARAM_SET,
/// COMMAND_LONG, SET_POSITION_TARGET_LOCAL_NED, TIMESYNC, ATT_POS_MOCAP, ODOMETRY, COMMAND_INT, SET_GPS_GLOBAL_ORIGIN,
/// MISSION_REQUEST_LIST, MISSION_COUNT, MISSION_CLEAR_ALL, LOG_REQUEST_LIST, LOG_REQUEST_DATA, LOG_ERASE,
/// LOG_REQUEST_END, FILE_TRANSFER_PROTOCOL.
const RECEIVED_MESSAGE_IDS: [u32; 20] = [0, 4, 20, 21, 23, 76, 84, 111, 138, 331, 75, 48, 43, 44, 45, 117, 119, 121, 122, 110];

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
    let built = built();
    shared.parameters.boot(built);
    shared.can_restart.raise();
    let (mut parser, mut receiver) = (Parser::new(), Receiver::new(shared.for_receive()));
    let mut now = 1_000_000_u64;
    let mut last = Vec::new();
    let mut times = Vec::new();
    for event in events {
        let bytes = match event {
            Event::Bytes(bytes) => bytes,
            Event::Message { which, sender, sequence, mut payload } => {
                payload.resize(255, 0);
                let message = RECEIVED_MESSAGE_IDS[usize::from(which) % RECEIVED_MESSAGE_IDS.len()];
                if let Ok(mut message) = MavMessage::parse(MavlinkVersion::V2, message, &payload) {
                    if let MavMessage::PARAM_SET(set) = &mut message {
                        named(set, sequence);
                    }
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
        let _ = shared.restarting.take();
        assert!(!shared.is_busy());
    }
    if shared.parameters.set_by_hand().next().is_some() {
        assert_eq!(built.judge(|name| shared.parameters.raw(name)), Ok(()));
    }
});

/// What the embedded scenario is, with some of the gains' factors judged good and some not.
fn built() -> &'static Built {
    static LOOPS: OnceLock<JudgedLoops> = OnceLock::new();
    static BUILT: OnceLock<Built> = OnceLock::new();
    let loops = LOOPS.get_or_init(|| JudgedLoops::judge(|factors| factors.rate.percent() >= 90.0, |_| true));
    BUILT.get_or_init(|| {
        let configuration = firmware::configuration::embedded().unwrap();
        let (motor, period) = (firmware::configuration::MOTOR, firmware::configuration::PERIOD_US);
        Built { configuration, motor, loops, identity: 7, period, follows_rotors: false }
    })
}

/// A name that there is, where there is none; its value then lies within its range, on one of its steps.
fn named(set: &mut PARAM_SET_DATA, choice: u8) {
    if set.param_id.to_str().is_ok_and(|name| Name::from_name(name).is_some()) {
        return;
    }
    let row = &PARAMETERS[usize::from(choice) % PARAMETERS.len()];
    let part = f32::from(set.param_value.to_bits() as u8) / 255.0;
    let above = part * (row.max - row.min);
    let above = if row.step > 0.0 { (above / row.step).round() * row.step } else { above };
    *set = PARAM_SET_DATA {
        param_value: row.min + above,
        param_id: row.name.into(),
        param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        ..set.clone()
    };
}
