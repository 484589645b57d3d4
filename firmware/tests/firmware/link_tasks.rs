//! The link's two tasks on lines that deliver in pieces, fail, end or take nothing more.

use crate::support::line::{Delivery, Incoming, Line, Outgoing};
use crate::support::receiver::{Local, ordered, report};
use crate::support::{PERIOD_US, Simulated, sent, v2};
use controller_core::state::State;
use core::cell::RefCell;
use embassy_futures::join::join;
use embedded_io_async::{ErrorKind, ErrorType, Read};
use firmware::hardware::Clock;
use firmware::link::acknowledgement::{Acknowledgement, Order};
use firmware::link::files::FileRequest;
use firmware::link::frame::Parser;
use firmware::link::receive::receive;
use firmware::link::telemetry::kind::Kind;
use firmware::link::transmit::{WRITE_TIMEOUT_US, transmit};
use firmware::parameters::table::{Name, PARAMETERS};
use firmware::shared::{Event, MissionList, Ping, QueuedRequest, Reply, Report, Severity, Timing, Traffic};
use flight::{Mode, Refusal, Request};
use mavlink::MessageData;
use mavlink::dialects::common::{
    ATTITUDE_QUATERNION_DATA, COMMAND_ACK_DATA, COMMAND_LONG_DATA, FILE_TRANSFER_PROTOCOL_DATA, HEARTBEAT_DATA,
    LOCAL_POSITION_NED_DATA, MISSION_ACK_DATA, MISSION_COUNT_DATA, MavAutopilot, MavCmd, MavMissionResult, MavModeFlag,
    MavResult, MavSeverity, MavState, MavSysStatusSensor, MavType, PARAM_VALUE_DATA, STATUSTEXT_DATA, SYS_STATUS_DATA,
    TIMESYNC_DATA,
};
use nalgebra::{Quaternion, Vector3};

fn disarm(sequence: u8) -> Vec<u8> {
    v2(
        sequence,
        &COMMAND_LONG_DATA { command: MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, param2: 21196.0, ..Default::default() },
    )
}

#[test]
fn a_frame_in_pieces_between_faults_is_received() {
    let (clock, shared, line) = (Simulated::default(), Local::new(), Line::default());
    let frame = disarm(1);
    let pieces = frame.chunks(5).map(|piece| Delivery::Bytes(piece.to_vec()));
    let pieces = pieces.flat_map(|piece| [piece, Delivery::Fault, Delivery::End]);
    line.borrow_mut().extend(pieces.take(3));
    line.borrow_mut().push_back(Delivery::Bytes(frame[5..].to_vec()));
    clock.run(200_000, receive(Incoming(&line), &clock, shared.for_receive()), |_| ());
    assert!(shared.disarm.is_raised());
    assert_eq!(shared.traffic.get().unwrap().value.frames, 1);
}

#[test]
fn a_broken_line_does_not_take_all_the_time() {
    struct Broken(u32);
    impl ErrorType for Broken {
        type Error = ErrorKind;
    }
    impl Read for Broken {
        async fn read(&mut self, _: &mut [u8]) -> Result<usize, ErrorKind> {
            self.0 += 1;
            assert!(self.0 <= 202, "more than two hundred attempts in a second");
            Err(ErrorKind::Other)
        }
    }
    let (clock, shared) = (Simulated::default(), Local::new());
    clock.run(1_000_000, receive(Broken(0), &clock, shared.for_receive()), |_| ());
}

/// A chip's line on which a frame arrives every [`BUSY_PERIOD_US`]: one that came while nobody read is an overrun, which
/// the next read reports and ends.
struct Busy<'a> {
    clock: &'a Simulated,
    /// The first frame that has not come yet.
    next: u64,
    sequence: u8,
}

const BUSY_PERIOD_US: u64 = 10_000;

impl ErrorType for Busy<'_> {
    type Error = ErrorKind;
}

impl Read for Busy<'_> {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
        let came = self.clock.now() / BUSY_PERIOD_US + 1;
        if came > self.next {
            self.next = came;
            return Err(ErrorKind::Other);
        }
        self.clock.until(self.next * BUSY_PERIOD_US).await;
        self.next += 1;
        self.sequence = self.sequence.wrapping_add(1);
        let frame = disarm(self.sequence);
        bytes[..frame.len()].copy_from_slice(&frame);
        Ok(frame.len())
    }
}

