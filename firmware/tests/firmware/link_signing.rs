//! Signed frames: those of pymavlink's own signing, forged, replayed and cut ones, and the key's way in.
//!
//! The frames in hexadecimal are pymavlink 2.4.50's, from `MAVLink.signing` with the key 00 01 02 … 1f:
//!
//! ```python
//! mav = common.MAVLink(None, srcSystem=255, srcComponent=190)
//! mav.signing.secret_key, mav.signing.sign_outgoing = bytes(range(32)), True
//! mav.signing.link_id, mav.signing.timestamp = 3, 0x0102030405
//! print(common.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3).pack(mav).hex())
//! ```

mod key;

use crate::support::chip::{Chip, Words};
use crate::support::line::Outgoing;
use crate::support::receiver::{Fed, Local, command, disarm, replies, report, texts};
use crate::support::{Simulated, v1, v2};
use core::cell::RefCell;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::link::frame::Parser;
use firmware::link::signing::{
    KEPT_AHEAD, KEPT_AHEAD_MIN, Key, LEAP_MAX, Refusal, STAMP_MAX, STREAMS_KNOWN, Signing, Stamp,
};
use firmware::link::transmit::transmit;
use firmware::parameters::storage::Storage;
use firmware::parameters::table::Name;
use firmware::shared::{Event, Reply, Severity};
use flight::Mode;
use mavlink::dialects::common::{
    HEARTBEAT_DATA, MavCmd, MavModeFlag, MavSeverity, MavState, MavType, RADIO_STATUS_DATA, SETUP_SIGNING_DATA,
    STATUSTEXT_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MessageData};

/// A ground station's heartbeat, its order to arm, and its order to stop, signed with stamps that follow each other.
const HEARTBEAT: &str = "fd09010000ffbe000000000000000608000003bbd303050403020100e3750378e479";
const ARM: &str = "fd20010001ffbe4c00000000803f00000000000000000000000000000000000000000000000090010101a79a\
    03060403020100a0586cd1f031";
const STOP: &str = "fd20010002ffbe4c0000000000000098a546000000000000000000000000000000000000000090010101b7e1\
    0307040302010068953a1df0a4";
/// The stamp of the first.
const FIRST_STAMP: Stamp = 0x01_0203_0405;

/// Frames of vehicle 1, component 1, on link 0.
const OWN: [&str; 2] = [
    "fd09010000010100000000000000020000030364be00050403020100d20754b034b3",
    "fd0d0100010101fd0000045369676e696e673a206f6666ba4a00060403020100a9be29c924e1",
];

/// Time of a test, us, long before the stamps' clock is a minute further.
const NOW_US: u64 = 1_000;

fn bytes(hexadecimal: &str) -> Vec<u8> {
    let digits: Vec<u8> = hexadecimal.bytes().map(|digit| (digit as char).to_digit(16).unwrap() as u8).collect();
    digits.chunks(2).map(|pair| pair[0] << 4 | pair[1]).collect()
}

fn key() -> Option<Key> {
    Key::new(core::array::from_fn(|index| index as u8))
}

/// A vehicle with a key, ready.
fn keyed() -> Local {
    let shared = Local::new();
    report(&shared, Mode::Ready, 0);
    shared.signing.set(key(), FIRST_STAMP - 1, 0);
    shared
}

/// What a stop that was received leaves behind.
fn is_stopped(shared: &Local) -> bool {
    shared.disarm.take()
}

/// Frames of some system and component, signed with a key on a clock of their own.
struct Sender {
    header: MavHeader,
    signing: Signing<NoopRawMutex>,
}

impl Sender {
    fn new(system: u32, key: Option<Key>, stamp: Stamp) -> Self {
        let signing = Signing::new();
        signing.set(key, stamp, 0);
        Self { header: MavHeader { system_id: system, component_id: 190, sequence: 0 }, signing }
    }

