//! An estimate of what the rotors deliver of what is commanded: battery, propellers, mass. Section 7 of
//! `docs/extended-law.md`.
//!
//! Rotors are commanded f / s. With F the mean of what was commanded, through lag and delay, and y = v_z' + g, the vertical
//! equation is y = s c with c = b_z F / m, and s is regressed on it:
//!
//! s += clip(gamma h (y - s c) c / ((F / m)^2 + c_0^2); ± r h), s in [s_lo, s_hi].
//!
//! Only the vertical equation: along the thrust axis wind across would leak in. A steady wind along the vertical reads as scale.

use super::parameters::EstimateParameters;
use crate::math;

/// c_0, m/s^2: below it a thrust says little about the scale.
pub const LEAST_THRUST: f32 = 2.0;

/// r, 1/s: how fast the scale may change at most.
const RATE_MAX: f32 = 0.2;

/// The estimate's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThrustScale {
    /// gamma h.
    gain: f32,
    /// r h.
    most: f32,
    least: f32,
    greatest: f32,
}

impl ThrustScale {
    /// For steps of `period`, s.
    #[must_use]
    pub fn new(parameters: &EstimateParameters, period: f32) -> Self {
        let EstimateParameters { scale_least, scale_greatest, scale_rate, .. } = *parameters;
        Self { gain: scale_rate * period, most: RATE_MAX * period, least: scale_least, greatest: scale_greatest }
    }

    /// The scale after an interval with the mean of the commanded thrust per mass `thrust` = F / m, m/s^2, its vertical part
    /// `upwards` = b_z F / m, and the vertical acceleration less gravity's, `lift` = v_z' + g, m/s^2.
    #[must_use]
    pub fn learnt(&self, scale: f32, thrust: f32, upwards: f32, lift: f32) -> f32 {
        let weight = self.gain * upwards / (thrust * thrust + LEAST_THRUST * LEAST_THRUST);
        let step = math::within(weight * (lift - scale * upwards), self.most);
        math::between(scale + step, self.least, self.greatest)
    }
}
