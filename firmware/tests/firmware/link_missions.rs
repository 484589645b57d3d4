//! Missions over the link: sent whole or not at all, checked item by item, given back, and followed.

#![expect(deprecated, reason = "superseded messages and frames: clients still send them")]

use crate::support::receiver::{Fed, Local, command, replies, texts};
use crate::support::{extended, from};
use controller_core::governor::HeadingSetpoint;
use core::f32::consts::FRAC_PI_2;
use firmware::frames;
use firmware::link::mission::{Item, SentItem};
use firmware::link::origin::Origin;
use firmware::shared::{MissionList, MissionReport, Reply, Report};
use flight::{ACCEPTANCE_RADIUS_M, Leg, Mode, Request};
use mavlink::dialects::common::{
    MISSION_ACK_DATA, MISSION_CLEAR_ALL_DATA, MISSION_COUNT_DATA, MISSION_ITEM_DATA, MISSION_ITEM_INT_DATA,
    MISSION_REQUEST_DATA, MISSION_REQUEST_INT_DATA, MISSION_REQUEST_LIST_DATA, MISSION_SET_CURRENT_DATA, MavCmd,
    MavFrame, MavMissionResult as Verdict, MavResult,
};
use mavlink::{MavlinkVersion, MessageData};
use nalgebra::Vector3;

const LIST: MissionList = MissionList { sender: (255, 190), list: 0 };
const OTHER: MissionList = MissionList { sender: (7, 1), list: 0 };

/// A waypoint of local axes, m north, east, down.
fn waypoint(seq: u16, north: f32, east: f32, down: f32) -> MISSION_ITEM_INT_DATA {
    MISSION_ITEM_INT_DATA {
        param4: f32::NAN,
        x: (north * 1e4) as i32,
        y: (east * 1e4) as i32,
        z: down,
        seq,
        command: MavCmd::MAV_CMD_NAV_WAYPOINT,
        target_system: 1,
        target_component: 1,
        frame: MavFrame::MAV_FRAME_LOCAL_NED,
        autocontinue: 1,
        ..Default::default()
    }
}

fn count(count: u16) -> MISSION_COUNT_DATA {
    MISSION_COUNT_DATA { count, target_system: 1, target_component: 1 }
}

fn ask(number: u16) -> Vec<Reply> {
    vec![Reply::MissionRequest(LIST, number)]
}

fn verdict(verdict: Verdict) -> Vec<Reply> {
    vec![Reply::Mission(LIST, verdict)]
}

/// A report of a vehicle that was armed at `home`, m, world.
fn report(shared: &Local, mode: Mode, mission: MissionReport) {
    shared.report.put(Report { mode, mission, home: Some(Vector3::zeros()), ..Report::NONE }, 0);
}

/// Sends a whole mission of these; the last answer.
fn upload(fed: &mut Fed<'_>, shared: &Local, items: &[MISSION_ITEM_INT_DATA]) -> Vec<Reply> {
    fed.message(&count(items.len() as u16), 0);
    for (number, item) in items.iter().enumerate() {
        assert_eq!(replies(shared), ask(number as u16));
        fed.message(item, 0);
    }
    replies(shared)
}

/// What a single item, sent as the only one, is answered, and what is said.
fn answer_to(item: &MISSION_ITEM_INT_DATA) -> (Verdict, Vec<String>) {
    let shared = Local::new();
    report(&shared, Mode::Ready, MissionReport::default());
    let mut fed = Fed::new(&shared);
    let answer = upload(&mut fed, &shared, std::slice::from_ref(item));
    let [Reply::Mission(LIST, verdict)] = answer[..] else { panic!("{answer:?}") };
    assert_eq!(shared.mission.count() == 1, verdict == Verdict::MAV_MISSION_ACCEPTED);
    (verdict, texts(&shared))
}

fn payload<D: MessageData>(message: &D) -> Vec<u8> {
    let mut payload = vec![0; 255];
    let length = message.ser(MavlinkVersion::V2, &mut payload);
    payload.truncate(length);
    payload
}

fn item_of(message: &MISSION_ITEM_INT_DATA, is_last: bool) -> Item {
    SentItem::read(&payload(message), true).item(is_last).unwrap()
}

