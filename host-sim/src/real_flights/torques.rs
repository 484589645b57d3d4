//! Inertia of a real flight, or why its log cannot show it; and how speed turns the vehicle.
//!
//! ```text
//! omega_i = (c/J_i) integral of (tau_i - beta omega_i - kappa v_j) dt + slow things      j: x for y, y for x
//! ```
//!
//! tau are the rotors' torques behind their lag. All of it without what is slower than a second, and smoothed over a
//! tenth: the axes' coupling and steady torques go with the slow. What goes with the integrals of omega and of v, by
//! least squares, is taken out of both sides; what is left of the torque is x, of omega y. If x is noisy as y is, the
//! slope of y over x is too small, and one over that of x over y too great: the true one lies between (R. Frisch,
//! 1934). Their ratio is r^2, the share of the turning that the commands explain. Where it is near 1 the two say the
//! same, and the inertia is known; where it is not, the inertia is refused.
//!
//! The usual reason is the log: a loop of 500 Hz writes commands that change between a log's samples, and the log does
//! not have them. Such commands change from sample to sample as noise does: the ratio of von
//! Neumann, mean squared change over twice the variance, is near 1 for noise and near 0 for a signal that the log
//! shows.
//!
//! kappa comes out of slow motion: torques that last half a second turn nothing, they stand against what speed does to
//! the rotors. A vehicle is pitched up by it as it moves ahead.

use super::flown::{Flown, PERIOD_S, Sample};
use super::forces::lagged;
use super::regression::{PART_COUNT, Parts, Shown, Sums, part_of};
use controller_core::allocation::Rotors;
use nalgebra::{DVector, Vector3};

/// What is slower, s, and quicker, s, is left out.
const SLOW_S: f64 = 1.0;
const QUICK_S: f64 = 0.1;
/// Torques that last so long, s, turn nothing.
const STANDING_S: f64 = 0.5;
/// The least share of the turning that commands must explain.
const EXPLAINED_MIN: f64 = 0.8;
/// Commands whose ratio is greater change between samples.
const NOISY_MIN: f64 = 0.05;
/// Less turning than this, rad/s, shows nothing.
const TURNING_MIN_RAD_PER_S: f64 = 0.05;

/// About one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turning {
    /// c/J by the slope of turning over torque, 1/(kg m^2): the least it can be.
    pub least: Shown,
    /// One over the slope of torque over turning: the greatest.
    pub greatest: Shown,
    /// r^2, negative where turning goes against the commands.
    pub explained: f64,
    /// Von Neumann's ratio of the commands.
    pub noisy: f64,
    /// RMS of the turning, rad/s.
    pub turned: f64,
}

impl Turning {
    /// J/c, kg m^2, and the numbers between which it is, with 95 %; or why it is not shown.
    ///
    /// # Errors
    /// In words.
    pub fn inertia(&self, log_rate: f64, loop_rate: Option<f64>) -> Result<(f64, [f64; 2]), String> {
        if self.turned < TURNING_MIN_RAD_PER_S {
            return Err(format!("it turns by {:.3} rad/s only; fly steps or turns about it", self.turned));
        }
        if self.explained >= EXPLAINED_MIN {
            let middle = (self.least.value * self.greatest.value).sqrt();
            let ends = [1.0 / self.greatest.interval()[1], 1.0 / self.least.interval()[0]];
            return Ok((1.0 / middle, ends));
        }
        let explained = 100.0 * self.explained.max(0.0);
        if self.noisy > NOISY_MIN || loop_rate.is_some_and(|rate| rate > 1.5 * log_rate) {
            let writer = loop_rate.map_or("a quicker loop".to_owned(), |rate| format!("a loop of {rate:.0} Hz"));
            return Err(format!(
                "{writer} wrote commands that change between the log's {log_rate:.0} samples a second (from one to the \
                 next by {:.0} % of what noise would), so those logged explain {explained:.0} % of the turning; log \
                 motors at the loop's rate, or rotor speeds",
                100.0 * self.noisy
            ));
        }
        Err(format!("commands explain {explained:.0} % of the turning; wind, contacts, or another vehicle"))
    }
}

/// About all three axes; `lags` are the rotors', s, up and down.
pub fn turnings(flown: &Flown, rotors: &Rotors, lags: [f64; 2]) -> [Turning; 3] {
    let samples = &flown.samples;
    let acting = lagged(samples, lags);
    [0, 1, 2].map(|axis| {
        let torques = integrals(acting.iter().map(|thrusts| torque(thrusts, rotors)[axis]));
        let rates = banded(&samples.iter().map(|sample| sample.rates[axis]).collect::<Vec<_>>());
        let others = passing(flown, axis);
        let commanded: Vec<f64> = samples.iter().map(|sample| torque(&sample.thrusts, rotors)[axis]).collect();
        turning(&without(&torques, &others), &without(&rates, &others), &commanded)
    })
}

