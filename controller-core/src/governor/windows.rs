//! From bounds to window lengths and integer scales: where the governor's bounds are made to hold.
//!
//! The commanded acceleration alpha stays in the cylinder C = {|alpha_12| <= A_12, |alpha_3| <= A_3}, whose diameter is
//! D = 2 sqrt(A_12^2 + A_3^2). Three moving averages of lengths T_1, T_2, T_3 follow. An average is a convex
//! combination, so it stays in C; and
//!
//! - jerk is (alpha(t) - alpha(t-T_i))/T_i averaged by the other two, for each i: |j| <= D / max(T_1, T_2);
//! - snap is a second difference, (alpha(t) - alpha(t-T_1)) - (alpha(t-T_2) - alpha(t-T_1-T_2)), over T_1 T_2 and
//!   averaged by the third: |s| <= 2D / (T_1 T_2);
//! - the third window bounds how fast snap itself moves: by at most 2 K_s in T_3.
//!
//! So T_1 = max(D/K_j, sqrt(2D/K_s)), T_2 = 2D/(K_s T_1): the least T_1 + T_2 that satisfies both. Should the windows
//! not fit the memory, the authority A is lowered until they do: slower, never beyond a bound.

use super::limits::{GovernorLimits, HISTORY_TICKS, LAST_AVERAGE_MAX_TICKS, SPEED_RANGE_M_PER_S};
use crate::error::{ParameterError, Reason, require};
use crate::math;
use crate::reference::ReferenceBounds;

/// Relative room left below each bound for single-precision rounding of the emitted numbers (about 20 roundings of
/// 6e-8 lie between an exact integer and a Euclidean norm).
pub(super) const ROUNDING_MARGIN: f32 = 4e-6;

/// Greatest integer value of a commanded acceleration: single precision has every whole number up to it, a comb of four
/// still fits 32 bits, three averages 64.
const LEVEL_MAX: f32 = 16_777_216.0;

/// Fewest integer steps from zero to an acceleration bound.
const LEVELS_MIN: f32 = 64.0;

/// The finest length unit is 2^-38 m: positions up to [`super::POSITION_RANGE_M`] still fit 64 bits.
const UNIT_EXPONENT_MAX: u32 = 38;

/// Windows, and the integer scales that go with them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Windows {
    /// Lengths of the three averages, in ticks.
    pub lengths: [usize; 3],
    /// A_12 in length units per tick squared, a whole number.
    pub horizontal: f32,
    /// A_3 in length units per tick squared, a whole number.
    pub vertical: f32,
    /// Length units in a metre, a power of two: scaling by it is exact.
    pub per_metre: f32,
}

impl Windows {
    /// Not designed yet.
    pub const NONE: Self = Self { lengths: [0; 3], horizontal: 0.0, vertical: 0.0, per_metre: 0.0 };

    /// The windows for `bounds`, all of them positive, at `period` seconds a tick.
    pub fn design(bounds: &ReferenceBounds, limits: &GovernorLimits, period: f32) -> Result<Self, ParameterError> {
        let third = (2 * ticks(0.5 * limits.snap_ramp, period)).max(2);
        require(
            third <= LAST_AVERAGE_MAX_TICKS,
            "governor.snap_ramp",
            Reason::Above(LAST_AVERAGE_MAX_TICKS as f32 * period),
        )?;
        let mut share = 1.0 - ROUNDING_MARGIN;
        let mut fitted = Self::lengths(bounds, share, period, third);
        for _ in 0..FITTING_STEPS_MAX {
            if fitted.is_some() {
                break;
            }
            share *= 0.97;
            fitted = Self::lengths(bounds, share, period, third);
        }
        let lengths = fitted.ok_or(ParameterError { field: "reference_bounds.snap", reason: Reason::NotPositive })?;
        Self::scaled(bounds, share, period, lengths)
    }

