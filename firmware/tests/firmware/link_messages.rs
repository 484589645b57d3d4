//! What the messages hold, with the `mavlink` crate as the other end of the line: every field that is read, every frame
//! that is written.

use crate::support::receiver::{Fed, Local};
use crate::support::{v1, v2};
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use core::f32::consts::PI;
use firmware::frames;
use firmware::link::frame::{Frame, Parser};
use firmware::link::pose::Poses;
use firmware::link::setpoint::setpoint;
use firmware::link::writer::Writer;
use firmware::parameters::table::Name;
use firmware::shared::{Ping, Reply};
use mavlink::dialects::common::{
    ATT_POS_MOCAP_DATA, MavFrame, MavParamType, ODOMETRY_DATA, PARAM_REQUEST_LIST_DATA, PARAM_REQUEST_READ_DATA,
    PARAM_SET_DATA, PositionTargetTypemask, SET_POSITION_TARGET_LOCAL_NED_DATA, STATUSTEXT_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MessageData};
use nalgebra::{Quaternion, Vector3};
use proptest::prelude::*;

/// What `read` makes of the one frame in `bytes`.
fn read<T>(bytes: &[u8], mut read: impl FnMut(&Frame<'_>) -> T) -> T {
    let (mut parser, mut found) = (Parser::new(), None);
    parser.feed(bytes, 0, &mut |frame| {
        found = Some(read(frame));
    });
    assert_eq!(parser.discarded(), 0);
    found.unwrap()
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
    fn our_frames_are_numbered_and_hold_nothing_of_the_one_before(first in "[ -~]{0,50}", second in "[ -~]{0,50}") {
        let mut writer = Writer::new();
        for (sequence, text) in [first, second].into_iter().enumerate() {
            let message = STATUSTEXT_DATA { text: text.as_str().into(), ..STATUSTEXT_DATA::DEFAULT };
            writer.write(7, &message);
            let mut whole = [0; 283];
            whole[..writer.bytes().len()].copy_from_slice(writer.bytes());
            let raw = MAVLinkV2MessageRaw::from_bytes_unparsed(whole);
            prop_assert!(raw.has_valid_crc_with_extra_crc(STATUSTEXT_DATA::EXTRA_CRC));
            let header = (raw.system_id(), raw.component_id(), usize::from(raw.sequence()), raw.message_id());
            prop_assert_eq!(header, (7, 1, sequence, STATUSTEXT_DATA::ID));
            prop_assert_eq!(read(writer.bytes(), |frame| frame.decode()), Some(message));
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
        let turn = HeadingSetpoint::Angle { angle: frames::heading(yaw), rate: frames::heading_rate(yaw_rate) };
        for bytes in [v1(1, &message), v2(1, &message)] {
            let message = read(&bytes, |frame| frame.decode()).unwrap();
            prop_assert_eq!(setpoint(&message, None), Ok(Setpoint { motion, turn }));
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
        let pose = read(&v2(1, &odometry), |frame| Poses::default().take(frame, 0)).unwrap().unwrap();
        prop_assert_eq!((pose.value.position(), pose.value.velocity()), (position, Some(velocity)));
        prop_assert!((pose.value.attitude() - attitude).norm() < 1e-6);
        // The other message, which has no velocity.
        let mocap = ATT_POS_MOCAP_DATA { time_usec, q, x, y, z };
        for bytes in [v1(1, &mocap), v2(1, &mocap)] {
            let pose = read(&bytes, |frame| Poses::default().take(frame, 0)).unwrap().unwrap();
            prop_assert_eq!((pose.value.position(), pose.value.velocity()), (position, None));
            prop_assert!((pose.value.attitude() - attitude).norm() < 1e-6);
        }
    }

    #[test]
    fn every_field_of_questions_is_read(time_usec: u64, seq: u32, value in 10_u8..=50, index in 0_i16..5) {
        let shared = Local::new();
        let mut fed = Fed::new(&shared);
        let (name, target_system, target_component) = (Name::TelemetryRate.row().name, 1, 1);
        let ping = Ping { time_usec, seq, target_system: 0, target_component: 0 };
        let set = PARAM_SET_DATA {
            param_value: value.into(), target_system, target_component,
            param_id: name.into(), param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        };
        let by_name = PARAM_REQUEST_READ_DATA { param_index: -1, target_system, target_component, param_id: name.into() };
        let by_index = PARAM_REQUEST_READ_DATA { param_index: index, param_id: "".into(), ..by_name.clone() };
        let all = PARAM_REQUEST_LIST_DATA { target_system, target_component };
        let expected = [
            Reply::Ping(Ping { target_system: 255, target_component: 190, ..ping.clone() }),
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
            for reply in &expected {
                prop_assert_eq!(&shared.replies.take().unwrap(), reply);
            }
        }
    }
}
