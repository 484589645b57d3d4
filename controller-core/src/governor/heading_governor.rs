//! The heading's own governor: the same ideas on the circle, to psi''.
//!
//! Command: phase x_0 and rate u, |u| <= R, changing by at most B a second. One moving average of N ticks and a cubic
//! spline with control points Psi (differences D1, D2; T the period) make psi'' continuous:
//!
//! psi = Psi + D2/6,  T psi' = D1,  T^2 psi'' = D2.
//!
//! Bounds: |nu''|^2 = psi''^2 + psi'^4 is convex in (psi', psi''), so where each commanded pair (u, u') satisfies
//! u'^2 + u^4 <= K_nu''^2, the averages do. With R = min(K_nu', 0.857 sqrt(K_nu'')), B = sqrt(K_nu''^2 - R^4): that
//! share makes a half turn, pi/R + R/B, as short as this budget permits.
//!
//! A turn is 2^44 integer units: phases wrap where the circle does, sums are exact, and the way to an angle is the
//! shorter one.

use super::braking::{BRAKING_SHARE, approach_speed};
use super::limits::GovernorLimits;
use super::windows::{ROUNDING_MARGIN, ticks};
use crate::error::{ParameterError, Reason, require};
use crate::heading::Heading;
use crate::math::{self, f32_to_i64, i64_to_f32};
use crate::reference::ReferenceBounds;
use nalgebra::Vector2;

/// log2 of the units in a turn, and what is left of a 64-bit phase.
const TURN_BITS: u32 = 44;
const SPARE_BITS: u32 = 64 - TURN_BITS;

/// Units in a radian.
const UNITS_PER_RAD: f32 = (1_u64 << TURN_BITS) as f32 / core::f32::consts::TAU;

/// Longest average, ticks.
const TURN_HISTORY_TICKS: usize = 64;

/// The share of sqrt(K_nu'') that makes the shortest half turn: the minimum of pi/r + r/sqrt(1-r^4).
const RATE_SHARE: f32 = 0.857;

/// What the heading is to do: be at a phase (units) that moves, or, without one, keep turning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HeadingGoal {
    pub phase: Option<i64>,
    /// Units a tick.
    pub rate: i64,
}

impl HeadingGoal {
    /// Come to rest.
    pub const STOP: Self = Self { phase: None, rate: 0 };
}

/// Command, average and spline of the heading.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HeadingGovernor {
    history: [i64; TURN_HISTORY_TICKS],
    newest: usize,
    length: usize,
    /// By how many ticks a steady turn comes out late.
    delay: f32,
    /// What turns N times a difference into rad/s, and one over the period.
    unit: f32,
    per_period: f32,
    /// R and B in units a tick (squared).
    fastest: i64,
    strongest: i64,
    commanded: i64,
    rate: i64,
    /// N times the newest first, second and third difference of Psi.
    first: i64,
    second: i64,
    third: i64,
    /// The last Psi but one, the knot's: whole units, and N times the rest, which is a few units at most.
    place: i64,
    part: i64,
    /// One over N, not too small: so what is a whole number of units goes over to the place, all of it.
    per_length: f32,
}

impl HeadingGovernor {
    /// Not designed yet, at rest along world x.
    pub const NONE: Self = Self {
        history: [0; TURN_HISTORY_TICKS],
        newest: 0,
        length: 0,
        delay: 0.0,
        unit: 0.0,
        per_period: 0.0,
        fastest: 0,
        strongest: 0,
        commanded: 0,
        rate: 0,
        first: 0,
        second: 0,
        third: 0,
        place: 0,
        part: 0,
        per_length: 0.0,
    };

