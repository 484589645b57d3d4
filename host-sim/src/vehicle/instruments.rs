//! The sensors that `[estimator]` describes: an IMU that samples at 1 kHz, and a source of poses that come late.
//!
//! ```text
//! every millisecond   omega_m = G(omega + b_g + n),  f_m = A(R' ((v_k - v_k-1) / 1 ms + g e3) + b_a + n)
//! every pose_every    p + n,  exp(n) q  -> pose_delay later
//! ```
//!
//! G and A are the sensor's own filters: a BMI088's, of 116 and 145 Hz by its data sheet, taken as second-order
//! Butterworth filters; another gyro's with [`Instruments::with_gyro_of`]. They make it 1.9 and 1.4 ms late, for which
//! the conditioner allows ([`ImuParameters::late`]).
//!
//! Noise densities and the walks of the biases are a BMI088's times `imu_noise`; the biases are drawn once. The seed
//! decides everything that is drawn: the same motion is sensed in the same way, to the last bit. No sensor feels or
//! shows more than a BMI088's range: a hard touchdown's 50 g are 24 g to its filter, which makes 9 g of the millisecond
//! that they last.

use crate::vehicle::sensors::{noise, single};
use estimation::estimator::EstimatorParameters;
use estimation::imu::ImuParameters;
use estimation::imu::low_pass::LowPass;
use flight::{ImuSample, Pose, Stamped, Velocity};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};
use scenario::body::BodyState;
use scenario::reality::estimator::{Estimator, IMU_RATE_HZ};
use std::collections::VecDeque;

/// Of the instruments.
pub const SAMPLE_PERIOD_US: u64 = 1_000;

/// The bandwidth of a BMI088's accelerometer's own filter as `firmware/src/bmi088.rs` sets it.
const ACCELEROMETER_BANDWIDTH_HZ: f64 = 145.0;

/// An IMU's input, before filters and noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueMotion {
    /// rad/s, body.
    pub angular_velocity: Vector3<f64>,
    /// m/s^2, body.
    pub specific_force: Vector3<f64>,
}

/// A sensor's own filter.
#[derive(Debug, Clone)]
struct OwnFilter {
    low_pass: LowPass,
    is_settled: bool,
}

/// With zeros at half the rate, where the bilinear transform puts a Butterworth filter's.
fn butterworth(bandwidth: f64) -> LowPass {
    LowPass::new(bandwidth, 0.5 * IMU_RATE_HZ, IMU_RATE_HZ)
}

/// The gyro's own filter, sampled at [`IMU_RATE_HZ`].
pub fn gyro_filter() -> LowPass {
    butterworth(ImuParameters::BMI088.gyro_bandwidth.into())
}

impl OwnFilter {
    fn new(low_pass: LowPass) -> Self {
        Self { low_pass, is_settled: false }
    }

    fn take(&mut self, value: &Vector3<f32>) -> Vector3<f32> {
        if !self.is_settled {
            self.low_pass.settle(value);
            self.is_settled = true;
        }
        self.low_pass.take(value)
    }
}

/// IMU and pose source of one vehicle.
#[derive(Debug, Clone)]
pub struct Instruments {
    what: Estimator,
    /// m/s^2.
    gravity: f64,
    random: Xoshiro256PlusPlus,
    /// Time since the first sample was due, us, and when in it the flight begins.
    clock: u64,
    beginning: u64,
    /// rad/s.
    gyro_bias: Vector3<f64>,
    /// m/s^2.
    accelerometer_bias: Vector3<f64>,
    /// m/s, at the last sample.
    velocity: Vector3<f64>,
    /// The gyro's filter and the accelerometer's, where they have any.
    filters: Option<[OwnFilter; 2]>,
    /// Poses on their way, with their times of arrival, us.
    late: VecDeque<(u64, Stamped<Pose>)>,
}

impl Instruments {
    /// Sensors as `what` describes them, under `gravity`, m/s^2, of a vehicle that has this velocity, m/s, a
    /// millisecond before the first sample. Outages count from `file_header`, us after that.
    pub fn new(what: &Estimator, gravity: f64, velocity: Vector3<f64>, beginning: u64) -> Self {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(what.seed);
        let mut bias = |deviation: f32| noise(&mut random, what.imu_noise * f64::from(deviation));
        let real = EstimatorParameters::BMI088;
        let (gyro_bias, accelerometer_bias) = (bias(real.gyro_bias), bias(real.accelerometer_bias));
        Self {
            what: *what,
            gravity,
            random,
            clock: 0,
            beginning,
            gyro_bias,
            accelerometer_bias,
            velocity,
            filters: Some([gyro_filter(), butterworth(ACCELEROMETER_BANDWIDTH_HZ)].map(OwnFilter::new)),
            late: VecDeque::new(),
        }
    }

