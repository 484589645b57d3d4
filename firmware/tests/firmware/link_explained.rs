//! What other vehicles understand and this one does not, or not in that way: answered or explained, once.

use crate::support::receiver::{Fed, Local, answer, command, newest, replies, texts};
use crate::support::{extended, v2};
use core::f32::consts::FRAC_PI_2;
use firmware::shared::Reply;
use flight::{Mode, Request};
use mavlink::MessageData;
use mavlink::dialects::common::{
    COMMAND_INT_DATA, COMMAND_LONG_DATA, GLOBAL_VISION_POSITION_ESTIMATE_DATA, GPS_INPUT_DATA, MANUAL_CONTROL_DATA,
    MISSION_WRITE_PARTIAL_LIST_DATA, MavCmd, MavFrame, MavParamType, MavResult, PARAM_REQUEST_READ_DATA,
    PARAM_SET_DATA, REQUEST_DATA_STREAM_DATA, SET_ATTITUDE_TARGET_DATA, SET_HOME_POSITION_DATA,
    VICON_POSITION_ESTIMATE_DATA, VISION_POSITION_ESTIMATE_DATA, VISION_SPEED_ESTIMATE_DATA,
};
use nalgebra::{UnitQuaternion, Vector3};

#[test]
fn vision_messages_are_poses() {
    // 1 m north, 2 m east, 3 m up; facing east, nose up by 0.2, right side down by 0.1.
    let (usec, x, y, z, roll, pitch, yaw) = (5, 1.0, 2.0, -3.0, 0.1, 0.2, FRAC_PI_2);
    let messages = [
        v2(1, &VISION_POSITION_ESTIMATE_DATA { usec, x, y, z, roll, pitch, yaw }),
        v2(1, &VICON_POSITION_ESTIMATE_DATA { usec, x, y, z, roll, pitch, yaw }),
        v2(1, &GLOBAL_VISION_POSITION_ESTIMATE_DATA { usec, x, y, z, roll, pitch, yaw }),
    ];
    // FLU to z-up, from east: nose up is a turn about left by a negative angle.
    let attitude = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -0.2)
        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.1);
    for bytes in messages {
        let shared = Local::new();
        Fed::new(&shared).bytes(&bytes, 77);
        let pose = newest(&shared).unwrap();
        assert_eq!((pose.time, pose.value.position()), (77, Vector3::new(2.0, 1.0, 3.0)));
        let difference = pose.value.attitude().coords - attitude.coords;
        assert!(difference.norm() < 1e-5, "{:?}", pose.value);
    }
    let shared = Local::new();
    Fed::new(&shared).message(&VISION_POSITION_ESTIMATE_DATA { usec, x, y, z, roll: f32::NAN, pitch, yaw }, 77);
    assert!(newest(&shared).is_none() && texts(&shared).len() == 1);
}

#[test]
fn the_covariance_and_the_reset_counter_of_a_vision_message_count() {
    let mut extensions: Vec<u8> = [0.04_f32; 21].iter().flat_map(|number| number.to_le_bytes()).collect();
    extensions.push(3);
    let message = VISION_POSITION_ESTIMATE_DATA { usec: 5, x: 1.0, ..Default::default() };
    let taken = |bytes: &[u8]| {
        let shared = Local::new();
        Fed::new(&shared).bytes(bytes, 77);
        newest(&shared).unwrap().value
    };
    let plain = taken(&v2(1, &message));
    assert_eq!(taken(&extended(&message, &extensions)), plain.deviations(0.2, 0.2).reset_counter(3));
    // Infinite variances are those of no pose.
    extensions[..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let shared = Local::new();
    Fed::new(&shared).bytes(&extended(&message, &extensions), 77);
    assert!(newest(&shared).is_none());
    assert_eq!(texts(&shared), ["Pose refused: covariance is not finite"]);
}

#[test]
fn a_message_that_is_not_flown_is_reported_once() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    for count in 0..1_000 {
        fed.message(&MANUAL_CONTROL_DATA { target: 1, ..Default::default() }, count * 20_000);
        fed.message(&SET_ATTITUDE_TARGET_DATA { target_system: 1, ..Default::default() }, count * 20_000);
        // For another system.
        fed.message(&MANUAL_CONTROL_DATA { target: 7, ..Default::default() }, count * 20_000);
    }
    assert_eq!(texts(&shared), ["Not flown: MANUAL_CONTROL", "Not flown: SET_ATTITUDE_TARGET"]);
}

#[test]
#[expect(deprecated, reason = "superseded messages: clients still send them")]
fn an_unused_message_is_reported_once() {
    fn reported_once<D: MessageData>(ours: &D, anothers: Option<&D>) {
        let shared = Local::new();
        let mut fed = Fed::new(&shared);
        anothers.iter().for_each(|message| fed.message(*message, 0));
        assert_eq!(texts(&shared), [""; 0], "{}", D::NAME);
        (0..3).for_each(|count| fed.message(ours, count * 5_000_000));
        assert_eq!(texts(&shared), [format!("Not used: {}", D::NAME)]);
    }
    let home = SET_HOME_POSITION_DATA { target_system: 1, ..Default::default() };
    reported_once(&home, Some(&SET_HOME_POSITION_DATA { target_system: 7, ..Default::default() }));
    let part = MISSION_WRITE_PARTIAL_LIST_DATA { target_system: 1, ..Default::default() };
    reported_once(&part, Some(&MISSION_WRITE_PARTIAL_LIST_DATA { target_system: 7, ..Default::default() }));
    let stream = REQUEST_DATA_STREAM_DATA { target_system: 1, ..Default::default() };
    reported_once(&stream, Some(&REQUEST_DATA_STREAM_DATA { target_system: 7, ..Default::default() }));
    reported_once(&VISION_SPEED_ESTIMATE_DATA { x: 1.0, ..Default::default() }, None);
    reported_once(&GPS_INPUT_DATA::DEFAULT, None);
}