#[test]
fn a_line_that_is_never_silent_is_heard_after_an_overrun() {
    let (clock, shared) = (Simulated::default(), Local::new());
    let line = Busy { clock: &clock, next: 0, sequence: 0 };
    clock.run(1_000_000, receive(line, &clock, shared.for_receive()), |_| ());
    let heard = shared.traffic.get().map_or(0, |traffic| traffic.value.frames);
    assert!(heard >= 90, "{heard} frames of 100");
}

#[test]
fn a_long_burst_is_received_whole() {
    let (clock, shared, line) = (Simulated::default(), Local::new(), Line::default());
    let burst = (0..=255).flat_map(disarm).collect();
    line.borrow_mut().push_back(Delivery::Bytes(burst));
    clock.run(300_000, receive(Incoming(&line), &clock, shared.for_receive()), |_| ());
    assert_eq!(shared.traffic.get().unwrap().value.frames, 256);
}

#[test]
fn every_command_of_a_burst_is_answered() {
    let (clock, shared, line, written) = (Simulated::default(), Local::new(), Line::default(), RefCell::default());
    let asked = |number: u8| COMMAND_LONG_DATA {
        param1: LOCAL_POSITION_NED_DATA::ID as f32,
        param2: 1e6 - f32::from(number),
        command: MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
        ..Default::default()
    };
    let burst = (0..40).flat_map(|number| v2(number, &asked(number))).collect();
    line.borrow_mut().push_back(Delivery::Bytes(burst));
    let outgoing = Outgoing { written: &written, at_once: 300 };
    let link =
        join(receive(Incoming(&line), &clock, shared.for_receive()), transmit(outgoing, &clock, shared.for_transmit()));
    clock.run(200_000, link, |_| ());
    assert_eq!(sent::<COMMAND_ACK_DATA>(&written).len(), 40);
}

/// Transmits for `duration` us.
fn transmitted(shared: &Local, duration: u64, each: impl FnMut(u64)) -> RefCell<Vec<u8>> {
    let (clock, written) = (Simulated::default(), RefCell::default());
    clock.run(duration, transmit(Outgoing { written: &written, at_once: 7 }, &clock, shared.for_transmit()), each);
    written
}

fn flying(shared: &Local, time: u64) {
    let state = State {
        position: Vector3::new(2.0, 1.0, 3.0),
        velocity: Vector3::new(0.2, 0.1, 0.3),
        attitude: Quaternion::identity(),
        angular_velocity: Vector3::new(0.5, 0.25, 0.125),
    };
    let timing = Timing { period: PERIOD_US, worst_duration: 2_500, ..Default::default() };
    shared.report.put(Report { mode: Mode::Flying, state: Some(state), timing, ..Report::NONE }, time);
}

#[test]
fn a_heartbeat_goes_out_every_second() {
    let shared = Local::new();
    let heartbeats: Vec<HEARTBEAT_DATA> = sent(&transmitted(&shared, 10_000_000, |_| ()));
    assert_eq!(heartbeats.len(), 10);
    let HEARTBEAT_DATA { mavtype, autopilot, base_mode, system_status, .. } = heartbeats[0];
    assert_eq!((mavtype, autopilot), (MavType::MAV_TYPE_QUADROTOR, MavAutopilot::MAV_AUTOPILOT_GENERIC));
    assert_eq!(system_status, MavState::MAV_STATE_BOOT);
    assert!(!base_mode.contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED));
}

#[test]
fn the_heartbeat_says_armed_in_the_armed_modes_only() {
    for mode in Mode::ALL {
        let shared = Local::new();
        report(&shared, mode, 0);
        let heartbeats: Vec<HEARTBEAT_DATA> = sent(&transmitted(&shared, 100_000, |_| ()));
        let armed = heartbeats[0].base_mode.contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
        assert_eq!(armed, mode.is_armed(), "{mode:?}");
    }
}

