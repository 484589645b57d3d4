//! The filter: nominal state and covariance at one instant, the horizon, and the three things that happen to them.
//!
//! - `Filter::advance`: the horizon moves on through what the IMU did.
//! - `Filter::test` and `Filter::fuse`: a pose that was true at the horizon is weighed, and taken into account.
//! - `Filter::rebase`: the pose source reports a move of its frame.
//!
//! Normalised innovations squared (NIS) are r' S^-1 r of a residual r whose covariance is S: for a filter and a pose
//! that are what they say, chi-square distributed with three degrees of freedom, 3 on average, and above [`NIS_GATE`]
//! once in a hundred thousand times.

use super::covariance::{Correction, Covariance, Part, inverse};
use super::history::History;
use super::measurement::PoseMeasurement;
use super::nominal::{self, Nominal};
use super::settings::Settings;
use super::verdict::Rejected;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// The greatest NIS of a pose that is believed: chi-square with 3 degrees of freedom, 1 - 1e-5.
pub const NIS_GATE: f32 = 25.9;

/// The greatest residuals that may be errors of estimation, m and rad (as error vectors).
const POSITION_RESIDUAL_MAX_M: f32 = 1.0;
const ATTITUDE_RESIDUAL_MAX_RAD: f32 = 0.52;

/// The deviation of a velocity of which nothing is known, m/s.
const UNKNOWN_VELOCITY_M_PER_S: f32 = 10.0;

/// Nominal state and covariance at `time`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Filter {
    /// The horizon, us.
    pub time: u64,
    /// Where the vehicle is believed to be.
    pub nominal: Nominal,
    /// How sure that is.
    pub covariance: Covariance,
    /// The last increment's body rate, rad/s, world.
    turn_rate: Vector3<f32>,
}

/// A measurement of one part of the state, weighed: its noise covariance V, and NIS.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Innovation {
    noise: Matrix3<f32>,
    nis: f32,
}

/// What is known of the biases: their values, and their blocks of the covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Biases {
    pub gyro: Vector3<f32>,
    pub accelerometer: Vector3<f32>,
    pub gg: Matrix3<f32>,
    pub ga: Matrix3<f32>,
    pub aa: Matrix3<f32>,
}

impl Biases {
    /// Zero, with the deviations of the settings.
    pub fn unknown(settings: &Settings) -> Self {
        let variance = |deviation: f32| Matrix3::from_diagonal_element(deviation * deviation);
        let parameters = settings.parameters();
        Self {
            gyro: Vector3::zeros(),
            accelerometer: Vector3::zeros(),
            gg: variance(parameters.gyro_bias),
            ga: Matrix3::zeros(),
            aa: variance(parameters.accelerometer_bias),
        }
    }
}

/// A pose, weighed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WeighedPose {
    position: Innovation,
    attitude: Innovation,
    velocity: Option<Innovation>,
}

impl WeighedPose {
    /// NIS of position and attitude.
    pub fn nis(&self) -> (f32, f32) {
        (self.position.nis, self.attitude.nis)
    }

    /// Whether every part is within its gate.
    pub fn gate(&self) -> Result<(), Rejected> {
        let within = |innovation: &Innovation| innovation.nis <= NIS_GATE;
        if !within(&self.position) {
            Err(Rejected::Position)
        } else if !within(&self.attitude) {
            Err(Rejected::Attitude)
        } else if self.velocity.is_some_and(|velocity| !within(&velocity)) {
            Err(Rejected::Velocity)
        } else {
            Ok(())
        }
    }
}

impl Filter {
    /// A filter that knows a pose and the biases it is given, with their covariance blocks, and no velocity.
    pub(super) fn start(time: u64, pose: &PoseMeasurement, biases: &Biases, settings: &Settings) -> Self {
        let parameters = settings.parameters();
        let (position, attitude) = settings.deviations(pose.deviations);
        let mut covariance = Covariance::diagonal([position, UNKNOWN_VELOCITY_M_PER_S, attitude, 1.0, 1.0]);
        (covariance.gg, covariance.ga, covariance.aa) = (biases.gg, biases.ga, biases.aa);
        let nominal = Nominal {
            position: pose.position,
            velocity: Vector3::zeros(),
            attitude: pose.attitude,
            gyro_bias: biases.gyro,
            accelerometer_bias: biases.accelerometer,
        };
        let mut filter = Self { time, nominal, covariance, turn_rate: Vector3::zeros() };
        if let Some(velocity) = pose.velocity.filter(|_| parameters.velocity_noise > 0.0) {
            filter.nominal.velocity = velocity;
            let variance = parameters.velocity_noise * parameters.velocity_noise;
            filter.covariance.vv = Matrix3::from_diagonal_element(variance);
        }
        filter
    }

    /// The biases and what is known of them.
    pub(super) fn biases(&self) -> Biases {
        let (n, c) = (&self.nominal, &self.covariance);
        Biases { gyro: n.gyro_bias, accelerometer: n.accelerometer_bias, gg: c.gg, ga: c.ga, aa: c.aa }
    }

