//! The unknowns that make a log most likely, and how sure that is.
//!
//! On whitened residuals e with their slopes J ([`super::noise`]), the noise fitted again on the way, each step solves
//!
//! ```text
//! sum Z' J step = sum Z' e          body rates: Z = J, Gauss-Newton     velocities: Z = J of the *reference's* flight
//! ```
//!
//! Gusts move the vehicle, and the law answers them: thrust and speed then go along with what is left, and least
//! squares would underestimate drag and thrust. The reference does not depend on gusts: instrumental variables
//! (L. Ljung, section 7.6), without bias whatever the gusts' spectrum.
//!
//! The covariance is A^-1 B A^-T with A = sum Z' J, and B = sum Z' Z for white residuals. What remains true if they are
//! not white is the jackknife's: by how much the unknowns move if a block b, one of G parts of the log, each
//! `JACKKNIFE_BLOCK_S` long, is left out, (A - A_b)^-1 sum_b Z' e, squared and summed over G blocks, times (G - 1) / G.
//! It counts in full what rests on a few blocks only, as drag does on the quickest legs; sums of Z' e alone would not,
//! because a block pulls the fit to itself. The greater of the two counts for each unknown, times what trials show it
//! to lack ([`UNCERTAINTY_FACTORS`]).
//!
//! Of the body rates the fit uses the innovation at each tick ([`super::low_passes`]). Of the velocities it uses ten
//! samples a second only: thrust over mass, drag and wind change slowly, and an estimator's prediction between its own
//! updates leaves artefacts from tick to tick.

use super::impulses::Impulse;
use super::low_passes::LowPasses;
use super::model::{
    CHANNEL_COUNT, Channels, DRAG_INDEX, IdentifiedModel, SQUARED_LAG_INDEX, STRENGTH_INDEX, SensedMotion,
    UNKNOWN_COUNT, Unknowns, WHOLE_DELAY_INDEX, prior,
};
use super::noise::{Noise, Whitening};
use super::student_t::PART_COUNT_RANGE;
use nalgebra::SMatrix;
use std::array::from_fn;

/// The parts of the log that the jackknife leaves out in order: longer than the memory of the residuals once they are
/// whitened. Turbulence is not quite of first order, nor is the gyro bias of an estimator.
const JACKKNIFE_BLOCK_S: f64 = 5.0;
/// Between two samples of the velocities.
const VELOCITY_PERIOD_S: f64 = 0.1;
/// Gauss-Newton steps at most; in how many of the first the noise is fitted anew, and in how many as long as steps are
/// longer than a standard uncertainty.
const STEPS_MAX: usize = 40;
const NOISE_STEPS: usize = 8;
const MORE_NOISE_STEPS: usize = 20;
/// The least part of a step that is taken.
const SHORTEST_SHARE: f64 = 0.125;
/// The longest step of an unknown, as a share of its uncertainty at the start: after longer steps, from a start far
/// off, the search ends at numbers that no vehicle has.
const STEP_MAX_SHARE: f64 = 0.5;
/// A shorter step ends the search, in standard uncertainties.
const CONVERGED_STEP_SIGMAS: f64 = 0.1;

/// Which uncertainties come out too small even so, and by what factor: errors over uncertainties of 300 trials of each
/// of two vehicles (the example `identify_coverage`), root mean square.
pub const UNCERTAINTY_FACTORS: [(usize, f64); 3] =
    [(WHOLE_DELAY_INDEX, 1.4), (SQUARED_LAG_INDEX, 1.2), (DRAG_INDEX, 1.3)];

/// Whitened series, a channel each.
type White = Vec<Vec<f64>>;

type Filters = [Whitening; CHANNEL_COUNT];

pub type Covariance = SMatrix<f64, UNKNOWN_COUNT, UNKNOWN_COUNT>;

/// The result of a fit.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The most likely unknowns.
    pub unknowns: Unknowns,
    /// Theirs.
    pub covariance: Covariance,
    /// From how many parts of the log the covariance is known.
    pub blocks: usize,
}