#[test]
fn a_mission_is_asked_for_item_by_item_and_given_back_as_it_was() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let sent = [
        MISSION_ITEM_INT_DATA { command: MavCmd::MAV_CMD_NAV_TAKEOFF, ..waypoint(0, 0.0, 0.0, -2.0) },
        MISSION_ITEM_INT_DATA { param1: 1.5, param2: 0.25, param4: -90.0, ..waypoint(1, 1.5, -2.25, -3.0) },
        MISSION_ITEM_INT_DATA {
            command: MavCmd::MAV_CMD_NAV_LAND,
            frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
            x: 473_977_420,
            y: 85_455_940,
            z: 0.0,
            ..waypoint(2, 0.0, 0.0, 0.0)
        },
    ];
    assert_eq!(upload(&mut fed, &shared, &sent), verdict(Verdict::MAV_MISSION_ACCEPTED));
    assert_eq!(texts(&shared), ["Mission: 3 items"]);
    fed.message(&MISSION_REQUEST_LIST_DATA { target_system: 1, target_component: 1 }, 0);
    assert_eq!(replies(&shared), [Reply::MissionCount(LIST, 3)]);
    for (number, sent) in (0..).zip(&sent) {
        fed.message(&MISSION_REQUEST_INT_DATA { seq: number, target_system: 1, target_component: 1 }, 0);
        assert_eq!(replies(&shared), [Reply::MissionItem { list: LIST, number, is_int: true }]);
        let back = shared.mission.item(number).unwrap().message(number, (255, 190));
        assert_eq!((back.param1, back.x, back.y, back.z), (sent.param1, sent.x, sent.y, sent.z));
        assert_eq!((back.seq, back.command, back.frame), (number, sent.command, sent.frame));
        assert_eq!(back.param4.is_nan(), sent.param4.is_nan());
        assert!(back.param4.is_nan() || (back.param4 - sent.param4).abs() < 0.01);
        assert!((back.param2 - sent.param2).abs() < 0.01);
    }
    // By the older message: degrees.
    fed.message(&MISSION_REQUEST_DATA { seq: 2, target_system: 1, target_component: 1 }, 0);
    assert_eq!(replies(&shared), [Reply::MissionItem { list: LIST, number: 2, is_int: false }]);
    let old = shared.mission.item(2).unwrap().old_message(2, (255, 190));
    assert!((old.x - 47.397_74).abs() < 1e-5 && (old.y - 8.545_594).abs() < 1e-5);
    fed.message(&MISSION_REQUEST_INT_DATA { seq: 3, target_system: 1, target_component: 1 }, 0);
    assert_eq!(replies(&shared), verdict(Verdict::MAV_MISSION_INVALID_SEQUENCE));
    fed.message(&MISSION_CLEAR_ALL_DATA { target_system: 1, target_component: 1 }, 0);
    assert_eq!((replies(&shared), shared.mission.count()), (verdict(Verdict::MAV_MISSION_ACCEPTED), 0));
}

#[test]
fn an_item_of_the_older_message_is_taken_as_well() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&count(1), 0);
    let item = MISSION_ITEM_DATA {
        x: 47.5,
        y: -8.25,
        z: 3.0,
        param4: f32::NAN,
        command: MavCmd::MAV_CMD_NAV_WAYPOINT,
        frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        target_system: 1,
        target_component: 1,
        ..Default::default()
    };
    fed.message(&item, 0);
    assert_eq!(replies(&shared)[1..], verdict(Verdict::MAV_MISSION_ACCEPTED));
    let back = shared.mission.item(0).unwrap().message(0, (255, 190));
    assert_eq!((back.x, back.y, back.z), (475_000_000, -82_500_000, 3.0));
}