#[test]
fn attitude_and_position_go_out_in_mavlinks_frames_at_requested_rates() {
    for rate in [10.0, 25.0, 50.0] {
        let shared = Local::new();
        shared.parameters.set(Name::TelemetryRate, rate).unwrap();
        let written = transmitted(&shared, 2_000_000, |now| flying(&shared, now));
        let attitudes: Vec<ATTITUDE_QUATERNION_DATA> = sent(&written);
        let positions: Vec<LOCAL_POSITION_NED_DATA> = sent(&written);
        assert_eq!((attitudes.len(), positions.len()), (2 * rate as usize, 2 * rate as usize));
        let LOCAL_POSITION_NED_DATA { time_boot_ms, x, y, z, vx, vy, vz } = positions[1];
        assert_eq!(time_boot_ms, 1000 / rate as u32);
        assert_eq!([x, y, z, vx, vy, vz], [1.0, 2.0, -3.0, 0.1, 0.2, -0.3]);
        let a = &attitudes[0];
        // No rotation of ours faces east.
        let east = [a.q1 - 0.5_f32.sqrt(), a.q2, a.q3, a.q4 - 0.5_f32.sqrt()];
        assert!(east.iter().all(|part| part.abs() < 1e-6), "{a:?}");
        assert_eq!([a.rollspeed, a.pitchspeed, a.yawspeed], [0.5, -0.25, -0.125]);
    }
}

#[test]
fn an_old_report_is_not_sent_as_the_present() {
    let shared = Local::new();
    let written = transmitted(&shared, 5_000_000, |now| {
        if now < 1_000_000 {
            flying(&shared, now);
        }
    });
    let attitudes: Vec<ATTITUDE_QUATERNION_DATA> = sent(&written);
    assert!(attitudes.len() <= 51, "{}", attitudes.len());
    let heartbeats: Vec<HEARTBEAT_DATA> = sent(&written);
    assert_eq!(heartbeats[4].system_status, MavState::MAV_STATE_BOOT);
}

#[test]
fn the_battery_is_reported_while_its_reading_is_fresh() {
    let shared = Local::new();
    let written = transmitted(&shared, 3_000_000, |now| {
        flying(&shared, now);
        shared.traffic.put(Traffic { refused: 70_000, ..Default::default() }, now);
        if now == 500_000 {
            shared.voltage.put(11.1, now);
        }
    });
    let statuses: Vec<SYS_STATUS_DATA> = sent(&written);
    let voltages: Vec<_> = statuses.iter().map(|status| status.voltage_battery).collect();
    assert_eq!(voltages, [u16::MAX, 11_100, u16::MAX]);
    let expected = SYS_STATUS_DATA {
        load: 250,
        voltage_battery: u16::MAX,
        current_battery: -1,
        errors_comm: u16::MAX,
        battery_remaining: -1,
        ..statuses[2].clone()
    };
    assert_eq!(statuses[2], expected);
    let battery = MavSysStatusSensor::MAV_SYS_STATUS_SENSOR_BATTERY;
    let known: Vec<_> =
        statuses.iter().map(|status| status.onboard_control_sensors_present.contains(battery)).collect();
    assert_eq!(known, [false, true, false]);
    assert_eq!(statuses[2].drop_rate_comm, 0);
}

#[test]
fn commands_are_answered_with_number_and_result() {
    let shared = Local::new();
    let command = MavCmd::MAV_CMD_COMPONENT_ARM_DISARM;
    let by = |command: u16, sender: (u8, u8)| Order { command, sender, frame: 0 };
    let asked =
        |sender| QueuedRequest { request: Request::Arm, order: Some(by(command as u16, sender)), setpoints: None };
    shared.answer(&asked((255, 190)), Ok(()));
    shared.answer(&asked((7, 1)), Err(Refusal::PosesUnsettled));
    shared.answer(&asked((0, 0)), Ok(()));
    // Not from the link.
    shared.answer(&QueuedRequest { request: Request::Arm, order: None, setpoints: None }, Ok(()));
    let (other, result) = (MavCmd::MAV_CMD_NAV_TAKEOFF, MavResult::MAV_RESULT_UNSUPPORTED);
    shared.replies.put(Reply::Command(by(other as u16, (254, 0)).answered(result))).unwrap();
    shared.replies.put(Reply::Command(by(65_000, (1, 191)).answered(result))).unwrap();
    let written = transmitted(&shared, 100_000, |_| ());
    let (accepted, denied) = (MavResult::MAV_RESULT_ACCEPTED, MavResult::MAV_RESULT_DENIED);
    let expected = [
        (command as u16, accepted, (255, 190)),
        (command as u16, denied, (7, 1)),
        (command as u16, accepted, (0, 0)),
        (other as u16, result, (254, 0)),
        (65_000, result, (1, 191)),
    ];
    let expected = expected.map(|(command, result, sender)| by(command, sender).answered(result));
    assert_eq!(sent::<Acknowledgement>(&written), expected);
    // Who knows no extension fields reads the same.
    let answers: Vec<COMMAND_ACK_DATA> = sent(&written);
    assert_eq!(answers[1], COMMAND_ACK_DATA { command, result: denied });
    // The refusal also goes out in words.
    let texts: Vec<STATUSTEXT_DATA> = sent(&written);
    assert_eq!(texts[0].text.to_str().unwrap(), "Refused: poses not believed for a whole second");
    assert_eq!(texts[0].severity, MavSeverity::MAV_SEVERITY_WARNING);
}

