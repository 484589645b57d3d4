//! How much gain or delay a stable loop can take before an eigenvalue reaches the unit circle.
//!
//! An eigenvalue e^(i angle) appears where the loop's response passes through -1. Scaling the loop's gain by kappa
//! moves every point of the response along its ray, so the critical kappa are -1 / L at the crossings of the negative
//! real axis. More delay turns it clockwise: at a frequency where |L| = 1, D samples take angle D of its phase. A held
//! command makes that exact for whole samples only, so the delay is found by steps, each of which takes what phase is
//! left.
//!
//! Two kinds of crossings no step leads to. A fraction of a sample may make one that was not there without it. And at
//! the Nyquist frequency there is no phase to take: the response is real, and further delay carries it along the axis.
//! So the eigenvalues themselves decide, up to two samples of further delay.
//!
//! The response is followed along a grid of frequencies. Where it comes near an axis and turns back it is looked at
//! more closely: it may cross twice between neighbours.

use super::chain::SampledLoop;
use super::compensator::Response;
use core::f64::consts::{PI, TAU};
use nalgebra::Complex;

/// The lowest frequency looked at, rad/s: below the slowest position loop one would fly.
const FREQUENCY_MIN_RAD_PER_S: f64 = 3e-3;

/// The same for slow ticks, radians per sample.
const ANGLE_MIN_RAD: f64 = 3e-5;

/// The highest one. At pi itself the response is real, so the sign of its imaginary part there would be rounding's.
const ANGLE_MAX_RAD: f64 = PI * (1.0 - 1e-4);

/// Maximum ratio of neighbouring frequencies less one.
const GRID_SPACING: f64 = 0.1;

/// How near to zero a measure of the response has to turn back to be looked at more closely.
const TURN_BACK_MAX: f64 = 0.5;

/// The margins of a stable loop, in samples and radians per sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct SampleMargins {
    /// Minimum factor above one at which stability is lost; infinite if none.
    pub gain_up: f64,
    /// Maximum factor below one at which stability is lost; zero if none.
    pub gain_down: f64,
    /// Minimum further delay at which stability is lost. Zero for a loop slower than [`FREQUENCY_MIN_RAD_PER_S`], which
    /// is not looked at.
    pub delay: f64,
    /// Highest frequency at which the loop's gain is one.
    pub crossover: f64,
}

/// The margins of `chain`, which is stable with its commands `delay` samples late, at ticks `period` seconds apart.
pub(super) fn margins(chain: &SampledLoop<'_>, delay: f64, period: f64) -> SampleMargins {
    let grid = Grid::measure(chain, delay, ANGLE_MIN_RAD.min(FREQUENCY_MIN_RAD_PER_S * period));
    let sweep = Sweep::along(&grid.points, *chain);
    let (gain_down, gain_up) = sweep.critical_gains();
    let unit_gain = sweep.crossings(gain);
    let (Some(lowest), Some(crossover)) = (unit_gain.first(), unit_gain.last()) else {
        return SampleMargins { gain_up, gain_down, delay: 0.0, crossover: 0.0 };
    };
    let turned = delay_margin(chain, &grid, delay, *lowest);
    let delay = borne_out(chain, delay, turned);
    SampleMargins { gain_up, gain_down, delay, crossover: *crossover }
}

/// Positive where the loop amplifies.
fn gain(response: Complex<f64>) -> f64 {
    response.norm_sqr().ln()
}

/// The sine of the response's angle to the positive real axis.
fn phase(response: Complex<f64>) -> f64 {
    response.im / response.norm_sqr().sqrt()
}

