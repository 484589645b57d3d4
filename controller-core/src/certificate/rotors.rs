//! The certificate's last link: every wrench the certified law can command fits every rotor's range.
//!
//! The law's torque is a sum of terms whose sets are known exactly (`tau` of [`crate::attitude`]):
//!
//! | term | set | size |
//! |---|---|---|
//! | attitude and body-rate feedback | ball | iota of Theorem 2 |
//! | J R~^T omega_d' | ellipsoid | J U_omega' |
//! | \[J R~^T omega_d\]x R~^T omega_d | gyroscopic form | U_omega |
//!
//! R~ is any rotation, so the desired motion is a ball in the body's axes whatever its own direction. The extremes of
//! rotor i over thrust interval and torque set are support functions in the direction of its row of the inverse
//! ([`crate::allocation::support`]): no box around a ball is paid for.
//!
//! Margins count from hover: a rotor has the room between its hovering thrust and its limit; what the law may command
//! beyond hovering is required of it.

use super::form::{ARITHMETIC_ALLOWANCE, Form};
use super::inequality::Inequality;
use crate::allocation::geometry::ROTORS_MAX;
use crate::allocation::support::{Commands, RotorDemand, Shape, TorqueTerm, demands};
use crate::configuration::Configuration;
use crate::error::ParameterError;
use crate::math::real::Real;
use heapless::Vec;

/// Names of the inequalities, by rotor.
const NAMES: [(&str, &str); ROTORS_MAX] = [
    ("R rotor 1 least", "R rotor 1 greatest"),
    ("R rotor 2 least", "R rotor 2 greatest"),
    ("R rotor 3 least", "R rotor 3 greatest"),
    ("R rotor 4 least", "R rotor 4 greatest"),
    ("R rotor 5 least", "R rotor 5 greatest"),
    ("R rotor 6 least", "R rotor 6 greatest"),
    ("R rotor 7 least", "R rotor 7 greatest"),
    ("R rotor 8 least", "R rotor 8 greatest"),
];

/// The law's demand on one rotor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotorReport<R = f64> {
    /// Its extremes, and what it has.
    pub demand: RotorDemand<R>,
    /// How far below hovering the law may take it, against the room there, N.
    pub min: Inequality<R>,
    /// How far above, N.
    pub max: Inequality<R>,
}

/// The sets that the law's torque is a sum of, under the bounds of `form`.
///
/// # Errors
/// If the form's bounds are not finite; the constructors before it leave no way to that.
pub fn torque_terms<R: Real>(
    configuration: &Configuration,
    form: &Form<R>,
) -> Result<[TorqueTerm<R>; 3], ParameterError> {
    let inertia = configuration.vehicle().inertia.map(R::from);
    let raised = R::from(1.0) + ARITHMETIC_ALLOWANCE;
    let rate = form.rates.angular_velocity * raised;
    let semi_axes = inertia * (form.rates.angular_acceleration * raised);
    Ok([
        TorqueTerm::new("attitude and body-rate feedback", Shape::Ball { radius: form.feedback_torque * raised })?,
        TorqueTerm::new("desired angular acceleration", Shape::Ellipsoid { semi_axes })?,
        TorqueTerm::new("gyroscopic torque", Shape::Gyroscopic { inertia, rate })?,
    ])
}

/// The reports of all rotors of `configuration` under the bounds of `form`; empty if it has none.
///
/// # Errors
/// As [`torque_terms`].
pub fn reports<R: Real>(
    configuration: &Configuration,
    form: &Form<R>,
) -> Result<Vec<RotorReport<R>, ROTORS_MAX>, ParameterError> {
    let mut reports = Vec::new();
    let Some(rotors) = configuration.rotors() else {
        return Ok(reports);
    };
    let terms = torque_terms(configuration, form)?;
    let commands = Commands::new(form.thrust.min, form.thrust.max, &terms)?;
    let hover = R::from(configuration.vehicle().mass) * R::from(configuration.vehicle().gravity);
    for ((demand, row), (least, greatest)) in demands(rotors, &commands).iter().zip(rotors.pseudo_inverse()).zip(&NAMES)
    {
        let share = hover * row.x;
        let [available_min, available_max] = [demand.available_min, demand.available_max].map(R::from);
        let report = RotorReport {
            demand: *demand,
            min: Inequality::new(least, "N", share - demand.min, share - available_min).or_equal(),
            max: Inequality::new(greatest, "N", demand.max - share, available_max - share).or_equal(),
        };
        // As many reports as rotors: it fits.
        let _ = reports.push(report);
    }
    Ok(reports)
}