    fn say(&mut self, message: &impl MessageData, now: u64) -> Vec<u8> {
        let mut frame = MAVLinkV2MessageRaw::new();
        self.header.sequence = self.header.sequence.wrapping_add(1);
        frame.serialize_message_data(self.header, message);
        self.signing.sign(&mut frame, now);
        frame.raw_bytes().to_vec()
    }
}

/// The verdict of a vehicle with this state of signing on a frame.
fn judged(signing: &Signing<NoopRawMutex>, frame: &[u8], now: u64) -> Result<(), Refusal> {
    let (mut parser, mut verdict) = (Parser::new(), None);
    parser.feed(frame, now, &mut |frame| verdict = Some(signing.judge(frame, true)));
    verdict.unwrap()
}

#[test]
fn what_pymavlink_signed_counts() {
    let shared = keyed();
    let mut fed = Fed::new(&shared);
    fed.bytes(&bytes(HEARTBEAT), NOW_US);
    assert!(shared.ground_station.get().is_some());
    fed.bytes(&bytes(ARM), NOW_US);
    assert!(shared.requests.take().is_some());
    fed.bytes(&bytes(STOP), NOW_US);
    assert!(is_stopped(&shared));
    assert_eq!(texts(&shared), [""; 0]);
}

#[test]
fn the_vehicle_signs_as_pymavlink_does() {
    let heartbeat = HEARTBEAT_DATA {
        mavtype: MavType::MAV_TYPE_QUADROTOR,
        system_status: MavState::MAV_STATE_STANDBY,
        base_mode: MavModeFlag::empty(),
        mavlink_version: 3,
        ..HEARTBEAT_DATA::DEFAULT
    };
    let text = STATUSTEXT_DATA { severity: MavSeverity::MAV_SEVERITY_WARNING, text: "Signing: off".into() };
    let mut sender = Sender::new(1, key(), FIRST_STAMP - 1);
    (sender.header.component_id, sender.header.sequence) = (1, u8::MAX);
    assert_eq!(sender.say(&heartbeat, 0), bytes(OWN[0]));
    assert_eq!(sender.say(&text, 0), bytes(OWN[1]));
}

#[test]
fn a_frame_with_any_bit_changed_does_nothing() {
    for frame in [HEARTBEAT, ARM, STOP].map(bytes) {
        for bit in 0..8 * frame.len() {
            let shared = keyed();
            let mut changed = frame.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            Fed::new(&shared).bytes(&changed, NOW_US);
            let nothing = shared.ground_station.get().is_none() && shared.requests.take().is_none();
            assert!(nothing && !is_stopped(&shared) && replies(&shared).is_empty(), "bit {bit}");
        }
    }
}

#[test]
fn a_frame_that_is_not_signed_is_refused_in_words_as_the_parameter_says() {
    for frame in [v2(1, &disarm()), v1(2, &disarm())] {
        for (signed_only, taken) in [(1.0, false), (0.0, true)] {
            let shared = keyed();
            shared.parameters.set(Name::SignedOnly, signed_only).unwrap();
            Fed::new(&shared).bytes(&frame, NOW_US);
            assert_eq!((is_stopped(&shared), texts(&shared).is_empty()), (taken, taken));
        }
        let shared = keyed();
        Fed::new(&shared).bytes(&frame, NOW_US);
        assert_eq!(texts(&shared), ["Refused: not signed"]);
        assert_eq!(shared.replies.take(), None);
    }
    // Without a key nothing is, whatever the parameter.
    let shared = Local::new();
    Fed::new(&shared).bytes(&v2(1, &disarm()), NOW_US);
    assert!(is_stopped(&shared));
}

#[test]
fn heartbeats_and_radios_that_do_not_sign_are_passed_over_without_a_word() {
    let shared = keyed();
    let mut fed = Fed::new(&shared);
    fed.message(&HEARTBEAT_DATA { mavtype: MavType::MAV_TYPE_GCS, ..HEARTBEAT_DATA::DEFAULT }, NOW_US);
    fed.message(&RADIO_STATUS_DATA::DEFAULT, NOW_US);
    assert_eq!(texts(&shared), [""; 0]);
    // A stranger's heartbeat must not keep the failsafe of a lost station asleep.
    assert!(shared.ground_station.get().is_none());
}

