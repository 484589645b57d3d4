//! What the link carries before there is a pose: lean, inertial sensor, vibration, named values, the bench report, and
//! the motor test as QGroundControl asks for it.

use crate::support::desk::Desk;
use crate::support::line::Outgoing;
use crate::support::receiver::{Fed, Local, command, ordered, replies, report, texts};
use crate::support::{Simulated, sent};
use core::cell::RefCell;
use estimation::imu::VibrationReport;
use firmware::link::telemetry::{motion, vehicle};
use firmware::link::transmit::transmit;
use firmware::parameters::table::Name;
use firmware::shared::{Calibrated, Reply, Report, TEXT_MAX, Timing, Traffic};
use flight::{ImuSample, Lean, Mode, MotorTest, Request};
use mavlink::dialects::common::{
    ATTITUDE_DATA, ATTITUDE_QUATERNION_DATA, COMMAND_LONG_DATA, HIGHRES_IMU_DATA, LOCAL_POSITION_NED_DATA, MavCmd,
    MavResult, MavSeverity, MavSysStatusSensor, NAMED_VALUE_FLOAT_DATA, ODOMETRY_DATA, STATUSTEXT_DATA, VIBRATION_DATA,
};
use nalgebra::{Quaternion, Vector3};

const ACTUATOR_TEST: MavCmd = MavCmd::MAV_CMD_ACTUATOR_TEST;
const RUN_PREARM_CHECKS: MavCmd = MavCmd::MAV_CMD_RUN_PREARM_CHECKS;

/// Nose up by 0.2 rad, on the bench, without an estimate.
fn leaning() -> Report {
    let attitude = Quaternion::new(0.1_f32.cos(), 0.0, -(0.1_f32.sin()), 0.0);
    let lean = Some(Lean { attitude, angular_velocity: Vector3::new(0.1, 0.2, 0.3) });
    Report { mode: Mode::Checks, lean, levelling: Some([0.9, 0.95, 1.05, 1.1]), ..Report::NONE }
}

/// What goes out in so many us, with the values put down anew each millisecond.
fn transmitted(shared: &Local, duration: u64, each: impl FnMut(u64)) -> RefCell<Vec<u8>> {
    let (clock, written) = (Simulated::default(), RefCell::default());
    let line = Outgoing { written: &written, at_once: 300 };
    clock.run(duration, transmit(line, &clock, shared.for_transmit()), each);
    written
}

#[test]
fn gravity_gives_roll_and_pitch_and_nothing_that_could_be_taken_for_an_estimate() {
    let attitude = motion::attitude(7_000, &leaning()).unwrap();
    assert!((attitude.pitch - 0.2).abs() < 0.01 && attitude.roll.abs() < 0.01 && attitude.yaw == 0.0, "{attitude:?}");
    assert_eq!((attitude.rollspeed, attitude.pitchspeed, attitude.yawspeed), (0.1, -0.2, -0.3));
    let shared = Local::new();
    let written = transmitted(&shared, 3_000_000, |now| shared.report.put(leaning(), now));
    assert!(sent::<ATTITUDE_DATA>(&written).len() >= 29);
    assert!(sent::<ATTITUDE_QUATERNION_DATA>(&written).is_empty() && sent::<ODOMETRY_DATA>(&written).is_empty());
    assert!(sent::<LOCAL_POSITION_NED_DATA>(&written).is_empty());
    assert!(motion::estimator_status(0, &leaning()).flags.is_empty());
    let status = vehicle::status(None, Some(&leaning()), Traffic::default(), None);
    let doubtful = MavSysStatusSensor::MAV_SYS_STATUS_AHRS | MavSysStatusSensor::MAV_SYS_STATUS_PREARM_CHECK;
    assert!(!status.onboard_control_sensors_health.intersects(doubtful));
}

