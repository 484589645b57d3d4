//! Whom to blame where the rotors are short of room: the certificate's numbers for the tightest rotor, in a sentence.
//!
//! From its share of the middle thrust a rotor is displaced by half the thrust's interval and by the law's torque terms; these
//! add up to its extreme. The one that displaces it most towards the limit it comes closest to is named; where
//! the share alone is beyond the limit, it is the thrust. Which axis costs most is a separate question: how much less the
//! rotor would have to do if the law asked for no torque about that axis. For real quadrotors it is yaw: a newton
//! metre of it costs several times the thrust that one of roll does (k_eta / k_m against 1 / arm; 4.9 times for the
//! Hummingbird).

use controller_core::allocation::TorqueTerm;
use controller_core::allocation::support::torque_part;
use controller_core::certificate::configuration::Configuration;
use controller_core::certificate::{Certificate, Form, rotors};
use controller_core::error::ParameterError;
use nalgebra::{Vector3, Vector4};

/// What the tightest rotor is asked for, by what, and about which axis. Empty without rotors.
///
/// # Errors
/// As [`rotors::torque_terms`].
pub fn sentence(configuration: &Configuration, certificate: &Certificate) -> Result<String, ParameterError> {
    let Some(mounted) = configuration.rotors() else {
        return Ok(String::new());
    };
    let margin = |i: usize| {
        let demand = &certificate.rotors[i].demand;
        (demand.available_max - demand.greatest).min(demand.least - demand.available_min)
    };
    let Some(worst) = (0..certificate.rotors.len()).min_by(|a, b| margin(*a).total_cmp(&margin(*b))) else {
        return Ok(String::new());
    };
    let demand = &certificate.rotors[worst].demand;
    let maximum = demand.available_max - demand.greatest <= demand.least - demand.available_min;
    let (end, available, asked) = if maximum {
        ("greatest", demand.available_max, demand.greatest)
    } else {
        ("least", demand.available_min, demand.least)
    };
    let row = mounted.pseudo_inverse()[worst];
    let towards = if maximum { row } else { -row };
    let terms = rotors::torque_terms(configuration, &certificate.sharp)?;
    let (blame, blamed) = cause(&certificate.sharp, &terms, &towards, available);
    let (axis, relief) = weak_axis(&terms, &torque_part(&towards));
    let verdict = if margin(worst) >= 0.0 { "with a margin of" } else { "too much by" };
    Ok(format!(
        "rotor {}: asked for {asked:.3} N, {end} available {available:.3} N, {verdict} {:.3} N; most of it from {blame} \
         ({blamed:.3} N); the weak axis is {axis} ({relief:.3} N)\n",
        worst + 1,
        margin(worst).abs(),
    ))
}

/// What displaces a rotor most in the direction `towards` (its row of B+, or less it), and by how much, N.
fn cause(form: &Form, terms: &[TorqueTerm], towards: &Vector4<f64>, available: f64) -> (&'static str, f64) {
    let share = 0.5 * towards.x * (form.thrust.least + form.thrust.greatest);
    let beyond = share - available * towards.x.signum();
    if beyond > 0.0 {
        return ("thrust", beyond);
    }
    let spread = 0.5 * (towards.x * (form.thrust.greatest - form.thrust.least)).abs();
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
mod tests {
    use super::*;
    use controller_core::allocation::Shape;
    use controller_core::certificate::Interval;

    fn terms(sets: &[(&'static str, Shape)]) -> Vec<TorqueTerm> {
        sets.iter().map(|(name, shape)| TorqueTerm::new(name, *shape).unwrap()).collect()
    }

    /// The Hummingbird's rotor 3, upwards: a newton metre of yaw costs it 10.24 N, one of roll or pitch 2.08 N.
    const ROW: Vector4<f64> = Vector4::new(0.25, -2.08, 2.08, 10.24);

    fn form(least: f64, greatest: f64) -> Form {
        let paper = scenario::Scenario::paper().unwrap();
        let certificate = Certificate::new(&paper.configuration).unwrap();
        Form { thrust: Interval { least, greatest }, ..certificate.sharp }
    }

    #[test]
    fn the_largest_displacement_is_blamed_and_the_costliest_axis_named() {
        let ball = |radius| Shape::Ball { radius };
        let balls = terms(&[("small", ball(0.01)), ("large", ball(0.2))]);
        assert_eq!(cause(&form(5.0, 5.0), &balls, &-ROW, 0.0).0, "large");
        assert_eq!(weak_axis(&balls, &torque_part(&ROW)).0, "yaw");
        let rolling = terms(&[("roll", Shape::Ellipsoid { semi_axes: Vector3::new(0.3, 0.1, 0.001) })]);
        assert_eq!(weak_axis(&rolling, &torque_part(&ROW)).0, "roll");
    }

    #[test]
    fn the_thrust_is_blamed_for_its_swing_and_for_a_share_beyond_the_limit() {
        let small = terms(&[("small", Shape::Ball { radius: 0.01 })]);
        assert_eq!(cause(&form(5.0, 60.0), &small, &ROW, 12.5).0, "thrust");
        let large = terms(&[("large", Shape::Ball { radius: 0.5 })]);
        let (blame, beyond) = cause(&form(60.0, 60.0), &large, &ROW, 12.5);
        assert!(blame == "thrust" && (beyond - 2.5).abs() < 1e-12);
    }
}
