//! What the messages hold, with the `mavlink` crate as the other end of the line: every number of the dialect, every field
//! that is read, every frame that is written.

#![expect(deprecated, reason = "PING is, and is still read")]

mod support;

use controller_core::governor::{Motion, Setpoint, Turn};
use core::f32::consts::PI;
use firmware::frames;
use firmware::link::Reply;
use firmware::link::checksum::{checksum, extra};
use firmware::link::command::Command;
use firmware::link::draft::Draft;
use firmware::link::frame::{Frame, Header, Parser};
use firmware::link::message::{self, LENGTHS};
use firmware::link::pose::Poses;
use firmware::link::setpoint::setpoint;
use firmware::parameters::table::Name;
use mavlink::dialects::common::{
    ATT_POS_MOCAP_DATA, COMMAND_LONG_DATA, MavCmd, MavFrame, MavMessage, MavParamType, ODOMETRY_DATA,
    PARAM_REQUEST_LIST_DATA, PARAM_REQUEST_READ_DATA, PARAM_SET_DATA, PING_DATA, PositionTargetTypemask,
    SET_POSITION_TARGET_LOCAL_NED_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MavlinkVersion, Message, MessageData};
use nalgebra::{Quaternion, Vector3};
use proptest::prelude::*;
use support::receiver::{Fed, Local};
use support::{v1, v2};

/// What `read` makes of the one frame in `bytes`.
fn read<T>(bytes: &[u8], mut read: impl FnMut(&Frame<'_>) -> T) -> T {
    let (mut parser, mut found) = (Parser::new(), None);
    parser.feed(bytes, 0, &mut |frame| {
        assert!(frame.is_whole());
        found = Some(read(frame));
    });
    assert_eq!(parser.discarded(), 0);
    found.unwrap()
}

#[test]
fn every_message_of_the_dialect_has_its_number_and_no_other_has_one() {
    for message in 0..1 << 24 {
        let expected = Some(MavMessage::extra_crc(message)).filter(|&extra| extra != 0);
        assert_eq!(extra(message), expected, "{message}");
    }
    assert_eq!(extra(u32::MAX), None);
}

#[test]
fn messages_are_called_by_their_numbers() {
    let named: [(u32, &str); 17] = [
        (message::HEARTBEAT, "HEARTBEAT"),
        (message::SYS_STATUS, "SYS_STATUS"),
        (message::PING, "PING"),
        (message::PARAM_REQUEST_READ, "PARAM_REQUEST_READ"),
        (message::PARAM_REQUEST_LIST, "PARAM_REQUEST_LIST"),
        (message::PARAM_VALUE, "PARAM_VALUE"),
        (message::PARAM_SET, "PARAM_SET"),
        (message::ATTITUDE_QUATERNION, "ATTITUDE_QUATERNION"),
        (message::LOCAL_POSITION_NED, "LOCAL_POSITION_NED"),
        (message::COMMAND_LONG, "COMMAND_LONG"),
        (message::COMMAND_ACK, "COMMAND_ACK"),
        (message::SET_POSITION_TARGET_LOCAL_NED, "SET_POSITION_TARGET_LOCAL_NED"),
        (message::HIL_ACTUATOR_CONTROLS, "HIL_ACTUATOR_CONTROLS"),
        (message::HIL_SENSOR, "HIL_SENSOR"),
        (message::ATT_POS_MOCAP, "ATT_POS_MOCAP"),
        (message::STATUSTEXT, "STATUSTEXT"),
        (message::ODOMETRY, "ODOMETRY"),
    ];
    for (number, name) in named {
        assert_eq!(MavMessage::message_id_from_name(name), Some(number), "{name}");
    }
}

#[test]
fn version_1_messages_that_are_read_are_as_long_as_their_fields() {
    for (number, length) in LENGTHS {
        let mut payload = [0; 255];
        let message = MavMessage::default_message_from_id(number).unwrap();
        assert_eq!(length, message.ser(MavlinkVersion::V1, &mut payload), "{number}");
    }
}

#[test]
fn more_than_a_frame_holds_is_cut() {
    let mut draft = Draft::new();
    let header = Header { system: 1, component: 1, sequence: 0 };
    assert_eq!(draft.begin(message::ODOMETRY).bytes(&[1; 400]).finish(header).len(), 10 + 255 + 2);
}

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0), -100.0_f32..100.0]
}

