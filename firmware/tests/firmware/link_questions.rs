//! What is asked of the vehicle, beside what it shall do: messages, missions, places, the time, nonsense.

use crate::support::receiver::{Fed, Local, answer, command, ordered, replies, texts};
use crate::support::{extended, v2_of_payload};
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use firmware::link::acknowledgement::{Acknowledgement, Order};
use firmware::link::files::FileRequest;
use firmware::link::telemetry::kind::Kind;
use firmware::shared::{MissionList, Ping, REPLIES_CAPACITY, Reply};
use flight::{Mode, Request};
use mavlink::MessageData;
use mavlink::dialects::common::{
    COMMAND_INT_DATA, COMMAND_LONG_DATA, FILE_TRANSFER_PROTOCOL_DATA, MISSION_CLEAR_ALL_DATA, MISSION_COUNT_DATA,
    MISSION_REQUEST_LIST_DATA, MavCmd, MavFrame, MavMissionResult, MavResult, TIMESYNC_DATA,
};
use nalgebra::Vector3;

#[test]
fn unknown_commands_are_answered_as_unsupported() {
    for known in [MavCmd::MAV_CMD_DO_PARACHUTE, MavCmd::MAV_CMD_NAV_WAYPOINT] {
        assert_eq!(answer(&command(known, [0.0; 5]), Mode::Ready), MavResult::MAV_RESULT_UNSUPPORTED);
    }
    // One that is not in the dialect at all is answered by its number, if it is for us.
    for (target, answers) in [(1, 1), (0, 1), (7, 0)] {
        for (id, crc, length) in [
            (COMMAND_LONG_DATA::ID, COMMAND_LONG_DATA::EXTRA_CRC, 33),
            (COMMAND_INT_DATA::ID, COMMAND_INT_DATA::EXTRA_CRC, 35),
        ] {
            let mut payload = vec![0; length];
            payload[28..30].copy_from_slice(&65_000_u16.to_le_bytes());
            payload[30] = target;
            let shared = Local::new();
            Fed::new(&shared).bytes(&v2_of_payload(1, id, crc, &payload), 0);
            let order = Order { command: 65_000, sender: (255, 190), frame: 0 };
            let unsupported = Reply::Command(order.answered(MavResult::MAV_RESULT_UNSUPPORTED));
            assert_eq!(replies(&shared), vec![unsupported; answers]);
        }
    }
}

#[test]
fn messages_are_sent_on_request_and_at_requested_rates() {
    let reply_to = |command: MavCmd, first: f32, second: f32| {
        let shared = Local::new();
        Fed::new(&shared).message(&crate::support::receiver::command(command, [first, second, 0.0, 0.0, 0.0]), 0);
        let replies = replies(&shared);
        let Some(Reply::Command(Acknowledgement { result, .. })) = replies.last() else { panic!("{replies:?}") };
        (replies[..replies.len() - 1].to_vec(), *result)
    };
    let (accepted, unsupported) = (MavResult::MAV_RESULT_ACCEPTED, MavResult::MAV_RESULT_UNSUPPORTED);
    let (request, interval) = (MavCmd::MAV_CMD_REQUEST_MESSAGE, MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL);
    for (command, number, kind) in [
        (request, 148.0, Kind::AutopilotVersion),
        (request, 85.0, Kind::PositionTarget),
        (MavCmd::MAV_CMD_GET_HOME_POSITION, 0.0, Kind::HomePosition),
    ] {
        let shared = Local::new();
        let asked = crate::support::receiver::command(command, [number, 0.0, 0.0, 0.0, 0.0]);
        Fed::new(&shared).message(&asked, 0);
        // The sending half answers.
        assert_eq!(replies(&shared), [Reply::Requested(kind, ordered(command))]);
    }
    assert_eq!(reply_to(request, 435.0, 0.0).0.len(), 5);
    assert_eq!(reply_to(request, 435.0, 2.0), (vec![Reply::Mode(2)], accepted));
    assert_eq!(reply_to(request, 435.0, 9.0), (vec![], MavResult::MAV_RESULT_DENIED));
    let odometry = Reply::Interval { kind: Kind::Odometry, interval: 20_000 };
    assert_eq!(reply_to(interval, 331.0, 20_000.0), (vec![odometry], accepted));
    assert_eq!(reply_to(interval, 331.0, f32::NAN), (vec![], MavResult::MAV_RESULT_DENIED));
    for number in [9_999.0, -1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(reply_to(request, number, 0.0), (vec![], unsupported), "{number}");
    }
}

