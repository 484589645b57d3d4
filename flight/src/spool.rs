//! How the rotors are brought up from their idle to the law's thrusts.
//!
//! For [`SPOOL_TICKS`] a rotor is given a growing part of the way from its least thrust to the law's: no rotor leaves
//! the range in which the law's own commands are. The reference waits at rest.

use controller_core::allocation::Thrusts;

/// Ticks from the rotors' idle to the law's thrusts.
const SPOOL_TICKS: u32 = 100;

/// How far the rotors have come.
#[derive(Debug, PartialEq)]
pub(super) struct Spool {
    /// Each rotor's least thrust, N.
    least: Thrusts,
    /// Ticks since the rotors' idle.
    ticks: u32,
}

impl Spool {
    /// At the rotors' idle, with their least thrusts, N.
    pub fn new(least: Thrusts) -> Self {
        Self { least, ticks: 0 }
    }

    /// Back at the rotors' idle.
    pub fn restart(&mut self) {
        self.ticks = 0;
    }

    /// Whether the rotors give the law's thrusts.
    pub fn is_over(&self) -> bool {
        self.ticks >= SPOOL_TICKS
    }

    /// One tick on: the part of the way to `thrusts`, N, that the rotors have come.
    pub fn advance(&mut self, mut thrusts: Thrusts) -> Thrusts {
        self.ticks = self.ticks.saturating_add(1).min(SPOOL_TICKS);
        if !self.is_over() {
            let part = self.ticks as f32 / SPOOL_TICKS as f32;
            thrusts.iter_mut().zip(&self.least).for_each(|(thrust, least)| *thrust = least + part * (*thrust - least));
        }
        thrusts
    }
}

#[cfg(test)]
mod tests;