/// A rotation, scalar first.
fn rotation() -> impl Strategy<Value = Quaternion<f32>> {
    [-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0, 0.1_f32..1.0]
        .prop_map(|[x, y, z, w]| Quaternion::new(w, x, y, z).normalize())
}

proptest! {
    #[test]
    fn the_checksum_is_that_of_the_protocol(bytes in prop::collection::vec(any::<u8>(), 0..280), extra: u8) {
        prop_assert_eq!(checksum(&bytes, extra), mavlink::calculate_crc(&bytes, extra));
    }

    #[test]
    fn our_frames_are_read_by_another_implementation(
        payload in prop::collection::vec(prop_oneof![Just(0_u8), any::<u8>()], 1..232),
        sequence: u8,
    ) {
        let mut draft = Draft::new();
        // Nothing of the last message is left in the next.
        let _ = draft.begin(message::ODOMETRY).bytes(&[0xFF; 255]).finish(Header { system: 9, component: 9, sequence: 9 });
        let header = Header { system: 7, component: 1, sequence };
        let bytes = draft.begin(message::ODOMETRY).bytes(&payload).finish(header);
        let mut whole = [0; 283];
        whole[..bytes.len()].copy_from_slice(bytes);
        let raw = MAVLinkV2MessageRaw::from_bytes_unparsed(whole);
        prop_assert!(raw.has_valid_crc_with_extra_crc(ODOMETRY_DATA::EXTRA_CRC));
        let header = (raw.system_id(), raw.component_id(), raw.sequence(), raw.message_id());
        prop_assert_eq!(header, (7, 1, sequence, ODOMETRY_DATA::ID));
        prop_assert_eq!(raw.raw_bytes(), bytes);
        let end = payload.iter().rposition(|&byte| byte != 0).map_or(1, |last| last + 1);
        prop_assert_eq!(raw.payload(), &payload[..end]);
    }

    #[test]
    fn every_field_of_a_command_is_read(p: [f32; 7], number in 0_usize..3, target: bool) {
        let command = [MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, MavCmd::MAV_CMD_DO_MOTOR_TEST, MavCmd::MAV_CMD_DO_SET_MODE][number];
        let [param1, param2, param3, param4, param5, param6, param7] = p;
        let (target_system, target_component, confirmation) = (target.into(), target.into(), 0);
        let message = COMMAND_LONG_DATA {
            param1, param2, param3, param4, param5, param6, param7, command, target_system, target_component, confirmation,
        };
        for bytes in [v1(1, &message), v2(1, &message)] {
            let read = read(&bytes, Command::from_frame);
            prop_assert_eq!(read.command, command as u16);
            prop_assert_eq!(read.parameters.map(f32::to_bits), p.map(f32::to_bits));
        }
    }

    #[test]
    fn every_field_of_a_setpoint_is_read(
        [x, y, z, vx, vy, vz, afx, afy, afz, yaw_rate] in prop::array::uniform10(number()),
        yaw in -PI..PI,
    ) {
        let message = SET_POSITION_TARGET_LOCAL_NED_DATA {
            time_boot_ms: 0xFFFF_FFFF,
            x, y, z, vx, vy, vz, afx, afy, afz, yaw, yaw_rate,
            type_mask: PositionTargetTypemask::empty(),
            target_system: 1,
            target_component: 1,
            coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
        };
        let world = |x, y, z| frames::world(&Vector3::new(x, y, z));
        let (position, velocity, acceleration) = (world(x, y, z), world(vx, vy, vz), world(afx, afy, afz));
        let motion = Motion::PositionVelocityAcceleration { position, velocity, acceleration };
        let turn = Turn::Angle { angle: frames::heading(yaw), rate: frames::heading_rate(yaw_rate) };
        for bytes in [v1(1, &message), v2(1, &message)] {
            prop_assert_eq!(read(&bytes, setpoint), Ok(Setpoint { motion, turn }));
        }
    }

    #[test]
    fn every_field_of_a_pose_is_read(
        [x, y, z, vx, vy, vz, rollspeed, pitchspeed, yawspeed] in prop::array::uniform9(prop_oneof![Just(0.0), -1.0_f32..1.0]),
        q in rotation(),
        time_usec in 1_u64..1 << 48,
    ) {
        let q = [q.w, q.i, q.j, q.k];
        let odometry = ODOMETRY_DATA {
            time_usec, x, y, z, q, vx, vy, vz, rollspeed, pitchspeed, yawspeed,
            pose_covariance: [f32::NAN; 21],
            velocity_covariance: [f32::NAN; 21],
            frame_id: MavFrame::MAV_FRAME_LOCAL_NED,
            child_frame_id: MavFrame::MAV_FRAME_LOCAL_NED,
        };
        let (position, velocity) = (frames::world(&Vector3::new(x, y, z)), frames::world(&Vector3::new(vx, vy, vz)));
        let [w, i, j, k] = q;
        let attitude = frames::attitude(&Quaternion::new(w, i, j, k));
        let pose = read(&v2(1, &odometry), |frame| Poses::default().take(frame)).unwrap().unwrap();
        prop_assert_eq!((pose.position, pose.velocity), (position, velocity));
        prop_assert!((pose.attitude - attitude).norm() < 1e-6);
        // The other message, twice: its velocity is the difference.
        let first = ATT_POS_MOCAP_DATA { time_usec, q, x: x - 0.01, y, z: z + 0.02 };
        let second = ATT_POS_MOCAP_DATA { time_usec: time_usec + 10_000, q, x, y, z };
        for frames in [[v1(1, &first), v1(2, &second)], [v2(1, &first), v2(2, &second)]] {
            let mut poses = Poses::default();
            let [none, pose] = frames.map(|bytes| read(&bytes, |frame| poses.take(frame)).unwrap());
            prop_assert_eq!(none, None);
            let pose = pose.unwrap();
            prop_assert_eq!(pose.position, position);
            prop_assert!((pose.attitude - attitude).norm() < 1e-6);
            prop_assert!((pose.velocity - Vector3::new(0.0, 1.0, 2.0)).norm() < 1e-4, "{}", pose.velocity);
        }
    }

    #[test]
    fn every_field_of_questions_is_read(time_usec: u64, seq: u32, value in 10_u8..=50, index in 0_i16..5) {
        let shared = Local::new();
        let mut fed = Fed::new(&shared);
        let (name, target_system, target_component) = (Name::TelemetryRate.row().name, 1, 1);
        let ping = PING_DATA { time_usec, seq, target_system: 0, target_component: 0 };
        let set = PARAM_SET_DATA {
            param_value: value.into(), target_system, target_component,
            param_id: name.into(), param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        };
        let by_name = PARAM_REQUEST_READ_DATA { param_index: -1, target_system, target_component, param_id: name.into() };
        let by_index = PARAM_REQUEST_READ_DATA { param_index: index, param_id: "".into(), ..by_name.clone() };
        let all = PARAM_REQUEST_LIST_DATA { target_system, target_component };
        let expected = [
            Reply::Ping { time: time_usec, sequence: seq, system: 255, component: 190 },
            Reply::Parameter(Name::TelemetryRate),
            Reply::Parameter(Name::TelemetryRate),
            Reply::Parameter(Name::from_index(index as usize).unwrap()),
            Reply::AllParameters,
        ];
        let old = [v1(1, &ping), v1(2, &set), v1(3, &by_name), v1(4, &by_index), v1(5, &all)];
        for frames in [old, [v2(1, &ping), v2(2, &set), v2(3, &by_name), v2(4, &by_index), v2(5, &all)]] {
            shared.parameters.set(Name::TelemetryRate, 33.0).unwrap();
            frames.iter().for_each(|bytes| fed.bytes(bytes, 0));
            prop_assert_eq!(shared.parameters.get(Name::TelemetryRate), f32::from(value));
            for reply in expected {
                prop_assert_eq!(shared.replies.take().unwrap(), reply);
            }
        }
    }
}
