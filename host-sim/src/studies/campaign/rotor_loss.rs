//! What became of a flight in which a rotor failed, and what the law took for a failing rotor.
//!
//! | figure | |
//! |---|---|
//! | found | the first rotor that the law took for lost, and when; another law than ours looks for none |
//! | false alarm | a rotor found that had not failed: in a flight without a failure, before it, or another one |
//! | height lost | greatest height below both where it failed and the reference, from then on |
//! | distance | greatest distance from the reference, from then on |
//!
//! A vehicle that turns has no heading to hold. So a flight in which a rotor failed is held to its place alone: it
//! *tracks* if it ends within [`PLACE_HELD_DISTANCE_M`](scenario::rotor_loss::PLACE_HELD_DISTANCE_M) of its reference.

use crate::flight::Brief;
use controller_core::allocation::remaining::LostRotor;
use controller_core::allocation::{Rotor, Rotors};
use scenario::Scenario;
use scenario::reality::failure::Failure;

/// For the rounding of a wrench's components or a rotor's command against a bound, relative; for a rotor that may
/// stand still, N.
pub(super) const BOUND_TOLERANCE: f64 = 1e-6;

/// A flight's failing rotor, and the one that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotorLoss {
    /// The rotor that failed before the flight's end.
    pub failure: Option<Failure>,
    /// The rotor that the law found, counted from 0, and when, s.
    pub found: Option<(usize, f64)>,
    /// m; zero where none failed.
    pub height_lost: f64,
    /// m; zero where none failed.
    pub distance: f64,
    /// Where it failed, m.
    height: f64,
}

impl RotorLoss {
    /// Of a flight of `scenario`, before its first tick.
    #[must_use]
    pub fn before_flight(scenario: &Scenario) -> Self {
        let end = scenario.timing.duration();
        let failure = scenario.reality.failure.filter(|failure| failure.time < end);
        Self { failure, found: None, height_lost: 0.0, distance: 0.0, height: f64::INFINITY }
    }

    /// The flight cannot be flown to its end.
    #[must_use]
    pub fn unfinished(self) -> Self {
        let lost = if self.failure.is_some() { f64::INFINITY } else { 0.0 };
        Self { height_lost: lost, distance: lost, ..self }
    }

    /// Takes a tick in, after which the law has found a rotor to be `lost`.
    pub fn observe(&mut self, tick: &Brief, lost: Option<LostRotor>) {
        let time = tick.time_us as f64 * 1e-6;
        self.found = self.found.or_else(|| lost.map(|lost| (lost.rotor, time)));
        if self.failure.is_none_or(|failure| time < failure.time) {
            return;
        }
        let (position, wanted) = (&tick.state.position, tick.reference.position.map(f64::from));
        if self.height == f64::INFINITY {
            self.height = position.z;
        }
        self.height_lost = self.height_lost.max(self.height.min(wanted.z) - position.z);
        self.distance = self.distance.max((position - wanted).norm());
    }

    /// Whether a rotor was found that had not failed.
    #[must_use]
    pub fn is_false_alarm(&self) -> bool {
        let failed = |rotor, time| self.failure.is_some_and(|failure| failure.rotor == rotor && failure.time <= time);
        self.found.is_some_and(|(rotor, time)| !failed(rotor, time))
    }
}

/// Whether each rotor's command is within what that rotor can deliver, but for rounding, or nothing is commanded of the
/// one that is `lost`: all that is proven from then on.
#[must_use]
pub fn is_within_ranges(tick: &Brief, rotors: Option<&Rotors>, lost: usize) -> bool {
    let mut ranges = rotors.into_iter().flat_map(|rotors| rotors.iter());
    let raised = 1.0 + BOUND_TOLERANCE as f32;
    tick.rotor_thrusts.iter().enumerate().all(|(number, thrust)| {
        let within = |rotor: &Rotor| (rotor.thrust_min / raised..=rotor.thrust_max * raised).contains(thrust);
        ranges.next().is_some_and(|rotor| within(rotor) || number == lost && *thrust == 0.0)
    })
}

#[cfg(test)]
mod tests;