#[test]
fn another_key_is_refused_wherever_unsigned_frames_are_not() {
    for signed_only in [1.0, 0.0] {
        let shared = Local::new();
        shared.signing.set(Key::new([7; 32]), FIRST_STAMP - 1, 0);
        shared.parameters.set(Name::SignedOnly, signed_only).unwrap();
        Fed::new(&shared).bytes(&bytes(STOP), NOW_US);
        assert!(!is_stopped(&shared));
        assert_eq!(texts(&shared), ["Refused: signed with another key"]);
    }
}

#[test]
fn refusals_are_reported_once_a_second() {
    let shared = keyed();
    let mut fed = Fed::new(&shared);
    for step in 0..300 {
        fed.message(&disarm(), NOW_US + step * 10_000);
    }
    assert_eq!(texts(&shared).len(), 3);
}

#[test]
fn a_signature_that_is_cut_off_is_no_frame_and_the_next_one_is_found() {
    let stop = bytes(STOP);
    for length in stop.len() - 13..stop.len() {
        let shared = keyed();
        let mut fed = Fed::new(&shared);
        fed.bytes(&stop[..length], NOW_US);
        assert!(!is_stopped(&shared), "{length} bytes");
        // The next frame fills it up to its length; what is left of that is noise, and the one after it counts.
        fed.bytes(&bytes(HEARTBEAT), NOW_US);
        fed.bytes(&stop, NOW_US + 200_000);
        assert!(is_stopped(&shared), "{length} bytes");
    }
}

#[test]
fn a_frame_received_once_is_refused_for_ever() {
    let shared = keyed();
    let mut fed = Fed::new(&shared);
    fed.bytes(&bytes(STOP), NOW_US);
    assert!(is_stopped(&shared));
    // The same again, and one from before it that the line kept for a while.
    for old in [STOP, ARM, STOP] {
        fed.bytes(&bytes(old), NOW_US + 2_000_000);
        assert!(!is_stopped(&shared) && shared.requests.take().is_none());
    }
    assert_eq!(texts(&shared), ["Refused: its time stamp was used before"]);
}

#[test]
fn a_stream_that_was_forgotten_cannot_be_replayed() {
    let signing = Signing::new();
    signing.set(key(), FIRST_STAMP, 0);
    let mut first = Sender::new(100, key(), FIRST_STAMP);
    let frames = first.say(&disarm(), 0);
    assert_eq!(judged(&signing, &frames, 0), Ok(()));
    // As many others as there is room for, all ahead of it.
    for system in 0..STREAMS_KNOWN as u32 {
        let mut other = Sender::new(system + 1, key(), FIRST_STAMP + 10);
        assert_eq!(judged(&signing, &other.say(&disarm(), 0), 0), Ok(()), "{system}");
    }
    assert_eq!(judged(&signing, &frames, 0), Err(Refusal::Replayed));
    // It goes on where it was.
    assert_eq!(judged(&signing, &first.say(&disarm(), 0), 0), Ok(()));
}

#[test]
fn streams_rise_each_by_itself_and_a_new_one_is_at_most_a_minute_behind() {
    let signing = Signing::new();
    signing.set(key(), 0, 0);
    let minute: Stamp = 6_000_000;
    let says = |system, stamp| Sender::new(system, key(), stamp - 1).say(&disarm(), 0);
    assert_eq!(judged(&signing, &says(1, 10 * minute), 0), Ok(()));
    assert_eq!(judged(&signing, &says(2, 9 * minute), 0), Ok(()));
    assert_eq!(judged(&signing, &says(3, 9 * minute - 1), 0), Err(Refusal::Replayed));
    assert_eq!(judged(&signing, &says(2, 9 * minute + 1), 0), Ok(()));
    // The clock goes on by itself: 30 s later so does what is a minute behind it.
    assert_eq!(judged(&signing, &says(4, 9 * minute + minute / 2 - 1), 30_000_000), Err(Refusal::Replayed));
    assert_eq!(judged(&signing, &says(5, 9 * minute + minute / 2), 30_000_000), Ok(()));
}

