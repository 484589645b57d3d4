//! Many on one line: whom the vehicle obeys, whose setpoints it flies, and what no client crowds out.

use crate::support::desk::Desk;
use crate::support::line::{Live, Outgoing};
use crate::support::receiver::{Fed, Local, answers, command, disarm, ordered, replies, texts};
use crate::support::{Simulated, from, sent, v2};
use controller_core::governor::Motion;
use core::cell::RefCell;
use embassy_futures::join::join;
use firmware::link::acknowledgement::Acknowledgement;
use firmware::link::receive::receive;
use firmware::link::transmit::transmit;
use firmware::shared::{QueuedRequest, REQUESTS_CAPACITY, Reply};
use flight::{Mode, Request};
use mavlink::MessageData;
use mavlink::dialects::common::{
    COMMAND_LONG_DATA, HEARTBEAT_DATA, MavCmd, MavFrame, MavResult, MavType, PositionTargetTypemask,
    SET_ATTITUDE_TARGET_DATA, SET_POSITION_TARGET_GLOBAL_INT_DATA, SET_POSITION_TARGET_LOCAL_NED_DATA,
};

const ARM_DISARM: MavCmd = MavCmd::MAV_CMD_COMPONENT_ARM_DISARM;

fn arm() -> COMMAND_LONG_DATA {
    command(ARM_DISARM, [1.0, 0.0, 0.0, 0.0, 0.0])
}

fn mode(main: f32, sub: f32) -> COMMAND_LONG_DATA {
    command(MavCmd::MAV_CMD_DO_SET_MODE, [1.0, main, sub, 0.0, 0.0])
}

fn take_off(param7: f32) -> COMMAND_LONG_DATA {
    COMMAND_LONG_DATA { param7, ..command(MavCmd::MAV_CMD_NAV_TAKEOFF, [0.0; 5]) }
}

fn asked(shared: &Local) -> Vec<QueuedRequest> {
    std::iter::from_fn(|| shared.requests.take()).collect()
}

fn requests(shared: &Local) -> Vec<Request> {
    asked(shared).into_iter().map(|asked| asked.request).collect()
}

/// One of each kind but landing and disarming.
fn lesser() -> [COMMAND_LONG_DATA; 5] {
    let test = command(MavCmd::MAV_CMD_DO_MOTOR_TEST, [2.0, 0.0, 5.0, 1.0, 0.0]);
    [arm(), take_off(3.0), mode(6.0, 0.0), mode(4.0, 3.0), test]
}

#[test]
fn landing_and_disarming_are_never_crowded_out() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    for _ in 0..40 {
        lesser().iter().for_each(|message| fed.message(message, 0));
    }
    let _ = (answers(&shared), replies(&shared));
    fed.message(&command(MavCmd::MAV_CMD_NAV_LAND, [0.0; 5]), 0);
    fed.message(&command(ARM_DISARM, [0.0; 5]), 0);
    assert!(replies(&shared).is_empty() && answers(&shared).is_empty());
    let requests = requests(&shared);
    // Of each kind the latest, in the order of their coming.
    assert!(requests.len() <= 7, "{requests:?}");
    assert_eq!(requests[requests.len() - 2..], [Request::Land, Request::Disarm]);
}

#[test]
fn the_pilots_switches_do_not_wait_for_room_on_the_link() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    lesser().iter().for_each(|message| fed.message(message, 0));
    for request in [Request::Arm, Request::Disarm, Request::Hold, Request::FlySetpoints, Request::Land] {
        shared.request(QueuedRequest { request, order: None, setpoints: None });
    }
    let asked = std::iter::from_fn(|| shared.requests.take()).collect::<Vec<_>>();
    let by_radio = asked.iter().filter(|asked| asked.order.is_none()).count();
    assert_eq!((asked.len(), by_radio), (REQUESTS_CAPACITY, 5), "{asked:?}");
    // And all of them, the link's landing and disarming too, whatever comes behind.
    let urgent = [command(MavCmd::MAV_CMD_NAV_LAND, [0.0; 5]), command(ARM_DISARM, [0.0; 5])];
    urgent.iter().for_each(|message| fed.message(message, 0));
    for request in [Request::Arm, Request::Disarm, Request::Hold, Request::FlySetpoints, Request::Land] {
        shared.request(QueuedRequest { request, order: None, setpoints: None });
    }
    lesser().iter().for_each(|message| fed.message(message, 0));
    assert_eq!(requests(&shared)[..2], [Request::Land, Request::Disarm]);
}

