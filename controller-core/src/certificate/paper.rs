//! The certificate of the paper's law: the wrench in two forms, as printed and sharp, and the rotors under the sharp
//! one.

use super::form::{self, Derivation, Form};
use super::inequality::Inequality;
use super::rotors::{self, RotorReport};
use crate::allocation::geometry::ROTORS_MAX;
use crate::configuration::{Configuration, PaperLaw};
use crate::error::ParameterError;
use crate::math::real::Real;
use heapless::Vec;

/// Every inequality about one configuration of the paper's law.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperCertificate<R = f64> {
    /// The paper's own bounds, x_f(0) = 0.
    pub printed: Form<R>,
    /// The bounds of `docs/sharp-bound.md`; they decide.
    pub sharp: Form<R>,
    /// Every rotor under the sharp form's bounds; empty for a configuration without rotors.
    pub rotors: Vec<RotorReport<R>, ROTORS_MAX>,
}

impl<R: Real> PaperCertificate<R> {
    /// Works out every inequality for `law`, the one of `configuration`.
    ///
    /// # Errors
    /// If a bound is beyond double precision; no configuration that its constructors accept leads there.
    #[inline(never)] // its temporaries are not to add up with the extended law's on a board's stack
    pub fn new(configuration: &Configuration, law: &PaperLaw) -> Result<Self, ParameterError> {
        let printed = form::form(configuration, law, Derivation::Printed);
        let sharp = form::form(configuration, law, Derivation::Sharp);
        let rotors = rotors::reports(configuration, &sharp)?;
        Ok(Self { printed, sharp, rotors })
    }

    /// The inequality at `place`: the sharp form's, then two for each rotor.
    pub(super) fn inequality(&self, place: usize) -> Option<&Inequality<R>> {
        let wrench = &self.sharp.inequalities;
        wrench.get(place).or_else(|| {
            let of_rotors = place.checked_sub(wrench.len())?;
            let rotor = self.rotors.get(of_rotors / 2)?;
            Some(if of_rotors.is_multiple_of(2) { &rotor.min } else { &rotor.max })
        })
    }
}