#[test]
fn sensor_and_vibration_go_out_in_axes_of_the_link_and_old_ones_do_not() {
    let shared = Local::new();
    let sample =
        ImuSample { angular_velocity: Vector3::new(0.1, 0.2, 0.3), specific_force: Vector3::new(1.0, 2.0, 9.0) };
    let shaken = VibrationReport { level: Vector3::new(1.0, 2.0, 3.0), clipped: 5 };
    let written = transmitted(&shared, 2_000_000, |now| {
        shared.imu.put(sample, now);
        shared.vibration.put(shaken, now);
    });
    let [first, .., last] = &sent::<HIGHRES_IMU_DATA>(&written)[..] else { panic!() };
    assert_eq!((last.xacc, last.yacc, last.zacc), (1.0, -2.0, -9.0));
    assert_eq!((last.xgyro, last.ygyro, last.zgyro), (0.1, -0.2, -0.3));
    assert!(last.time_usec > first.time_usec && last.fields_updated.bits() == 0x3F);
    let last = sent::<VIBRATION_DATA>(&written).pop().unwrap();
    assert_eq!((last.vibration_x, last.vibration_y, last.vibration_z, last.clipping_0), (1.0, 2.0, 3.0, 5));
    let shared = Local::new();
    shared.imu.put(sample, 0);
    let written = transmitted(&shared, 5_000_000, |_| ());
    assert!(sent::<HIGHRES_IMU_DATA>(&written).len() <= 6);
}

/// Names and values that go out in four seconds.
fn named(shared: &Local, report: Option<Report>) -> Vec<(String, f32)> {
    let written = transmitted(shared, 4_000_000, |now| {
        if let Some(report) = report {
            shared.report.put(report, now);
        }
    });
    let values = sent::<NAMED_VALUE_FLOAT_DATA>(&written).into_iter();
    values.map(|value| (value.name.to_str().unwrap().to_owned(), value.value)).collect()
}

#[test]
fn every_named_value_has_its_turn_and_those_without_a_value_are_left_out() {
    let timing = Timing { worst_duration: 410, worst_jitter: 12, missed: 3, gaps: 2, ..Timing::default() };
    let shared = Local::new();
    shared.gyro_calibrated.raise();
    shared.parameters.set(Name::Imu1OffsetY, 0.1).unwrap();
    let seen = named(&shared, Some(Report { timing, ..leaning() }));
    for expected in [
        ("TICK_MAX", 410.0),
        ("TICK_LATE", 12.0),
        ("TICK_MISS", 3.0),
        ("IMU_GAPS", 2.0),
        ("CAL_GYRO", 1.0),
        ("CAL_ACCEL", 1.0),
        ("CAL_LEVEL", 0.0),
        ("LEVEL_M1", 0.9),
        ("LEVEL_M4", 1.1),
    ] {
        assert!(seen.iter().any(|(name, value)| (name.as_str(), *value) == expected), "{expected:?} of {seen:?}");
    }
    let silent = named(&Local::new(), None);
    assert!(!silent.is_empty() && silent.iter().all(|(name, _)| name.starts_with("CAL_")), "{silent:?}");
    let level = Local::new();
    level.parameters.set(Name::Imu1LevelX, 0.01).unwrap();
    assert!(named(&level, None).contains(&("CAL_LEVEL".to_owned(), 1.0)));
}

/// The lines of a bench report that is asked for by the command, with their severities.
fn bench_report(shared: &Local) -> Vec<(String, MavSeverity)> {
    let written = transmitted(shared, 3_000_000, |now| {
        if now == 100_000 {
            Fed::new(shared).message(&command(RUN_PREARM_CHECKS, [0.0; 5]), now);
        }
    });
    let lines = sent::<STATUSTEXT_DATA>(&written).into_iter();
    lines.map(|line| (line.text.to_str().unwrap().to_owned(), line.severity)).collect()
}

#[test]
fn the_bench_report_has_every_inequality_with_its_numbers_and_the_verdict() {
    let shared = Local::new();
    let mut desk = Desk::new(&shared);
    (0..200).for_each(|_| {
        desk.tick();
    });
    let certified = shared.verdict.get().unwrap().value.as_ref();
    let Ok(certified) = certified else { return assert_eq!(desk.mode(), Mode::Locked) };
    shared.started.put(("Power", "a desk"), 0);
    texts(&shared);
    let lines = bench_report(&shared);
    let words: Vec<&str> = lines.iter().map(|(text, _)| text.as_str()).collect();
    assert_eq!(words[0], "Started by Power on a desk");
    assert!(words[1].starts_with("Scenario "));
    let rows: Vec<_> = certified.certificate().inequalities().collect();
    assert!(rows.len() > 5);
    for (row, line) in rows.iter().zip(&words[2..]) {
        let (name, numbers) = line.split_once(": ").unwrap();
        let (required, available) = numbers.split_once(" of ").unwrap();
        assert!(row.name.starts_with(name), "{line}");
        assert!((required.parse::<f64>().unwrap() - row.required).abs() < 1e-4, "{line}");
        assert!((available.parse::<f64>().unwrap() - row.available).abs() < 1e-4, "{line}");
    }
    let rest = &words[2 + rows.len()..];
    assert_eq!(rest[0], "Certified");
    assert_eq!(rest[1], "Calibration: gyro no, accel no, level no");
    assert!(rest[2].starts_with("Tick "), "{rest:?}");
    assert_eq!(rest[3..], ["Refused: no ground station for 2.5 s", "Report ends"]);
    assert!(words.iter().all(|line| line.len() <= TEXT_MAX));
}

