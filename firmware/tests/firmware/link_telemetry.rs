//! Telemetry out: each message of a vehicle whose state is known.

use controller_core::heading::Heading;
use controller_core::reference::Reference;
use controller_core::state::State;
use estimation::estimator::{Estimator, EstimatorParameters, Health, Settings};
use estimation::imu::ImuFault;
use firmware::esc::answer::Answer;
use firmware::esc::controller::Controller;
use firmware::link::origin::Origin;
use firmware::link::telemetry::{controllers, motion, vehicle};
use firmware::shared::{Report, Traffic};
use flight::{Mode, Stamped};
use mavlink::dialects::common::{
    EstimatorStatusFlags, MavLandedState, MavSysStatusSensor as Sensor, PositionTargetTypemask as Mask,
};
use nalgebra::{UnitQuaternion, Vector3};

/// Healthy, as far as an estimator that never began can be.
fn healthy() -> Health {
    let estimator = Estimator::new(&Settings::new(&EstimatorParameters::BMI088).unwrap());
    let mut health = estimator.health(0);
    health.faults = Default::default();
    health.pose_age = Some(20_000);
    health.deviations = (0.03, 0.06, 0.015);
    health.nis = (9.0, 2.25);
    health
}

/// At (2, 1, 3) in the law's world, pointing north and nose up by 0.2 rad, flying east.
fn report() -> Report {
    let north = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), core::f32::consts::FRAC_PI_2);
    // Nose up is a turn about left by a negative angle.
    let attitude = (north * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -0.2)).into_inner();
    let state = State {
        position: Vector3::new(2.0, 1.0, 3.0),
        velocity: Vector3::new(0.5, 0.0, 0.25),
        attitude,
        angular_velocity: Vector3::new(0.1, 0.2, 0.3),
    };
    Report {
        mode: Mode::Holding,
        is_airborne: true,
        state: Some(state),
        health: healthy(),
        home: Some(Vector3::new(2.0, 1.0, 1.0)),
        ..Report::NONE
    }
}

#[test]
fn angles_are_those_of_the_vehicle() {
    let attitude = motion::attitude(1_234_567, &report()).unwrap();
    assert_eq!(attitude.time_boot_ms, 1_234);
    // As well as displays need it.
    assert!(
        (attitude.pitch - 0.2).abs() < 0.01 && attitude.roll.abs() < 0.01 && attitude.yaw.abs() < 0.01,
        "{attitude:?}"
    );
}

#[test]
fn a_global_position_is_sent_with_its_height_above_home() {
    let origin = Origin::new(473_977_420, 85_455_940, 488_000).unwrap();
    let place = motion::global_position(0, &report(), &origin).unwrap();
    // 1 m north, 2 m east, 3 m up.
    assert_eq!((place.lat - 473_977_420, place.alt, place.relative_alt), (89, 491_000, 2_000));
    assert!((place.lon - 85_455_940 - 265).abs() <= 1, "{}", place.lon);
    assert_eq!((place.vx, place.vy, place.vz), (0, 50, -25));
    assert!(place.hdg < 100 || place.hdg > 35_900, "{}", place.hdg);
    let home = motion::home(&report(), &origin).unwrap();
    assert_eq!((home.latitude - 473_977_420, home.altitude, home.z), (89, 489_000, -1.0));
}

#[test]
fn a_vehicle_that_goes_down_by_the_imu_names_no_place_as_its_target() {
    let heading = Heading::FORWARD;
    let rest = Vector3::zeros();
    let reference = Reference { position: rest, velocity: rest, acceleration: rest, jerk: rest, snap: rest, heading };
    for (mode, place) in [(Mode::Holding, true), (Mode::Landing, true), (Mode::Descending, false)] {
        let report = Report { mode, reference: Some(reference), ..report() };
        let mask = motion::position_target(0, &report).unwrap().type_mask;
        assert_eq!(mask.is_empty(), place, "{mode:?}");
        assert!(
            place || mask.contains(Mask::POSITION_TARGET_TYPEMASK_X_IGNORE | Mask::POSITION_TARGET_TYPEMASK_Z_IGNORE)
        );
        // Level, and so fast down.
        assert!(!mask.contains(Mask::POSITION_TARGET_TYPEMASK_VZ_IGNORE));
    }
}