/// The minimum further delay, in samples, at which the response passes through -1. The undelayed loop has unit gain at
/// `unit_gain` and nowhere below.
fn delay_margin(chain: &SampledLoop<'_>, grid: &Grid, delay: f64, unit_gain: f64) -> f64 {
    /// Brackets are found in a few steps.
    const DELAY_STEPS_MAX: usize = 40;
    /// Of a sample.
    const DELAY_RESOLUTION_SAMPLES: f64 = 1e-10;
    // How a fraction of a sample is held changes the gain at high frequencies only: nothing crosses far below.
    let points = grid.from(0.5 * unit_gain);

    // Samples of delay that each frequency of unit gain still takes before -1, were the gain to stay.
    let left_at = |extra: f64| {
        let delayed = chain.with_delay(delay + extra);
        // The gain does not turn with the delay, so the grid need not be any finer for it.
        Sweep::along(points, delayed).crossings(gain).into_iter().map(move |angle| {
            let response = delayed.response(angle);
            ((-response.im).atan2(-response.re), angle)
        })
    };
    // From the start that may be all the way round; near the end, to either side.
    let first = left_at(0.0).map(|(phase, angle)| phase.rem_euclid(TAU) / angle).fold(f64::INFINITY, f64::min);
    let nearest = |extra: f64| {
        let left = left_at(extra).map(|(phase, angle)| phase / angle).min_by(|a, b| a.abs().total_cmp(&b.abs()));
        left.filter(|left| left.abs() > DELAY_RESOLUTION_SAMPLES).unwrap_or(0.0)
    };
    let mut low = (0.0, first);
    let mut high = (first, nearest(first));
    for _ in 0..DELAY_STEPS_MAX {
        if high.1 <= 0.0 {
            break;
        }
        low = high;
        let further = high.0 + 2.0 * high.1;
        high = (further, nearest(further));
    }
    if high.1 < 0.0 { root(nearest, low, high) } else { high.0 }
}

/// The part of `margin`, samples, that the eigenvalues confirm.
fn borne_out(chain: &SampledLoop<'_>, delay: f64, margin: f64) -> f64 {
    /// Delays are tried at these parts of a sample. Whole samples are among them: there the response at the Nyquist
    /// frequency is farthest along the axis.
    const TRIES_PER_SAMPLE: f64 = 4.0;
    /// So many of them: from there on a fraction of a sample changes little.
    const TRIES_MAX: u32 = 8;
    /// Halvings of such a part.
    const HALVINGS_MAX: usize = 40;
    let is_stable = |delay: &f64| chain.with_delay(*delay).spectral_radius() < 1.0;
    let below = (TRIES_PER_SAMPLE * delay).floor();
    let mut tried = (1..=TRIES_MAX)
        .map(|part| (below + f64::from(part)) / TRIES_PER_SAMPLE)
        .take_while(|tried| *tried < delay + margin);
    let Some(unstable) = tried.find(|tried| !is_stable(tried)) else { return margin };
    let (mut low, mut high) = (delay.max(unstable - 1.0 / TRIES_PER_SAMPLE), unstable);
    for _ in 0..HALVINGS_MAX {
        let middle = 0.5 * (low + high);
        if is_stable(&middle) { low = middle } else { high = middle }
    }
    low - delay
}

/// Frequencies, rising, with the law's part of the response: the same for every delay.
struct Grid {
    points: Vec<(f64, Response)>,
}

impl Grid {
    /// From `lowest` on, fine enough to follow a response that `delay` samples turn.
    fn measure(chain: &SampledLoop<'_>, delay: f64, lowest: f64) -> Self {
        let step = PI / (8.0 * (delay + 1.0));
        let below = core::iter::successors(Some(ANGLE_MIN_RAD / (1.0 + GRID_SPACING)), |angle| {
            Some(angle / (1.0 + GRID_SPACING))
        });
        let mut angles: Vec<f64> = below.take_while(|angle| *angle >= lowest).collect();
        angles.reverse();
        let mut angle = ANGLE_MIN_RAD;
        while angle < ANGLE_MAX_RAD {
            angles.push(angle);
            angle += step.min(GRID_SPACING * angle);
        }
        angles.push(ANGLE_MAX_RAD);
        Self { points: angles.into_iter().map(|angle| (angle, chain.law_response(angle))).collect() }
    }

    /// The part from the last frequency below `lowest` on.
    fn from(&self, lowest: f64) -> &[(f64, Response)] {
        let above = self.points.partition_point(|(angle, _)| *angle < lowest);
        &self.points[above.saturating_sub(1)..]
    }
}

/// The response of a loop along a grid.
struct Sweep<'a> {
    chain: SampledLoop<'a>,
    points: Vec<(f64, Complex<f64>)>,
}

impl<'a> Sweep<'a> {
    fn along(grid: &[(f64, Response)], chain: SampledLoop<'a>) -> Self {
        let points = grid.iter().map(|(angle, law)| (*angle, chain.response_with(*angle, law))).collect();
        Self { chain, points }
    }

