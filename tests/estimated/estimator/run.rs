//! One flight with an estimator on board.

use super::sensors::{Imu, pose};
use super::truth::{Moment, Truth};
use controller_core::state::State;
use estimation::estimator::covariance::Covariance;
use estimation::estimator::filter::Filter;
use estimation::estimator::{Accepted, Estimator, EstimatorParameters, Rejected, Settings};
use estimation::imu::{Calibration, Conditioner, ImuParameters};
use flight::Stamped;
use nalgebra::{SMatrix, SVector, UnitQuaternion};
use rand::Rng;
use std::collections::VecDeque;

/// How late poses come, ms, and how far apart they are.
const POSE_DELAY_MS: usize = 20;
const POSE_PERIOD_MS: usize = 10;

/// The last part of a flight.
const WITHOUT_POSES_MS: usize = 2_000;

/// Squares of the errors at one tick: m^2, rad^2.
pub struct TickError {
    pub position: f64,
    pub attitude: f64,
}

/// What the pose source takes for the moment at a time, ms, that was this.
pub type Meddle<'a> = &'a (dyn Fn(usize, Moment) -> Moment + Sync);

/// What a flight showed.
pub struct Shown {
    /// One a tick of 10 ms, from where they count to the last pose.
    pub ticks: Vec<TickError>,
    /// Normalised squared errors of all 15 states, every half second.
    pub nees: Vec<f64>,
    /// Position errors 0.5 s and 2 s after the last pose, m.
    pub drift: [f64; 2],
    /// Poses taken and refused.
    pub counts: (u32, u32),
    /// What became of the last pose.
    pub last: Option<Result<Accepted, Rejected>>,
}

/// Flies `truth`, with poses of moments that `meddle` may have changed.
pub fn fly(truth: &Truth, parameters: &EstimatorParameters, meddle: Meddle, random: &mut impl Rng) -> Shown {
    let mut conditioner = Conditioner::new(&ImuParameters::PROMPT, &Calibration::NONE, 10_000).unwrap();
    let mut estimator = Box::new(Estimator::new(&Settings::new(parameters).unwrap()));
    let mut imu = Imu::new(random);
    let mut biases = VecDeque::new();
    let mut shown = Shown { ticks: Vec::new(), nees: Vec::new(), drift: [0.0; 2], counts: (0, 0), last: None };
    let silent_from = truth.milliseconds() - WITHOUT_POSES_MS;
    for (n, moment) in truth.moments.iter().enumerate() {
        let now = n as u64 * 1_000;
        let (rate, force) = imu.sample(moment, random);
        biases.push_back((imu.gyro_bias, imu.accelerometer_bias));
        if let Some(increment) = conditioner.sample(now, &rate, Some(&force)).increment {
            estimator.imu(&increment);
        }
        if biases.len() > POSE_DELAY_MS + 1 {
            biases.pop_front();
        }
        if n % POSE_PERIOD_MS != 0 || n < POSE_DELAY_MS {
            continue;
        }
        let then = &truth.moments[n - POSE_DELAY_MS];
        if n <= silent_from {
            let stamped = Stamped {
                value: pose(&meddle(n - POSE_DELAY_MS, *then), random),
                time: now - POSE_DELAY_MS as u64 * 1_000,
            };
            let _ = estimator.pose(&stamped, now);
        }
        if n < truth.counts_from {
            continue;
        }
        let error = error(estimator.state(now, &rate, None).unwrap().state, moment);
        if n <= silent_from {
            if n % 500 == 0 {
                shown.nees.push(nees(estimator.filter().unwrap(), then, &biases[0]));
            }
            shown.ticks.push(error);
        } else if n == silent_from + 500 {
            shown.drift[0] = error.position.sqrt();
        } else if n == silent_from + WITHOUT_POSES_MS {
            shown.drift[1] = error.position.sqrt();
        }
    }
    let health = estimator.health(0);
    (shown.counts, shown.last) = (health.counts, health.last);
    shown
}

/// The estimate's error.
fn error(state: State, moment: &Moment) -> TickError {
    let attitude = UnitQuaternion::new_normalize(state.attitude.cast::<f64>());
    TickError {
        position: (state.position.cast::<f64>() - moment.position).norm_squared(),
        attitude: attitude.angle_to(&moment.attitude).powi(2),
    }
}

type Biases = (nalgebra::Vector3<f64>, nalgebra::Vector3<f64>);

/// e' P^-1 e at the horizon.
fn nees(filter: &Filter, moment: &Moment, biases: &Biases) -> f64 {
    let nominal = &filter.nominal;
    let attitude = UnitQuaternion::new_normalize(nominal.attitude.cast::<f64>());
    let parts = [
        moment.position - nominal.position.cast::<f64>(),
        moment.velocity - nominal.velocity.cast::<f64>(),
        (moment.attitude * attitude.inverse()).scaled_axis(),
        biases.0 - nominal.gyro_bias.cast::<f64>(),
        biases.1 - nominal.accelerometer_bias.cast::<f64>(),
    ];
    let error = SVector::<f64, 15>::from_iterator(parts.iter().flat_map(|part| part.iter().copied()));
    error.dot(&(full(&filter.covariance).try_inverse().unwrap() * error))
}

/// All of P.
fn full(c: &Covariance) -> SMatrix<f64, 15, 15> {
    let upper = [
        [&c.pp, &c.pv, &c.pt, &c.pg, &c.pa],
        [&c.pv, &c.vv, &c.vt, &c.vg, &c.va],
        [&c.pt, &c.vt, &c.tt, &c.tg, &c.ta],
        [&c.pg, &c.vg, &c.tg, &c.gg, &c.ga],
        [&c.pa, &c.va, &c.ta, &c.ga, &c.aa],
    ];
    SMatrix::from_fn(|i, j| {
        let (row, column) = if i / 3 <= j / 3 { (i % 3, j % 3) } else { (j % 3, i % 3) };
        f64::from(upper[i / 3][j / 3][(row, column)])
    })
}
