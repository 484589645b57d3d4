//! Commands and heartbeats in: what they do, and what is answered.

use crate::support::desk::Desk;
use crate::support::receiver::{
    Fed, Local, answer, answers, command, disarm, ordered, replies, report, texts, whichever,
};
use crate::support::{patched, v1, v2, v2_of_payload};
use firmware::parameters::table::Name;
use firmware::shared::{QueuedRequest, Reply};
use flight::{Mode, MotorSetting, MotorTest, Request, Setting};
use mavlink::MessageData;
use mavlink::dialects::common::{COMMAND_LONG_DATA, HEARTBEAT_DATA, MavAutopilot, MavCmd, MavResult, MavType};

const ARM_DISARM: MavCmd = MavCmd::MAV_CMD_COMPONENT_ARM_DISARM;

fn arm() -> COMMAND_LONG_DATA {
    command(ARM_DISARM, [1.0, 0.0, 0.0, 0.0, 0.0])
}

fn requests(shared: &Local) -> usize {
    std::iter::from_fn(|| shared.requests.take()).count()
}

#[test]
fn an_arm_command_becomes_a_request_that_control_answers() {
    for bytes in [v1(1, &arm()), v2(1, &arm())] {
        let shared = Local::new();
        Fed::new(&shared).bytes(&bytes, 0);
        let QueuedRequest { request, order, setpoints } = shared.requests.take().unwrap();
        assert_eq!((request, order.map(whichever), setpoints), (Request::Arm, Some(ordered(ARM_DISARM)), None));
        assert!(replies(&shared).is_empty() && !shared.disarm.is_raised());
    }
}

#[test]
fn a_command_whose_end_comes_a_tenth_of_a_second_late_does_nothing() {
    for (late, taken) in [(100_000, true), (100_001, false)] {
        let shared = Local::new();
        let mut fed = Fed::new(&shared);
        let bytes = v2(1, &arm());
        let (begin, end) = bytes.split_at(bytes.len() - 1);
        fed.bytes(begin, 0);
        fed.bytes(end, late);
        assert_eq!(shared.requests.take().is_some(), taken, "{late}");
        // What follows is understood.
        fed.bytes(&v2(2, &disarm()), late);
        assert!(shared.disarm.take());
    }
}

#[test]
fn a_disarm_command_cannot_be_lost_nor_undone_by_an_earlier_arm_command() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    (0..3).for_each(|_| fed.message(&arm(), 0));
    fed.message(&disarm(), 0);
    assert!(shared.disarm.take());
    assert!(shared.requests.take().is_none());
    let refused = Reply::Command(ordered(ARM_DISARM).answered(MavResult::MAV_RESULT_DENIED));
    assert_eq!(answers(&shared), [refused]);
    // The other two wait for the answer to the last.
    let [Reply::Likewise { order: first, of: second }, Reply::Likewise { order, of: last }, ref accepted] =
        replies(&shared)[..]
    else {
        panic!()
    };
    assert!(order.frame == second && order.frame != last && [first, order].map(whichever) == [ordered(ARM_DISARM); 2]);
    assert_eq!(*accepted, Reply::Command(ordered(ARM_DISARM).answered(MavResult::MAV_RESULT_ACCEPTED)));
}

#[test]
fn the_same_frame_again_does_not_act_again() {
    let test = command(MavCmd::MAV_CMD_DO_MOTOR_TEST, [2.0, 0.0, 5.0, 1.0, 0.0]);
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    fed.bytes(&v2(7, &test), 0);
    fed.bytes(&v2(7, &test), 900_000);
    assert_eq!(requests(&shared), 1);
    // Sent again on purpose, or so late that the sequence number has come round.
    fed.bytes(&v2(8, &test), 910_000);
    assert_eq!(requests(&shared), 1);
    fed.bytes(&v2(8, &test), 1_910_000);
    assert_eq!(requests(&shared), 1);
}

#[test]
fn what_a_line_delivers_twice_does_not_arm_after_a_disarm() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let disarm = command(ARM_DISARM, [0.0; 5]);
    for now in [0, 50_000, 900_000] {
        fed.bytes(&v2(1, &arm()), now);
        fed.bytes(&v2(2, &disarm), now + 10_000);
    }
    let asked: Vec<_> = std::iter::from_fn(|| shared.requests.take()).map(|asked| asked.request).collect();
    assert_eq!(asked, [Request::Arm, Request::Disarm]);
    // Others in between do not make it forgotten at once.
    (3..10).for_each(|sequence| fed.bytes(&v2(sequence, &command(MavCmd::MAV_CMD_NAV_LAND, [0.0; 5])), 920_000));
    requests(&shared);
    fed.bytes(&v2(2, &disarm), 930_000);
    assert_eq!(requests(&shared), 0);
}

