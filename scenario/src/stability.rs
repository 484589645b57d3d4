//! The requirements on the sampled loops: stable, with margins.
//!
//! A linear model without margin models a vehicle that does not exist. [`LoopMargin::FLYABLE_MIN`] is what a
//! configuration must have to fly; `host-sim tune` asks for more.

use crate::sampled_loop::{Axis, LoopReport};
use std::fmt;

/// How far a loop must be from instability, each margin alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopMargin {
    /// The factor on the loop's gain, above one, that it must bear; and its inverse below one.
    pub gain: f64,
    /// The additional delay that it must bear, s.
    pub delay: f64,
}

impl LoopMargin {
    /// The minimum margin to fly.
    ///
    /// *Gain, 1.5*: a loop's gain is proportional to the rotors' thrust coefficient and to one over the inertia. Data
    /// sheets, air density and a fresh or a worn propeller move the first by a fifth, an estimate of the inertia is
    /// rarely better than that: 1.2 * 1.2 = 1.44. Both are as often too small as too great, so the loop must bear 1 /
    /// 1.5 as well: a lateral loop whose attitude loop is too weak to carry it fails there.
    ///
    /// *Delay, 2 ms*: what no file states. A sample of a gyro read at 1 kHz is up to 1 ms old when a tick uses it; the
    /// tick's own work, the frame to the motor controllers and their next step take most of another.
    pub const FLYABLE_MIN: Self = Self { gain: 1.5, delay: 2e-3 };

    /// The maximum shortfall of `report`'s loop from this margin; none if it has all of it.
    #[must_use]
    pub fn lacking(&self, report: &LoopReport) -> Option<Lack> {
        let axis = report.axis;
        let Some(margins) = report.margins else {
            let what = Shortfall::Unstable { spectral_radius: report.spectral_radius };
            return Some(Lack { axis, missed: report.spectral_radius - 1.0, what });
        };
        let (gain, delay) = (self.gain, self.delay);
        let shortfalls = [
            (gain / margins.gain_up - 1.0, Shortfall::GainUp { found: margins.gain_up, required: gain }),
            (gain * margins.gain_down - 1.0, Shortfall::GainDown { found: margins.gain_down, required: 1.0 / gain }),
            (1.0 - margins.delay / delay, Shortfall::Delay { found: margins.delay, required: delay }),
        ];
        let (missed, what) = shortfalls.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        (missed > 0.0).then_some(Lack { axis, missed, what })
    }

    /// The shortfall of the first of `reports` that has one; an unstable loop counts before a weak one.
    #[must_use]
    pub fn first_lacking(&self, reports: &[LoopReport]) -> Option<Lack> {
        let unstable = reports.iter().filter(|report| report.margins.is_none());
        unstable.chain(reports).find_map(|report| self.lacking(report))
    }
}

/// A loop without the required margin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lack {
    /// Which loop.
    pub axis: Axis,
    /// By how much it misses, relative to the requirement; above zero.
    pub missed: f64,
    /// Its shortfall.
    pub what: Shortfall,
}

/// A loop's shortfall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shortfall {
    /// It is unstable as it is.
    Unstable {
        /// Growth of an error per sample.
        spectral_radius: f64,
    },
    /// Too little more gain destabilises it.
    GainUp {
        /// The factor that does.
        found: f64,
        /// The factor that it must bear.
        required: f64,
    },
    /// Too little less gain destabilises it.
    GainDown {
        /// The factor that does.
        found: f64,
        /// The factor that it must bear.
        required: f64,
    },
    /// Too little delay destabilises it.
    Delay {
        /// The delay that does, s.
        found: f64,
        /// The delay that it must bear, s.
        required: f64,
    },
}

impl fmt::Display for Lack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "sampled loop {}: ", self.axis.name())?;
        match self.what {
            Shortfall::Unstable { spectral_radius } => {
                write!(f, "unstable, spectral radius {spectral_radius:.4} per sample, must be below 1")
            }
            Shortfall::GainUp { found, required } => {
                write!(f, "unstable at {found:.2} times its gain, must be stable up to {required:.2} times")
            }
            Shortfall::GainDown { found, required } => {
                write!(f, "unstable at {found:.2} times its gain, must be stable down to {required:.2} times")
            }
            Shortfall::Delay { found, required } => {
                write!(f, "unstable with {:.1} ms more delay, must bear {:.1} ms", 1e3 * found, 1e3 * required)
            }
        }
    }
}

#[cfg(test)]
mod tests;