#[test]
fn odometry_goes_out_as_it_would_come_in_with_its_covariance() {
    let odometry = motion::odometry(5, &report()).unwrap();
    assert_eq!((odometry.x, odometry.y, odometry.z, odometry.time_usec), (1.0, 2.0, -3.0, 5));
    // East is to the right of a vehicle that points north; up is ahead of a nose that is up.
    assert!((odometry.vy - 0.5).abs() < 1e-5 && odometry.vx > 0.04 && odometry.vz < -0.24, "{odometry:?}");
    assert!((odometry.pose_covariance[0] - 0.0003).abs() < 1e-9);
    assert!((odometry.pose_covariance[20] - 0.000_075).abs() < 1e-9);
    assert!((odometry.velocity_covariance[0] - 0.0012).abs() < 1e-9 && odometry.velocity_covariance[20].is_nan());
}

#[test]
fn the_estimators_health_is_reported() {
    use EstimatorStatusFlags as Flags;
    let status = motion::estimator_status(7, &report());
    assert!(status.flags.contains(Flags::ESTIMATOR_ATTITUDE | Flags::ESTIMATOR_POS_HORIZ_ABS));
    assert!((status.pos_horiz_ratio - 1.0).abs() < 1e-6 && status.pos_horiz_accuracy == 0.03);
    // Coasting, it no longer knows where it is.
    let mut coasting = report();
    coasting.health.pose_age = Some(400_000);
    let flags = motion::estimator_status(7, &coasting).flags;
    assert!(flags.contains(Flags::ESTIMATOR_ATTITUDE) && !flags.contains(Flags::ESTIMATOR_POS_HORIZ_ABS));
    assert!(motion::estimator_status(7, &Report::NONE).flags.is_empty());
}

#[test]
fn sensors_are_healthy_only_while_they_are() {
    let bits = |report: Option<&Report>| {
        vehicle::status(None, report, Traffic::default(), None).onboard_control_sensors_health
    };
    let poses = Sensor::MAV_SYS_STATUS_SENSOR_VISION_POSITION | Sensor::MAV_SYS_STATUS_SENSOR_GPS;
    let imu = Sensor::MAV_SYS_STATUS_SENSOR_3D_GYRO | Sensor::MAV_SYS_STATUS_SENSOR_3D_ACCEL;
    let well = report();
    assert!(bits(Some(&well)).contains(poses | imu | Sensor::MAV_SYS_STATUS_AHRS));
    let mut lost = report();
    lost.health.pose_age = None;
    assert!(!bits(Some(&lost)).intersects(poses) && bits(Some(&lost)).contains(imu));
    for (fault, failed, other) in [
        (ImuFault::AccelerometerSilent, Sensor::MAV_SYS_STATUS_SENSOR_3D_ACCEL, Sensor::MAV_SYS_STATUS_SENSOR_3D_GYRO),
        (ImuFault::AccelerometerStuck, Sensor::MAV_SYS_STATUS_SENSOR_3D_ACCEL, Sensor::MAV_SYS_STATUS_SENSOR_3D_GYRO),
        (ImuFault::GyroSaturated, Sensor::MAV_SYS_STATUS_SENSOR_3D_GYRO, Sensor::MAV_SYS_STATUS_SENSOR_3D_ACCEL),
    ] {
        let health = bits(Some(&Report { imu_fault: Some(fault), ..report() }));
        assert!(!health.contains(failed) && health.contains(other), "{fault}");
    }
    assert!(!bits(Some(&Report::NONE)).intersects(poses | imu | Sensor::MAV_SYS_STATUS_PREARM_CHECK));
    assert!(bits(None).is_empty());
    let motors = Sensor::MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS;
    let unreached = Report { motors_fail: true, ..report() };
    assert!(bits(Some(&well)).contains(motors) && !bits(Some(&unreached)).contains(motors));
    assert!(bits(Some(&unreached)).contains(Sensor::MAV_SYS_STATUS_SENSOR_ATTITUDE_STABILIZATION));
    // It may be armed where it reports so.
    for (mode, ready, armable) in [(Mode::Ready, true, true), (Mode::Checks, false, false), (Mode::Flying, false, true)]
    {
        let report = Report { mode, ready, ..report() };
        assert_eq!(bits(Some(&report)).contains(Sensor::MAV_SYS_STATUS_PREARM_CHECK), armable, "{mode:?}");
    }
}

