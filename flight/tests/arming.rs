//! What arming needs: every reason for refusing it, brought about from outside, and a vehicle that can be armed
//! afterwards.

use crate::support::{
    Flight, Handed, PERIOD_US, SETTLING_TICKS, at_rest, at_rest_with, displaced, go_to, pilot, settled,
};
use controller_core::prelude::*;
use estimation::estimator::{Fault, Increment};
use estimation::imu::ImuFault;
use flight::{Battery, Mode, MotorTest, Output, Refusal, Request, Stamped, Stored};

const NOW_US: u64 = 5_000_000;

/// A request to arm.
fn arm(handed: Handed) -> Handed {
    Handed { request: Some(Request::Arm), ..handed }
}

/// Arming refused in a tick that is handed this after rest, for this; and permitted after rest again.
fn refuses(handed: Handed, refusal: Refusal) {
    let mut pilot = settled(NOW_US - PERIOD_US);
    let outcome = arm(handed).to(&mut pilot);
    assert_eq!(outcome.answer, Some(Err(refusal)));
    assert!(outcome.output == Output::Stop && !outcome.mode.is_armed(), "{outcome:?}");
    for tick in 1..=SETTLING_TICKS {
        at_rest(NOW_US + tick * PERIOD_US).to(&mut pilot);
    }
    let later = arm(at_rest(NOW_US + (SETTLING_TICKS + 1) * PERIOD_US)).to(&mut pilot);
    assert_eq!((later.answer, later.mode), (Some(Ok(())), Mode::Idling), "after {refusal:?}");
}

/// The same after two seconds and a half in which `lie` has changed what the sensors of a vehicle at rest say.
fn refuses_sensors(lie: impl FnOnce(&mut Flight), refusal: Refusal) {
    let mut flight = Flight::new();
    lie(&mut flight);
    for _ in 0..250 {
        flight.inputs.request = Some(Request::Arm);
        let outcome = flight.tick();
        assert!(matches!(outcome.answer, Some(Err(_))), "{refusal:?}: {:?} {:?}", outcome.answer, outcome.health);
    }
    flight.inputs.request = Some(Request::Arm);
    let outcome = flight.tick();
    assert_eq!(outcome.answer, Some(Err(refusal)), "{:?}", outcome.health);
}

/// Another body rate at the next tick, rad/s.
fn with_body_rate(rate: &Vector3<f32>) -> Handed {
    Handed { body_rate: Some(Stamped { value: *rate, time: NOW_US }), ..at_rest(NOW_US) }
}

/// Every increment of the next tick changed.
fn with_imu(change: impl FnMut(&mut Increment)) -> Handed {
    let mut handed = at_rest(NOW_US);
    handed.increments.iter_mut().for_each(change);
    handed
}

/// A roll of `degrees`.
fn rolled(degrees: f32) -> Quaternion<f32> {
    let half = degrees.to_radians() / 2.0;
    Quaternion::new(half.cos(), half.sin(), 0.0, 0.0)
}

#[test]
fn arming_is_refused_without_fresh_measurements() {
    let silent = |elapsed: u64| Handed {
        increments: vec![],
        body_rate: None,
        poses: vec![],
        ..at_rest(NOW_US - PERIOD_US + elapsed)
    };
    refuses(silent(22_001), Refusal::ImuStale);
    refuses_sensors(|flight| flight.present.imu = false, Refusal::ImuStale);
    refuses_sensors(|flight| flight.present.pose = false, Refusal::Estimator(Fault::NotStarted));
    // Poses that break off: 300 ms later.
    let mut flight = Flight::settled();
    flight.present.pose = false;
    flight.ticks(30);
    flight.inputs.request = Some(Request::Arm);
    assert_eq!(flight.tick().answer, Some(Err(Refusal::Estimator(Fault::NoPose))));
}

#[test]
fn arming_is_refused_with_measurements_that_make_no_sense() {
    for number in [f32::NAN, f32::INFINITY, 1e9] {
        let not_started = Refusal::Estimator(Fault::NotStarted);
        refuses(with_imu(|imu| imu.delta_angle.y = number), Refusal::ImuStale);
        refuses(with_imu(|imu| imu.delta_velocity.z = number), Refusal::ImuStale);
        refuses_sensors(|flight| flight.imu = Box::new(move |imu| imu.delta_velocity.x = number), Refusal::ImuStale);
        // Only one of two.
        let mut once = at_rest(NOW_US);
        once.increments[0].delta_angle.x = number;
        refuses(once, not_started);
        refuses(with_body_rate(&Vector3::new(number, 0.0, 0.0)), Refusal::ImuStale);
    }
    let mut early = at_rest(NOW_US);
    early.poses[0].time += 100_000;
    refuses(early, Refusal::PosesUnsettled);
}

