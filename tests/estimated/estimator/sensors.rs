//! What a BMI088 and a camera system make of a moment: white noise, biases that walk, poses with noise.

use super::truth::Moment;
use estimation::estimator::{EstimatorParameters, PoseMeasurement};
use flight::{Pose, Velocity};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

pub const REAL_PARAMETERS: EstimatorParameters = EstimatorParameters::BMI088;

const SAMPLE_RATE_HZ: f64 = 1e3;

/// Normal noise on three axes.
pub fn noise(random: &mut impl Rng, deviation: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| StandardNormal.sample(random)) * deviation
}

/// The biases of one IMU: drawn at first, walking from then on.
pub struct Imu {
    pub gyro_bias: Vector3<f64>,
    pub accelerometer_bias: Vector3<f64>,
}

impl Imu {
    pub fn new(random: &mut impl Rng) -> Self {
        Self {
            gyro_bias: noise(random, f64::from(REAL_PARAMETERS.gyro_bias)),
            accelerometer_bias: noise(random, f64::from(REAL_PARAMETERS.accelerometer_bias)),
        }
    }

    /// Rate and force, as the sensor says. A density n sampled at f is noise of deviation n sqrt(f); a walk of density
    /// w moves by w / sqrt(f) between samples.
    pub fn sample(&mut self, moment: &Moment, random: &mut impl Rng) -> (Vector3<f32>, Vector3<f32>) {
        self.gyro_bias += noise(random, f64::from(REAL_PARAMETERS.gyro_walk) / SAMPLE_RATE_HZ.sqrt());
        self.accelerometer_bias += noise(random, f64::from(REAL_PARAMETERS.accelerometer_walk) / SAMPLE_RATE_HZ.sqrt());
        let rate =
            moment.rate + self.gyro_bias + noise(random, f64::from(REAL_PARAMETERS.gyro_noise) * SAMPLE_RATE_HZ.sqrt());
        let force = moment.force
            + self.accelerometer_bias
            + noise(random, f64::from(REAL_PARAMETERS.accelerometer_noise) * SAMPLE_RATE_HZ.sqrt());
        (rate.map(|x| x as f32), force.map(|x| x as f32))
    }
}

/// The pose of a moment.
pub fn pose(moment: &Moment, random: &mut impl Rng) -> PoseMeasurement {
    let position = moment.position + noise(random, f64::from(REAL_PARAMETERS.position_noise));
    let turned = UnitQuaternion::from_scaled_axis(noise(random, f64::from(REAL_PARAMETERS.attitude_noise)));
    let attitude = (turned * moment.attitude).into_inner();
    let single = Quaternion::from(attitude.coords.map(|x| x as f32));
    let nothing = Velocity::World(Vector3::zeros());
    PoseMeasurement::new(&Pose::new(position.map(|x| x as f32), nothing, single).unwrap())
}
