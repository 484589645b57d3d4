//! The thrust scale: an estimate of the delivered thrust over the commanded thrust (battery, propellers, mass). Section
//! 9 of `docs/extended-law.md`.
//!
//! In steady flight a wrong scale and a force look alike: the force estimate carries both. The scale is learnt from
//! variations alone. With y = v' + g e3 + kappa v and f = bbar F / m, both less their slow averages,
//!
//! ```text
//! y - ybar = s (f - fbar) for any constant force
//! s += gamma_s h (dy - s df) . df / (|df|^2 + c_0^2),   s in [s_lo, s_hi]
//! ```
//!
//! So |s - s*| never rises while force and scale are constant, and s stands still where thrust does. Rotors are
//! commanded f / s.

use super::parameters::ExtendedParameters;
use crate::math;
use nalgebra::Vector3;

/// c_0, m/s^2: variations below it carry little information about the scale.
const VARIATION_MIN_M_PER_S2: f64 = 2.0;

/// Bandwidth of the slow averages, 1/s.
const AVERAGES_BANDWIDTH_PER_S: f64 = 0.7;

/// The scale and the averages behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaleEstimate {
    /// ybar and fbar, m/s^2. The first interval starts them: any other start would look like a variation.
    pub slow: Option<[Vector3<f32>; 2]>,
    /// s.
    pub scale: f32,
}

impl ScaleEstimate {
    /// A known scale.
    #[must_use]
    pub fn at(scale: f32) -> Self {
        Self { slow: None, scale }
    }
}

/// The estimate's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThrustScale {
    /// gamma_s h.
    gain: f32,
    /// 1 - e^(-h AVERAGES_BANDWIDTH_PER_S).
    slow: f32,
    /// c_0^2 / e^(-2 h AVERAGES_BANDWIDTH_PER_S), m^2/s^4.
    least_square: f32,
    least: f32,
    greatest: f32,
}

impl ThrustScale {
    /// For steps of `period`, s.
    #[must_use]
    pub fn new(parameters: &ExtendedParameters, period: f32) -> Self {
        let kept = math::exp(-AVERAGES_BANDWIDTH_PER_S * f64::from(period));
        Self {
            gain: parameters.scale_rate * period,
            slow: (1.0 - kept) as f32,
            least_square: (VARIATION_MIN_M_PER_S2 * VARIATION_MIN_M_PER_S2 / (kept * kept)) as f32,
            least: parameters.scale_least,
            greatest: parameters.scale_greatest,
        }
    }

    /// The estimate after an interval in which `made` was observed and `commanded` acted, both m/s^2, world frame.
    #[must_use]
    #[inline(always)] // see position.rs
    pub fn updated(&self, estimate: &ScaleEstimate, made: &Vector3<f32>, commanded: &Vector3<f32>) -> ScaleEstimate {
        let scale = estimate.scale;
        let Some([slow_made, slow_commanded]) = estimate.slow else {
            return ScaleEstimate { slow: Some([*made, *commanded]), scale };
        };
        // From the averages before this interval; those with it are e^(-h AVERAGES_BANDWIDTH_PER_S) times as far, which
        // is in c_0.
        let (made, commanded) = (made - slow_made, commanded - slow_commanded);
        let square = commanded.norm_squared();
        let step = self.gain * (made.dot(&commanded) - scale * square) / (square + self.least_square);
        ScaleEstimate {
            slow: Some([slow_made + made * self.slow, slow_commanded + commanded * self.slow]),
            scale: math::clamp(scale + step, self.least, self.greatest),
        }
    }
}