#[test]
fn arming_takes_a_whole_second_of_poses_that_are_all_believed() {
    let mut pilot = pilot();
    let mut first = None;
    for tick in 1..400 {
        let outcome = arm(at_rest(tick * PERIOD_US)).to(&mut pilot);
        if outcome.answer == Some(Ok(())) {
            first = first.or(Some(tick));
        } else {
            assert!(first.is_none(), "{outcome:?}");
        }
    }
    // Half a second for the estimate to begin, and a second.
    assert_eq!(first, Some(151));
    for (elapsed, answer) in [(99, Err(Refusal::PosesUnsettled)), (100, Ok(()))] {
        let mut flight = Flight::settled();
        flight.source = Box::new(|body, time| displaced(body, time, &Vector3::new(0.0, 0.1, 0.0), &Vector3::zeros()));
        flight.tick();
        flight.source = Flight::new().source;
        flight.ticks(elapsed);
        flight.inputs.request = Some(Request::Arm);
        assert_eq!(flight.tick().answer, Some(answer), "{elapsed}");
    }
}

#[test]
fn arming_takes_a_whole_second_after_poses_that_did_not_come() {
    for (elapsed, answer) in [(99, Err(Refusal::PosesUnsettled)), (101, Ok(()))] {
        let mut flight = Flight::settled();
        flight.present.pose = false;
        assert!(!flight.ticks(50).health.is_good());
        flight.present.pose = true;
        flight.ticks(elapsed);
        flight.inputs.request = Some(Request::Arm);
        assert_eq!(flight.tick().answer, Some(answer), "{elapsed}");
    }
}

#[test]
fn arming_is_refused_while_the_vehicle_moves() {
    for (speed, answer) in [(0.19, Ok(())), (0.21, Err(Refusal::Moving))] {
        let mut flight = Flight::new();
        flight.body.velocity.x = speed;
        flight.weightless = true;
        flight.ticks(200);
        flight.inputs.request = Some(Request::Arm);
        assert_eq!(flight.tick().answer, Some(answer), "{speed} m/s");
    }
    refuses(with_body_rate(&Vector3::new(0.0, 0.0, 0.21)), Refusal::Moving);
}

#[test]
fn arming_is_refused_at_a_tilt_of_thirty_degrees_and_not_just_below() {
    for (degrees, answer) in
        [(30.1, Err(Refusal::Tilted)), (90.0, Err(Refusal::Tilted)), (180.0, Err(Refusal::Tilted)), (29.9, Ok(()))]
    {
        let mut pilot = pilot();
        for tick in 1..SETTLING_TICKS {
            at_rest_with(&rolled(degrees), tick * PERIOD_US).to(&mut pilot);
        }
        let outcome = arm(at_rest_with(&rolled(degrees), SETTLING_TICKS * PERIOD_US)).to(&mut pilot);
        assert_eq!(outcome.answer, Some(answer), "{degrees} degrees");
    }
}

#[test]
fn arming_is_refused_where_the_accelerometer_says_that_up_is_elsewhere() {
    let flipped = |imu: &mut Increment| imu.delta_velocity = -imu.delta_velocity;
    let weightless = |imu: &mut Increment| imu.delta_velocity = Vector3::zeros();
    let not_started = Refusal::Estimator(Fault::NotStarted);
    refuses_sensors(|flight| flight.imu = Box::new(flipped), not_started);
    refuses_sensors(|flight| flight.imu = Box::new(weightless), not_started);
    // It may also begin after the estimate has.
    refuses(with_imu(flipped), Refusal::Gravity);
    refuses(with_imu(weightless), Refusal::Gravity);
    let leaning = |degrees: f32| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        with_imu(|imu| imu.delta_velocity = Vector3::new(sin, 0.0, cos) * imu.delta_velocity.z)
    };
    refuses(leaning(10.5), Refusal::Gravity);
    let outcome = arm(leaning(9.5)).to(&mut settled(NOW_US - PERIOD_US));
    assert_eq!(outcome.answer, Some(Ok(())));
}

#[test]
fn arming_is_refused_where_the_gyro_turns_or_is_biased_by_two_degrees_a_second() {
    let turning = |rate: f32| Vector3::new(rate, 0.0, 0.0);
    refuses_sensors(|flight| flight.gyro_bias = turning(10.0), Refusal::Estimator(Fault::NotStarted));
    refuses(with_body_rate(&turning(10.0)), Refusal::Moving);
    refuses_sensors(|flight| flight.gyro_bias = turning(2_f32.to_radians()), Refusal::Estimator(Fault::GyroBias));
}

