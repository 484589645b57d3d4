//! Frames out of any stream of bytes: whole, broken, repeated, hidden behind noise.

use crate::support::{v1, v2, v2_of_payload};
use firmware::link::frame::{FRAME_AGE_MAX_US, FRAME_MAX_BYTES, Header, Parser, Version};
use mavlink::dialects::common::{
    ATT_POS_MOCAP_DATA, COMMAND_LONG_DATA, HEARTBEAT_DATA, LOGGING_DATA_DATA, MavCmd, ODOMETRY_DATA,
    PARAM_REQUEST_LIST_DATA, PARAM_SET_DATA,
};
use mavlink::{MavlinkVersion, MessageData};
use proptest::prelude::*;

/// What a parser makes of `bytes`, a microsecond apart: message numbers and sequence numbers.
fn parsed(bytes: &[u8]) -> Vec<(u32, u8)> {
    let mut parser = Parser::new();
    let mut found = Vec::new();
    for (time, &byte) in bytes.iter().enumerate() {
        let mut next = parser.push(byte, time as u64);
        while let Some(frame) = next {
            found.push((frame.message, frame.header.sequence));
            next = parser.next_frame();
        }
    }
    found
}

fn arm() -> COMMAND_LONG_DATA {
    COMMAND_LONG_DATA { param1: 1.0, command: MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, ..Default::default() }
}

fn odometry() -> ODOMETRY_DATA {
    ODOMETRY_DATA { time_usec: 5, x: 1.0, q: [1.0, 0.0, 0.0, 0.0], pose_covariance: [0.1; 21], ..Default::default() }
}

#[test]
fn frames_of_both_versions_are_found() {
    let bytes = [v1(1, &arm()), v2(2, &arm()), v2(3, &odometry()), v1(4, &HEARTBEAT_DATA::default())].concat();
    let (command, pose, heartbeat) = (COMMAND_LONG_DATA::ID, ODOMETRY_DATA::ID, HEARTBEAT_DATA::ID);
    assert_eq!(parsed(&bytes), [(command, 1), (command, 2), (pose, 3), (heartbeat, 4)]);
}

#[test]
fn fields_come_out_as_they_went_in() {
    let mut parser = Parser::new();
    let bytes = v2(9, &odometry());
    let (last, rest) = bytes.split_last().unwrap();
    for &byte in rest {
        assert!(parser.push(byte, 70).is_none());
    }
    let frame = parser.push(*last, 80).unwrap();
    assert_eq!(frame.header, Header { system: 255, component: 190, sequence: 9 });
    assert_eq!((frame.version, frame.time), (Version::V2, 70));
    assert_eq!(frame.decode(), Some(odometry()));
    assert_eq!(parser.discarded(), 0);
}

#[test]
fn every_single_wrong_byte_is_noticed() {
    let good = v2(1, &arm());
    for place in 0..good.len() {
        for flip in [0x01, 0x80, 0xFF] {
            let mut bytes = good.clone();
            bytes[place] ^= flip;
            assert!(!parsed(&bytes).contains(&(COMMAND_LONG_DATA::ID, 1)), "byte {place}, {flip:#x}");
        }
    }
}

#[test]
fn a_truncated_frame_costs_itself_and_what_lies_where_its_payload_should() {
    let (whole, next) = (v2(1, &odometry()), v2(2, &arm()));
    for length in 0..whole.len() {
        // The frames behind it may only come out once enough bytes show that the first was broken.
        let frames = [v2(3, &odometry()), v2(4, &odometry()), v2(5, &odometry())].concat();
        let found = parsed(&[&whole[..length], &next, &frames].concat());
        // Within a header the frame's length is unknown.
        let next_whole = if (1..10).contains(&length) { 5 } else { 3 };
        assert!(found.contains(&(ODOMETRY_DATA::ID, next_whole)), "{length}: {found:?}");
        let reaches_beyond = length + next.len() > whole.len();
        assert_eq!(found.contains(&(COMMAND_LONG_DATA::ID, 2)), length == 0 || reaches_beyond, "{length}: {found:?}");
    }
}

#[test]
fn a_repeated_frame_comes_out_twice_for_its_reader_to_judge() {
    let frame = v2(1, &arm());
    assert_eq!(parsed(&[frame.clone(), frame].concat()), [(COMMAND_LONG_DATA::ID, 1); 2]);
}

/// A frame that carries `inner`, of a message that the dialect does not have, or with these incompatibility flags.
fn carrying(inner: &[u8], message: u32, flags: u8) -> Vec<u8> {
    let mut payload = [7; 100];
    payload[10..10 + inner.len()].copy_from_slice(inner);
    let mut bytes = v2_of_payload(1, message, 77, &payload);
    bytes[2] = flags;
    bytes.extend(std::iter::repeat_n(0, if flags & 1 == 1 { 13 } else { 0 }));
    bytes
}