    /// Prepares for `bounds` that are positive.
    pub fn design(
        &mut self,
        bounds: &ReferenceBounds,
        limits: &GovernorLimits,
        period: f32,
    ) -> Result<(), ParameterError> {
        let length = ticks(limits.heading_ramp, period);
        require(
            length <= TURN_HISTORY_TICKS,
            "governor.heading_ramp",
            Reason::Above(TURN_HISTORY_TICKS as f32 * period),
        )?;
        let second = bounds.heading_second_derivative * (1.0 - ROUNDING_MARGIN);
        let rate = (bounds.heading_rate * (1.0 - ROUNDING_MARGIN)).min(RATE_SHARE * math::sqrt(second));
        let strongest = strongest_at(rate, bounds, period);
        require(strongest > 0, "reference_bounds.heading_second_derivative", Reason::NotPositive)?;
        self.length = length;
        self.per_length = (1.0 / length as f32).next_up();
        self.delay = (length as f32 - 1.0) * 0.5 + 1.0;
        self.unit = 1.0 / (UNITS_PER_RAD * length as f32 * period);
        self.per_period = 1.0 / period;
        self.fastest = units(rate, period);
        self.strongest = strongest;
        Ok(())
    }

    /// Starts at rest at `phase`, units.
    pub fn start(&mut self, phase: i64) {
        self.history.fill(0);
        (self.rate, self.first, self.second, self.third, self.part) = (0, 0, 0, 0, 0);
        (self.commanded, self.place) = (phase, phase);
    }

    /// Advances by one tick towards `goal`.
    pub fn tick(&mut self, goal: &HeadingGoal) {
        self.push(self.command(goal));
    }

    /// The commanded acceleration towards `goal`, units per tick squared.
    fn command(&self, goal: &HeadingGoal) -> i64 {
        // Far from 64 bits: a rate is below 2^58 for every setpoint, and half a turn is 2^43.
        let wanted = goal.rate + goal.phase.map_or(0, |phase| self.approach(phase));
        // Not `clamp`, which may panic.
        let wanted = wanted.min(self.fastest).max(-self.fastest);
        (wanted - self.rate).min(self.strongest).max(-self.strongest)
    }

    /// The greatest rate towards `phase`, the shorter way round, from which braking ends on it.
    fn approach(&self, phase: i64) -> i64 {
        let error = phase.wrapping_sub(self.commanded).wrapping_shl(SPARE_BITS) >> SPARE_BITS;
        let strongest = BRAKING_SHARE * i64_to_f32(self.strongest);
        let distance = i64_to_f32(error) / strongest;
        if distance.abs() <= 1.0 {
            return error;
        }
        f32_to_i64(strongest * approach_speed(distance.abs()).copysign(distance))
    }

    fn push(&mut self, acceleration: i64) {
        self.newest = (self.newest + 1) % TURN_HISTORY_TICKS;
        let oldest = (self.newest + TURN_HISTORY_TICKS - self.length) % TURN_HISTORY_TICKS;
        // Read first: a window as long as the history drops what is about to be overwritten.
        let dropped = self.history.get(oldest).copied().unwrap_or(0);
        if let Some(slot) = self.history.get_mut(self.newest) {
            *slot = acceleration;
        }
        self.third = acceleration - dropped;
        self.second += self.third;
        self.first += self.second;
        self.rate += acceleration;
        self.commanded = self.commanded.wrapping_add(self.rate);
        self.part += self.first - self.second;
        let units = f32_to_i64(i64_to_f32(self.part) * self.per_length);
        self.place = self.place.wrapping_add(units);
        self.part -= units * self.length as i64;
    }

    /// Whether nothing turns and `goal` is at rest too.
    pub fn at_rest(&self, goal: &HeadingGoal) -> bool {
        let behind = self.commanded.wrapping_sub(self.place).wrapping_mul(self.length as i64) - self.part;
        let still = self.rate == 0 && behind == 0 && self.first == 0 && self.second == 0 && self.third == 0;
        still && self.command(goal) == 0
    }

    /// By how many ticks a steady turn comes out late.
    pub fn delay(&self) -> f32 {
        self.delay
    }