#[test]
fn a_place_on_the_globe_is_flown_to_by_command_int() {
    let goto = |frame: MavFrame, z: f32, param4: f32| COMMAND_INT_DATA {
        command: MavCmd::MAV_CMD_DO_REPOSITION,
        target_system: 1,
        frame,
        // 10 m north and 20 m west of 0 N, 0 E.
        x: 899,
        y: -1_799,
        z,
        param4,
        ..Default::default()
    };
    let asked = |message: &COMMAND_INT_DATA| {
        let shared = Local::new();
        Fed::new(&shared).message(message, 0);
        shared.requests.take().map(|asked| asked.request)
    };
    for (message, turn) in [
        (goto(MavFrame::MAV_FRAME_GLOBAL, 3.0, f32::NAN), HeadingSetpoint::Keep),
        (goto(MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT, 3.0, f32::NAN), HeadingSetpoint::Keep),
        // North: a quarter turn to the left of east, where the law's heading is zero.
        (
            goto(MavFrame::MAV_FRAME_GLOBAL, 3.0, 0.0),
            HeadingSetpoint::Angle { angle: core::f32::consts::FRAC_PI_2, rate: 0.0 },
        ),
    ] {
        let Some(Request::GoTo(Setpoint { motion: Motion::Position(position), turn: turned })) = asked(&message) else {
            panic!("{message:?}")
        };
        assert!((position - Vector3::new(-20.0, 10.0, 3.0)).norm() < 0.02, "{position}");
        assert_eq!(turned, turn);
    }
    // A yaw relative to the vehicle's heading is not one from north.
    let relative = |yaw: f32| COMMAND_INT_DATA { param2: 3.0, ..goto(MavFrame::MAV_FRAME_GLOBAL, 3.0, yaw) };
    for yaw in [0.0, f32::NAN] {
        let turn = asked(&relative(yaw))
            .map(|request| matches!(request, Request::GoTo(to) if to.turn == HeadingSetpoint::Keep));
        assert_eq!(turn, Some(true), "{yaw}");
    }
    let shared = Local::new();
    Fed::new(&shared).message(&relative(0.5), 0);
    assert_eq!(shared.requests.take(), None);
    assert_eq!(texts(&shared), ["Reposition: yaw from north only"]);
    let nowhere = COMMAND_INT_DATA { y: i32::MAX, ..goto(MavFrame::MAV_FRAME_GLOBAL, 3.0, 0.0) };
    for (message, words) in [
        (goto(MavFrame::MAV_FRAME_GLOBAL, f32::NAN, 0.0), "Reposition: needs a place and an altitude"),
        (nowhere, "Reposition: needs a place and an altitude"),
        (goto(MavFrame::MAV_FRAME_LOCAL_NED, 3.0, 0.0), "Reposition: in a global frame only"),
    ] {
        let shared = Local::new();
        Fed::new(&shared).message(&message, 0);
        assert_eq!((shared.requests.take(), texts(&shared)), (None, vec![words.to_owned()]));
    }
}

/// What sending, asking for and clearing a list is answered with.
fn there_is_none(list: u8) -> [Reply; 3] {
    let asked = MissionList { sender: (255, 190), list };
    [
        Reply::Mission(asked, MavMissionResult::MAV_MISSION_UNSUPPORTED),
        Reply::MissionCount(asked, 0),
        Reply::Mission(asked, MavMissionResult::MAV_MISSION_ACCEPTED),
    ]
}

#[test]
fn fence_and_rally_points_are_answered_as_what_they_are() {
    for list in [1, 2] {
        let shared = Local::new();
        let mut fed = Fed::new(&shared);
        fed.bytes(&extended(&MISSION_COUNT_DATA { count: 3, target_system: 1, target_component: 1 }, &[list]), 0);
        fed.bytes(&extended(&MISSION_REQUEST_LIST_DATA { target_system: 1, target_component: 1 }, &[list]), 0);
        fed.bytes(&extended(&MISSION_CLEAR_ALL_DATA { target_system: 1, target_component: 1 }, &[list]), 0);
        assert_eq!(replies(&shared), there_is_none(list));
    }
}

#[test]
fn a_request_for_a_file_is_refused_and_an_answer_is_left_alone() {
    // Open a file for reading (4), an acknowledgement (128), a refusal (129); to us, to all, to another system.
    for (operation, target, answers) in [(4, 1, 1), (4, 0, 1), (127, 1, 1), (4, 7, 0), (128, 1, 0), (129, 1, 0)] {
        let mut message = FILE_TRANSFER_PROTOCOL_DATA { target_system: target, ..Default::default() };
        message.payload[..4].copy_from_slice(&[0xFF, 0x01, 3, operation]);
        let shared = Local::new();
        Fed::new(&shared).message(&message, 0);
        let request = FileRequest { sender: (255, 190), sequence: 0x1FF, session: 3, operation };
        assert_eq!(replies(&shared), vec![Reply::NoFiles(request); answers], "{operation} to {target}");
    }
}

#[test]
fn a_ping_to_everybody_is_answered_and_an_answer_is_not() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&Ping { time_usec: 5, seq: 6, target_system: 0, target_component: 0 }, 0);
    fed.message(&Ping { time_usec: 5, seq: 6, target_system: 1, target_component: 1 }, 0);
    assert_eq!(
        replies(&shared),
        [Reply::Ping(Ping { time_usec: 5, seq: 6, target_system: 255, target_component: 190 })]
    );
}

#[test]
fn a_flood_of_questions_overflows_nothing() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    for _ in 0..1000 {
        fed.message(&command(MavCmd::MAV_CMD_REQUEST_MESSAGE, [148.0, 0.0, 0.0, 0.0, 0.0]), 0);
    }
    assert_eq!(replies(&shared).len(), REPLIES_CAPACITY);
}

#[test]
fn the_time_is_sent_fifty_times_a_second_at_most() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    // A thousand questions in a second, and an answer among them.
    let count: usize = (0..1_000)
        .map(|question| {
            fed.message(&TIMESYNC_DATA { tc1: 0, ts1: 7 + question }, question as u64 * 1_000);
            let sent = replies(&shared);
            assert!(sent.iter().all(|reply| *reply == Reply::TimeSync { asked: 7 + question }), "{sent:?}");
            sent.len()
        })
        .sum();
    assert!((45..=50).contains(&count), "{count}");
    fed.message(&TIMESYNC_DATA { tc1: 5, ts1: 7 }, 2_000_000);
    assert!(replies(&shared).is_empty());
}