#[test]
fn a_command_inside_a_frame_that_is_not_understood_is_never_taken() {
    let (inner, next) = (v2(9, &arm()), v2(2, &arm()));
    let unknown = 0x0001_2345;
    for inner in [inner, v1(9, &arm())] {
        for (message, flags) in [(unknown, 0), (unknown, 1), (unknown, 2), (LOGGING_DATA_DATA::ID, 2)] {
            let outer = carrying(&inner, message, flags);
            for noise in [&[][..], &[0x55], &[0xFE, 3]] {
                let bytes = [noise, &outer, &next, &v2(3, &odometry()), &v2(4, &odometry())].concat();
                let found = parsed(&bytes);
                assert!(!found.contains(&(COMMAND_LONG_DATA::ID, 9)), "{message:#x} {flags} {noise:?}");
                let expected = (COMMAND_LONG_DATA::ID, 2);
                assert!(!noise.is_empty() || found.contains(&expected), "{message:#x} {flags}");
                assert!(found.contains(&(ODOMETRY_DATA::ID, 4)), "{message:#x} {flags} {noise:?}");
            }
        }
        // Version 1, of a number that the dialect does not have.
        let mut bytes = vec![0xFE, inner.len() as u8, 1, 255, 190, 229];
        bytes.extend([&inner[..], &[0, 0]].concat());
        assert_eq!(parsed(&[bytes, next.clone()].concat()), [(COMMAND_LONG_DATA::ID, 2)]);
    }
}

#[test]
fn a_command_inside_a_broken_frame_is_never_taken() {
    let mut log = LOGGING_DATA_DATA::default();
    let hidden = v2(1, &arm());
    log.data[..hidden.len()].copy_from_slice(&hidden);
    let good = v2(2, &log);
    for place in [4, 12, good.len() - 1] {
        let mut bytes = good.clone();
        bytes[place] ^= 0x10;
        let found = parsed(&[bytes, v2(3, &odometry()), v2(4, &odometry())].concat());
        assert_eq!(found, [(ODOMETRY_DATA::ID, 3), (ODOMETRY_DATA::ID, 4)], "{place}");
    }
}

#[test]
fn a_command_behind_an_unknown_flag_is_not_taken() {
    for flag in 1..8 {
        let mut bytes = v2(1, &arm());
        bytes[2] = 1 << flag;
        let end = bytes.len() - 2;
        let checksum = mavlink::calculate_crc(&bytes[1..end], COMMAND_LONG_DATA::EXTRA_CRC);
        bytes[end..].copy_from_slice(&checksum.to_le_bytes());
        assert_eq!(parsed(&[bytes, v2(2, &arm())].concat()), [(COMMAND_LONG_DATA::ID, 2)]);
    }
}

#[test]
fn messages_outside_the_dialect_are_passed_over() {
    let foreign = v2_of_payload(1, 0x0001_2345, 77, &[3; 40]);
    assert_eq!(parsed(&[foreign, v2(2, &arm())].concat()), [(COMMAND_LONG_DATA::ID, 2)]);
}

#[test]
fn a_command_inside_a_log_being_sent_does_nothing() {
    let mut log = LOGGING_DATA_DATA::default();
    let hidden = v2(1, &arm());
    log.data[..hidden.len()].copy_from_slice(&hidden);
    assert_eq!(parsed(&v2(2, &log)), [(LOGGING_DATA_DATA::ID, 2)]);
}

#[test]
fn cut_and_extended_payloads_are_understood() {
    let pose = ATT_POS_MOCAP_DATA { time_usec: 9, q: [1.0, 0.0, 0.0, 0.0], x: 2.0, ..Default::default() };
    let mut payload = [0; 255];
    let full = pose.ser(MavlinkVersion::V1, &mut payload);
    let cut = pose.ser(MavlinkVersion::V2, &mut payload);
    assert!(cut < full);
    // Cut to its zeros; whole; with the 84 bytes of extension (a covariance).
    for length in [cut, full, full + 84] {
        let mut parser = Parser::new();
        let bytes = v2_of_payload(1, ATT_POS_MOCAP_DATA::ID, ATT_POS_MOCAP_DATA::EXTRA_CRC, &payload[..length]);
        let (last, rest) = bytes.split_last().unwrap();
        assert!(rest.iter().all(|&byte| parser.push(byte, 0).is_none()));
        let frame = parser.push(*last, 0).unwrap();
        assert_eq!(frame.decode(), Some(pose.clone()), "{length} bytes");
        assert_eq!(frame.decode::<ODOMETRY_DATA>(), None);
    }
}

#[test]
fn version_1_does_not_cut_payloads() {
    // A checksum can be right for a payload too short to be the message.
    let mut bytes = vec![0xFE, 4, 1, 255, 190, PARAM_SET_DATA::ID as u8, 1, 2, 3, 4];
    bytes.extend(mavlink::calculate_crc(&bytes[1..], PARAM_SET_DATA::EXTRA_CRC).to_le_bytes());
    let mut parser = Parser::new();
    let (last, rest) = bytes.split_last().unwrap();
    assert!(rest.iter().all(|&byte| parser.push(byte, 0).is_none()));
    assert_eq!(parser.push(*last, 0).unwrap().decode::<PARAM_SET_DATA>(), None);
}

