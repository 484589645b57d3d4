//! How much gain or delay a stable loop can take before an eigenvalue reaches the unit circle.
//!
//! An eigenvalue e^(i angle) appears where the loop's response passes through -1. Scaling the loop's gain by kappa moves
//! every point of the response along its ray, so the critical kappa are -1 / L at the crossings of the negative real
//! axis. More delay turns it clockwise: at a frequency where |L| = 1, D samples take angle D of its phase. A held command
//! makes that exact for whole samples only, so the delay is found by steps, each of which takes what phase is left.
//!
//! The response is followed on a logarithmic grid with [`POINTS`] points; a loop that crosses an axis twice between
//! neighbours, so a near-tangency within 10 % of frequency, is not seen to.

use super::chain::SampledLoop;
use core::f64::consts::{PI, TAU};
use nalgebra::Complex;

/// Points of the frequency grid.
const POINTS: usize = 120;

/// The lowest frequency looked at, as a part of the Nyquist frequency: below the slowest position loop one would fly.
const LOWEST: f64 = 1e-5;

/// The margins of a stable loop, in samples and radians per sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct SampleMargins {
    /// Least factor above one at which stability is lost; infinite if none.
    pub gain_up: f64,
    /// Greatest factor below one at which stability is lost; zero if none.
    pub gain_down: f64,
    /// Least further delay at which stability is lost.
    pub delay: f64,
    /// Highest frequency at which the loop's gain is one.
    pub crossover: f64,
}

/// The margins of `chain`, which is stable with its commands `delay` samples late.
pub(super) fn margins(chain: &SampledLoop, delay: f64) -> SampleMargins {
    let sweep = Sweep::of(chain);
    let unit_gain = sweep.crossings(gain);
    let (gain_down, gain_up) = sweep.critical_gains();
    SampleMargins {
        gain_up,
        gain_down,
        delay: delay_margin(chain, delay, &unit_gain),
        crossover: unit_gain.last().copied().unwrap_or(PI),
    }
}

/// Positive where the loop amplifies.
fn gain(response: Complex<f64>) -> f64 {
    response.norm_sqr().ln()
}

/// The least further delay, in samples, at which the response passes through -1; `unit_gain` are its frequencies now.
fn delay_margin(chain: &SampledLoop, delay: f64, unit_gain: &[f64]) -> f64 {
    /// Each step leaves a small part of the phase before it; this is far more than they need.
    const STEPS: usize = 40;
    /// Of a sample.
    const RESOLUTION: f64 = 1e-8;

    // What each frequency has left before -1, in samples: first all the way round, then to either side.
    let phase_to_critical = |chain: &SampledLoop, angle: f64| {
        let response = chain.response(angle);
        (-response.im).atan2(-response.re)
    };
    let mut extra = unit_gain
        .iter()
        .map(|angle| phase_to_critical(chain, *angle).rem_euclid(TAU) / angle)
        .fold(f64::INFINITY, f64::min);
    for _ in 0..STEPS {
        let delayed = chain.with_delay(delay + extra);
        let left = Sweep::of(&delayed)
            .crossings(gain)
            .into_iter()
            .map(|angle| phase_to_critical(&delayed, angle) / angle)
            .min_by(|a, b| a.abs().total_cmp(&b.abs()))
            .unwrap_or(0.0);
        extra = (extra + left).max(0.0);
        if left.abs() < RESOLUTION {
            break;
        }
    }
    extra
}

/// The response along the frequency grid.
struct Sweep<'a> {
    chain: &'a SampledLoop,
    points: [(f64, Complex<f64>); POINTS],
}

impl<'a> Sweep<'a> {
    fn of(chain: &'a SampledLoop) -> Self {
        let ratio = LOWEST.powf(1.0 / (POINTS - 1) as f64);
        let mut angle = PI;
        let mut points = [(0.0, Complex::new(0.0, 0.0)); POINTS];
        for point in points.iter_mut().rev() {
            *point = (angle, chain.response(angle));
            angle *= ratio;
        }
        Self { chain, points }
    }

    /// The frequencies, rising, at which `measure` of the response changes sign.
    fn crossings(&self, measure: impl Fn(Complex<f64>) -> f64) -> Vec<f64> {
        self.points
            .windows(2)
            .filter_map(|pair| {
                let [(left, at_left), (right, at_right)] = [pair[0], pair[1]];
                let (at_left, at_right) = (measure(at_left), measure(at_right));
                let changes = (at_left < 0.0) != (at_right < 0.0);
                changes.then(|| root(|angle| measure(self.chain.response(angle)), (left, at_left), (right, at_right)))
            })
            .collect()
    }

    /// The factors on the gain nearest to one, below and above, that put the response through -1.
    fn critical_gains(&self) -> (f64, f64) {
        // At the Nyquist frequency the response is real: there the curve ends on the axis without crossing it.
        let end = core::iter::once(PI);
        self.crossings(|response| response.im)
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

/// The zero of `value` between two points of opposite sign: regula falsi, Illinois variant.
fn root(value: impl Fn(f64) -> f64, mut left: (f64, f64), mut right: (f64, f64)) -> f64 {
    /// Some eight are enough to the last bit; the bound is for values that are noise.
    const STEPS: usize = 60;
    for _ in 0..STEPS {
        let middle = (left.0 * right.1 - right.0 * left.1) / (right.1 - left.1);
        if !(middle > left.0 && middle < right.0) {
            break;
        }
        let at_middle = value(middle);
        if at_middle == 0.0 {
            return middle;
        }
        if (at_middle < 0.0) == (right.1 < 0.0) {
            right = (middle, at_middle);
            left.1 *= 0.5;
        } else {
            left = (middle, at_middle);
            right.1 *= 0.5;
        }
    }
    0.5 * (left.0 + right.0)
}
