//! The wrapper against two scripted sensors.

use super::*;
use core::future::pending;
use core::pin::pin;
use core::task::{Context, Poll, Waker};
use embassy_futures::block_on;
use nalgebra::Vector3;

/// A sensor's answer.
#[derive(Clone, Copy, PartialEq)]
enum Says {
    Samples,
    /// The same rate over and over, or the same force.
    Stuck(bool, bool),
    NoForce,
    Faults,
    Hangs,
}

struct Sensor {
    says: Says,
    asked: u64,
    /// Its rate about x, rad/s, identifies the sensor.
    rate: f32,
}

impl Imu for Sensor {
    async fn sample(&mut self) -> Result<RawImu, Fault> {
        self.asked += 1;
        let jitter = |is_stuck: bool| if is_stuck { 0.0 } else { (self.asked % 7) as f32 * 1e-3 };
        let (rate, force) = match self.says {
            Says::Stuck(rate, force) => (jitter(rate), Some(jitter(force))),
            Says::Samples => (jitter(false), Some(jitter(false))),
            Says::NoForce => (jitter(false), None),
            Says::Faults => return Err(Fault),
            Says::Hangs => pending().await,
        };
        let angular_velocity = Vector3::new(self.rate, rate, 0.0);
        let specific_force = force.map(|force| Vector3::new(0.0, force, 9.81));
        Ok(RawImu { time: self.asked, angular_velocity, specific_force })
    }

    fn parameters(&self) -> ImuParameters {
        ImuParameters { rate: 1000.0 + self.rate, ..ImuParameters::BMI088 }
    }

    fn is_polled(&self) -> bool {
        self.rate == 2.0
    }
}

/// Two sensors, both well, the second asked once.
fn pair() -> Redundant<Sensor, Sensor> {
    let sensor = |rate| Sensor { says: Says::Samples, asked: 0, rate };
    let mut pair = Redundant::new(sensor(1.0), sensor(2.0));
    assert!(block_on(pair.standby()).unwrap().is_ok());
    pair
}

/// The rates about x of the next samples; none for a fault.
fn rates(pair: &mut Redundant<Sensor, Sensor>, count: usize) -> Vec<Option<f32>> {
    (0..count).map(|_| block_on(pair.sample()).ok().map(|sample| sample.angular_velocity.x)).collect()
}

#[test]
fn the_first_speaks_while_it_is_well() {
    let mut pair = pair();
    assert_eq!(rates(&mut pair, 1_000), [Some(1.0); 1_000]);
    assert_eq!((pair.unit(), pair.parameters().rate, pair.second.asked), (Unit::First, 1001.0, 1));
}

#[test]
fn the_second_takes_over_at_the_fourth_fault_in_a_row_and_keeps_it() {
    let mut pair = pair();
    rates(&mut pair, 10);
    pair.first.says = Says::Faults;
    assert_eq!(rates(&mut pair, 3), [None; 3]);
    pair.first.says = Says::Samples;
    assert_eq!(rates(&mut pair, 1), [Some(1.0)], "three are borne");
    pair.first.says = Says::Faults;
    assert_eq!(rates(&mut pair, 5), [None, None, None, Some(2.0), Some(2.0)]);
    // No way back, and no stand-in any more.
    pair.first.says = Says::Samples;
    let asked = pair.first.asked;
    assert_eq!(rates(&mut pair, 100), [Some(2.0); 100]);
    assert_eq!((pair.unit(), pair.parameters().rate, pair.is_polled()), (Unit::Second, 1002.0, true));
    assert_eq!(pair.first.asked, asked);
    assert!(block_on(pair.standby()).is_none());
    // If it fails as well, that is reported.
    pair.second.says = Says::Faults;
    assert_eq!(rates(&mut pair, 10), [None; 10]);
}

#[test]
fn a_sensor_that_is_stuck_or_without_a_force_is_left_after_20_samples() {
    for says in [Says::Stuck(true, false), Says::Stuck(false, true), Says::NoForce] {
        let mut pair = pair();
        rates(&mut pair, 10);
        pair.first.says = says;
        let answers = rates(&mut pair, 30);
        let taken = answers.iter().position(|rate| *rate == Some(2.0)).unwrap();
        assert!((19..=20).contains(&taken), "{taken}");
        assert!(answers.iter().all(Option::is_some));
    }
}

#[test]
fn a_wait_that_is_given_up_counts_as_a_fault() {
    let mut pair = pair();
    pair.first.says = Says::Hangs;
    for _ in 0..TAKE_OVER_AFTER_FAULTS {
        let mut sample = pin!(pair.sample());
        assert!(sample.as_mut().poll(&mut Context::from_waker(Waker::noop())).is_pending());
    }
    let mut sample = pin!(pair.sample());
    let Poll::Ready(Ok(sample)) = sample.as_mut().poll(&mut Context::from_waker(Waker::noop())) else {
        panic!("the first was asked a fifth time");
    };
    assert_eq!(sample.angular_velocity.x, 2.0);
}

#[test]
fn a_second_that_has_not_answered_does_not_take_over() {
    let mut pair = pair();
    pair.second.says = Says::Faults;
    assert_eq!(block_on(pair.standby()), Some(Err(Fault)));
    pair.first.says = Says::Faults;
    assert_eq!(rates(&mut pair, 10), [None; 10]);
    pair.first.says = Says::Samples;
    assert_eq!(rates(&mut pair, 1), [Some(1.0)]);
    assert_eq!(pair.unit(), Unit::First);
}