#[test]
fn the_bench_report_comes_without_a_certificate_and_a_report_too_and_not_of_an_armed_vehicle() {
    let shared = Local::new();
    let words: Vec<_> = bench_report(&shared).into_iter().collect();
    let text = |text: &str, severity| (text.to_owned(), severity);
    let (information, critical) = (MavSeverity::MAV_SEVERITY_INFO, MavSeverity::MAV_SEVERITY_CRITICAL);
    assert_eq!(
        words[1..],
        [
            text("Calibration: gyro no, accel no, level no", information),
            text("No report from control", critical),
            text("Report ends", information),
        ]
    );
    for (mode, result) in [
        (Mode::Ready, MavResult::MAV_RESULT_ACCEPTED),
        (Mode::Idling, MavResult::MAV_RESULT_TEMPORARILY_REJECTED),
        (Mode::Flying, MavResult::MAV_RESULT_TEMPORARILY_REJECTED),
    ] {
        let shared = Local::new();
        report(&shared, mode, 0);
        Fed::new(&shared).message(&command(RUN_PREARM_CHECKS, [0.0; 5]), 0);
        let replies = replies(&shared);
        assert!(replies.contains(&Reply::Command(ordered(RUN_PREARM_CHECKS).answered(result))), "{replies:?}");
        assert_eq!(replies.contains(&Reply::BenchReport), mode == Mode::Ready);
    }
}

/// The request that a command becomes, if any.
fn asked(message: &COMMAND_LONG_DATA) -> Option<Request> {
    let shared = Local::new();
    Fed::new(&shared).message(message, 0);
    shared.requests.take().map(|asked| asked.request)
}

#[test]
fn an_actuator_test_is_a_motor_test_in_both_countings_and_no_number_ends_it() {
    let nan = f32::NAN;
    let test = |rotor, level| Some(Request::MotorTest(MotorTest { rotor, level, duration: 1_000_000 }));
    for (parameters, request) in [
        ([0.1, 1.0, 0.0, 0.0, 1.0], test(0, 0.1)),
        ([0.1, 1.0, 0.0, 0.0, 4.0], test(3, 0.1)),
        // QGroundControl adds 1000 to PX4's 101 to 104.
        ([0.1, 1.0, 0.0, 0.0, 1101.0], test(0, 0.1)),
        ([0.1, 1.0, 0.0, 0.0, 1104.0], test(3, 0.1)),
        // The flight rules refuse what is too much.
        ([1.0, 1.0, 0.0, 0.0, 1.0], test(0, 1.0)),
        ([nan, 0.0, 0.0, 0.0, 1102.0], Some(Request::EndMotorTest)),
        ([nan, 1.0, 0.0, 0.0, 2.0], Some(Request::EndMotorTest)),
        ([0.1, 0.0, 0.0, 0.0, 2.0], Some(Request::EndMotorTest)),
        ([0.1, nan, 0.0, 0.0, 2.0], None),
        ([0.1, 1.0, 0.0, 0.0, 5.0], None),
        ([0.1, 1.0, 0.0, 0.0, 0.0], None),
        ([0.1, 1.0, 0.0, 0.0, 33.0], None),
        ([0.1, 1.0, 0.0, 0.0, 1105.0], None),
        ([0.1, 1.0, 0.0, 0.0, 1201.0], None),
        ([0.1, 1.0, 0.0, 0.0, nan], None),
        ([nan, 0.0, 0.0, 0.0, nan], None),
    ] {
        assert_eq!(asked(&command(ACTUATOR_TEST, parameters)), request, "{parameters:?}");
    }
}

#[test]
fn what_is_calibrated_counts_for_the_first_sensor() {
    let shared = Local::new();
    shared.parameters.set(Name::Imu2OffsetX, 0.5).unwrap();
    shared.parameters.set(Name::Imu1GyroX, 0.01).unwrap();
    let (accelerometer, level) = firmware::parameters::calibration::found((&shared.parameters).into());
    assert_eq!(
        Calibrated { gyro: false, accelerometer, level },
        Calibrated { gyro: false, accelerometer: false, level: false }
    );
}