    /// Window lengths for a share of the acceleration bounds, if they fit the history.
    fn lengths(bounds: &ReferenceBounds, share: f32, period: f32, third: usize) -> Option<[usize; 3]> {
        let (horizontal, vertical) = (bounds.horizontal_acceleration, bounds.vertical_acceleration);
        let diameter = 2.0 * share * math::sqrt(horizontal * horizontal + vertical * vertical);
        // Bounds shrunk by the room for rounding, as the authority is.
        let (jerk, snap) = (bounds.jerk * (1.0 - ROUNDING_MARGIN), bounds.snap * (1.0 - ROUNDING_MARGIN));
        let first = ticks((diameter / jerk).max(math::sqrt(2.0 * diameter / snap)), period);
        let second = ticks(2.0 * diameter / (snap * first as f32 * period), period);
        (first.saturating_add(second).saturating_add(third) < HISTORY_TICKS).then_some([first, second, third])
    }

    /// Chooses the length unit: as fine as the integers allow.
    fn scaled(bounds: &ReferenceBounds, share: f32, period: f32, lengths: [usize; 3]) -> Result<Self, ParameterError> {
        let horizontal = bounds.horizontal_acceleration * share * period * period;
        let vertical = bounds.vertical_acceleration * share * period * period;
        let total: usize = lengths.iter().sum();
        let product: usize = lengths.iter().product();
        let (product, total) = (product as f32, total as f32);
        // The greatest sums: of speed, and of what a steady acceleration trails by. Kept below 2^61.
        let sums =
            (4.0 * SPEED_RANGE_M_PER_S * period * product).max(horizontal.max(vertical) * product * total * total);
        let mut per_metre = (1_u64 << UNIT_EXPONENT_MAX) as f32;
        for _ in 0..UNIT_EXPONENT_MAX {
            if horizontal.max(vertical) * per_metre <= LEVEL_MAX && sums * per_metre < (1_u64 << 61) as f32 {
                break;
            }
            per_metre *= 0.5;
        }
        for (level, field) in [
            (horizontal, "reference_bounds.horizontal_acceleration"),
            (vertical, "reference_bounds.vertical_acceleration"),
        ] {
            let min = LEVELS_MIN / (per_metre * share * period * period);
            require(level * per_metre >= LEVELS_MIN, field, Reason::Below(min))?;
        }
        // Converting to an integer rounds towards zero.
        let whole = |level: f32| (level * per_metre) as u32 as f32;
        Ok(Self { lengths, horizontal: whole(horizontal), vertical: whole(vertical), per_metre })
    }

    /// The product of the lengths: what sums are divided by to become averages.
    pub fn product(&self) -> i64 {
        self.lengths.iter().map(|&length| length as i64).product()
    }

    /// The product of the first two: what the head's sums are divided by.
    pub fn head(&self) -> i64 {
        let [first, second, _] = self.lengths;
        first as i64 * second as i64
    }

    /// What the three span together, ticks.
    pub fn span(&self) -> i64 {
        self.lengths.iter().map(|&length| length as i64).sum()
    }

    /// By how many ticks a steady motion comes out late.
    pub fn delay(&self) -> f32 {
        let total: usize = self.lengths.iter().sum();
        // A window of N ticks delays by (N-1)/2; the spline's newest control point lies two ticks ahead of its output.
        (total as f32 - 3.0) * 0.5 + 2.0
    }

    /// The spread (variance, in ticks squared) of the averages' weights, the quintic spline's included.
    pub fn variance(&self) -> f32 {
        self.lengths.iter().map(|&length| (length as f32 * length as f32 - 1.0) / 12.0).sum::<f32>() + 0.5
    }
}

/// How often the authority may be lowered by 3 %: down to about 2e-4 of the bound.
const FITTING_STEPS_MAX: usize = 280;

/// The least whole number of ticks that lasts `duration` seconds, at least one.
pub(super) fn ticks(duration: f32, period: f32) -> usize {
    let exact = duration / period * (1.0 + ROUNDING_MARGIN);
    let whole = exact as usize;
    whole.saturating_add(usize::from((whole as f32) < exact)).max(1)
}

#[cfg(test)]
mod tests;