    /// Moves the horizon on to `time` through `history`, which covers that; an earlier time changes nothing.
    pub(super) fn advance(&mut self, time: u64, history: &History, settings: &Settings) {
        for increment in history.between(self.time, time) {
            let motion = self.nominal.advance(&increment, settings.parameters().gravity);
            self.covariance.advance(&motion, settings.parameters());
            self.turn_rate = motion.turn_rate;
        }
        self.time = self.time.max(time);
    }

    /// Weighs a pose that was true at the horizon.
    ///
    /// # Errors
    /// Where it is too far from the state to be an error of estimation, or a covariance is invalid.
    pub(super) fn weigh(&self, pose: &PoseMeasurement, settings: &Settings) -> Result<WeighedPose, Rejected> {
        let parameters = settings.parameters();
        let (position, attitude) = settings.deviations(pose.deviations);
        let (apart, turned) = self.residuals(pose);
        if apart.norm_squared() > POSITION_RESIDUAL_MAX_M * POSITION_RESIDUAL_MAX_M {
            return Err(Rejected::Position);
        }
        if turned.norm_squared() > ATTITUDE_RESIDUAL_MAX_RAD * ATTITUDE_RESIDUAL_MAX_RAD {
            return Err(Rejected::Attitude);
        }
        let noise = |deviation: f32, per_second: &Vector3<f32>| {
            let late = per_second * parameters.time_noise;
            Matrix3::from_diagonal_element(deviation * deviation) + late * late.transpose()
        };
        let weigh = |part: Part, residual: &Vector3<f32>, noise: Matrix3<f32>| {
            let weight = inverse(&(self.covariance.block(part) + noise)).ok_or(Rejected::NotFinite)?;
            Ok(Innovation { noise, nis: residual.dot(&(weight * residual)) })
        };
        let velocity = match pose.velocity {
            Some(velocity) if parameters.velocity_noise > 0.0 => {
                let noise = noise(parameters.velocity_noise, &Vector3::zeros());
                Some(weigh(Part::Velocity, &(velocity - self.nominal.velocity), noise)?)
            }
            _ => None,
        };
        Ok(WeighedPose {
            position: weigh(Part::Position, &apart, noise(position, &self.nominal.velocity))?,
            attitude: weigh(Part::Attitude, &turned, noise(attitude, &self.turn_rate))?,
            velocity,
        })
    }

    /// Fuses a weighed pose: position, attitude, velocity, one after the other.
    ///
    /// # Errors
    /// Where a covariance is invalid; the filter is then of no use.
    pub(super) fn fuse(&mut self, pose: &PoseMeasurement, tested: &WeighedPose) -> Result<(), Rejected> {
        let (apart, _) = self.residuals(pose);
        self.take(Part::Position, &apart, &tested.position.noise)?;
        let (_, turned) = self.residuals(pose);
        self.take(Part::Attitude, &turned, &tested.attitude.noise)?;
        if let (Some(velocity), Some(innovation)) = (pose.velocity, &tested.velocity) {
            let residual = velocity - self.nominal.velocity;
            self.take(Part::Velocity, &residual, &innovation.noise)?;
        }
        if self.covariance.is_positive() { Ok(()) } else { Err(Rejected::NotFinite) }
    }

    /// Puts the state into the frame in which `pose` is: position and attitude are the pose's, the velocity turns
    /// along.
    pub(super) fn rebase(&mut self, pose: &PoseMeasurement, settings: &Settings) {
        let (position, attitude) = settings.deviations(pose.deviations);
        let turn = nominal::unit(&(pose.attitude * self.nominal.attitude.conjugate()));
        let rotation = UnitQuaternion::new_unchecked(turn).to_rotation_matrix().into_inner();
        let variance = |deviation: f32| Matrix3::from_diagonal_element(deviation * deviation);
        let square = self.nominal.velocity.norm_squared();
        self.covariance.rebase(&rotation, &variance(position), &variance(attitude), square);
        self.nominal.position = pose.position;
        self.nominal.attitude = pose.attitude;
        self.nominal.velocity = rotation * self.nominal.velocity;
        self.turn_rate = rotation * self.turn_rate;
    }

    /// How far a pose is from the state, m and error vector.
    pub(super) fn residuals(&self, pose: &PoseMeasurement) -> (Vector3<f32>, Vector3<f32>) {
        (pose.position - self.nominal.position, nominal::difference(&pose.attitude, &self.nominal.attitude))
    }

    fn take(&mut self, part: Part, residual: &Vector3<f32>, noise: &Matrix3<f32>) -> Result<(), Rejected> {
        let weight = inverse(&(self.covariance.block(part) + noise)).ok_or(Rejected::NotFinite)?;
        let Correction { position, velocity, attitude, gyro_bias, accelerometer_bias } =
            self.covariance.fuse(part, residual, noise, &weight);
        let nominal = &mut self.nominal;
        nominal.position += position;
        nominal.velocity += velocity;
        nominal.attitude = nominal::unit(&(nominal::rotation(&attitude) * nominal.attitude));
        nominal.gyro_bias += gyro_bias;
        nominal.accelerometer_bias += accelerometer_bias;
        Ok(())
    }
}

#[cfg(test)]
mod tests;
