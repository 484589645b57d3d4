//! The proof before take-off: every inequality the paper relies on, evaluated for one configuration.
//!
//! From vehicle, limits, gains and reference bounds the certificate works out, as required, available and margin:
//!
//! - those on thrust and torque, of Assumption 1 and Theorems 1 and 2: [`form`];
//! - every rotor's least and greatest thrust within its range: [`rotors`].
//!
//! Those on the wrench in two [`Form`]s, always both: *as printed* ([`printed`]) and *sharp* ([`sharp`], derived in `docs/sharp-bound.md`).
//! The sharp form decides. Both bound everything reachable after a reset (x_f = 0, path lifted anew); neither
//! covers flight with any other start of the filters.

pub mod certified;
pub mod configuration;
pub mod form;
pub mod inequality;
pub mod printed;
pub mod reachable;
pub mod rotors;
pub mod sharp;

use crate::allocation::geometry::ROTORS_MAX;
use crate::error::ParameterError;
use configuration::Configuration;
use form::{Derivation, Form};
use heapless::Vec;
use inequality::Inequality;
use rotors::RotorReport;

/// The certificate of one configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// The paper's own bounds, x_f(0) = 0.
    pub printed: Form,
    /// The bounds of `docs/sharp-bound.md`; they decide.
    pub sharp: Form,
    /// Every rotor under the sharp form's bounds; empty for a configuration without rotors.
    pub rotors: Vec<RotorReport, ROTORS_MAX>,
}

impl Certificate {
    /// Works out every inequality for `configuration`, in a bounded amount of work.
    ///
    /// # Errors
    /// If a bound is beyond double precision; no configuration that its constructors accept leads there.
    pub fn new(configuration: &Configuration) -> Result<Self, ParameterError> {
        let printed = form::form(configuration, Derivation::Printed);
        let sharp = form::form(configuration, Derivation::Sharp);
        let rotors = rotors::reports(configuration, &sharp)?;
        Ok(Self { printed, sharp, rotors })
    }

    /// Everything that decides: the sharp form's inequalities, then two for each rotor.
    pub fn inequalities(&self) -> impl Iterator<Item = &Inequality> {
        let count = self.sharp.inequalities.len() + 2 * self.rotors.len();
        (0..count).filter_map(|place| self.inequality(place))
    }

    fn inequality(&self, place: usize) -> Option<&Inequality> {
        let wrench = &self.sharp.inequalities;
        wrench.get(place).or_else(|| {
            let of_rotors = place.checked_sub(wrench.len())?;
            let rotor = self.rotors.get(of_rotors / 2)?;
            Some(if of_rotors.is_multiple_of(2) { &rotor.least } else { &rotor.greatest })
        })
    }

    /// Whether the configuration is certified: everything that decides holds.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.inequalities().all(Inequality::holds)
    }

    /// The inequality with the least margin.
    #[must_use]
    pub fn tightest(&self) -> Option<Inequality> {
        inequality::tightest(self.inequalities())
    }
}

#[cfg(test)]
mod tests;