    /// The frequencies, rising, at which `measure` of the response changes sign.
    fn crossings(&self, measure: impl Fn(Complex<f64>) -> f64) -> Vec<f64> {
        let values: Vec<(f64, f64)> =
            self.points.iter().map(|(angle, response)| (*angle, measure(*response))).collect();
        let at = |angle: f64| measure(self.chain.response(angle));
        let changes = |left: f64, right: f64| (left < 0.0) != (right < 0.0);
        let mut crossings: Vec<f64> = values
            .windows(2)
            .filter(|pair| changes(pair[0].1, pair[1].1))
            .map(|pair| root(at, pair[0], pair[1]))
            .collect();
        for three in values.windows(3) {
            let [left, middle, right] = [three[0], three[1], three[2]];
            let turns =
                middle.1.abs() <= left.1.abs() && middle.1.abs() < right.1.abs() && middle.1.abs() < TURN_BACK_MAX;
            if turns
                && !changes(left.1, middle.1)
                && !changes(middle.1, right.1)
                && let Some(beyond) = beyond(at, left, right)
            {
                crossings.extend([root(at, left, beyond), root(at, beyond, right)]);
            }
        }
        crossings.sort_unstable_by(f64::total_cmp);
        crossings
    }

    /// The factors on the gain nearest to one, below and above, that put the response through -1.
    fn critical_gains(&self) -> (f64, f64) {
        // At the Nyquist frequency the curve ends on the axis without crossing it.
        let end = core::iter::once(PI);
        self.crossings(phase)
            .into_iter()
            .chain(end)
            .map(|angle| -1.0 / self.chain.response(angle).re)
            .filter(|factor| *factor > 0.0)
            .fold(
                (0.0, f64::INFINITY),
                |(down, up), factor| {
                    if factor > 1.0 { (down, factor.min(up)) } else { (factor.max(down), up) }
                },
            )
    }
}

/// A point between two of the same sign where `value`, which turns back between them, has the other one.
fn beyond(value: impl Fn(f64) -> f64, left: (f64, f64), right: (f64, f64)) -> Option<(f64, f64)> {
    /// Each leaves two thirds of the interval.
    const GOLDEN_STEPS: usize = 16;
    let (mut low, mut high) = (left.0, right.0);
    for _ in 0..GOLDEN_STEPS {
        let third = (high - low) / 3.0;
        let [near, far] = [low + third, high - third].map(|angle| (angle, value(angle)));
        if let Some(beyond) = [near, far].into_iter().find(|point| (point.1 < 0.0) != (left.1 < 0.0)) {
            return Some(beyond);
        }
        if near.1.abs() < far.1.abs() { high = far.0 } else { low = near.0 }
    }
    None
}

/// The zero of `value` between two points of opposite sign: regula falsi, Illinois variant.
fn root(value: impl Fn(f64) -> f64, mut left: (f64, f64), mut right: (f64, f64)) -> f64 {
    /// Some eight are enough; the bound is for values that are noise.
    const ROOT_STEPS_MAX: usize = 60;
    /// Relative, of two estimates in a row.
    const ROOT_RESOLUTION: f64 = 1e-12;
    let (mut last, mut moved_right) = (left.0, None);
    for _ in 0..ROOT_STEPS_MAX {
        let middle = (left.0 * right.1 - right.0 * left.1) / (right.1 - left.1);
        if !(middle > left.0 && middle < right.0) {
            // Rounding put it onto the end that is the zero, however far the other one is.
            return if left.1.abs() < right.1.abs() { left.0 } else { right.0 };
        }
        if (middle - last).abs() < ROOT_RESOLUTION * middle {
            return middle;
        }
        last = middle;
        let at_middle = value(middle);
        if at_middle == 0.0 {
            return middle;
        }
        // An end that stays for a second time counts half, or it would stay for good.
        let moves_right = (at_middle < 0.0) == (right.1 < 0.0);
        let stays_again = moved_right == Some(moves_right);
        let (moving, staying) = if moves_right { (&mut right, &mut left) } else { (&mut left, &mut right) };
        *moving = (middle, at_middle);
        if stays_again {
            staying.1 *= 0.5;
        }
        moved_right = Some(moves_right);
    }
    0.5 * (left.0 + right.0)
}
