//! A simulator's answers: which become IMU and pose, with which time, and which are refused.

use crate::support::PERIOD_US;
use crate::support::line::{Delivery, Incoming, Line};
use crate::support::receiver::{Local, newest};
use crate::support::simulator::{COMMANDED_US, Hil, command, commanded, odometry, sensor};
use crate::support::{Simulated, patched, v2};
use firmware::hil;
use firmware::parameters::table::Name;
use mavlink::dialects::common::{ESC_STATUS_DATA, HIL_SENSOR_DATA, HilSensorUpdatedFlags, MavFrame, ODOMETRY_DATA};
use nalgebra::Vector3;

/// When the answer to that command is true, us: the vehicle has moved on by a period.
const ANSWER_TIME_US: u64 = COMMANDED_US + PERIOD_US;

/// The shared values after the simulator has sent `bytes`, 5 ms after its command.
fn received(hil: &Hil, bytes: Vec<u8>) -> Local {
    received_by(Local::new(), hil, bytes)
}

/// The same of a vehicle that has these.
fn received_by(shared: Local, hil: &Hil, bytes: Vec<u8>) -> Local {
    let (clock, line) = (Simulated::default(), Line::default());
    clock.0.set(COMMANDED_US + 5_000);
    line.borrow_mut().push_back(Delivery::Bytes(bytes));
    clock.run(3_000, hil::receive(hil, Incoming(&line), &clock, shared.for_simulator(), PERIOD_US), |_| ());
    shared
}

#[test]
fn an_answer_is_what_the_sensors_say_a_period_after_its_command() {
    let hil = commanded();
    assert!(hil.active() && hil.awaiting());
    let shared = received(&hil, [v2(1, &odometry(ANSWER_TIME_US)), v2(2, &sensor(ANSWER_TIME_US))].concat());
    let (imu, pose) = (shared.imu.get().unwrap(), newest(&shared).unwrap());
    assert_eq!((imu.time, pose.time), (ANSWER_TIME_US, ANSWER_TIME_US));
    assert_eq!(imu.value.angular_velocity, Vector3::new(0.5, -0.25, -0.125));
    assert_eq!(imu.value.specific_force, Vector3::new(1.0, -2.0, 9.0));
    assert_eq!(pose.value.position(), Vector3::new(2.0, 1.0, 3.0));
    assert!(
        (pose.value.velocity().unwrap() - Vector3::new(0.0, 0.5, 0.0)).norm() < 1e-6,
        "{}",
        pose.value.velocity().unwrap()
    );
    assert!(!hil.awaiting());
}

#[test]
fn rotor_speeds_are_taken_where_the_controllers_would_answer() {
    let status = |index, time_usec| ESC_STATUS_DATA { time_usec, rpm: [6000, -60, 0, 7], index, ..Default::default() };
    let answers = || {
        let shared = Local::new();
        shared.parameters.set(Name::MotorProtocol, 1.0).unwrap();
        shared
    };
    let shared = received_by(answers(), &commanded(), v2(1, &status(0, ANSWER_TIME_US)));
    let speeds = shared.rotor_speeds.get().unwrap();
    assert_eq!(speeds.time, ANSWER_TIME_US);
    assert!((speeds.value[0].unwrap() - 628.3185).abs() < 1e-3 && speeds.value[2] == Some(0.0), "{speeds:?}");
    // Of other rotors, of a time to come, and where controllers do not answer.
    for (shared, status) in [
        (answers(), status(4, ANSWER_TIME_US)),
        (answers(), status(0, ANSWER_TIME_US + 1)),
        (Local::new(), status(0, ANSWER_TIME_US)),
    ] {
        assert!(received_by(shared, &commanded(), v2(1, &status)).rotor_speeds.get().is_none());
    }
}

#[test]
fn neither_a_pose_nor_a_sample_within_the_period_ends_the_exchange() {
    let hil = commanded();
    let shared = received(&hil, [v2(1, &odometry(ANSWER_TIME_US)), v2(2, &sensor(ANSWER_TIME_US - 1))].concat());
    assert!(newest(&shared).is_some() && shared.imu.get().is_some());
    assert!(hil.awaiting());
}

