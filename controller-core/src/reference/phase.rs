//! A phase that a month of uptime does not blur.
//!
//! omega t + phi grows without limit, so in floating point it loses a bit of precision each time it doubles. Here a
//! full turn is 2^64: the rate is an integer count of 2^-64 turns per microsecond and the product with an integer time
//! wraps around exactly where the circle does. What remains is the rounding of the rate, at most 2^-65 turns a
//! microsecond: after 30 days 4.5e-7 rad.

use crate::error::{ParameterError, Reason, require};
use crate::math;
use core::f64::consts::TAU;

/// One turn, 2^64, as a floating-point number.
const UNITS_PER_TURN: f64 = 18_446_744_073_709_551_616.0;

/// omega t + phi on the circle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Phase {
    per_microsecond: i64,
    offset: u64,
}

impl Phase {
    /// The greatest |omega|, rad/s: far above anything a vehicle can follow, far below what would alias.
    pub const RATE_MAX_RAD_PER_S: f64 = 1e5;

    /// From omega in rad/s and phi in rad.
    ///
    /// # Errors
    /// Names `rate_field` or `offset_field` if the number is not finite or |omega| exceeds
    /// [`Self::RATE_MAX_RAD_PER_S`].
    pub fn new(
        rate: f64,
        offset: f64,
        rate_field: &'static str,
        offset_field: &'static str,
    ) -> Result<Self, ParameterError> {
        require(rate.is_finite(), rate_field, Reason::NotFinite)?;
        require(offset.is_finite(), offset_field, Reason::NotFinite)?;
        require(rate.abs() < Self::RATE_MAX_RAD_PER_S, rate_field, Reason::NotBelow(Self::RATE_MAX_RAD_PER_S as f32))?;
        let per_microsecond = math::round(rate / TAU * 1e-6 * UNITS_PER_TURN) as i64;
        Ok(Self { per_microsecond, offset: turns(offset) })
    }

    /// The phase at `time_us`, in units of 2^-64 turns.
    pub fn at(&self, time_us: u64) -> u64 {
        self.offset.wrapping_add((self.per_microsecond as u64).wrapping_mul(time_us))
    }
}

/// An angle in radians as 2^-64 turns, modulo a full one.
pub fn turns(angle: f64) -> u64 {
    let turns = angle / TAU;
    let fraction = turns - math::floor(turns);
    // 2^64 itself would saturate rather than wrap: count half as many units twice the size, then double on the circle.
    (math::round(fraction * (UNITS_PER_TURN / 2.0)) as u64).wrapping_mul(2)
}

/// A swing of a few turns, in radians, as 2^-64 turns: cheap enough for a tick, exact to 2^-32 turns.
pub(crate) fn swing(angle: f32) -> u64 {
    /// 2^32 / (2 pi).
    const UNITS_PER_RAD: f32 = 683_565_275.576_431_6;
    ((angle * UNITS_PER_RAD) as i64 as u64).wrapping_shl(32)
}

#[cfg(test)]
mod tests;