#[test]
fn the_latest_of_a_kind_wins_and_the_one_before_it_is_answered() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.message(&take_off(3.0), 0);
    fed.bytes(&from(254, 190, 1, &take_off(5.0)), 0);
    let order = ordered(MavCmd::MAV_CMD_NAV_TAKEOFF);
    let rejected = Reply::Command(order.answered(MavResult::MAV_RESULT_TEMPORARILY_REJECTED));
    assert_eq!(answers(&shared), std::slice::from_ref(&rejected));
    assert_eq!(requests(&shared), [Request::TakeOff(Some(5.0))]);
    // A repeated request is one; a replaced one is not done.
    [2.0, 2.0, 3.0].iter().for_each(|height| fed.message(&take_off(*height), 0));
    let [asked] = asked(&shared)[..] else { panic!() };
    assert_eq!(asked.request, Request::TakeOff(Some(3.0)));
    assert!(matches!(replies(&shared)[..], [Reply::Likewise { .. }]));
    assert_eq!(answers(&shared), [rejected]);
}

/// What is acknowledged, in the name of the number of its command, of frames that come at these times, us, on a desk
/// where everything else is well.
fn acknowledged(frames: &[(u64, Vec<u8>)]) -> Vec<(u16, MavResult)> {
    answered(frames).into_iter().map(|(command, _, result)| (command, result)).collect()
}

/// The same, with the system that it is for.
fn answered(frames: &[(u64, Vec<u8>)]) -> Vec<(u16, u8, MavResult)> {
    let (clock, shared, line, written) = (Simulated::default(), Local::new(), Live::default(), RefCell::default());
    let mut desk = Desk::new(&shared);
    let outgoing = Outgoing { written: &written, at_once: 300 };
    let link =
        join(receive(line.clone(), &clock, shared.for_receive()), transmit(outgoing, &clock, shared.for_transmit()));
    clock.run(3_200_000, link, |now| {
        if now.is_multiple_of(10_000) {
            shared.ground_station.put((), now);
            desk.tick();
        }
        frames.iter().filter(|(at, _)| *at == now).for_each(|(_, bytes)| line.say(bytes));
    });
    sent::<Acknowledgement>(&written)
        .into_iter()
        .map(|ack| (ack.order.command, ack.order.sender.0, ack.result))
        .collect()
}

const ACCEPTED: MavResult = MavResult::MAV_RESULT_ACCEPTED;
const DENIED: MavResult = MavResult::MAV_RESULT_DENIED;

#[test]
fn a_frame_that_comes_twice_at_once_is_answered_by_what_becomes_of_it_and_not_of_one_before() {
    let taking_off = MavCmd::MAV_CMD_NAV_TAKEOFF as u16;
    // Refused while disarmed; armed; then one frame twice before control has had a look at it.
    let twice = [v2(3, &take_off(2.0)), v2(3, &take_off(2.0))].concat();
    let frames = [(2_900_000, v2(1, &take_off(2.0))), (2_950_000, v2(2, &arm())), (3_000_000, twice)];
    let arming = (ARM_DISARM as u16, ACCEPTED);
    let results = [(taking_off, DENIED), arming, (taking_off, ACCEPTED), (taking_off, ACCEPTED)];
    assert_eq!(acknowledged(&frames), results);
}

#[test]
fn every_copy_of_a_repeated_command_is_acknowledged() {
    let land = command(MavCmd::MAV_CMD_NAV_LAND, [0.0; 5]);
    let version = command(MavCmd::MAV_CMD_REQUEST_MESSAGE, [300.0, 0.0, 0.0, 0.0, 0.0]);
    let nothing = command(MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION, [0.0; 5]);
    let unknown = command(MavCmd::MAV_CMD_DO_PARACHUTE, [0.0; 5]);
    for message in [land, version, unknown, arm(), command(ARM_DISARM, [0.0; 5])] {
        for count in [2, 3, 5, 12] {
            let results = acknowledged(&[(3_000_000, v2(1, &message).repeat(count))]);
            let (_, result) = results[0];
            assert_eq!(results, vec![(message.command as u16, result); count], "{message:?}");
        }
    }
    // Of equal orders that are not copies as many as there is room for; the room is free again afterwards.
    let land = command(MavCmd::MAV_CMD_NAV_LAND, [0.0; 5]);
    let many = |first: u8| (first..first + 12).flat_map(|sequence| v2(sequence, &land)).collect::<Vec<_>>();
    let bursts = [0, 1, 2_u8].map(|burst| (3_000_000 + 20_000 * u64::from(burst), many(12 * burst)));
    let later = (3_060_000, v2(50, &arm()).repeat(2));
    let results = acknowledged(&[&bursts[..], &[later]].concat());
    assert_eq!(results[..21], [(MavCmd::MAV_CMD_NAV_LAND as u16, ACCEPTED); 21]);
    assert_eq!(results[21..], [(ARM_DISARM as u16, ACCEPTED); 2]);
    // No task calibrates on this desk: an answer that never comes is not made up.
    assert_eq!(acknowledged(&[(3_000_000, v2(1, &nothing).repeat(3))]), []);
}

