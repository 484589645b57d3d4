//! From samples to control: every increment, the newest sample, faults in words, and the second sensor.

use crate::support::PERIOD_US;
use crate::support::bodies::{Body, Does, RIGHT, Sensor};
use crate::support::line::Live;
use crate::support::receiver::{Local, texts};
use crate::support::simulator::{Hil, command, sensor};
use crate::support::{Simulated, v2};
use estimation::estimator::Increment;
use firmware::hardware::Imu;
use firmware::redundant::Redundant;
use firmware::shared::INCREMENTS_CAPACITY;
use firmware::{hil, imu};
use mavlink::dialects::common::HIL_SENSOR_DATA;
use nalgebra::Vector3;

fn first(body: &Body) -> Sensor<'_> {
    Sensor { body, wrong: RIGHT, is_second: false }
}

fn both(body: &Body) -> impl Imu + '_ {
    Redundant::new(first(body), Sensor { body, wrong: RIGHT, is_second: true })
}

/// Takes every increment, as control does.
fn drain(shared: &Local) -> Vec<Increment> {
    std::iter::from_fn(|| shared.increments.take()).collect()
}

/// What control got of two seconds, draining 100 times a second, while `each` acts; and the texts.
fn flown(body: &Body, mut sensor: impl Imu, each: impl Fn(u64)) -> (Vec<Increment>, Vec<String>) {
    let shared = Local::new();
    let mut increments = Vec::new();
    body.clock.run(2_000_000, imu::run(shared.for_imu(), &body.clock, &mut sensor, PERIOD_US), |now| {
        each(now);
        if now % 10_000 == 0 {
            increments.extend(drain(&shared));
        }
        if let Some(sample) = shared.imu.get() {
            assert!(sample.time <= now);
        }
    });
    assert_eq!(shared.lost_increments.get(), 0);
    (increments, texts(&shared))
}

fn gaps(increments: &[Increment]) -> usize {
    increments.windows(2).filter(|pair| pair[0].end != pair[1].start).count()
}

#[test]
fn control_gets_every_increment_of_5_ms() {
    let body = Body::new();
    body.rate.set(Vector3::new(0.5, 0.0, -1.0));
    let (increments, texts) = flown(&body, first(&body), |_| ());
    assert_eq!((gaps(&increments), texts.len()), (0, 0));
    assert!((395..=400).contains(&increments.len()), "{}", increments.len());
    assert!(increments.iter().all(|one| one.end - one.start == 5_000));
    let turned: Vector3<f32> = increments.iter().map(|one| one.delta_angle).sum();
    let seconds: f32 = increments.iter().map(Increment::seconds).sum();
    assert!((turned - body.rate.get() * seconds).norm() < 1e-3, "{turned} in {seconds} s");
}

#[test]
fn the_newest_sample_is_the_sensors_last_and_low_passed() {
    let (body, shared) = (Body::new(), Local::new());
    let mut sensor = first(&body);
    body.clock.run(1_000_000, imu::run(shared.for_imu(), &body.clock, &mut sensor, PERIOD_US), |now| {
        // As often as control ticks, which would see it stand still.
        let phase = core::f32::consts::TAU * (now % 10_000) as f32 * 1e-4;
        body.rate.set(Vector3::x() * phase.sin());
        if now > 100_000 {
            let sample = shared.imu.get().unwrap();
            assert!(now - sample.time <= 1_000, "{}", now - sample.time);
            assert!(sample.value.angular_velocity.x.abs() < 0.02, "{}", sample.value.angular_velocity);
        }
    });
}

#[test]
fn increments_that_overflow_are_counted_and_leave_a_gap() {
    let (body, shared) = (Body::new(), Local::new());
    let mut sensor = first(&body);
    let mut increments = Vec::new();
    body.clock.run(200_000, imu::run(shared.for_imu(), &body.clock, &mut sensor, PERIOD_US), |now| {
        if !(50_000..150_000).contains(&now) {
            increments.extend(drain(&shared));
        }
    });
    let lost = shared.lost_increments.get();
    assert!((20 - INCREMENTS_CAPACITY - 1..=20 - INCREMENTS_CAPACITY + 1).contains(&(lost as usize)), "{lost}");
    assert_eq!(gaps(&increments), 1);
    let missing = increments.windows(2).map(|pair| pair[1].start - pair[0].end).max();
    assert_eq!(missing, Some(u64::from(lost) * 5_000));
}

