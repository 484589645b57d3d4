//! The heading's own governor: the same ideas on the circle, to psi''.
//!
//! Command: phase x_0 and rate u, |u| <= R, changing by at most B a second. One moving average of N ticks and a cubic
//! spline with control points Psi (differences D1, D2; T the period) make psi'' continuous:
//!
//! psi = Psi + D2/6,  T psi' = D1,  T^2 psi'' = D2.
//!
//! Bounds: |nu''|^2 = psi''^2 + psi'^4 is convex in (psi', psi''), so where each commanded pair (u, u') satisfies
//! u'^2 + u^4 <= K_nu''^2, the averages do. With R = min(K_nu', 0.857 sqrt(K_nu'')), B = sqrt(K_nu''^2 - R^4): that share
//! makes a half turn, pi/R + R/B, as short as this budget permits. A start faster than R slows down with the B its own
//! rate leaves.
//!
//! A turn is 2^44 integer units: phases wrap where the circle does, sums are exact, and the way to an angle is the
//! shorter one.

use super::braking::{BRAKING_SHARE, approach_speed};
use super::bridge::TurnBridge;
use super::windows::{ROUNDING_ROOM, ticks};
use super::{GovernorError, GovernorLimits};
use crate::error::{ParameterError, Reason, require, require_positive};
use crate::heading::Heading;
use crate::math;
use crate::reference::ReferenceBounds;
use crate::reference::phase::turns;

/// log2 of the units in a turn, and what is left of a 64-bit phase.
const TURN_BITS: u32 = 44;
const SPARE_BITS: u32 = 64 - TURN_BITS;

/// Units in a radian.
const PER_RADIAN: f32 = (1_u64 << TURN_BITS) as f32 / core::f32::consts::TAU;

/// Longest average, ticks.
const TURN_HISTORY: usize = 64;

/// The share of sqrt(K_nu'') that makes the shortest half turn: the minimum of pi/r + r/sqrt(1-r^4).
const RATE_SHARE: f32 = 0.857;

/// What the heading is to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum TurnGoal {
    /// Come to rest.
    Stop,
    /// Turn to a phase (units) that moves at a rate (units a tick).
    Angle { phase: i64, rate: i64 },
    /// Keep turning, units a tick.
    Rate { rate: i64 },
}

/// Command, average and spline of the heading.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Turning {
    history: [i64; TURN_HISTORY],
    newest: usize,
    length: usize,
    period: f32,
    /// R and B in units a tick (squared), and the B in force while above R.
    fastest: i64,
    strongest: i64,
    strongest_above: i64,
    commanded: i64,
    rate: i64,
    /// N (x_0 - Psi), and N times the newest first and second difference of Psi.
    trail: i64,
    first: i64,
    second: i64,
    bounds: ReferenceBounds,
    bridge: Option<(TurnBridge, u32)>,
    /// psi at the start of a bridge, units.
    bridged_from: i64,
}

impl Turning {
    #[inline]
    pub fn new(bounds: &ReferenceBounds, limits: &GovernorLimits, period: f32) -> Result<Self, ParameterError> {
        require_positive(bounds.heading_rate, "reference_bounds.heading_rate")?;
        require_positive(bounds.heading_second_derivative, "reference_bounds.heading_second_derivative")?;
        let length = ticks(limits.heading_ramp, period);
        require(length <= TURN_HISTORY, "governor.heading_ramp", Reason::NotAbove(TURN_HISTORY as f32 * period))?;
        let second = bounds.heading_second_derivative * (1.0 - ROUNDING_ROOM);
        let rate = (bounds.heading_rate * (1.0 - ROUNDING_ROOM)).min(RATE_SHARE * math::sqrt(second));
        let mut turning = Self {
            history: [0; TURN_HISTORY],
            newest: 0,
            length,
            period,
            fastest: (rate * period * PER_RADIAN) as i64,
            strongest: 0,
            strongest_above: 0,
            commanded: 0,
            rate: 0,
            trail: 0,
            first: 0,
            second: 0,
            bounds: *bounds,
            bridge: None,
            bridged_from: 0,
        };
        turning.strongest = turning.strongest_at(rate);
        require(turning.strongest > 0, "reference_bounds.heading_second_derivative", Reason::NotPositive)?;
        Ok(turning)
    }

    /// The B that a rate (rad/s) leaves, units per tick squared.
    #[inline]
    fn strongest_at(&self, rate: f32) -> i64 {
        let second = self.bounds.heading_second_derivative * (1.0 - ROUNDING_ROOM);
        let left = (second * second - rate * rate * rate * rate).max(0.0);
        (math::sqrt(left) * self.period * self.period * PER_RADIAN) as i64
    }

    /// Starts from `heading`.
    #[inline]
    pub fn start(&mut self, heading: &Heading) -> Result<(), GovernorError> {
        let direction = heading.direction();
        let phase = (turns(math::atan2(f64::from(direction.y), f64::from(direction.x))) >> SPARE_BITS) as i64;
        let bridge = if heading.acceleration() == 0.0 {
            None
        } else {
            let longest = self.length as u32;
            let bridge = TurnBridge::search(heading.rate(), heading.acceleration(), &self.bounds, self.period, longest);
            Some(bridge.ok_or(GovernorError::NoWayOn { field: "initial.heading.acceleration" })?)
        };
        let steady = bridge.map_or(heading.rate(), |bridge| bridge.at(bridge.duration).1);
        let within = steady.abs() <= self.bounds.heading_rate;
        let (above, strongest) =
            ((steady.abs() * self.period * PER_RADIAN) as i64 > self.fastest, self.strongest_at(steady));
        // Slowing down must end within a minute or so, or the rate cannot be said to be brought to rest.
        if !within || (above && strongest < self.strongest / 64) {
            return Err(GovernorError::NoWayOn { field: "initial.heading.rate" });
        }
        self.strongest_above = strongest;
        self.bridged_from = phase;
        self.bridge = bridge.map(|bridge| (bridge, 0));
        if bridge.is_none() {
            self.settle(phase, steady);
        }
        Ok(())
    }