#[test]
fn a_frame_that_goes_on_being_delivered_acts_once_a_second() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let acted = (0..20).filter(|count| {
        fed.bytes(&v2(1, &command(ARM_DISARM, [0.0; 5])), count * 500_000);
        requests(&shared) == 1
    });
    assert_eq!(acted.count(), 10);
}

#[test]
fn a_client_that_repeats_a_command_with_its_count_is_answered() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    (0..3).for_each(|confirmation| fed.message(&COMMAND_LONG_DATA { confirmation, ..arm() }, 1_000));
    // QueuedRequest once, to be answered three times.
    assert_eq!((requests(&shared), replies(&shared).len()), (1, 2));
}

#[test]
fn a_motor_test_names_motor_level_and_time() {
    let shared = Local::new();
    Fed::new(&shared).message(&command(MavCmd::MAV_CMD_DO_MOTOR_TEST, [4.0, 0.0, 12.5, 1.5, 1.0]), 0);
    let request = Request::MotorTest(MotorTest { rotor: 3, level: 0.125, duration: 1_500_000 });
    assert_eq!(shared.requests.take().unwrap().request, request);
}

#[test]
fn a_motors_controller_is_named_and_what_it_shall_do() {
    let configure =
        |what: f32, function: f32| command(MavCmd::MAV_CMD_CONFIGURE_ACTUATOR, [what, 0.0, 0.0, 0.0, function]);
    for (what, setting) in [(1.0, Setting::Beep), (4.0, Setting::Normal), (5.0, Setting::Reversed)] {
        let request = Request::MotorSetting(MotorSetting { rotor: 2, setting });
        assert_eq!(asked(&configure(what, 3.0)), Some(request));
    }
    for function in [0.0, 5.0, 1.5, f32::NAN, 33.0] {
        assert_eq!(answer(&configure(5.0, function), Mode::Ready), MavResult::MAV_RESULT_DENIED, "{function}");
    }
    // Turning both ways is not for rotors.
    for what in [0.0, 2.0, 3.0, 6.0, f32::NAN] {
        assert_eq!(answer(&configure(what, 3.0), Mode::Ready), MavResult::MAV_RESULT_UNSUPPORTED, "{what}");
    }
}

#[test]
fn invalid_commands_are_denied_with_a_reason() {
    let test = MavCmd::MAV_CMD_DO_MOTOR_TEST;
    let nan = f32::NAN;
    for message in [
        command(ARM_DISARM, [nan; 5]),
        command(ARM_DISARM, [2.0, 0.0, 0.0, 0.0, 0.0]),
        command(ARM_DISARM, [0.5, 21196.0, 0.0, 0.0, 0.0]),
        command(test, [0.0, 0.0, 5.0, 1.0, 0.0]),
        command(test, [5.0, 0.0, 5.0, 1.0, 0.0]),
        command(test, [1.5, 0.0, 5.0, 1.0, 0.0]),
        command(test, [1.0, 1.0, 1100.0, 1.0, 0.0]),
        command(test, [1.0, 0.0, 5.0, 1.0, 4.0]),
        command(MavCmd::MAV_CMD_DO_SET_MODE, [nan, 6.0, 0.0, 0.0, 0.0]),
        command(MavCmd::MAV_CMD_DO_SET_MODE, [1.0, 4.0, 9.0, 0.0, 0.0]),
        command(MavCmd::MAV_CMD_CONFIGURE_ACTUATOR, [1.0, 0.0, 0.0, 0.0, 5.0]),
        command(MavCmd::MAV_CMD_REQUEST_MESSAGE, [435.0, 99.0, 0.0, 0.0, 0.0]),
        command(MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, [30.0, nan, 0.0, 0.0, 0.0]),
    ] {
        assert_eq!(answer(&message, Mode::Ready), MavResult::MAV_RESULT_DENIED, "{message:?}");
        let shared = Local::new();
        Fed::new(&shared).message(&message, 0);
        let [words] = &texts(&shared)[..] else { panic!("{message:?}") };
        assert!(words.len() <= 50, "{words}");
    }
}

#[test]
fn no_parameter_of_a_command_may_be_nan_where_it_is_used() {
    let messages = [
        (arm(), 1),
        (command(MavCmd::MAV_CMD_DO_MOTOR_TEST, [1.0, 0.0, 5.0, 1.0, 0.0]), 5),
        (command(MavCmd::MAV_CMD_DO_SET_MODE, [1.0, 6.0, 0.0, 0.0, 0.0]), 2),
    ];
    for (message, used) in messages {
        for parameter in 0..7 {
            for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                let shared = Local::new();
                Fed::new(&shared).bytes(&patched(&message, 4 * parameter, value), 0);
                let denied = Reply::Command(ordered(message.command).answered(MavResult::MAV_RESULT_DENIED));
                assert_eq!(replies(&shared).contains(&denied), parameter < used, "{message:?} {parameter} {value}");
                assert!((requests(&shared) == 0) || parameter >= used);
            }
        }
    }
}