#[test]
fn a_fault_is_reported_once_when_it_sets_in_and_again_when_it_comes_back() {
    for (does, words) in [(Does::Stuck, "IMU: gyro stuck"), (Does::Forceless, "IMU: accelerometer does not answer")] {
        let body = Body::new();
        let (increments, texts) = flown(&body, first(&body), |now| {
            let fails = (100_000..400_000).contains(&now) || (1_600_000..1_700_000).contains(&now);
            body.first.set(if fails { does } else { Does::Well });
        });
        assert_eq!(texts, [words, words]);
        // Without a force the gyro goes on; a stuck gyro counts as missing.
        assert_eq!(gaps(&increments), if matches!(does, Does::Stuck) { 2 } else { 0 }, "{words}");
        let stuck = increments.iter().filter(|one| (150_000..390_000).contains(&one.start)).count();
        assert_eq!(stuck == 0, matches!(does, Does::Stuck), "{words}: {stuck}");
    }
}

#[test]
fn the_second_sensor_takes_over_without_a_gap_and_this_is_reported() {
    for (does, more) in [
        (Does::Faults, vec!["IMU does not answer", "IMU: the second takes over", "IMU answers again"]),
        (Does::Stuck, vec!["IMU: the second takes over"]),
        (Does::Forceless, vec!["IMU: accelerometer does not answer", "IMU: the second takes over"]),
    ] {
        let body = Body::new();
        // Calibrated by then: while that goes on, samples of the second come in between.
        let (increments, texts) = flown(&body, both(&body), |now| {
            body.first.set(if (1_900_000..1_950_000).contains(&now) { does } else { Does::Well });
        });
        assert_eq!(texts, more);
        let late: Vec<_> = increments.into_iter().filter(|one| one.end > 1_850_000).collect();
        assert_eq!(gaps(&late), 0);
        assert!(late.last().unwrap().end >= 1_980_000, "{late:?}");
    }
}

#[test]
fn a_second_sensor_that_does_not_answer_on_the_ground_is_reported_once_and_never_flown() {
    let body = Body::new();
    body.second.set(Does::Faults);
    let (_, texts) = flown(&body, both(&body), |now| {
        if now == 1_500_000 {
            body.second.set(Does::Well);
            body.first.set(Does::Faults);
        }
    });
    assert_eq!(texts, ["Second IMU does not answer", "IMU does not answer"]);
}

#[test]
fn a_simulators_samples_go_the_same_way_at_its_own_rate_and_may_be_free_of_noise() {
    let (clock, shared, line, hil) = (Simulated::default(), Local::new(), Live::default(), Hil::new());
    // The same for half a second, then something else at each answer, which is true a period later.
    let rate = |time: u64| if time < 500_000 { 0.5 } else { (time / PERIOD_US % 3) as f32 };
    let mut increments = Vec::new();
    let mut late = 0;
    clock.run(1_000_000, hil::receive(&hil, line.clone(), &clock, shared.for_simulator(), PERIOD_US), |now| {
        if now % PERIOD_US == 0 && now > 0 {
            command(&hil, now);
            let time = now + PERIOD_US;
            line.say(&v2(1, &HIL_SENSOR_DATA { xgyro: rate(time), ..sensor(time) }));
        }
        increments.extend(drain(&shared));
        late +=
            usize::from(shared.imu.get().is_some_and(|newest| newest.value.angular_velocity.x != rate(newest.time)));
    });
    // One for each answer but the first: they last a period, and the law's rate is not late.
    assert_eq!((increments.len(), gaps(&increments)), (98, 0));
    assert!(increments.iter().all(|one| one.end - one.start == PERIOD_US) && late == 0);
    assert_eq!(shared.imu.get().unwrap().value.angular_velocity.x, rate(990_000 + PERIOD_US));
    assert_eq!(texts(&shared), [""; 0]);
}