#[test]
fn no_answer_is_fresher_than_the_last_command_makes_it() {
    // A microsecond later than it can be; a second to come; a clock of its own.
    for time in [ANSWER_TIME_US + 1, ANSWER_TIME_US + 1_000_000, u64::MAX - PERIOD_US, u64::MAX - 1, u64::MAX] {
        let hil = commanded();
        let shared = received(&hil, [v2(1, &odometry(time)), v2(2, &sensor(time))].concat());
        assert!(shared.imu.get().is_none() && newest(&shared).is_none(), "{time}");
        assert!(hil.awaiting());
    }
}

#[test]
fn a_late_answer_keeps_its_own_time_and_is_not_the_one_awaited() {
    let hil = Hil::new();
    command(&hil, COMMANDED_US - PERIOD_US);
    command(&hil, COMMANDED_US);
    let shared =
        received(&hil, [v2(1, &odometry(COMMANDED_US - 2 * PERIOD_US)), v2(2, &sensor(COMMANDED_US))].concat());
    assert_eq!(shared.imu.get().unwrap().time, COMMANDED_US);
    assert_eq!(newest(&shared).unwrap().time, COMMANDED_US - 2 * PERIOD_US);
    assert!(hil.awaiting());
}

#[test]
fn no_field_of_an_answer_may_be_nan_or_infinite() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        // Accelerometer and gyro; what is behind them (magnetometer, barometer) is not used.
        for field in 0..13 {
            let hil = commanded();
            let shared = received(&hil, patched(&sensor(ANSWER_TIME_US), 8 + 4 * field, value));
            assert_eq!(shared.imu.get().is_none(), field < 6, "HIL_SENSOR field {field}: {value}");
            assert_eq!(hil.awaiting(), field < 6);
        }
        // Position, attitude, velocity, body rates.
        for field in 0..13 {
            let shared = received(&commanded(), patched(&odometry(ANSWER_TIME_US), 8 + 4 * field, value));
            assert!(newest(&shared).is_none(), "ODOMETRY field {field}: {value}");
        }
    }
}

#[test]
fn a_simulator_that_does_not_know_a_rate_or_a_force_has_not_answered() {
    use HilSensorUpdatedFlags as Field;
    for unknown in [
        Field::HIL_SENSOR_UPDATED_XACC,
        Field::HIL_SENSOR_UPDATED_YACC,
        Field::HIL_SENSOR_UPDATED_ZACC,
        Field::HIL_SENSOR_UPDATED_XGYRO,
        Field::HIL_SENSOR_UPDATED_YGYRO,
        Field::HIL_SENSOR_UPDATED_ZGYRO,
    ] {
        let fields_updated = Field::all().difference(unknown);
        let shared = received(&commanded(), v2(1, &HIL_SENSOR_DATA { fields_updated, ..sensor(ANSWER_TIME_US) }));
        assert!(shared.imu.get().is_none(), "{unknown:?}");
    }
}

#[test]
fn a_pose_in_other_frames_or_without_a_rotation_is_refused() {
    for wrong in [
        ODOMETRY_DATA { frame_id: MavFrame::MAV_FRAME_LOCAL_ENU, ..odometry(ANSWER_TIME_US) },
        ODOMETRY_DATA { child_frame_id: MavFrame::MAV_FRAME_LOCAL_FRD, ..odometry(ANSWER_TIME_US) },
        ODOMETRY_DATA { q: [0.0; 4], ..odometry(ANSWER_TIME_US) },
    ] {
        assert!(newest(&received(&commanded(), v2(1, &wrong))).is_none(), "{wrong:?}");
    }
}

#[test]
fn sensors_of_a_simulator_without_a_command_do_not_count() {
    let hil = Hil::new();
    let shared = received(&hil, [v2(1, &odometry(0)), v2(2, &sensor(0))].concat());
    assert!(shared.imu.get().is_none() && newest(&shared).is_none());
    assert!(!hil.active());
}