/// Fits `model`; `reference` is that of the same flight without disturbances. Samples come each `period`, s.
///
/// # Errors
/// If the search does not settle: the log is of another vehicle, or has too little information.
pub fn fit(model: &IdentifiedModel, reference: &IdentifiedModel, period: f64) -> Result<Fit, String> {
    let (mut unknowns, wide) = prior();
    let [least, most] = PART_COUNT_RANGE;
    let count = ((model.seconds() / JACKKNIFE_BLOCK_S).round() as usize).clamp(least, most);
    unknowns[STRENGTH_INDEX] = model.balance();
    let (start, mut noise) = (unknowns, [Noise::START; CHANNEL_COUNT]);
    let sampling = Sampling::new(model, period);
    let mut sensed_motions = Vec::new();
    let (mut share, mut last, mut is_near) = (1.0, Unknowns::zeros(), false);
    for step in 0..STEPS_MAX {
        let impulses = model.impulses(&unknowns);
        let residuals = sampling.take(&model.residuals(&unknowns, &impulses, &sensed_motions));
        if step < NOISE_STEPS || (step < MORE_NOISE_STEPS && !is_near) {
            noise = from_fn(|channel| Noise::START.fitted(&residuals[channel], sampling.periods[channel]));
        }
        let filters: Filters =
            from_fn(|channel| noise[channel].whitening(residuals[channel].len(), sampling.periods[channel]));
        let slope = |unknown| {
            let width = 1e-3 * wide[unknown];
            slopes([model, reference], &sampling, &filters, (&unknowns, unknown, width), (&impulses, &sensed_motions))
        };
        let slopes: Vec<(White, White)> = (0..UNKNOWN_COUNT).map(slope).collect();
        let (mut spread, blocks) = equations(&white(&filters, &residuals), &slopes, count);
        let mut information = blocks.iter().map(|block| block.information).sum::<Covariance>();
        let mut pull = blocks.iter().map(|block| block.pull).sum::<Unknowns>();
        for unknown in 0..UNKNOWN_COUNT {
            let weight = 1.0 / (wide[unknown] * wide[unknown]);
            information[(unknown, unknown)] += weight;
            spread[(unknown, unknown)] += weight;
            pull[unknown] += weight * (start[unknown] - unknowns[unknown]);
        }
        let inverse = scaled_inverse(&information).ok_or("says nothing that a model could be fitted to")?;
        let covariance = inverse * spread * inverse.transpose();
        let moved = inverse * pull;
        let within = |part: f64| (0..UNKNOWN_COUNT).all(|i| moved[i].abs() < part * covariance[(i, i)].sqrt());
        if step >= NOISE_STEPS && is_near && within(CONVERGED_STEP_SIGMAS) {
            return Ok(Fit { unknowns, covariance: robust(&covariance, &information, &blocks)?, blocks: blocks.len() });
        }
        // Wind and drag come as a product, so whole steps may leap to and fro across the solution: then shorter ones
        // are taken.
        let is_back = (0..UNKNOWN_COUNT).map(|i| moved[i] * last[i] / covariance[(i, i)]).sum::<f64>() < 0.0;
        share = if is_back { f64::max(0.5 * share, SHORTEST_SHARE) } else { f64::min(1.5 * share, 1.0) };
        (last, is_near) = (moved, within(1.0));
        let widest = moved.component_div(&wide).amax();
        unknowns += moved * f64::min(share, STEP_MAX_SHARE / widest);
        let impulses = model.impulses(&unknowns);
        let residuals = sampling.take(&model.residuals(&unknowns, &impulses, &sensed_motions));
        let gusts = from_fn(|axis| {
            let wander = filters[axis].wander(&residuals[axis]);
            wander.into_iter().flat_map(|b| std::iter::repeat_n(b, sampling.every[axis])).collect()
        });
        sensed_motions = model.sensed_motions(&unknowns, &impulses, &gusts);
    }
    Err("is of no vehicle like the scenario's: the search for its numbers does not settle".to_owned())
}

/// How often each channel is sampled: velocities each [`VELOCITY_PERIOD_S`], body rates at every tick.
struct Sampling<'a> {
    low_passes: Option<&'a LowPasses>,
    /// Ticks.
    every: [usize; CHANNEL_COUNT],
    /// s.
    periods: [f64; CHANNEL_COUNT],
}

impl<'a> Sampling<'a> {
    fn new(model: &'a IdentifiedModel, period: f64) -> Self {
        let rare = (VELOCITY_PERIOD_S / period).round().max(1.0) as usize;
        let every: [usize; CHANNEL_COUNT] = from_fn(|channel| if channel < 3 { rare } else { 1 });
        Self { low_passes: model.low_passes(), every, periods: every.map(|every| every as f64 * period) }
    }