#[test]
fn an_upload_that_breaks_off_leaves_the_mission_that_there_was() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    upload(&mut fed, &shared, &[waypoint(0, 1.0, 0.0, -2.0)]);
    texts(&shared);
    fed.message(&count(3), 0);
    fed.message(&waypoint(0, 9.0, 0.0, -2.0), 0);
    replies(&shared);
    // Any frame is a clock; what is not answered is asked for again, and in the end given up.
    let nudge = MISSION_REQUEST_LIST_DATA { target_system: 9, target_component: 1 };
    let mut asked = Vec::new();
    for step in 1..=60 {
        fed.message(&nudge, step * 100_000);
        asked.extend(replies(&shared));
    }
    let given_up = Reply::Mission(LIST, Verdict::MAV_MISSION_OPERATION_CANCELLED);
    assert_eq!(asked, [vec![Reply::MissionRequest(LIST, 1); 4], vec![given_up]].concat(), "every 0.3 s of 1.5");
    assert_eq!(texts(&shared), ["Mission: upload broken off, nothing changed"]);
    assert_eq!(shared.mission.count(), 1);
    assert_eq!(shared.mission.item(0), Some(item_of(&waypoint(0, 1.0, 0.0, -2.0), true)));
    // Nor does one that its client breaks off.
    fed.message(&count(2), 7_000_000);
    let cancelled = Verdict::MAV_MISSION_OPERATION_CANCELLED;
    fed.message(&MISSION_ACK_DATA { target_system: 1, target_component: 1, mavtype: cancelled }, 7_000_000);
    replies(&shared);
    fed.message(&waypoint(0, 9.0, 0.0, -2.0), 7_000_000);
    assert_eq!(replies(&shared), verdict(Verdict::MAV_MISSION_INVALID_SEQUENCE));
}

#[test]
fn a_client_that_sends_other_items_than_requested_is_refused_and_makes_room_for_others() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&count(3), 0);
    fed.message(&waypoint(0, 1.0, 0.0, -2.0), 0);
    assert_eq!(replies(&shared), [ask(0), ask(1)].concat());
    // A hundred times a second, as it answers each request.
    let mut answered = Vec::new();
    for step in 1..=200 {
        fed.message(&waypoint(7, 9.0, 0.0, -2.0), step * 10_000);
        answered.extend(replies(&shared));
    }
    let requests = answered.iter().take_while(|reply| **reply == Reply::MissionRequest(LIST, 1)).count();
    assert!((4..=5).contains(&requests), "{answered:?}");
    // From then on each is refused by itself.
    let refused = verdict(Verdict::MAV_MISSION_INVALID_SEQUENCE);
    assert!(answered[requests..].iter().all(|reply| [reply.clone()] == refused[..]), "{answered:?}");
    assert_eq!(texts(&shared), ["Mission: not the items requested, nothing changed"]);
    fed.bytes(&from(7, 1, 1, &count(1)), 2_000_000);
    assert_eq!(replies(&shared), [Reply::MissionRequest(OTHER, 0)]);
}

#[test]
fn an_upload_that_was_left_behind_keeps_no_other_station_out() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&count(3), 0);
    replies(&shared);
    fed.bytes(&from(7, 1, 1, &count(1)), 60_000_000);
    let given_up = Reply::Mission(LIST, Verdict::MAV_MISSION_OPERATION_CANCELLED);
    assert_eq!(replies(&shared), [given_up, Reply::MissionRequest(OTHER, 0)]);
}

#[test]
fn a_frame_that_is_delivered_twice_counts_once_and_a_lost_answer_is_given_again() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let twice = |fed: &mut Fed<'_>, frame: Vec<u8>| (0..2).for_each(|_| fed.bytes(&frame, 0));
    twice(&mut fed, from(255, 190, 1, &count(2)));
    assert_eq!(replies(&shared), ask(0));
    twice(&mut fed, from(255, 190, 2, &waypoint(0, 1.0, 0.0, -2.0)));
    assert_eq!(replies(&shared), ask(1));
    // Sent again on purpose, because the request for the next was lost: that is repeated in a quarter of a second.
    fed.bytes(&from(255, 190, 3, &waypoint(0, 1.0, 0.0, -2.0)), 0);
    assert_eq!(replies(&shared), []);
    fed.bytes(&from(255, 190, 3, &waypoint(0, 1.0, 0.0, -2.0)), 250_000);
    assert_eq!(replies(&shared), ask(1));
    twice(&mut fed, from(255, 190, 4, &waypoint(1, 2.0, 0.0, -2.0)));
    assert_eq!(replies(&shared), verdict(Verdict::MAV_MISSION_ACCEPTED));
    fed.bytes(&from(255, 190, 5, &waypoint(1, 2.0, 0.0, -2.0)), 0);
    assert_eq!(replies(&shared), verdict(Verdict::MAV_MISSION_ACCEPTED));
    assert_eq!(shared.mission.count(), 2);
}