#[test]
fn a_value_outside_the_dialect_makes_a_message_none() {
    // The type of a heartbeat's sender is the fifth byte of its payload.
    for (kind, known) in [(6, true), (250, false)] {
        let payload = [0, 0, 0, 0, kind, 8, 0, 0, 3];
        let bytes = v2_of_payload(1, HEARTBEAT_DATA::ID, HEARTBEAT_DATA::EXTRA_CRC, &payload);
        let (mut parser, mut found) = (Parser::new(), None);
        parser.feed(&bytes, 0, &mut |frame| found = Some(frame.decode::<HEARTBEAT_DATA>().is_some()));
        assert_eq!(found, Some(known));
    }
}

#[test]
fn a_signed_frame_is_taken_with_its_signature() {
    let mut bytes = v2(1, &arm());
    bytes[2] = 1;
    let end = bytes.len() - 2;
    let checksum = mavlink::calculate_crc(&bytes[1..end], COMMAND_LONG_DATA::EXTRA_CRC);
    bytes[end..].copy_from_slice(&checksum.to_le_bytes());
    // A signature is any 13 bytes, and these look like a frame.
    bytes.extend(v1(9, &PARAM_REQUEST_LIST_DATA { target_system: 1, target_component: 1 }));
    bytes.extend([0; 3]);
    assert_eq!(parsed(&[bytes, v2(2, &arm())].concat()), [(COMMAND_LONG_DATA::ID, 1), (COMMAND_LONG_DATA::ID, 2)]);
}

#[test]
fn a_frame_behind_noise_is_as_old_as_the_noise() {
    // A lone start byte looks like a frame of up to 263 bytes until enough others have come.
    let mut parser = Parser::new();
    assert!(parser.push(0xFE, 1_000).is_none());
    let mut found = Vec::new();
    for &byte in [v2(1, &odometry()), v2(2, &odometry())].concat().iter() {
        let mut next = parser.push(byte, 50_000);
        while let Some(frame) = next {
            found.push((frame.header.sequence, frame.time));
            next = parser.next_frame();
        }
    }
    // The first lies where the payload of the noise's frame would.
    assert_eq!(found, [(2, 1_000)]);
}

#[test]
fn half_a_frame_is_forgotten_when_the_rest_comes_too_late() {
    let bytes = v2(1, &odometry());
    let mut parser = Parser::new();
    let (early, late) = bytes.split_at(100);
    assert!(early.iter().all(|&byte| parser.push(byte, 0).is_none()));
    assert!(late.iter().all(|&byte| parser.push(byte, FRAME_AGE_MAX_US + 1).is_none()));
    assert!(parser.discarded() >= 100);
    // In time, it would have been a frame.
    let mut parser = Parser::new();
    assert!(early.iter().all(|&byte| parser.push(byte, 0).is_none()));
    assert!(late.iter().filter(|&&byte| parser.push(byte, FRAME_AGE_MAX_US).is_some()).count() == 1);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_bytes_make_it_panic_and_every_byte_is_accounted_for(
        bytes in prop::collection::vec(prop_oneof![Just(0xFD_u8), Just(0xFE), Just(0), Just(1), any::<u8>()], 0..3000),
        pace in 0_u64..3000,
    ) {
        let mut parser = Parser::new();
        let (mut least, mut most) = (0, 0);
        for (count, &byte) in bytes.iter().enumerate() {
            let now = count as u64 * pace;
            let mut next = parser.push(byte, now);
            while let Some(frame) = next {
                prop_assert!(frame.time <= now && now - frame.time <= FRAME_AGE_MAX_US);
                least += frame.payload.len() + 8;
                most += frame.payload.len() + 25;
                next = parser.next_frame();
            }
        }
        let discarded = parser.discarded() as usize;
        prop_assert!(discarded + least <= bytes.len() && bytes.len() <= discarded + most + FRAME_MAX_BYTES);
    }

    #[test]
    fn good_frames_are_found_again_behind_noise_and_the_frame_that_it_may_seem_to_begin(
        noise in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..40), 6),
    ) {
        let mut bytes = Vec::new();
        for (sequence, noise) in noise.iter().enumerate() {
            bytes.extend(noise);
            // As long as the longest frame, so that whatever the noise seems to begin ends before the next.
            bytes.extend(v2(100, &odometry()));
            bytes.extend(v2(100, &odometry()));
            bytes.extend(v2(sequence as u8, &odometry()));
        }
        // Noise may hold the last ones back until more bytes come.
        bytes.extend([0; FRAME_MAX_BYTES]);
        let is_last = |&(message, sequence): &(u32, u8)| message == ODOMETRY_DATA::ID && sequence < 100;
        let found: Vec<_> = parsed(&bytes).into_iter().filter(is_last).collect();
        let expected: Vec<_> = (0..noise.len()).map(|sequence| (ODOMETRY_DATA::ID, sequence as u8)).collect();
        prop_assert_eq!(found, expected);
    }
}