#[test]
fn equal_commands_at_once_get_equal_answers() {
    for message in [command(MavCmd::MAV_CMD_NAV_LAND, [0.0; 5]), command(ARM_DISARM, [0.0; 5]), arm()] {
        let by = |system: u8| from(system, 190, 1, &message);
        let mut results = answered(&[(3_000_000, [by(255), by(254), by(253)].concat())]);
        results.sort_by_key(|(_, system, _)| *system);
        let accepted = [253, 254, 255].map(|system| (message.command as u16, system, ACCEPTED));
        assert_eq!(results, accepted, "{message:?}");
    }
    // Of two heights one is flown.
    let (low, high) = (from(255, 190, 2, &take_off(2.0)), from(254, 190, 2, &take_off(3.0)));
    let frames = [(2_950_000, from(255, 190, 1, &arm())), (3_000_000, [low, high].concat())];
    let taking_off = MavCmd::MAV_CMD_NAV_TAKEOFF as u16;
    let rejected = MavResult::MAV_RESULT_TEMPORARILY_REJECTED;
    assert_eq!(answered(&frames)[1..], [(taking_off, 255, rejected), (taking_off, 254, ACCEPTED)]);
}

#[test]
fn an_arm_command_sent_again_is_accepted_again_whether_its_bytes_are_equal_or_not() {
    let accepted = (ARM_DISARM as u16, MavResult::MAV_RESULT_ACCEPTED);
    let times = [3_000_000, 3_050_000, 3_100_000];
    let again = times.map(|at| (at, v2(1, &arm())));
    assert_eq!(acknowledged(&again), [accepted; 3]);
    let anew = times.map(|at| (at, v2((at / 50_000) as u8, &arm())));
    assert_eq!(acknowledged(&anew), [accepted; 3]);
}

#[test]
fn equal_bytes_are_acknowledged_with_the_result_of_the_first_and_never_of_another_command() {
    let denied = MavResult::MAV_RESULT_DENIED;
    let nonsense = v2(1, &mode(1.0, 0.0));
    let set_mode = MavCmd::MAV_CMD_DO_SET_MODE as u16;
    assert_eq!(acknowledged(&[(3_000_000, nonsense.clone()), (3_040_000, nonsense)]), [(set_mode, denied); 2]);
    // Armed, disarmed, and the first frame once more: it does not arm, and is not acknowledged so.
    let (armed, disarmed) = (v2(1, &arm()), v2(2, &command(ARM_DISARM, [0.0; 5])));
    let frames = [(3_000_000, armed.clone()), (3_050_000, disarmed), (3_100_000, armed)];
    let results: Vec<_> = acknowledged(&frames).into_iter().map(|(_, result)| result).collect();
    let accepted = MavResult::MAV_RESULT_ACCEPTED;
    assert_eq!(results, [accepted, accepted, MavResult::MAV_RESULT_TEMPORARILY_REJECTED]);
}

/// A heartbeat of this type.
fn heartbeat(mavtype: MavType) -> HEARTBEAT_DATA {
    HEARTBEAT_DATA { mavtype, ..Default::default() }
}

const STATION: MavType = MavType::MAV_TYPE_GCS;
const COMPANION: MavType = MavType::MAV_TYPE_ONBOARD_CONTROLLER;