    /// Starts the average as if it had always turned at `rate` (rad/s) and is at `phase` now.
    #[inline]
    fn settle(&mut self, phase: i64, rate: f32) {
        // A rate exactly at its bound could be rounded across it, seven times by 6e-8 until it is emitted.
        let most = self.bounds.heading_rate * (1.0 - 4.5e-7);
        let rate = rate.min(most).max(-most);
        let length = self.length as i64;
        self.history = [0; TURN_HISTORY];
        self.rate = (rate * self.period * PER_RADIAN) as i64;
        // Even, so that the halving below is exact.
        self.rate -= self.rate % 2;
        self.trail = self.rate / 2 * length * (length - 1);
        self.first = self.rate * length;
        self.second = 0;
        self.commanded = phase.wrapping_add(self.rate).wrapping_add(self.rate / 2 * (length - 1));
    }

    /// Advances by one tick towards `goal`.
    #[inline]
    pub fn tick(&mut self, goal: &TurnGoal) {
        if let Some((bridge, elapsed)) = self.bridge {
            let elapsed = elapsed + 1;
            self.bridge = (elapsed < bridge.duration).then_some((bridge, elapsed));
            if self.bridge.is_none() {
                let (angle, rate, _) = bridge.at(elapsed);
                self.settle(self.bridged_from.wrapping_add((angle * PER_RADIAN) as i64), rate);
            }
            return;
        }
        self.push(self.command(goal));
    }

    /// The commanded acceleration towards `goal`, units per tick squared.
    #[inline]
    fn command(&self, goal: &TurnGoal) -> i64 {
        let wanted = match *goal {
            TurnGoal::Stop => 0,
            TurnGoal::Rate { rate } => rate,
            TurnGoal::Angle { phase, rate } => rate.saturating_add(self.approach(phase)),
        };
        let strongest = if self.rate.abs() > self.fastest { self.strongest_above } else { self.strongest };
        let wanted = wanted.min(self.fastest).max(-self.fastest);
        // Not `clamp`, which may panic.
        wanted.saturating_sub(self.rate).min(strongest).max(-strongest)
    }

    /// The greatest rate towards `phase`, the shorter way round, from which braking ends on it.
    #[inline]
    fn approach(&self, phase: i64) -> i64 {
        let error = phase.wrapping_sub(self.commanded).wrapping_shl(SPARE_BITS) >> SPARE_BITS;
        let strongest = BRAKING_SHARE * self.strongest as f32;
        let distance = error as f32 / strongest;
        if distance.abs() <= 1.0 {
            return error;
        }
        (strongest * approach_speed(distance.abs()).copysign(distance)) as i64
    }

    #[inline]
    fn push(&mut self, acceleration: i64) {
        self.newest = (self.newest + 1) % TURN_HISTORY;
        let oldest = (self.newest + TURN_HISTORY - self.length) % TURN_HISTORY;
        // Read first: a window as long as the history drops what is about to be overwritten.
        let dropped = self.history.get(oldest).copied().unwrap_or(0);
        if let Some(slot) = self.history.get_mut(self.newest) {
            *slot = acceleration;
        }
        self.second += acceleration - dropped;
        self.first += self.second;
        self.rate += acceleration;
        self.commanded = self.commanded.wrapping_add(self.rate);
        self.trail += self.rate * self.length as i64 - self.first;
    }

    /// Whether nothing turns and `goal` asks for nothing else.
    #[inline]
    pub fn at_rest(&self, goal: &TurnGoal) -> bool {
        let still = self.rate == 0 && self.trail == 0 && self.first == 0 && self.second == 0;
        self.bridge.is_none() && still && self.command(goal) == 0
    }

    /// By how many ticks a steady turn comes out late.
    #[inline]
    pub fn delay(&self) -> f32 {
        (self.length as f32 - 1.0) * 0.5 + 1.0
    }

    /// The heading at hand.
    #[inline]
    pub fn heading(&self) -> Heading {
        if let Some((bridge, elapsed)) = self.bridge {
            let (angle, rate, acceleration) = bridge.at(elapsed);
            let phase = self.bridged_from.wrapping_add((angle * PER_RADIAN) as i64);
            return Heading::from_phase((phase as u64) << SPARE_BITS, rate, acceleration);
        }
        let length = self.length as i64;
        let behind = self.trail + self.first - self.second / 6;
        let phase = self.commanded.wrapping_sub(behind.checked_div_euclid(length).unwrap_or(0));
        let unit = 1.0 / (PER_RADIAN * self.length as f32 * self.period);
        let rate = (2 * self.first - self.second) as f32 * (0.5 * unit);
        Heading::from_phase((phase as u64) << SPARE_BITS, rate, self.second as f32 * (unit / self.period))
    }
}

/// An angle (rad) as a phase in units.
#[inline]
pub(super) fn phase(angle: f32) -> i64 {
    (turns(f64::from(angle)) >> SPARE_BITS) as i64
}

/// A rate (rad/s) in units a tick; an angle with `period` one.
#[inline]
pub(super) fn units(rate: f32, period: f32) -> i64 {
    (rate * period * PER_RADIAN) as i64
}