/// kappa of x and of y, N m for each m/s: what torques stand against while the vehicle moves.
pub fn moments_of_speed(flown: &Flown, rotors: &Rotors, lags: [f64; 2]) -> [Shown; 2] {
    let acting = lagged(&flown.samples, lags);
    [0, 1].map(|axis| {
        let torques: Vec<f64> = acting.iter().map(|thrusts| torque(thrusts, rotors)[axis]).collect();
        let torques = smoothed(&torques, (STANDING_S / PERIOD_S) as usize);
        let mut parts = Parts::new(2);
        for (number, (sample, torque)) in flown.samples.iter().zip(&torques).enumerate() {
            let velocity = sample.attitude.inverse_transform_vector(&sample.velocity)[1 - axis];
            parts.add(number, torques.len(), &DVector::from_vec(vec![velocity, 1.0]), *torque);
        }
        parts.shown(|unknowns| unknowns[0]).unwrap_or(Shown { value: 0.0, uncertainty: f64::INFINITY })
    })
}

/// What turns a vehicle about an axis besides its rotors, as integrals: its turning itself and, but about z, its speed.
pub fn passing(flown: &Flown, axis: usize) -> Vec<Vec<f64>> {
    let velocity = |sample: &Sample| sample.attitude.inverse_transform_vector(&sample.velocity);
    let mut all = vec![integrals(flown.samples.iter().map(|sample| sample.rates[axis]))];
    if axis < 2 {
        all.push(integrals(flown.samples.iter().map(|sample| velocity(sample)[1 - axis])));
    }
    all
}

/// The banded integral of a series.
pub fn integrals(series: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sum = 0.0;
    let integral = |number: f64| {
        sum += number * PERIOD_S;
        sum
    };
    banded(&series.map(integral).collect::<Vec<_>>())
}

/// What of a series does not go with `others`.
pub fn without(series: &[f64], others: &[Vec<f64>]) -> Vec<f64> {
    let mut sums = Sums::new(others.len());
    let row = |sample: usize| DVector::from_iterator(others.len(), others.iter().map(|other| other[sample]));
    for (sample, number) in series.iter().enumerate() {
        sums.add(&row(sample), *number);
    }
    let Some((unknowns, _)) = sums.solved() else { return series.to_vec() };
    series.iter().enumerate().map(|(sample, number)| number - row(sample).dot(&unknowns)).collect()
}

/// The torque of some thrusts, N m.
pub fn torque(thrusts: &[f64], rotors: &Rotors) -> Vector3<f64> {
    arms(rotors).zip(thrusts).map(|(arm, thrust)| arm * *thrust).sum()
}

/// The torque of one newton of each rotor, m.
pub fn arms(rotors: &Rotors) -> impl Iterator<Item = Vector3<f64>> + '_ {
    rotors.effectiveness().iter().map(|column| column.fixed_rows::<3>(1).into_owned())
}

fn turning(torques: &[f64], rates: &[f64], commanded: &[f64]) -> Turning {
    let mut parts = [[0.0; 3]; PART_COUNT];
    for (sample, (x, y)) in torques.iter().zip(rates).enumerate() {
        let part = &mut parts[part_of(sample, torques.len())];
        part[0] += x * x;
        part[1] += x * y;
        part[2] += y * y;
    }
    let all = parts.iter().fold([0.0; 3], |all, part| [0, 1, 2].map(|which| all[which] + part[which]));
    let slopes = |sums: [f64; 3]| [sums[1] / sums[0], sums[2] / sums[1]];
    let without = parts.map(|part| slopes([0, 1, 2].map(|which| all[which] - part[which])));
    let shown = |which: usize| Shown::of_parts(slopes(all)[which], &without.map(|slopes| slopes[which]));
    let explained = all[1] * all[1].abs() / (all[0] * all[2]);
    Turning {
        least: shown(0),
        greatest: shown(1),
        explained,
        noisy: noisy(commanded),
        turned: (all[2] / rates.len().max(1) as f64).sqrt(),
    }
}

/// Von Neumann's ratio of the part quicker than a second.
fn noisy(series: &[f64]) -> f64 {
    let slow = smoothed(series, (SLOW_S / PERIOD_S) as usize);
    let quick: Vec<f64> = series.iter().zip(&slow).map(|(here, slow)| here - slow).collect();
    let changes: f64 = quick.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
    changes / (2.0 * quick.iter().map(|here| here * here).sum::<f64>()).max(f64::MIN_POSITIVE)
}

/// Without the slow and the quick.
pub fn banded(series: &[f64]) -> Vec<f64> {
    let slow = smoothed(series, (SLOW_S / PERIOD_S) as usize);
    let middle: Vec<f64> = series.iter().zip(&slow).map(|(here, slow)| here - slow).collect();
    smoothed(&middle, (QUICK_S / PERIOD_S) as usize)
}

/// The mean of `width` samples about each.
fn smoothed(series: &[f64], width: usize) -> Vec<f64> {
    let mut sums = Vec::with_capacity(series.len() + 1);
    sums.push(0.0);
    let mut sum = 0.0;
    for number in series {
        sum += number;
        sums.push(sum);
    }
    let half = width / 2;
    let mean = |sample: usize| {
        let (begin, end) = (sample.saturating_sub(half), (sample + half + 1).min(series.len()));
        (sums[end] - sums[begin]) / (end - begin) as f64
    };
    (0..series.len()).map(mean).collect()
}