    /// The samples of `channels`; of low-passed body rates the innovations.
    fn take(&self, channels: &Channels) -> Channels {
        from_fn(|channel| match self.low_passes {
            Some(low_passes) if channel >= 3 => low_passes.innovations(&channels[channel]),
            _ => channels[channel].iter().step_by(self.every[channel]).copied().collect(),
        })
    }
}

fn white(filters: &Filters, channels: &Channels) -> White {
    channels.iter().zip(filters).map(|(series, filter)| filter.whiten(series)).collect()
}

/// The whitened slopes of the residuals of the model and of the reference over one unknown, by central differences.
fn slopes(
    [model, reference]: [&IdentifiedModel; 2],
    sampling: &Sampling<'_>,
    filters: &Filters,
    (unknowns, unknown, width): (&Unknowns, usize, f64),
    (impulses, sensed_motions): (&[Impulse], &[SensedMotion]),
) -> (White, White) {
    let hovering = reference.hovering(unknowns);
    let moved = |by: f64| {
        let mut moved = *unknowns;
        moved[unknown] += by;
        let late = [WHOLE_DELAY_INDEX, SQUARED_LAG_INDEX].contains(&unknown).then(|| model.impulses(&moved));
        let flown = model.residuals(&moved, late.as_deref().unwrap_or(impulses), sensed_motions);
        (sampling.take(&flown), sampling.take(&reference.residuals(&moved, &hovering, &[])))
    };
    let (ahead, behind) = (moved(width), moved(-width));
    let slope = |ahead: &Channels, behind: &Channels| {
        let difference = |(a, b): (&f64, &f64)| (b - a) / (2.0 * width);
        white(filters, &from_fn(|channel| ahead[channel].iter().zip(&behind[channel]).map(difference).collect()))
    };
    (slope(&ahead.0, &behind.0), slope(&ahead.1, &behind.1))
}

/// The inverse of a matrix whose unknowns have very different sizes.
fn scaled_inverse(matrix: &Covariance) -> Option<Covariance> {
    let scale = Unknowns::from_fn(|i, _| 1.0 / matrix[(i, i)].abs().sqrt());
    let scaled = Covariance::from_fn(|i, j| matrix[(i, j)] * scale[i] * scale[j]);
    let inverse = scaled.try_inverse()?;
    Some(Covariance::from_fn(|i, j| inverse[(i, j)] * scale[i] * scale[j]))
}

/// The equations of one of the parts of the log.
#[derive(Debug, Clone, Default)]
struct Block {
    /// Its part of A.
    information: Covariance,
    /// Its part of the sum of Z' e.
    pull: Unknowns,
}

/// sum Z' Z, and what each part of the log adds to A and to sum Z' e; each unknown has the slopes of the model and of
/// the reference.
fn equations(errors: &White, slopes: &[(White, White)], count: usize) -> (Covariance, Vec<Block>) {
    let mut spread = Covariance::zeros();
    let mut blocks = vec![Block::default(); count];
    for (channel, errors) in errors.iter().enumerate() {
        let deviation = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        for (sample, error) in errors.iter().enumerate() {
            let slope = Unknowns::from_fn(|unknown, _| slopes[unknown].0[channel][sample]) / deviation;
            let instrument = if channel < 3 {
                Unknowns::from_fn(|unknown, _| slopes[unknown].1[channel][sample]) / deviation
            } else {
                slope
            };
            let block = &mut blocks[count * sample / errors.len()];
            block.information.ger(1.0, &instrument, &slope, 1.0);
            block.pull += instrument * (error / deviation);
            spread.ger(1.0, &instrument, &instrument, 1.0);
        }
    }
    (spread, blocks)
}

/// The covariance with each deviation the greater of the usual and the jackknife's, correlations kept.
fn robust(usual: &Covariance, information: &Covariance, blocks: &[Block]) -> Result<Covariance, String> {
    let share = (blocks.len() - 1) as f64 / blocks.len() as f64;
    let mut spread = Covariance::zeros();
    for block in blocks {
        let others = scaled_inverse(&(information - block.information));
        let moved = others.ok_or("rests on a small part of its time: fly longer")? * block.pull;
        spread.ger(share, &moved, &moved, 1.0);
    }
    let mut grow = Unknowns::from_fn(|i, _| (spread[(i, i)] / usual[(i, i)]).max(1.0).sqrt());
    for (unknown, factor) in UNCERTAINTY_FACTORS {
        grow[unknown] *= factor;
    }
    Ok(Covariance::from_fn(|i, j| usual[(i, j)] * grow[i] * grow[j]))
}