#[test]
fn what_is_requested_is_accepted_where_there_is_anything_to_send() {
    let shared = Local::new();
    let order = ordered(MavCmd::MAV_CMD_REQUEST_MESSAGE);
    for kind in [Kind::PositionTarget, Kind::ProtocolVersion, Kind::HomePosition] {
        shared.replies.put(Reply::Requested(kind, order)).unwrap();
    }
    // On the ground, without an estimate.
    let written = transmitted(&shared, 100_000, |now| report(&shared, Mode::Checks, now));
    let results: Vec<_> = sent::<Acknowledgement>(&written).iter().map(|answer| answer.result).collect();
    let later = MavResult::MAV_RESULT_TEMPORARILY_REJECTED;
    assert_eq!(results, [later, MavResult::MAV_RESULT_ACCEPTED, later]);
}

const ARM: QueuedRequest = QueuedRequest {
    request: Request::Arm,
    order: Some(ordered(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM)),
    setpoints: None,
};

#[test]
fn a_message_for_an_idle_line_goes_out_at_once() {
    type Say = fn(&Local);
    let say: [(Say, u32); 3] = [
        (|shared| shared.answer(&ARM, Ok(())), COMMAND_ACK_DATA::ID),
        (|shared| shared.reply(Reply::Parameter(Name::SystemId)), PARAM_VALUE_DATA::ID),
        (|shared| shared.announce(Event::new(Severity::Information, "now")), STATUSTEXT_DATA::ID),
    ];
    for (say, message) in say {
        let shared = Local::new();
        // The next heartbeat is due at a second; telemetry has no value to send.
        shared.parameters.set(Name::TelemetryRate, 10.0).unwrap();
        let written = transmitted(&shared, 460_000, |now| {
            if now == 455_000 {
                say(&shared);
            }
        });
        let mut parser = Parser::new();
        let mut sent = Vec::new();
        parser.feed(&written.borrow(), 0, &mut |frame| sent.push(frame.message));
        assert_eq!(sent.last(), Some(&message), "{sent:?}");
    }
}

#[test]
fn the_time_is_requested_once_a_second_and_sent_to_every_requester() {
    let shared = Local::new();
    shared.replies.put(Reply::TimeSync { asked: -5 }).unwrap();
    let messages: Vec<TIMESYNC_DATA> = sent(&transmitted(&shared, 1_900_000, |_| ()));
    let [answer, first, second] = &messages[..] else { panic!("{messages:?}") };
    assert_eq!((answer.ts1, first.tc1, second.tc1), (-5, 0, 0));
    // Nanoseconds.
    assert!((1_000_000_000 - 10_000_000..=1_000_000_000).contains(&(second.ts1 - first.ts1)), "{messages:?}");
    assert!((0..100_000_000).contains(&answer.tc1), "{messages:?}");
}

#[test]
fn a_ping_goes_back_to_its_sender_as_it_came() {
    let shared = Local::new();
    let (time_usec, seq) = (0x0102_0304_0506_0708, 0x090A_0B0C);
    let ping = Ping { time_usec, seq, target_system: 255, target_component: 190 };
    shared.replies.put(Reply::Ping(ping.clone())).unwrap();
    let pings: Vec<Ping> = sent(&transmitted(&shared, 100_000, |_| ()));
    assert_eq!(pings, [ping]);
}

