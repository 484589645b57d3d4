//! Samples and poses of any numbers, at any times, to the conditioner and the estimator. Whatever comes, the state is
//! made of numbers, its attitude of unit length, and what was fused is where the state is.

#![no_main]

use arbitrary::Arbitrary;
use estimation::estimator::{Accepted, Estimator, EstimatorParameters, PoseMeasurement, Settings};
use flight::{Pose, Stamped, Velocity};
use estimation::imu::{Calibration, Conditioner, ImuParameters};
use libfuzzer_sys::fuzz_target;
use nalgebra::{Quaternion, Vector3};

/// How far from a pose the state may be right after taking it, m.
const POSE_DISTANCE_MAX_M: f32 = 1.0;

#[derive(Debug, Arbitrary)]
enum Event {
    /// As many samples, so far apart (us), of small numbers, as sensors give them.
    Samples { count: u8, every: u16, rate: [i16; 3], force: [i16; 3] },
    /// One sample of any numbers.
    Sample { after: u32, rate: [f32; 3], force: Option<[f32; 3]> },
    /// A pose near the origin, so old (us).
    Near { age: u32, position: [i8; 3], attitude: [i8; 4], quality: i8, resets: u8 },
    /// A pose of any numbers, at any time.
    Pose { time: u64, position: [f32; 3], velocity: [f32; 3], attitude: [f32; 4], deviations: (f32, f32) },
    /// The poses are followed to wherever they are.
    Adopt,
    /// Time passes, us.
    Wait(u32),
}

fn scaled(numbers: [i16; 3], range: f32) -> Vector3<f32> {
    Vector3::from(numbers.map(|number| f32::from(number) * (range / 32_768.0)))
}

fuzz_target!(|events: Vec<Event>| {
    let settings = Settings::new(&EstimatorParameters::BMI088).unwrap();
    let mut conditioner = Conditioner::new(&ImuParameters::BMI088, &Calibration::NONE, 10_000).unwrap();
    let mut estimator = Box::new(Estimator::new(&settings));
    let mut now = 1_000_000_u64;
    for event in events {
        match event {
            Event::Samples { count, every, rate, force } => {
                for _ in 0..count {
                    now += u64::from(every % 4_096);
                    let (rate, force) = (scaled(rate, 35.0), scaled(force, 235.0));
                    if let Some(increment) = conditioner.sample(now, &rate, Some(&force)).increment {
                        estimator.imu(&increment);
                    }
                }
            }
            Event::Sample { after, rate, force } => {
                now += u64::from(after);
                let force = force.map(Vector3::from);
                if let Some(increment) = conditioner.sample(now, &Vector3::from(rate), force.as_ref()).increment {
                    estimator.imu(&increment);
                }
            }
            Event::Near { age, position, attitude, quality, resets } => {
                let position = Vector3::from(position.map(|number| f32::from(number) * 0.01));
                let [w, i, j, k] = attitude.map(f32::from);
                let length = (w * w + i * i + j * j + k * k).sqrt();
                if let Ok(pose) =
                    Pose::new(position, Velocity::World(Vector3::zeros()), Quaternion::new(w, i, j, k) / length)
                {
                    let value = PoseMeasurement::new(&pose).quality(quality).reset_counter(resets);
                    let time = now.saturating_sub(u64::from(age % 400_000));
                    let taken = estimator.pose(&Stamped { value, time }, now);
                    near(&estimator, taken.ok(), time, &position);
                    assert!(quality >= 0 || taken.is_err(), "a failed pose was taken");
                    assert!(estimator.pose(&Stamped { value, time }, now).is_err(), "a pose was taken twice");
                }
            }
            Event::Pose {
                time,
                position,
                velocity,
                attitude: [w, i, j, k],
                deviations: (of_position, of_attitude),
            } => {
                let (position, velocity) = (Vector3::from(position), Velocity::World(Vector3::from(velocity)));
                if let Ok(pose) = Pose::new(position, velocity, Quaternion::new(w, i, j, k)) {
                    let value = PoseMeasurement::with_velocity(&pose).deviations(of_position, of_attitude);
                    let taken = estimator.pose(&Stamped { value, time }, now);
                    near(&estimator, taken.ok(), time, &position);
                }
            }
            Event::Adopt => {
                estimator.adopt();
            }
            Event::Wait(time) => now += u64::from(time),
        }
        let health = estimator.health(now);
        if let Some(estimated) = conditioner.newest().and_then(|newest| {
            estimator.state(now, &newest.value.angular_velocity, conditioner.under_way().as_ref())
        }) {
            let state = &estimated.state;
            let numbers = [state.position, state.velocity, state.angular_velocity, estimated.acceleration];
            assert!(numbers.iter().all(|vector| vector.iter().all(|x| x.is_finite())), "{state:?} {health:?}");
            assert!((state.attitude.norm() - 1.0).abs() < 1e-3, "{state:?}");
        }
    }
});

/// What was fused is where the state at its time is.
fn near(estimator: &Estimator, taken: Option<Accepted>, time: u64, position: &Vector3<f32>) {
    // Among later poses it is not the last that was fused.
    if let (Some(Accepted::Fused), Some(filter)) = (taken, estimator.filter().filter(|filter| filter.time == time)) {
        let away = (filter.nominal.position - position).norm();
        assert!(away < POSE_DISTANCE_MAX_M, "fused {away} m away");
    }
}
