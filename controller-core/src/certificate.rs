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
<<<<<<< HEAD
pub mod extended;
=======
pub mod form;
>>>>>>> main
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
<<<<<<< HEAD
mod tests {
    use super::*;
    use crate::gains::{GainParameters, Gains};
    use crate::reference::ReferenceBounds;
    use crate::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};

    /// The paper's experiment, Section VI.
    pub(crate) fn paper() -> Configuration {
        let inertia = Vector3::new(2.24e-3, 2.9e-3, 5.3e-3);
        let vehicle = Vehicle::new(VehicleParameters { mass: 0.46, inertia, gravity: 9.81 }).unwrap();
        let torque_max = Vector3::repeat(0.5);
        let limits = Limits::new(LimitParameters { thrust_max: 7.0, torque_max }, &vehicle).unwrap();
        let f = 0.418_879_02_f32;
        let swing = core::f32::consts::PI * f;
        let bounds = ReferenceBounds {
            horizontal_speed: 5.0,
            horizontal_acceleration: f * f,
            vertical_acceleration: f * f,
            jerk: core::f32::consts::SQRT_2 * f * f * f,
            snap: core::f32::consts::SQRT_2 * f * f * f * f,
            heading_rate: swing,
            heading_second_derivative: swing * swing,
        };
        Configuration::new(vehicle, limits, Gains::new(GainParameters::TABLE_1, &vehicle).unwrap(), bounds).unwrap()
    }

    #[test]
    fn table_1_is_refused_as_printed_and_in_yaw_only() {
        let printed = Certificate::new(&paper()).unwrap().printed;
        assert!(!printed.holds());
        assert!((printed.torque - Vector3::new(0.379, 0.446, 0.664)).amax() < 1e-3, "{}", printed.torque);
        let failing = printed.inequalities.iter().filter(|inequality| !inequality.holds());
        assert!(failing.map(|inequality| inequality.name).eq(["T2 yaw torque"]));
    }

    #[test]
    fn table_1_is_certified_by_the_sharp_bound_within_the_published_figures() {
        let sharp = Certificate::new(&paper()).unwrap().sharp;
        assert!(sharp.holds());
        let published = Vector3::new(0.29, 0.33, 0.48);
        assert!(sharp.torque.iter().zip(published.iter()).all(|(ours, theirs)| ours <= theirs), "{}", sharp.torque);
        assert!(sharp.thrust.greatest <= 6.19 && (sharp.thrust.least - 3.512).abs() < 1e-3, "{:?}", sharp.thrust);
    }

    #[test]
    fn theorem_1s_interval_is_the_published_one() {
        let thrust = Certificate::new(&paper()).unwrap().printed.thrust;
        assert!((thrust.least - 3.512).abs() < 1e-3 && (thrust.greatest - 6.188).abs() < 1e-3, "{thrust:?}");
    }

    #[test]
    fn references_that_the_vehicle_cannot_follow_at_all_fail_assumption_1() {
        let paper = paper();
        let fails = |bounds: ReferenceBounds, name: &str| {
            let certificate = Certificate::new(&paper.with_bounds(bounds).unwrap()).unwrap();
            let failing = |form: &Form| form.inequalities.iter().any(|i| i.name == name && !i.holds());
            assert!(failing(&certificate.printed) && failing(&certificate.sharp) && !certificate.holds(), "{name}");
        };
        // 7 N on 0.46 kg is 15.2 m/s^2: with gravity, less than 12 sideways.
        fails(ReferenceBounds { horizontal_acceleration: 12.0, ..*paper.bounds() }, "A1 thrust for the reference");
        fails(ReferenceBounds { snap: 2500.0, ..*paper.bounds() }, "A1 yaw torque for the reference");
    }

    #[test]
    fn a_reference_that_leaves_no_upward_thrust_is_no_configuration() {
        let paper = paper();
        let falling = ReferenceBounds { vertical_acceleration: 7.9, ..*paper.bounds() };
        assert_eq!(paper.with_bounds(falling).unwrap_err().field, "gains.m_p");
    }
}
=======
mod tests;
>>>>>>> main