/// A vehicle that `armed` by system, component and type has armed, and whether a force disarm of `stops` stops it.
fn stops(armed: (u8, u8, MavType), stops: (u8, u8, MavType)) -> bool {
    let shared = Local::new();
    let (mut fed, mut desk) = (Fed::new(&shared), Desk::new(&shared));
    for tick in 0..300 {
        shared.ground_station.put((), desk.now);
        for (system, component, mavtype) in [armed, stops] {
            fed.bytes(&from(system, component, tick as u8, &heartbeat(mavtype)), desk.now);
        }
        if tick == 250 {
            fed.bytes(&from(armed.0, armed.1, 200, &arm()), desk.now);
        }
        desk.tick();
    }
    assert_eq!(desk.mode(), Mode::Idling, "{:?}", texts(&shared));
    fed.bytes(&from(stops.0, stops.1, 201, &disarm()), desk.now);
    desk.tick();
    !desk.mode().is_armed()
}

#[test]
fn the_operators_ground_station_stops_what_a_companion_armed() {
    assert!(stops((1, 191, COMPANION), (255, 190, STATION)));
    // Not the other way round, nor one companion the other's, nor one ground station the other's.
    assert!(!stops((255, 190, STATION), (1, 191, COMPANION)));
    assert!(!stops((1, 191, COMPANION), (1, 192, COMPANION)));
    assert!(!stops((255, 190, STATION), (254, 190, STATION)));
}

#[test]
fn who_armed_is_a_system_and_a_component() {
    assert!(!stops((255, 190, STATION), (255, 191, STATION)));
    assert!(stops((255, 190, STATION), (255, 190, STATION)));
}

fn target(x: f32) -> SET_POSITION_TARGET_LOCAL_NED_DATA {
    let type_mask = PositionTargetTypemask::from_bits_retain(0b1101_1111_1000);
    let coordinate_frame = MavFrame::MAV_FRAME_LOCAL_NED;
    SET_POSITION_TARGET_LOCAL_NED_DATA { x, type_mask, coordinate_frame, target_system: 1, ..Default::default() }
}

#[test]
fn of_two_streams_of_setpoints_one_is_flown_and_the_other_refused() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let mut flown = vec![];
    for count in 0..100 {
        let (now, other) = (count * 20_000, 1 + (count % 2) as u8);
        fed.bytes(&from(250, other, count as u8, &target(f32::from(other))), now);
        flown.extend(shared.setpoint.take());
    }
    assert_eq!(flown.len(), 50);
    let words = texts(&shared);
    assert_eq!(words, vec!["Setpoint refused: another sender's are flown"; 2]);
    // A stream that falls silent for a second no longer counts.
    fed.bytes(&from(250, 2, 101, &target(9.0)), 2_980_000);
    assert!(shared.setpoint.take().is_some());
}

/// OFFBOARD, requested by a sender of an armed vehicle on the ground while others stream, each its own place: whether
/// it is granted, whose setpoints are taken afterwards, and the texts.
fn offboard(asker: (u8, u8), streams: &[(u8, u8)]) -> (bool, Vec<f32>, Vec<String>) {
    let shared = Local::new();
    let (mut fed, mut desk) = (Fed::new(&shared), Desk::new(&shared));
    let (mut taken, mut said) = (vec![], vec![]);
    for tick in 0..400_u64 {
        shared.ground_station.put((), desk.now);
        if tick == 260 {
            let order = from(asker.0, asker.1, 1, &mode(6.0, 0.0));
            texts(&shared);
            fed.bytes(&order, desk.now);
            said = texts(&shared);
        }
        desk.tick();
        if tick == 250 {
            fed.bytes(&from(asker.0, asker.1, 0, &arm()), desk.now);
        }
        for (place, (system, component)) in streams.iter().enumerate() {
            fed.bytes(&from(*system, *component, tick as u8, &target(place as f32)), desk.now);
        }
        if tick > 261 {
            // North is the law's y.
            let setpoint = shared.setpoint.get().map(|setpoint| setpoint.value.motion);
            taken.extend(setpoint.map(|motion| if let Motion::Position(place) = motion { place.y } else { panic!() }));
        }
    }
    taken.dedup();
    let flown = shared.setpoint_owner.get().is_some();
    (flown, taken, said)
}