    /// The heading `back` seconds before the knot at hand, at most the time between two:
    /// D0 - s (D1 - s/2 (D2 - s/3 D3)), and its derivatives, with s in knots.
    pub fn heading(&self, back: f32) -> Heading {
        let (second, third, s) = (i64_to_f32(self.second), i64_to_f32(self.third), back * self.per_period);
        let first = i64_to_f32(2 * self.first - self.second) * 0.5;
        let earlier = s * (first - 0.5 * s * (second - s / 3.0 * third));
        let phase =
            self.place.wrapping_add(f32_to_i64((i64_to_f32(self.part) + second / 6.0 - earlier) * self.per_length));
        let rate = (first - s * (second - 0.5 * s * third)) * self.unit;
        Heading::from_phase((phase as u64) << SPARE_BITS, rate, (second - s * third) * self.unit * self.per_period)
    }
}

/// The B that a rate (rad/s) leaves, units per tick squared.
fn strongest_at(rate: f32, bounds: &ReferenceBounds, period: f32) -> i64 {
    let second = bounds.heading_second_derivative * (1.0 - ROUNDING_MARGIN);
    let left = (second * second - rate * rate * rate * rate).max(0.0);
    (math::sqrt(left) * period * period * UNITS_PER_RAD) as i64
}

/// An angle (rad) as a phase in units, to 2^-34 turns for any angle that a setpoint may have.
///
/// In fixed point: the angle in 2^-32 rad is exact (or smaller than that), and so is, on the circle, its product with
/// the whole part of the 2^64-ths of a turn in it.
pub(super) fn phase(angle: f32) -> i64 {
    /// 2^32 / (2 pi): its whole part, and 2^22 times the rest.
    const TURNS_PER_RAD_WHOLE: i64 = 683_565_275;
    const TURNS_PER_RAD_FRACTION: i64 = 2_417_729;
    let fine = (angle * 4_294_967_296.0) as i64;
    fine.wrapping_mul(TURNS_PER_RAD_WHOLE).wrapping_add((fine >> 22).wrapping_mul(TURNS_PER_RAD_FRACTION)) >> SPARE_BITS
}

/// Where a heading points, in units, to single precision.
///
/// From the middle of its quadrant, each step takes delta to delta - sin delta: 0.79, 0.078, 8e-5 rad, nothing.
pub(super) fn nearest_phase(heading: &Heading) -> i64 {
    let target = heading.direction();
    let eighths = if target.x >= 0.0 { 1 } else { 3 };
    let mut phase = eighths << (TURN_BITS - 3);
    if target.y < 0.0 {
        phase = -phase;
    }
    for _ in 0..3 {
        let here = direction(phase);
        phase += ((here.x * target.y - here.y * target.x) * UNITS_PER_RAD) as i64;
    }
    phase
}

/// The unit vector that a phase in units points along.
fn direction(phase: i64) -> Vector2<f32> {
    let (sin, cos) = math::sin_cos_turns((phase as u64) << SPARE_BITS);
    Vector2::new(cos, sin)
}

/// A rate (rad/s) in units a tick; an angle with `period` one.
pub(super) fn units(rate: f32, period: f32) -> i64 {
    (rate * period * UNITS_PER_RAD) as i64
}

#[cfg(test)]
mod tests {
    use super::super::tests::Random;
    use super::*;
    use crate::reference::phase::turns;

    #[test]
    fn an_angle_is_a_phase_however_often_it_goes_round() {
        let mut random = Random::new(8);
        for _ in 0..100_000 {
            let angle = random.signed() * 10.0_f32.powf(9.0 * random.unit() - 3.0);
            let miss = (phase(angle) << SPARE_BITS).wrapping_sub(turns(f64::from(angle)) as i64);
            assert!(miss.abs() <= 1 << 30, "{angle} rad: off by {miss}");
        }
    }
}