#[test]
fn arming_is_refused_with_poses_that_lie_or_do_not_advance() {
    let not_started = Refusal::Estimator(Fault::NotStarted);
    let resent = Flight::new().tick().health;
    assert!(resent.faults.contain(Fault::NotStarted));
    refuses_sensors(
        |flight| flight.source = Box::new(|body, _| displaced(body, 1_000_000, &Vector3::zeros(), &Vector3::zeros())),
        not_started,
    );
    let upside_down = Vector3::new(std::f64::consts::PI, 0.0, 0.0);
    refuses_sensors(
        |flight| flight.source = Box::new(move |body, time| displaced(body, time, &Vector3::zeros(), &upside_down)),
        not_started,
    );
    let untracked = |body: &crate::support::Body, time| {
        let pose = displaced(body, time, &Vector3::zeros(), &Vector3::zeros());
        flight::Stamped { value: pose.value.quality(-1), ..pose }
    };
    refuses_sensors(|flight| flight.source = Box::new(untracked), not_started);
}

#[test]
fn arming_is_refused_without_a_ground_station_or_against_a_disarm_command() {
    refuses(Handed { ground_station: None, ..at_rest(NOW_US) }, Refusal::GroundStationSilent);
    refuses(Handed { ground_station: Some(NOW_US - 2_500_000), ..at_rest(NOW_US) }, Refusal::GroundStationSilent);
    refuses(Handed { ground_station: Some(NOW_US + 1_000_000), ..at_rest(NOW_US) }, Refusal::GroundStationSilent);
    refuses(Handed { disarm: true, ..at_rest(NOW_US) }, Refusal::DisarmCommanded);
}

#[test]
fn nothing_turns_while_flash_is_written() {
    refuses(Handed { is_busy: true, ..at_rest(NOW_US) }, Refusal::Busy);
    let mut flight = Flight::settled();
    flight.inputs.is_busy = true;
    let test = Request::MotorTest(MotorTest { rotor: 0, level: 0.1, duration: 1_000_000 });
    assert_eq!(flight.answer(test), Err(Refusal::Busy));
}

#[test]
fn what_was_stored_and_is_lost_does_not_arm() {
    for stored in [Stored::SigningKey, Stored::Parameter("FENCE_RADIUS")] {
        refuses(Handed { lost: Some(stored), ..at_rest(NOW_US) }, Refusal::Lost(stored));
    }
}

#[test]
fn a_clock_whose_crystal_does_not_run_does_not_arm() {
    refuses(Handed { is_clock_doubtful: true, ..at_rest(NOW_US) }, Refusal::ClockDoubtful);
}

#[test]
fn an_imu_that_has_failed_does_not_arm_and_begins_no_flight() {
    for fault in ImuFault::ALL {
        refuses(Handed { imu_fault: Some(fault), ..at_rest(NOW_US) }, Refusal::Imu(fault));
        let mut flight = Flight::idling();
        flight.inputs.imu_fault = Some(fault);
        assert_eq!(flight.answer(Request::TakeOff(None)), Err(Refusal::Imu(fault)));
        for imu_fault in [Some(fault), None] {
            flight.inputs.imu_fault = imu_fault;
            flight.inputs.setpoint = Some(go_to(0.0, 0.0, 1.0));
            flight.answer(Request::FlySetpoints).unwrap();
            assert_eq!(flight.pilot.mode() == Mode::Flying, imu_fault.is_none());
        }
        // In flight the estimate is what counts.
        flight.inputs.imu_fault = Some(fault);
        assert_eq!(flight.tick().mode, Mode::Flying);
    }
}

#[test]
fn motors_that_are_not_reached_do_not_arm() {
    refuses(Handed { motors_fail: true, ..at_rest(NOW_US) }, Refusal::MotorsFail);
}

#[test]
fn a_battery_that_is_low_does_not_arm() {
    for battery in [Battery::Low, Battery::Critical] {
        refuses(Handed { battery, ..at_rest(NOW_US) }, Refusal::BatteryLow);
    }
}

#[test]
fn a_battery_that_is_to_be_watched_and_is_not_measured_does_not_arm_and_is_flown_on() {
    refuses(Handed { battery: Battery::Missing, ..at_rest(NOW_US) }, Refusal::BatteryMissing);
    let mut flight = Flight::armed();
    for _ in 0..500 {
        flight.inputs.battery = Battery::Missing;
        assert_eq!(flight.tick().mode, Mode::Flying);
    }
}