#[test]
fn of_two_stations_that_send_missions_the_second_is_refused() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&count(2), 0);
    replies(&shared);
    fed.bytes(&from(7, 1, 1, &count(1)), 0);
    fed.bytes(&from(7, 1, 2, &waypoint(0, 5.0, 0.0, -2.0)), 0);
    let denied = [Verdict::MAV_MISSION_DENIED, Verdict::MAV_MISSION_INVALID_SEQUENCE];
    assert_eq!(replies(&shared), denied.map(|verdict| Reply::Mission(OTHER, verdict)));
    assert_eq!(texts(&shared), ["Mission: another station sends one"]);
    fed.message(&waypoint(0, 1.0, 0.0, -2.0), 0);
    fed.message(&waypoint(1, 2.0, 0.0, -2.0), 0);
    assert_eq!(replies(&shared)[1..], verdict(Verdict::MAV_MISSION_ACCEPTED));
    fed.bytes(&from(7, 1, 3, &count(1)), 0);
    assert_eq!(replies(&shared), [Reply::MissionRequest(OTHER, 0)]);
}

#[test]
fn a_mission_is_not_changed_while_it_is_flown() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    upload(&mut fed, &shared, &[waypoint(0, 1.0, 0.0, -2.0)]);
    fed.message(&count(2), 0);
    fed.message(&waypoint(0, 5.0, 0.0, -2.0), 0);
    replies(&shared);
    texts(&shared);
    report(&shared, Mode::Flying, MissionReport { is_flown: true, ..MissionReport::default() });
    // The last item of an upload that began before.
    fed.message(&waypoint(1, 6.0, 0.0, -2.0), 0);
    fed.message(&count(1), 0);
    fed.message(&MISSION_CLEAR_ALL_DATA { target_system: 1, target_component: 1 }, 0);
    assert_eq!(replies(&shared), vec![Reply::Mission(LIST, Verdict::MAV_MISSION_DENIED); 3]);
    assert_eq!(texts(&shared)[0], "Mission: not changed while it is flown");
    assert_eq!(shared.mission.item(0), Some(item_of(&waypoint(0, 1.0, 0.0, -2.0), true)));
}