#[test]
fn every_parameter_is_listed_with_its_place() {
    let shared = Local::new();
    shared.replies.put(Reply::AllParameters).unwrap();
    let values: Vec<PARAM_VALUE_DATA> = sent(&transmitted(&shared, 1_500_000, |_| ()));
    assert_eq!(values.len(), PARAMETERS.len());
    for (index, (value, row)) in values.iter().zip(&PARAMETERS).enumerate() {
        assert_eq!((usize::from(value.param_index), usize::from(value.param_count)), (index, PARAMETERS.len()));
        // By their bits: nothing was built here, and what is as built is not a number.
        let (value, default) = ((value.param_id.to_str().unwrap(), value.param_value.to_bits()), row.default.to_bits());
        assert_eq!(value, (row.name, default));
    }
}

#[test]
fn too_many_events_lose_the_last_ones_and_their_number_is_reported() {
    let shared = Local::new();
    for number in 0..11 {
        shared.announce(Event::new(Severity::Information, number));
    }
    let texts: Vec<STATUSTEXT_DATA> = sent(&transmitted(&shared, 2_000_000, |_| ()));
    let texts: Vec<_> = texts.iter().map(|text| text.text.to_str().unwrap()).collect();
    let lost: Vec<_> = texts.iter().filter(|text| text.ends_with("lost")).collect();
    assert_eq!(lost, [&"3 events lost"]);
    let rest: Vec<_> = texts.iter().filter(|text| !text.ends_with("lost")).copied().collect();
    assert_eq!(rest, ["0", "1", "2", "3", "4", "5", "6", "7"]);
}

#[test]
fn a_line_that_takes_nothing_loses_frames_but_not_the_task() {
    let (clock, shared, written) = (Simulated::default(), Local::new(), RefCell::default());
    let stuck = Outgoing { written: &written, at_once: 0 };
    let mut waiting = Vec::new();
    clock.run(20 * WRITE_TIMEOUT_US, transmit(stuck, &clock, shared.for_transmit()), |now| {
        flying(&shared, now);
        if shared.events.put(Event::new(Severity::Warning, "one of many")).is_ok() {
            waiting.push(now);
        }
    });
    // Events are taken, each one given up in its time, even though telemetry is always due.
    assert!(waiting.iter().any(|&time| time > 10 * WRITE_TIMEOUT_US), "{waiting:?}");
}

/// What these replies put into the payloads of messages of one number, byte for byte.
fn payloads(replies: Vec<Reply>, number: u32) -> Vec<Vec<u8>> {
    let shared = Local::new();
    replies.into_iter().for_each(|reply| shared.reply(reply));
    let written = transmitted(&shared, 100_000, |_| ());
    let (mut parser, mut found) = (Parser::new(), Vec::new());
    for &byte in written.borrow().iter() {
        let frame = parser.push(byte, 0);
        found.extend(frame.filter(|frame| frame.message == number).map(|frame| frame.payload.to_vec()));
    }
    assert_eq!(parser.discarded(), 0);
    found
}

#[test]
fn an_answer_about_missions_says_which_list_it_is_about() {
    let about = |list| MissionList { sender: (255, 190), list };
    let counts = payloads([0, 1, 2].map(|list| Reply::MissionCount(about(list), 0)).into(), MISSION_COUNT_DATA::ID);
    assert_eq!(counts, [vec![0, 0, 255, 190], vec![0, 0, 255, 190, 1], vec![0, 0, 255, 190, 2]]);
    let refused = MavMissionResult::MAV_MISSION_UNSUPPORTED;
    let acks = [0, 1, 2].map(|list| Reply::Mission(about(list), refused)).into();
    assert_eq!(payloads(acks, MISSION_ACK_DATA::ID), [vec![255, 190, 3], vec![255, 190, 3, 1], vec![255, 190, 3, 2]]);
    // Accepted is zero, and the list stands behind it.
    let accepted = vec![Reply::Mission(about(1), MavMissionResult::MAV_MISSION_ACCEPTED)];
    assert_eq!(payloads(accepted, MISSION_ACK_DATA::ID), [vec![255, 190, 0, 1]]);
}

#[test]
fn a_refused_file_request_is_named_with_the_next_number() {
    for (sequence, next) in [(0x1FF, [0x00, 0x02]), (u16::MAX, [0, 0])] {
        let request = FileRequest { sender: (255, 190), sequence, session: 3, operation: 4 };
        let refused = payloads(vec![Reply::NoFiles(request)], FILE_TRANSFER_PROTOCOL_DATA::ID);
        let header = [next[0], next[1], 3, 129, 1, 4, 0, 0, 0, 0, 0, 0];
        assert_eq!(refused, [[&[0, 255, 190][..], &header, &[7]].concat()]);
    }
}
