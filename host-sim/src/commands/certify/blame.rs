//! Why the rotors' margin is what it is: the certificate's numbers for the tightest rotor, in a sentence.
//!
//! From its share of the middle thrust a rotor is displaced by half the thrust's interval and by the law's torque
//! terms; these add up to its extreme. The one that displaces it most towards the limit it comes closest to is named;
//! where the share alone is beyond the limit, it is the thrust. Which axis costs most is a separate question: how much
//! less the rotor would have to do if the law commanded no torque about that axis. For real quadrotors it is yaw: a
//! newton metre of it costs several times the thrust that one of roll does (k_eta / k_m against 1 / arm; 4.9 times for
//! the Hummingbird).

use controller_core::allocation::TorqueTerm;
use controller_core::allocation::support::torque_part;
use controller_core::certificate::form::Form;
use controller_core::certificate::paper::PaperCertificate;
use controller_core::certificate::rotors;
use controller_core::configuration::Configuration;
use controller_core::error::ParameterError;
use nalgebra::{Vector3, Vector4};

/// The command of the tightest rotor, its greatest part, and its weak axis. Empty without rotors.
///
/// # Errors
/// As [`rotors::torque_terms`].
pub fn sentence(configuration: &Configuration, certificate: &PaperCertificate) -> Result<String, ParameterError> {
    let Some(mounted) = configuration.rotors() else {
        return Ok(String::new());
    };
    let margin = |i: usize| {
        let demand = &certificate.rotors[i].demand;
        (demand.available_max - demand.max).min(demand.min - demand.available_min)
    };
    let Some(worst) = (0..certificate.rotors.len()).min_by(|a, b| margin(*a).total_cmp(&margin(*b))) else {
        return Ok(String::new());
    };
    let demand = &certificate.rotors[worst].demand;
    let maximum = demand.available_max - demand.max <= demand.min - demand.available_min;
    let (end, available, commanded) = if maximum {
        ("greatest", demand.available_max, demand.max)
    } else {
        ("least", demand.available_min, demand.min)
    };
    let row = mounted.pseudo_inverse()[worst];
    let towards = if maximum { row } else { -row };
    let terms = rotors::torque_terms(configuration, &certificate.sharp)?;
    let (blame, blamed) = cause(&certificate.sharp, &terms, &towards, available);
    let (axis, relief) = weak_axis(&terms, &torque_part(&towards));
    let verdict = if margin(worst) >= 0.0 { "with a margin of" } else { "too much by" };
    Ok(format!(
        "rotor {}: commanded {commanded:.3} N, {end} available {available:.3} N, {verdict} {:.3} N; most of it from \
         {blame} ({blamed:.3} N); the weak axis is {axis} ({relief:.3} N)\n",
        worst + 1,
        margin(worst).abs(),
    ))
}

/// The term that displaces a rotor most in the direction `towards` (its row of B+, or less it), and by how much, N.
fn cause(form: &Form, terms: &[TorqueTerm], towards: &Vector4<f64>, available: f64) -> (&'static str, f64) {
    let share = 0.5 * towards.x * (form.thrust.min + form.thrust.max);
    let beyond = share - available * towards.x.signum();
    if beyond > 0.0 {
        return ("thrust", beyond);
    }
    let spread = 0.5 * (towards.x * (form.thrust.max - form.thrust.min)).abs();
    let parts = terms.iter().map(|term| (term.name(), term.support(&torque_part(towards))));
    parts.fold(("thrust", spread), |worst, part| if part.1 > worst.1 { part } else { worst })
}

/// The axis without whose torque a rotor would have least to do, and by how much less, N.
fn weak_axis(terms: &[TorqueTerm], towards: &Vector3<f64>) -> (&'static str, f64) {
    let support = |direction: &Vector3<f64>| terms.iter().map(|term| term.support(direction)).sum::<f64>();
    let relief = |place: usize| {
        let mut rest = *towards;
        rest[place] = 0.0;
        support(towards) - support(&rest)
    };
    let axes = [("roll", relief(0)), ("pitch", relief(1)), ("yaw", relief(2))];
    axes.into_iter().reduce(|worst, axis| if axis.1 > worst.1 { axis } else { worst }).unwrap_or(axes[0])
}

#[cfg(test)]
mod tests;