#[test]
fn a_position_is_not_controlled_without_a_pose() {
    let place = Sensor::MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL
        | Sensor::MAV_SYS_STATUS_SENSOR_Z_ALTITUDE_CONTROL
        | Sensor::MAV_SYS_STATUS_SENSOR_YAW_POSITION;
    let attitude = Sensor::MAV_SYS_STATUS_SENSOR_ATTITUDE_STABILIZATION;
    for (mode, controlled) in [(Mode::Holding, true), (Mode::Landing, true), (Mode::Descending, false)] {
        let report = Report { mode, ..report() };
        let health = vehicle::status(None, Some(&report), Traffic::default(), None).onboard_control_sensors_health;
        assert!(health.contains(attitude), "{mode:?}");
        assert_eq!(health & place, if controlled { place } else { Sensor::empty() }, "{mode:?}");
    }
}

#[test]
fn ground_and_air_are_distinguished() {
    for (mode, is_airborne, landed) in [
        // Unknown yet, or stale.
        (Mode::Boot, false, MavLandedState::MAV_LANDED_STATE_UNDEFINED),
        (Mode::Stopped, false, MavLandedState::MAV_LANDED_STATE_UNDEFINED),
        (Mode::Ready, false, MavLandedState::MAV_LANDED_STATE_ON_GROUND),
        (Mode::TakingOff, false, MavLandedState::MAV_LANDED_STATE_ON_GROUND),
        (Mode::TakingOff, true, MavLandedState::MAV_LANDED_STATE_TAKEOFF),
        (Mode::Holding, true, MavLandedState::MAV_LANDED_STATE_IN_AIR),
        (Mode::Landing, true, MavLandedState::MAV_LANDED_STATE_LANDING),
        (Mode::Descending, true, MavLandedState::MAV_LANDED_STATE_LANDING),
    ] {
        let report = Report { mode, is_airborne, ..report() };
        assert_eq!(vehicle::extended_state(&report).landed_state, landed, "{mode:?}");
    }
    // It was disarmed by force in the air.
    for mode in [Mode::Checks, Mode::Ready] {
        let report = Report { mode, is_airborne: false, may_fall: true, ..report() };
        assert_eq!(vehicle::extended_state(&report).landed_state, MavLandedState::MAV_LANDED_STATE_UNDEFINED);
    }
}

#[test]
fn modes_have_names_and_the_heartbeat_says_the_same_number() {
    let named: Vec<_> = (1..=vehicle::MODE_COUNT).map(|index| vehicle::available_mode(index).unwrap()).collect();
    assert!(vehicle::available_mode(0).is_none() && vehicle::available_mode(vehicle::MODE_COUNT + 1).is_none());
    let flown = [Mode::Flying, Mode::Holding, Mode::TakingOff, Mode::Landing].map(|mode| (mode, false));
    for (mode, mission) in flown.into_iter().chain([(Mode::Flying, true)]) {
        let shown = vehicle::ModeReport { mode, mission, policy: false };
        let number = vehicle::heartbeat(Some(shown), false).custom_mode;
        assert!(named.iter().any(|named| named.custom_mode == number), "{mode:?}");
        assert_eq!(vehicle::current_mode(&shown).custom_mode, number);
    }
    // PX4's AUTO, EXTERNAL1: named only where a policy is built in.
    let shown = vehicle::ModeReport { mode: Mode::Flying, mission: false, policy: true };
    let number = vehicle::heartbeat(Some(shown), false).custom_mode;
    assert_eq!(number, 4 << 16 | 11 << 24);
    assert_eq!(named.iter().any(|named| named.custom_mode == number), option_env!("POLICY").is_some());
}

#[test]
fn controllers_that_answer_are_told_with_what_they_say() {
    let speeds = Stamped { value: [Some(100.0 * core::f32::consts::TAU), Some(0.0), None, Some(10.0)], time: 7 };
    let mut said = [Controller::default(); 4];
    said[0] = Controller { temperature: Some(40), voltage: Some(15.5), current: Some(3), ..Controller::default() };
    said[0] = Controller { answered: 65_537, missed: 9, ..said[0] };
    said[1].status = Some(Answer::STALLED);
    let status = controllers::status(speeds, Some(&said));
    assert_eq!((status.time_usec, status.rpm, status.index), (7, [6000, 0, 0, 95], 0));
    assert!(status.voltage[0] == 15.5 && status.current[0] == 3.0 && status.voltage[1].is_nan());
    let info = controllers::info(speeds, &said);
    assert_eq!((info.info, info.count, info.counter, info.error_count[0]), (0b1011, 4, 1, 9));
    assert_eq!(info.temperature, [4000, i16::MAX, i16::MAX, i16::MAX]);
    assert_eq!(info.failure_flags, [0, 32, 0, 0]);
}
