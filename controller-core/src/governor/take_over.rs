//! A governor that begins at any reference, in motion or not: a bridge, then the governor.
//!
//! Position and heading are led to steady motion on bridges of their own; where one ends, the governor's averages start.
//! Setpoints are accepted all the while and take effect then. Only what changes between references needs this: firmware that
//! starts flights from where the vehicle is has a [`Governor`] alone.

use super::bridge::{self, Bridge, TurnBridge};
use super::smoother::Knot;
use super::turning::{PER_RADIAN, SPARE_BITS, phase_of, strongest_at, units};
use super::{Governor, GovernorLimits, Memory, POSITION_RANGE, SPEED_RANGE, Setpoint};
use crate::error::{InputError, ParameterError};
use crate::heading::Heading;
use crate::reference::{Reference, ReferenceBounds};
use crate::state::check_vectors;
use core::fmt;

/// Why a reference cannot be taken over.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TakeOverError {
    /// It is not finite or out of range.
    Start(InputError),
    /// No way from it to rest inside the bounds was found.
    NoWayOn {
        /// The part of the reference to blame.
        field: &'static str,
    },
}

impl From<InputError> for TakeOverError {
    #[inline]
    fn from(error: InputError) -> Self {
        Self::Start(error)
    }
}

impl fmt::Display for TakeOverError {
    #[inline]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start(error) => write!(f, "{error}"),
            Self::NoWayOn { field } => write!(f, "{field}: cannot be brought to rest within the reference bounds"),
        }
    }
}

impl core::error::Error for TakeOverError {}

/// A [`Governor`] behind bridges from references in motion.
#[derive(Debug, PartialEq)]
pub struct TakeOver<'m> {
    governor: &'m mut Governor,
    bounds: ReferenceBounds,
    /// The position's bridge, and the ticks spent on it.
    bridge: Option<(Bridge, u32)>,
    /// The heading's.
    turn: Option<(TurnBridge, u32)>,
    /// psi at the start of the heading's, units.
    turned_from: i64,
}

impl<'m> TakeOver<'m> {
    /// At rest at the origin, as [`Governor::new`].
    ///
    /// # Errors
    /// As there.
    #[inline]
    pub fn new(
        bounds: &ReferenceBounds,
        limits: &GovernorLimits,
        period: f32,
        memory: &'m mut Memory,
    ) -> Result<Self, ParameterError> {
        let governor = Governor::new(bounds, limits, period, memory)?;
        Ok(Self { governor, bounds: *bounds, bridge: None, turn: None, turned_from: 0 })
    }

    /// Takes over from any reference, in motion or not; without setpoints it is brought to a smooth stop.
    ///
    /// A change of mode, not a tick: the search for a way on (see the module `bridge`) has no tick's time limit.
    ///
    /// # Errors
    /// [`TakeOverError::Start`] for numbers not finite or out of range, [`TakeOverError::NoWayOn`] for a reference outside
    /// the bounds or about to leave them. All goes on as before then.
    #[inline]
    pub fn restart(&mut self, from: &Reference) -> Result<(), TakeOverError> {
        from.check()?;
        check_vectors(&[
            (&from.position, POSITION_RANGE, "initial.position"),
            (&from.velocity, SPEED_RANGE, "initial.velocity"),
        ])?;
        if !self.bounds.contain(from, 1e-6) {
            return Err(TakeOverError::NoWayOn { field: "initial reference" });
        }
        let Reference { position, velocity, acceleration, jerk, snap, .. } = *from;
        let start = Knot { position, velocity, acceleration, jerk, snap };
        let bridge = if bridge::is_steady(&start) {
            None
        } else {
            let found = Bridge::search(&start, &self.bounds, self.governor.period, self.governor.windows.first());
            Some(found.ok_or(TakeOverError::NoWayOn { field: "initial.acceleration" })?)
        };
        self.restart_turn(&from.heading)?;
        self.bridge = bridge.map(|bridge| (bridge, 0));
        if bridge.is_none() {
            self.governor.settle(&position, &velocity);
        }
        self.stop();
        Ok(())
    }

    /// The heading's part of a restart.
    #[inline]
    fn restart_turn(&mut self, from: &Heading) -> Result<(), TakeOverError> {
        let (period, turning) = (self.governor.period, &mut self.governor.turning);
        let bridge = if from.acceleration() == 0.0 {
            None
        } else {
            let (rate, acceleration, longest) = (from.rate(), from.acceleration(), turning.length() as u32);
            let found = TurnBridge::search(rate, acceleration, &self.bounds, period, longest);
            Some(found.ok_or(TakeOverError::NoWayOn { field: "initial.heading.acceleration" })?)
        };
        let steady = bridge.map_or(from.rate(), |bridge| bridge.at(bridge.duration).1);
        let within = steady.abs() <= self.bounds.heading_rate;
        if !within || !turning.allow(units(steady, period), strongest_at(steady, &self.bounds, period)) {
            return Err(TakeOverError::NoWayOn { field: "initial.heading.rate" });
        }
        self.turned_from = phase_of(from);
        self.turn = bridge.map(|bridge| (bridge, 0));
        if bridge.is_none() {
            self.settle_turn(self.turned_from, steady);
        }
        Ok(())
    }

    /// Hands a steady turn to the governor: at `phase` (units), with `rate` (rad/s).
    #[inline]
    fn settle_turn(&mut self, phase: i64, rate: f32) {
        // A rate exactly at its bound could be rounded across it, seven times by 6e-8 until it is emitted.
        let most = self.bounds.heading_rate * (1.0 - 4.5e-7);
        let rate = units(rate.min(most).max(-most), self.governor.period);
        self.governor.turning.start(phase, rate - rate % 2);
    }

    /// As [`Governor::accept`]; takes effect on the far side of the bridges.
    ///
    /// # Errors
    /// As there.
    #[inline]
    pub fn accept(&mut self, setpoint: &Setpoint) -> Result<(), InputError> {
        self.governor.accept(setpoint)
    }

    /// As [`Governor::stop`].
    #[inline]
    pub fn stop(&mut self) {
        self.governor.stop();
    }

    /// As [`Governor::at_rest`].
    #[must_use]
    #[inline]
    pub fn at_rest(&self) -> bool {
        self.bridge.is_none() && self.turn.is_none() && self.governor.at_rest()
    }

    /// The reference one period later.
    #[inline]
    pub fn tick(&mut self) -> Reference {
        self.governor.age();
        let Knot { position, velocity, acceleration, jerk, snap } = self.travel();
        Reference { position, velocity, acceleration, jerk, snap, heading: self.turn() }
    }

    #[inline]
    fn travel(&mut self) -> Knot {
        let Some((bridge, elapsed)) = &mut self.bridge else { return self.governor.travel() };
        *elapsed += 1;
        let knot = bridge.knot(*elapsed as f32);
        if *elapsed >= bridge.duration() {
            self.bridge = None;
            self.governor.settle(&knot.position, &knot.velocity);
        }
        knot
    }

    #[inline]
    fn turn(&mut self) -> Heading {
        let Some((bridge, elapsed)) = &mut self.turn else { return self.governor.turn() };
        *elapsed += 1;
        let (angle, rate, acceleration) = bridge.at(*elapsed);
        let phase = self.turned_from.wrapping_add((angle * PER_RADIAN) as i64);
        if *elapsed < bridge.duration {
            return Heading::from_phase((phase as u64) << SPARE_BITS, rate, acceleration);
        }
        self.turn = None;
        self.settle_turn(phase, rate);
        self.governor.turning.heading()
    }
}