#[test]
fn the_client_that_requests_offboard_has_its_own_setpoints_flown() {
    let refused = vec!["No OFFBOARD by another sender's setpoints".to_owned()];
    let (stranger, station, companion, other) = ((9, 9), (255, 190), (255, 191), (255, 192));
    assert_eq!(offboard(station, &[stranger, station]), (true, vec![1.0], vec![]));
    assert_eq!(offboard(station, &[station, stranger]), (true, vec![0.0], vec![]));
    assert_eq!(offboard(station, &[companion, station]), (true, vec![1.0], vec![]));
    // None of its own: only those of the one sender there is, of its system.
    assert_eq!(offboard(station, &[companion]), (true, vec![0.0], vec![]));
    for streams in [&[stranger][..], &[stranger, companion], &[companion, other]] {
        let (flown, _, said) = offboard(station, streams);
        assert_eq!((flown, said), (false, refused.clone()), "{streams:?}");
    }
}

#[test]
fn a_refused_request_does_not_take_over_a_flight_by_setpoints() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let setpoint_owner = Some((255, 190));
    shared.setpoint_owner.set(setpoint_owner);
    // Another sender streams, and requests; until control has granted it nothing changes.
    fed.bytes(&from(9, 9, 1, &target(9.0)), 1_000);
    fed.bytes(&from(9, 9, 2, &mode(6.0, 0.0)), 2_000);
    let [asked] = asked(&shared)[..] else { panic!() };
    assert_eq!(asked.setpoints, Some((9, 9)));
    fed.bytes(&from(9, 9, 3, &target(9.0)), 3_000);
    assert!(shared.setpoint.take().is_none());
    fed.bytes(&from(255, 190, 1, &target(1.0)), 4_000);
    assert!(shared.setpoint.take().is_some());
}

#[test]
fn offboard_is_refused_in_words_while_what_streams_cannot_be_flown() {
    fn refused<D: MessageData>(message: &D, words: &str) {
        let shared = Local::new();
        let mut fed = Fed::new(&shared);
        fed.message(message, 0);
        texts(&shared);
        fed.message(&mode(6.0, 0.0), 500_000);
        let denied = ordered(MavCmd::MAV_CMD_DO_SET_MODE).answered(MavResult::MAV_RESULT_DENIED);
        assert_eq!((replies(&shared), texts(&shared)), (vec![Reply::Command(denied)], vec![words.to_owned()]));
        assert_eq!(requests(&shared), []);
        // With another one beside it, and long after.
        fed.message(&target(1.0), 600_000);
        fed.message(&mode(6.0, 0.0), 700_000);
        assert_eq!(requests(&shared), [Request::FlySetpoints]);
        fed.message(&mode(6.0, 0.0), 9_000_000);
        assert_eq!(requests(&shared), [Request::FlySetpoints]);
    }
    let ours = SET_ATTITUDE_TARGET_DATA { target_system: 1, ..Default::default() };
    refused(&ours, "No OFFBOARD by SET_ATTITUDE_TARGET");
    let global = SET_POSITION_TARGET_GLOBAL_INT_DATA {
        target_system: 1,
        coordinate_frame: MavFrame::MAV_FRAME_GLOBAL_INT,
        ..Default::default()
    };
    refused(&global, "No OFFBOARD by SET_POSITION_TARGET_GLOBAL_INT");
}

#[test]
fn a_text_is_sent_at_most_once_a_second() {
    let shared = Local::new();
    let (mut fed, mut desk) = (Fed::new(&shared), Desk::new(&shared));
    // By control's clock.
    desk.tick();
    let mut said = vec![];
    for tick in 0..300_u64 {
        shared.ground_station.put((), desk.now);
        for count in 0..25_u8 {
            let sequence = (tick as u8).wrapping_mul(26).wrapping_add(count);
            fed.bytes(&v2(sequence, &mode(f32::from(count % 2), 9.0)), desk.now);
        }
        let motor_test = command(MavCmd::MAV_CMD_DO_MOTOR_TEST, [1.0, 0.0, 99.0, 1.0, 0.0]);
        fed.bytes(&v2((tick as u8).wrapping_mul(26).wrapping_add(25), &motor_test), desk.now);
        desk.tick();
        said.extend(texts(&shared));
    }
    let times = |words: &str| said.iter().filter(|text| text.as_str() == words).count();
    let (nonsense, level) =
        ("Mode refused: PX4's 6 0, 4 2, 4 3, 4 4 or 4 6 only", "Motor test refused: level not in 0 to 15 %");
    assert!((2..=3).contains(&times(nonsense)) && (2..=3).contains(&times(level)), "{said:?}");
    assert!(!said.iter().any(|text| text.contains("events lost")), "{said:?}");
}