/// The request of a message to control, if any.
fn asked(message: &COMMAND_LONG_DATA) -> Option<Request> {
    let shared = Local::new();
    Fed::new(&shared).message(message, 0);
    shared.requests.take().map(|asked| asked.request)
}

#[test]
fn modes_are_px4s_or_guided() {
    let set_mode = |base: f32, main: f32, sub: f32| command(MavCmd::MAV_CMD_DO_SET_MODE, [base, main, sub, 0.0, 0.0]);
    for (message, request) in [
        (set_mode(1.0, 6.0, 0.0), Request::FlySetpoints),
        // With every flag of our own heartbeat, the HIL flag among them.
        (set_mode(249.0, 6.0, 0.0), Request::FlySetpoints),
        (set_mode(8.0, 0.0, 0.0), Request::FlySetpoints),
        (set_mode(216.0, 0.0, 0.0), Request::FlySetpoints),
        (set_mode(1.0, 4.0, 3.0), Request::Hold),
        (set_mode(1.0, 4.0, 2.0), Request::TakeOff(None)),
        (set_mode(1.0, 4.0, 6.0), Request::Land),
        (set_mode(1.0, 4.0, 11.0), Request::FlyPolicy),
    ] {
        assert_eq!(asked(&message), Some(request), "{message:?}");
    }
    for message in [
        set_mode(64.0, 0.0, 0.0),
        set_mode(4.0, 0.0, 0.0),
        set_mode(256.0, 0.0, 0.0),
        set_mode(-1.0, 0.0, 0.0),
        set_mode(1.0, 4.0, 5.0),
        set_mode(1.0, 1.0, 0.0),
    ] {
        assert_eq!(answer(&message, Mode::Flying), MavResult::MAV_RESULT_DENIED, "{message:?}");
    }
    // ArduPilot's numbers, as MAVProxy sends them to whom it does not know: LOITER, LAND.
    for number in [5.0, 9.0] {
        let shared = Local::new();
        Fed::new(&shared).message(&set_mode(1.0, number, 0.0), 0);
        assert_eq!(texts(&shared), ["Mode refused: PX4's 6 0, 4 2, 4 3, 4 4 or 4 6 only"]);
    }
}

#[test]
fn the_message_set_mode_means_the_command() {
    const EXTRA_CRC: u8 = 89;
    // Custom mode, lowest byte first; system; base mode.
    for (payload, request) in [
        ([0, 0, 6, 0, 1, 1], Some(Request::FlySetpoints)),
        ([0, 0, 4, 3, 1, 217], Some(Request::Hold)),
        ([0, 0, 4, 2, 0, 129], Some(Request::TakeOff(None))),
        ([0, 0, 4, 6, 1, 1], Some(Request::Land)),
        // For another vehicle.
        ([0, 0, 4, 6, 2, 1], None),
        // ArduPilot's RTL.
        ([6, 0, 0, 0, 1, 1], None),
    ] {
        let shared = Local::new();
        Fed::new(&shared).bytes(&v2_of_payload(1, 11, EXTRA_CRC, &payload), 0);
        let order = Some(ordered(MavCmd::MAV_CMD_DO_SET_MODE));
        let asked = shared.requests.take().map(|asked| (asked.request, asked.order.map(whichever)));
        assert_eq!(asked, request.map(|request| (request, order)), "{payload:?}");
        let is_refused = request.is_none() && payload[4] == 1;
        assert_eq!((replies(&shared).len(), texts(&shared).len()), (is_refused.into(), is_refused.into()));
    }
}

#[test]
fn taking_off_landing_and_disarming_are_requested() {
    let takeoff = |param7: f32| COMMAND_LONG_DATA { param7, ..command(MavCmd::MAV_CMD_NAV_TAKEOFF, [0.0; 5]) };
    assert_eq!(asked(&takeoff(3.0)), Some(Request::TakeOff(Some(3.0))));
    assert_eq!(asked(&takeoff(f32::NAN)), Some(Request::TakeOff(None)));
    assert_eq!(asked(&takeoff(0.0)), Some(Request::TakeOff(None)));
    assert_eq!(asked(&command(MavCmd::MAV_CMD_NAV_LAND, [0.0; 5])), Some(Request::Land));
    assert_eq!(asked(&command(ARM_DISARM, [0.0; 5])), Some(Request::Disarm));
    // Only the number that forces does.
    assert_eq!(asked(&command(ARM_DISARM, [0.0, 21195.0, 0.0, 0.0, 0.0])), Some(Request::Disarm));
    assert_eq!(asked(&disarm()), None);
}