#[test]
fn a_missing_parameter_is_reported_by_its_name_once_a_second() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let set = PARAM_SET_DATA {
        param_value: 1.0,
        target_system: 1,
        target_component: 1,
        param_id: "COM_RCL_EXCEPT".into(),
        param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    };
    let read = PARAM_REQUEST_READ_DATA {
        param_index: -1,
        target_system: 1,
        target_component: 1,
        param_id: "SYSID_THISMAV".into(),
    };
    for now in 0..50 {
        fed.message(&set, now * 10_000);
        fed.message(&read, now * 10_000);
    }
    assert_eq!(texts(&shared), ["No parameter COM_RCL_EXCEPT"]);
    fed.message(&read, 2_000_000);
    assert_eq!(texts(&shared), ["No parameter SYSID_THISMAV"]);
    // Or by its number.
    fed.message(&PARAM_REQUEST_READ_DATA { param_index: 999, param_id: "".into(), ..read }, 4_000_000);
    assert_eq!(texts(&shared), ["No parameter 999"]);
}

#[test]
fn the_heartbeat_cannot_be_switched_off_nor_thinned_out() {
    let interval = |interval: f32| command(MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, [0.0, interval, 0.0, 0.0, 0.0]);
    for (us, result) in [
        (-1.0, MavResult::MAV_RESULT_DENIED),
        (2e6, MavResult::MAV_RESULT_DENIED),
        (1e6, MavResult::MAV_RESULT_ACCEPTED),
        (0.0, MavResult::MAV_RESULT_ACCEPTED),
    ] {
        let shared = Local::new();
        Fed::new(&shared).message(&interval(us), 0);
        let last = replies(&shared).pop();
        assert!(matches!(last, Some(Reply::Command(ack)) if ack.result == result), "{us}");
    }
    assert_eq!(answer(&interval(-1.0), Mode::Ready), MavResult::MAV_RESULT_DENIED);
}

fn take_off(frame: MavFrame, x: i32, y: i32, z: f32) -> COMMAND_INT_DATA {
    COMMAND_INT_DATA { command: MavCmd::MAV_CMD_NAV_TAKEOFF, target_system: 1, frame, x, y, z, ..Default::default() }
}

#[test]
#[expect(deprecated, reason = "frames that clients still use")]
fn the_frame_and_the_place_of_a_take_off_are_honoured_or_refused() {
    fn asked<D: MessageData + std::fmt::Debug>(message: &D) -> Option<Request> {
        let shared = Local::new();
        // Ten metres above the sea.
        let origin = firmware::link::origin::Origin::new(473_000_000, 85_000_000, 10_000).unwrap();
        shared.origin.put(origin, 0);
        Fed::new(&shared).message(message, 0);
        let request = shared.requests.take().map(|asked| asked.request);
        assert_eq!(texts(&shared).len(), usize::from(request.is_none()), "{message:?}");
        request
    }
    let (global, relative) = (MavFrame::MAV_FRAME_GLOBAL, MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT);
    for (message, height) in [
        // As high above the sea, or above home.
        (take_off(global, 0, 0, 13.0), Some(3.0)),
        (take_off(MavFrame::MAV_FRAME_GLOBAL_INT, i32::MAX, i32::MAX, 13.0), Some(3.0)),
        (take_off(relative, 0, 0, 3.0), Some(3.0)),
        (take_off(MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, 473_000_000, 85_000_000, 3.0), Some(3.0)),
        (take_off(relative, 473_000_100, 85_000_000, 3.0), Some(3.0)),
        (take_off(global, 0, 0, f32::NAN), None),
        (take_off(relative, 0, 0, 0.0), None),
    ] {
        assert_eq!(asked(&message), Some(Request::TakeOff(height)), "{message:?}");
    }
    for message in [
        take_off(MavFrame::MAV_FRAME_LOCAL_NED, 0, 0, -3.0),
        take_off(MavFrame::MAV_FRAME_BODY_FRD, 0, 0, -3.0),
        // A hundred metres away.
        take_off(relative, 473_010_000, 85_000_000, 3.0),
    ] {
        assert_eq!(asked(&message), None, "{message:?}");
    }
    // COMMAND_LONG has the place in degrees, and the height above where it stands.
    let long = |param5, param6| {
        let command = MavCmd::MAV_CMD_NAV_TAKEOFF;
        asked(&COMMAND_LONG_DATA { command, target_system: 1, param5, param6, param7: 3.0, ..Default::default() })
    };
    assert_eq!(long(47.3, 8.5), Some(Request::TakeOff(Some(3.0))));
    assert_eq!(long(f32::NAN, f32::NAN), Some(Request::TakeOff(Some(3.0))));
    assert_eq!(long(47.301, 8.5), None);
}