#[test]
fn what_is_not_flown_is_refused_with_its_number_and_its_reason() {
    let good = waypoint(0, 1.0, 0.0, -2.0);
    let of = |change: fn(&mut MISSION_ITEM_INT_DATA)| {
        let mut item = good.clone();
        change(&mut item);
        item
    };
    for (item, result, words) in [
        (of(|i| i.command = MavCmd::MAV_CMD_DO_CHANGE_SPEED), 3, "command 178 is not flown"),
        (of(|i| i.command = MavCmd::MAV_CMD_NAV_LOITER_UNLIM), 3, "command 17 is not flown"),
        (of(|i| i.frame = MavFrame::MAV_FRAME_LOCAL_OFFSET_NED), 2, "frame 7 is not used"),
        (of(|i| i.frame = MavFrame::MAV_FRAME_MISSION), 2, "frame 2 is not used"),
        (of(|i| i.param1 = -1.0), 6, "parameter 1, not 0 to 6553 s"),
        (of(|i| i.param2 = -0.5), 7, "parameter 2, not 0.01 to 655 m"),
        (of(|i| i.param2 = f32::INFINITY), 7, "parameter 2, not 0.01 to 655 m"),
        (of(|i| i.param3 = 2.0), 8, "parameter 3, no passing by"),
        (of(|i| i.param4 = 1e9), 9, "parameter 4, yaw, not -360 to 360"),
        (of(|i| i.x = i32::MAX), 10, "parameter 5, not a place"),
        (of(|i| i.y = i32::MIN), 11, "parameter 6, not a place"),
        (of(|i| i.z = f32::NAN), 12, "parameter 7, not a height"),
        (of(|i| i.x = 2_000_000), 5, "outside the fence"),
        (of(|i| i.z = -60.0), 5, "outside the fence"),
        (of(|i| i.z = 0.5), 5, "below the place of arming"),
    ] {
        let (verdict, texts) = answer_to(&item);
        assert_eq!((verdict as u8, texts), (result, vec![format!("Mission item 0: {words}")]), "{item:?}");
    }
    assert_eq!(answer_to(&good).0, Verdict::MAV_MISSION_ACCEPTED);
    // Numbers that the crate's types do not know.
    for (place, value, words) in [(30, 0xFE, "command 254 is not flown"), (34, 99, "frame 99 is not used")] {
        let mut bytes = payload(&good);
        bytes[place] = value;
        assert_eq!(SentItem::read(&bytes, true).item(true).unwrap_err().to_string(), words);
    }
    // In a list, where they do not belong.
    for (command, number, words) in [
        (MavCmd::MAV_CMD_NAV_TAKEOFF, 1, "a take-off is the first item"),
        (MavCmd::MAV_CMD_NAV_LAND, 0, "a landing is the last item"),
        (MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH, 0, "a landing is the last item"),
    ] {
        let shared = Local::new();
        let mut fed = Fed::new(&shared);
        fed.message(&count(3), 0);
        (0..number).for_each(|number| fed.message(&waypoint(number, 0.0, 0.0, -1.0), 0));
        replies(&shared);
        fed.message(&MISSION_ITEM_INT_DATA { command, ..waypoint(number, 0.0, 0.0, -1.0) }, 0);
        assert_eq!(replies(&shared), verdict(Verdict::MAV_MISSION_UNSUPPORTED));
        assert_eq!(texts(&shared), [format!("Mission item {number}: {words}")]);
    }
}

#[test]
fn too_many_items_other_lists_and_other_vehicles_are_refused_or_left_alone() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&count(65), 0);
    assert_eq!(replies(&shared), verdict(Verdict::MAV_MISSION_NO_SPACE));
    assert_eq!(texts(&shared), ["Mission: 65 items, 64 at most"]);
    fed.bytes(&extended(&waypoint(0, 0.0, 0.0, -1.0), &[1]), 0);
    let fence = MissionList { list: 1, ..LIST };
    assert_eq!(replies(&shared), [Reply::Mission(fence, Verdict::MAV_MISSION_UNSUPPORTED)]);
    fed.message(&MISSION_COUNT_DATA { count: 1, target_system: 7, target_component: 1 }, 0);
    fed.message(&MISSION_ITEM_INT_DATA { target_system: 7, ..waypoint(0, 0.0, 0.0, -1.0) }, 0);
    assert_eq!(replies(&shared), []);
}

#[test]
fn places_are_those_of_their_frames() {
    let origin = Origin::new(473_977_420, 85_455_940, 488_000).unwrap();
    // 1 m above the origin, as MAVLink has it.
    let home = Vector3::new(0.0, 0.0, -1.0);
    let local = Vector3::new(3.0, -4.0, -6.0);
    let place = origin.place(&local);
    let globe = |frame, z| MISSION_ITEM_INT_DATA {
        x: place.latitude,
        y: place.longitude,
        z,
        frame,
        ..waypoint(0, 0.0, 0.0, 0.0)
    };
    let enu = MISSION_ITEM_INT_DATA { frame: MavFrame::MAV_FRAME_LOCAL_ENU, ..waypoint(0, -4.0, 3.0, 6.0) };
    for item in [
        waypoint(0, 3.0, -4.0, -6.0),
        enu,
        globe(MavFrame::MAV_FRAME_GLOBAL, 494.0),
        globe(MavFrame::MAV_FRAME_GLOBAL_INT, 494.0),
        globe(MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT, 5.0),
        globe(MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, 5.0),
    ] {
        let placed = item_of(&item, true).placed(&origin, &home);
        assert!((frames::world(&placed.position) - local).norm() < 0.02, "{item:?} {placed:?}");
        assert_eq!((placed.leg, placed.turn, placed.radius), (Leg::Waypoint, HeadingSetpoint::Keep, ACCEPTANCE_RADIUS_M));
    }
    // Yaw is from north to the right, degrees; the law's heading from east to the left.
    let turned = MISSION_ITEM_INT_DATA { param1: 2.5, param2: 1.25, param4: 180.0, ..waypoint(0, 0.0, 0.0, -1.0) };
    let placed = item_of(&turned, true).placed(&origin, &home);
    let HeadingSetpoint::Angle { angle, .. } = placed.turn else { panic!("{placed:?}") };
    assert!((angle + FRAC_PI_2).abs() < 1e-4, "{angle}");
    assert_eq!((placed.hold, placed.radius), (2_500_000, 1.25));
}