#[test]
fn a_simulator_takes_over_only_while_disarmed() {
    let message = command(MavCmd::MAV_CMD_DO_SET_MODE, [32.0, 0.0, 0.0, 0.0, 0.0]);
    for (mode, taken) in [(Mode::Ready, true), (Mode::Idling, false), (Mode::Flying, false), (Mode::Descending, false)]
    {
        let shared = Local::new();
        report(&shared, mode, 0);
        Fed::new(&shared).message(&message, 0);
        assert_eq!(shared.hil.is_raised(), taken, "{mode:?}");
        assert_eq!(replies(&shared).len(), 1);
    }
}

#[test]
fn commands_for_other_vehicles_are_left_to_them() {
    for (target_system, target_component, ours) in
        [(0, 0, true), (1, 1, true), (1, 0, true), (2, 1, false), (1, 100, false)]
    {
        let shared = Local::new();
        Fed::new(&shared).message(&COMMAND_LONG_DATA { target_system, target_component, ..disarm() }, 0);
        assert_eq!(shared.disarm.is_raised(), ours, "{target_system}/{target_component}");
    }
}

#[test]
fn a_line_that_echoes_does_not_command() {
    let shared = Local::new();
    shared.parameters.set(Name::SystemId, 255.0).unwrap();
    let mut bytes = v2(1, &COMMAND_LONG_DATA { target_system: 0, ..disarm() });
    bytes[6] = 1;
    let end = bytes.len() - 2;
    let checksum = mavlink::calculate_crc(&bytes[1..end], COMMAND_LONG_DATA::EXTRA_CRC);
    bytes[end..].copy_from_slice(&checksum.to_le_bytes());
    Fed::new(&shared).bytes(&bytes, 0);
    assert!(!shared.disarm.is_raised());
}

#[test]
fn only_a_ground_stations_heartbeat_counts_as_its_presence() {
    for (mavtype, counts) in [
        (MavType::MAV_TYPE_GCS, true),
        (MavType::MAV_TYPE_ONBOARD_CONTROLLER, false),
        (MavType::MAV_TYPE_QUADROTOR, false),
    ] {
        let shared = Local::new();
        let autopilot = MavAutopilot::MAV_AUTOPILOT_INVALID;
        Fed::new(&shared).message(&HEARTBEAT_DATA { mavtype, autopilot, ..Default::default() }, 1234);
        assert_eq!(shared.ground_station.get().map(|last| last.time), counts.then_some(1234));
    }
}

/// A ground station's, of this system.
fn from(system: u8, sequence: u8, message: &COMMAND_LONG_DATA) -> Vec<u8> {
    crate::support::from(system, 190, sequence, message)
}

/// A vehicle on a desk, in the mode that it is in after `ask` ran in each of three seconds' ticks.
fn desk<'a>(shared: &'a Local, mut ask: impl FnMut(u64, u64)) -> Desk<'a> {
    let mut desk = Desk::new(shared);
    for tick in 0..300 {
        shared.ground_station.put((), desk.now);
        ask(tick, desk.now);
        desk.tick();
    }
    desk
}

/// Whether a force disarm of this station stops the motors.
fn stops(fed: &mut Fed<'_>, desk: &mut Desk<'_>, system: u8) -> bool {
    fed.bytes(&from(system, 99, &disarm()), desk.now);
    desk.tick();
    !desk.mode().is_armed()
}

#[test]
fn a_refused_station_does_not_keep_another_from_stopping_the_motors() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let mut desk = desk(&shared, |tick, now| {
        match tick {
            // Too early to arm.
            20 => fed.bytes(&from(255, 1, &arm()), now),
            // A radio does, later.
            250 => shared.request(QueuedRequest { request: Request::Arm, order: None, setpoints: None }),
            _ => {}
        }
        fed.bytes(&from(255, tick as u8, &command(MavCmd::MAV_CMD_REQUEST_MESSAGE, [0.0; 5])), now);
    });
    assert_eq!(desk.mode(), Mode::Idling, "{:?}", texts(&shared));
    assert!(stops(&mut fed, &mut desk, 254), "{:?}", texts(&shared));
}

#[test]
fn of_two_stations_that_arm_at_once_the_later_commands() {
    let shared = Local::new();
    let mut fed = Fed::new(&shared);
    let mut desk = desk(&shared, |tick, now| {
        if tick == 250 {
            fed.bytes(&from(255, 1, &arm()), now);
            fed.bytes(&from(254, 1, &arm()), now);
        }
    });
    assert_eq!(desk.mode(), Mode::Idling, "{:?}", texts(&shared));
    assert!(!stops(&mut fed, &mut desk, 255));
    assert!(stops(&mut fed, &mut desk, 254), "{:?}", texts(&shared));
}