#[test]
fn a_forged_frame_moves_no_clock() {
    let signing = Signing::new();
    signing.set(key(), FIRST_STAMP, 0);
    let mut forged = Sender::new(100, Key::new([7; 32]), 1 << 47);
    assert_eq!(judged(&signing, &forged.say(&disarm(), 0), 0), Err(Refusal::Forged));
    assert_eq!(judged(&signing, &Sender::new(100, key(), FIRST_STAMP).say(&disarm(), 0), 0), Ok(()));
}

#[test]
fn every_frame_out_is_signed_with_a_stamp_of_its_own() {
    let (clock, shared, written) = (Simulated::default(), keyed(), RefCell::new(Vec::new()));
    let ear = Signing::<NoopRawMutex>::new();
    ear.set(key(), 0, 0);
    clock.run(
        3_000_000,
        transmit(Outgoing { written: &written, at_once: 300 }, &clock, shared.for_transmit()),
        |now| {
            if now == 1_000_000 {
                shared.reply(Reply::AllParameters);
                shared.announce(Event::new(Severity::Information, "Here"));
            }
        },
    );
    let (mut parser, mut count) = (Parser::new(), 0);
    parser.feed(&written.borrow(), 0, &mut |frame| {
        count += 1;
        assert_eq!(ear.judge(frame, true), Ok(()), "message {} of {} bytes", frame.message, frame.bytes.len());
    });
    assert!(count > 70 && parser.discarded() == 0, "{count} frames, {} bytes of none", parser.discarded());
}

/// A frame with this stamp, whatever it is, of a system that sends nothing else.
fn stamped(system: u32, stamp: Stamp) -> Vec<u8> {
    Sender::new(system, key(), 0).say(&HEARTBEAT_DATA::DEFAULT, stamp * 10)
}

#[test]
fn one_stamp_far_ahead_blocks_no_other_sender() {
    let signing = Signing::<NoopRawMutex>::new();
    signing.set(key(), FIRST_STAMP, 0);
    let year = LEAP_MAX;
    // The first frame since the start may set the clock, but not beyond what 48 bits last for.
    for stamp in [STAMP_MAX, (1 << 48) - 5_000, (1 << 48) - 1] {
        assert_eq!(judged(&signing, &stamped(7, stamp), 0), Err(Refusal::Ahead));
    }
    assert_eq!(judged(&signing, &stamped(7, FIRST_STAMP + 9 * year), 0), Ok(()));
    // After that a clock that is wrong by years is refused, of a stream that is known and of another.
    let now = FIRST_STAMP + 9 * year;
    for (system, stamp) in [(7, now + year + 1), (8, now + 2 * year), (8, STAMP_MAX - 1)] {
        assert_eq!(judged(&signing, &stamped(system, stamp), 0), Err(Refusal::Ahead));
    }
    // And those whose clock is right are accepted.
    assert_eq!(judged(&signing, &stamped(9, now + 1), 0), Ok(()));
    assert_eq!(judged(&signing, &stamped(7, now + 2), 0), Ok(()));
    assert_eq!(judged(&signing, &stamped(9, now + year), 0), Ok(()));
    // A key may come with any stamp.
    signing.set(Key::new([9; 32]), Stamp::MAX, 0);
    let mut sender = Sender::new(9, Key::new([9; 32]), FIRST_STAMP);
    assert_eq!(judged(&signing, &sender.say(&HEARTBEAT_DATA::DEFAULT, 0), 0), Ok(()));
    // After a start it may be set once more.
    let started = Signing::<NoopRawMutex>::new();
    started.restore(&signing.unkept(0, false).unwrap());
    let mut sender = Sender::new(9, Key::new([9; 32]), FIRST_STAMP + 9 * year);
    assert_eq!(judged(&started, &sender.say(&HEARTBEAT_DATA::DEFAULT, 0), 0), Ok(()));
}
