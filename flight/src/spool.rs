//! How the rotors are brought up from their idle to the law's thrusts.
//!
//! For [`SPOOL_DURATION_US`] a rotor is given a growing part of the way from its minimum thrust to the law's: no rotor
//! leaves the range in which the law's own commands are. The reference waits at rest.

use controller_core::allocation::Thrusts;

/// The time from the rotors' idle to the law's thrusts.
const SPOOL_DURATION_US: u64 = 1_000_000;

/// How far the rotors have come.
#[derive(Debug, PartialEq)]
pub(super) struct Spool {
    /// Each rotor's minimum thrust, N.
    thrust_min: Thrusts,
    /// The time between ticks, and that since the rotors' idle, us.
    period: u64,
    elapsed: u64,
}

impl Spool {
    /// At the rotors' idle, with their minimum thrusts, N, in ticks of `period` us.
    pub fn new(thrust_min: Thrusts, period: u64) -> Self {
        Self { thrust_min, period, elapsed: 0 }
    }

    /// Back at the rotors' idle.
    pub fn restart(&mut self) {
        self.elapsed = 0;
    }

    /// Whether the rotors give the law's thrusts.
    pub fn is_over(&self) -> bool {
        self.elapsed >= SPOOL_DURATION_US
    }

    /// One tick on: the part of the way to `thrusts`, N, that the rotors have come.
    pub fn advance(&mut self, mut thrusts: Thrusts) -> Thrusts {
        self.elapsed = self.elapsed.saturating_add(self.period).min(SPOOL_DURATION_US);
        if !self.is_over() {
            let part = self.elapsed as f32 / SPOOL_DURATION_US as f32;
            thrusts.iter_mut().zip(&self.thrust_min).for_each(|(thrust, min)| *thrust = min + part * (*thrust - min));
        }
        thrusts
    }
}

#[cfg(test)]
mod tests;