#[test]
fn a_mission_is_begun_paused_and_set_by_commands_and_only_if_all_of_it_may_be_flown() {
    let start = |first, last| command(MavCmd::MAV_CMD_MISSION_START, [first, last, 0.0, 0.0, 0.0]);
    let mode = command(MavCmd::MAV_CMD_DO_SET_MODE, [1.0, 4.0, 4.0, 0.0, 0.0]);
    let pause = |go_on| command(MavCmd::MAV_CMD_DO_PAUSE_CONTINUE, [go_on, 0.0, 0.0, 0.0, 0.0]);
    let set = |item| command(MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT, [item, 0.0, 0.0, 0.0, 0.0]);
    for (message, request) in [
        (start(0.0, 0.0), Some(Request::FlyMission(Some(0)))),
        (start(1.0, f32::NAN), Some(Request::FlyMission(Some(1)))),
        (start(f32::NAN, 0.0), Some(Request::FlyMission(None))),
        (start(-1.0, 0.0), Some(Request::FlyMission(None))),
        (start(64.0, 0.0), None),
        (start(0.5, 0.0), None),
        (start(0.0, 1.0), None),
        (mode, Some(Request::FlyMission(None))),
        (pause(0.0), Some(Request::Hold)),
        (pause(1.0), Some(Request::FlyMission(None))),
        (pause(2.0), None),
        (set(1.0), Some(Request::SetMissionItem(1))),
        (set(-1.0), None),
    ] {
        let shared = Local::new();
        let mut fed = Fed::new(&shared);
        upload(&mut fed, &shared, &[waypoint(0, 1.0, 0.0, -2.0), waypoint(1, 2.0, 0.0, -2.0)]);
        // A new mission begins at its first item.
        assert_eq!(shared.requests.take().map(|asked| asked.request), Some(Request::SetMissionItem(0)));
        texts(&shared);
        fed.message(&message, 0);
        assert_eq!(shared.requests.take().map(|asked| asked.request), request, "{message:?}");
        assert_eq!((texts(&shared).len(), replies(&shared).len()), if request.is_some() { (0, 0) } else { (1, 1) });
    }
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&MISSION_SET_CURRENT_DATA { seq: 3, target_system: 1, target_component: 1 }, 0);
    assert_eq!(shared.requests.take().map(|asked| asked.request), Some(Request::SetMissionItem(3)));
    fed.message(&start(0.0, 0.0), 0);
    assert_eq!(
        (shared.requests.take(), texts(&shared)),
        (None, vec!["Mission item 0: no such mission item".to_owned()])
    );
    // Home, and with it the fence, has become known since.
    replies(&shared);
    upload(&mut fed, &shared, &[waypoint(0, 1.0, 0.0, -2.0), waypoint(1, 2.0, 0.0, 2.0)]);
    let _ = (shared.requests.take(), texts(&shared), replies(&shared));
    report(&shared, Mode::Idling, MissionReport::default());
    fed.message(&start(0.0, 0.0), 0);
    assert_eq!(texts(&shared), ["Mission item 1: below the place of arming"]);
    assert_eq!(shared.requests.take(), None);
    let denied = replies(&shared);
    assert!(matches!(&denied[..], [Reply::Command(answer)] if answer.result == MavResult::MAV_RESULT_DENIED));
}
