//! The IMU task on a sensor that faults, hangs or returns NaN or infinity.

use crate::support::PERIOD_US;
use crate::support::Simulated;
use crate::support::receiver::{Local, texts};
use core::future::pending;
use estimation::imu::ImuParameters;
use firmware::hardware::{Clock, Fault, Imu, RawImu};
use firmware::imu::{SAMPLE_TIMEOUT_US, run};
use nalgebra::Vector3;

/// A sensor's answer a millisecond after it is read.
#[derive(Clone, Copy)]
enum Answer {
    Sample,
    Number(usize, f32),
    Fault,
    Nothing,
}

/// A sensor that samples, has `trouble` between two times, us, and samples afterwards.
struct Sensor<'a> {
    clock: &'a Simulated,
    trouble: Answer,
    from: u64,
    to: u64,
}

impl Imu for Sensor<'_> {
    async fn sample(&mut self) -> Result<RawImu, Fault> {
        self.clock.until(self.clock.now() + 1_000).await;
        let now = self.clock.now();
        // A sensor that works is noisy.
        let jitter = (now / 1_000 % 7) as f32 * 1e-4;
        let (mut angular_velocity, mut specific_force) = (Vector3::repeat(jitter), Vector3::new(0.0, jitter, 9.8));
        match if (self.from..self.to).contains(&now) { self.trouble } else { Answer::Sample } {
            Answer::Sample => {}
            Answer::Number(index @ 0..3, value) => angular_velocity[index] = value,
            Answer::Number(index, value) => specific_force[index - 3] = value,
            Answer::Fault => return Err(Fault),
            Answer::Nothing => pending().await,
        }
        Ok(RawImu { time: now, angular_velocity, specific_force: Some(specific_force) })
    }

    fn parameters(&self) -> ImuParameters {
        ImuParameters::PROMPT
    }

    fn is_polled(&self) -> bool {
        false
    }
}

/// The newest sample's times, once a millisecond, and the texts, with a sensor in trouble from 50 to 350 ms.
fn sampled(trouble: Answer) -> (Vec<u64>, Vec<String>) {
    let (clock, shared) = (Simulated::default(), Local::new());
    let mut sensor = Sensor { clock: &clock, trouble, from: 50_000, to: 350_000 };
    let mut times = Vec::new();
    clock.run(1_000_000, run(shared.for_imu(), &clock, &mut sensor, PERIOD_US), |_| {
        if let Some(sample) = shared.imu.get() {
            let numbers = sample.value.angular_velocity.iter().chain(&sample.value.specific_force);
            assert!(numbers.into_iter().all(|number| number.is_finite()));
            times.push(sample.time);
        }
    });
    (times, texts(&shared))
}

#[test]
fn every_fault_leaves_the_last_sample_to_age_and_is_reported_once() {
    let numbers =
        (0..6).flat_map(|index| [f32::NAN, f32::INFINITY, f32::NEG_INFINITY].map(|n| Answer::Number(index, n)));
    for trouble in numbers.chain([Answer::Fault, Answer::Nothing]) {
        let (times, texts) = sampled(trouble);
        assert!(times.iter().all(|time| !(50_000..350_000).contains(time)));
        assert!(times.contains(&49_000));
        assert_eq!(texts, ["IMU does not answer", "IMU: gap in the samples", "IMU answers again"]);
        // A sensor that hangs is asked again after so long, and found well.
        let back = times.iter().find(|time| **time >= 350_000).unwrap();
        assert!(*back <= 350_000 + SAMPLE_TIMEOUT_US + 10_000, "{back}");
    }
}

#[test]
fn samples_carry_the_time_they_were_read() {
    let (times, texts) = sampled(Answer::Sample);
    assert!(times.windows(2).all(|pair| pair[1] - pair[0] <= 1_000));
    assert!(times.len() > 990 && texts.is_empty());
}