    /// The same without filters of its own: what its IMU shows is true when it can be read.
    pub fn prompt(self) -> Self {
        Self { filters: None, ..self }
    }

    /// The same with the gyro's own filter of another sensor, which has one.
    pub fn with_gyro_of(mut self, sensor: &ImuParameters) -> Self {
        if let Some([gyro, _]) = &mut self.filters {
            *gyro = OwnFilter::new(butterworth(sensor.gyro_bandwidth.into()));
        }
        self
    }

    /// The IMU's sample of a vehicle at `state`, a millisecond after the last. A pose of this moment, if one is due,
    /// will carry `time`, us.
    pub fn sample(&mut self, state: &BodyState, time: u64) -> ImuSample {
        self.sample_of(state, time, |felt| felt)
    }

    /// The same where the IMU feels something else than the body does: `feels` of it.
    pub fn sample_of(
        &mut self,
        state: &BodyState,
        time: u64,
        feels: impl FnOnce(TrueMotion) -> TrueMotion,
    ) -> ImuSample {
        self.clock += SAMPLE_PERIOD_US;
        let real = EstimatorParameters::BMI088;
        let scale = |density: f32| self.what.imu_noise * f64::from(density);
        let (each, walk) = (IMU_RATE_HZ.sqrt(), 1.0 / IMU_RATE_HZ.sqrt());
        self.gyro_bias += noise(&mut self.random, scale(real.gyro_walk) * walk);
        self.accelerometer_bias += noise(&mut self.random, scale(real.accelerometer_walk) * walk);
        let acceleration = (state.velocity - self.velocity) * IMU_RATE_HZ;
        self.velocity = state.velocity;
        let attitude = UnitQuaternion::new_normalize(state.attitude);
        let force = attitude.inverse_transform_vector(&(acceleration + Vector3::z() * self.gravity));
        let felt = feels(TrueMotion { angular_velocity: state.angular_velocity, specific_force: force });
        let rate = felt.angular_velocity + self.gyro_bias + noise(&mut self.random, scale(real.gyro_noise) * each);
        let force = felt.specific_force
            + self.accelerometer_bias
            + noise(&mut self.random, scale(real.accelerometer_noise) * each);
        if (self.clock / SAMPLE_PERIOD_US).is_multiple_of(self.what.pose_every) {
            self.measure_pose(state, &attitude, time);
        }
        let ImuParameters { gyro_range, accelerometer_range, .. } = ImuParameters::BMI088;
        let (mut rate, mut force) =
            (clipped(&single(&rate), gyro_range), clipped(&single(&force), accelerometer_range));
        if let Some([gyro, accelerometer]) = &mut self.filters {
            (rate, force) = (gyro.take(&rate), accelerometer.take(&force));
        }
        ImuSample { angular_velocity: clipped(&rate, gyro_range), specific_force: clipped(&force, accelerometer_range) }
    }

    /// The next pose that has arrived by the last sample, with the time at which it was true. Its velocity is zero: the
    /// source knows none.
    pub fn arrived(&mut self) -> Option<Stamped<Pose>> {
        self.late.pop_front_if(|(arrival, _)| *arrival <= self.clock).map(|(_, pose)| pose)
    }

    /// The pose source takes a picture.
    fn measure_pose(&mut self, state: &BodyState, attitude: &UnitQuaternion<f64>, time: u64) {
        let position = state.position + noise(&mut self.random, self.what.position_noise);
        let turned = UnitQuaternion::from_scaled_axis(noise(&mut self.random, self.what.attitude_noise));
        let attitude = (turned * attitude).into_inner().coords.map(|value| value as f32);
        if self.random.random_bool(self.what.dropout) || self.is_out() {
            return;
        }
        let nothing = Velocity::World(Vector3::zeros());
        // A vehicle that is too far away for a pose has none.
        if let Ok(value) = Pose::new(single(&position), nothing, Quaternion::from(attitude)) {
            self.late.push_back((self.clock + self.what.pose_delay * SAMPLE_PERIOD_US, Stamped { value, time }));
        }
    }

    /// Whether poses are out, a delay before they would arrive.
    fn is_out(&self) -> bool {
        let arrival =
            (self.clock + self.what.pose_delay * SAMPLE_PERIOD_US) as f64 * 1e-6 - self.beginning as f64 * 1e-6;
        self.what.outage.is_some_and(|outage| (outage.start..outage.start + outage.duration).contains(&arrival))
    }
}

/// The output of a sensor with this `range`.
fn clipped(truth: &Vector3<f32>, range: f32) -> Vector3<f32> {
    truth.map(|component| component.clamp(-range, range))
}

#[cfg(test)]
mod tests;
