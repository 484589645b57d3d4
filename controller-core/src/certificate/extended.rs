//! The certificate of the extended law. Derived in `docs/extended-law.md`, sections 9 to 12.
//!
//! | inequality | what follows from it |
//! |---|---|
//! | K_a3 < g; m (g + \|p_d'' with its drag\|) < T_max | A1: the reference can be flown at all |
//! | \|w*_3\| < W_max, \|w*_3'\| < A without position error | A1: the heading arrives |
//! | M_z- + D_z < g - K_a3 | T1: u_z > 0, the law is defined |
//! | qbar < eta, 2 qbar M_t < w eta_t sqrt(1 - qbar^2) | E: the only equilibrium of the attitude is the target |
//! | N(feed-forward) < m n, in each cell of u | G: near the target the thrust is the law's own, so that the position loop is the proven one |
//! | thrust and torques within the limits | T1, T2 |
//! | each rotor's greatest thrust within its range | R: with the floor, which keeps it above the least, B+ w fits every rotor |
//!
//! [`reach`]: what u and its derivatives can be; [`motion`]: how the desired frame moves then; [`torque`]: what that asks for;
//! [`bounds`]: all of it together.

pub mod bounds;
pub mod motion;
pub mod reach;
pub mod torque;

use super::configuration::{Configuration, ExtendedLaw};
use super::form::ARITHMETIC_ALLOWANCE;
use super::inequality::Inequality;
use super::reachable::Reachable;
use super::sharp;
use crate::allocation::collected;
use crate::allocation::geometry::ROTORS_MAX;
use crate::error::ParameterError;
use crate::extended::parameters::{AttitudeParameters, Extended};
use crate::math;
use crate::reference::ReferenceBounds;
use bounds::ExtendedBounds;
use heapless::Vec;
use torque::switching_scalar;

/// Inequalities beside those on rotors.
const WITHOUT_ROTORS: usize = 12;

/// Names of the inequalities on rotors.
const ROTORS: [&str; ROTORS_MAX] = [
    "R rotor 1 greatest",
    "R rotor 2 greatest",
    "R rotor 3 greatest",
    "R rotor 4 greatest",
    "R rotor 5 greatest",
    "R rotor 6 greatest",
    "R rotor 7 greatest",
    "R rotor 8 greatest",
];

/// Every inequality about one configuration of the extended law.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtendedCertificate {
    /// What the law can command.
    pub bounds: ExtendedBounds,
    /// The inequalities, in the order of this module's table.
    pub inequalities: Vec<Inequality, { WITHOUT_ROTORS + ROTORS_MAX }>,
}

impl ExtendedCertificate {
    /// Works out every inequality for `law`, the one of `configuration`.
    ///
    /// # Errors
    /// If a bound is beyond double precision; no configuration that its constructors accept leads there.
    #[inline(never)] // as the paper law's
    pub fn new(configuration: &Configuration, law: &ExtendedLaw) -> Result<Self, ParameterError> {
        let parameters = &law.parameters;
        let bounds = bounds::bounds(configuration, parameters)?;
        let all = feasibility(configuration, parameters)
            .into_iter()
            .chain(equilibrium(&parameters.attitude))
            .chain(commands(configuration, &bounds))
            .chain(rotors(configuration, &bounds));
        let inequalities = collected(all);
        Ok(Self { bounds, inequalities })
    }
}

/// The reference with its drag, and room for it: Assumption 1, and that the law is defined.
fn feasibility(configuration: &Configuration, parameters: &Extended) -> [Inequality; 5] {
    let (vehicle, references) = (configuration.vehicle(), configuration.bounds());
    let (mass, gravity) = (f64::from(vehicle.mass), f64::from(vehicle.gravity));
    let with_drag = with_drag(references, parameters.estimates.drag_across);
    let vertical = f64::from(references.vertical_acceleration);
    let raised = 1.0 + ARITHMETIC_ALLOWANCE;
    let thrust = mass * (gravity + math::hypot(f64::from(with_drag.horizontal_acceleration), vertical)) * raised;
    // With M_p = 0 the filters stay at zero, whatever their bandwidths.
    let alone = Reachable::new(1.0, 1.0, 0.0, gravity, &with_drag);
    let [rate, acceleration] = sharp::turning_rates(&alone, &with_drag).map(|rate| rate * raised);
    let (fall, heading) = (f64::from(parameters.greatest_fall()), &parameters.heading);
    [
        Inequality::new("A1 vertical acceleration K_a3 < g", "m/s^2", vertical, gravity),
        Inequality::new("A1 thrust for the reference", "N", thrust, f64::from(configuration.limits().thrust_max)),
        Inequality::new("A1 heading rate for the reference", "rad/s", rate, f64::from(heading.rate)),
        Inequality::new("A1 heading acceleration", "rad/s^2", acceleration, f64::from(heading.acceleration)),
        Inequality::new("T1 fall M_z- + D_z < g - K_a3", "m/s^2", fall, gravity - vertical),
    ]
}

/// `bounds` of p_d'' + kappa p_d' and its derivatives, `drag` being kappa, 1/s.
fn with_drag(bounds: &ReferenceBounds, drag: f32) -> ReferenceBounds {
    ReferenceBounds {
        horizontal_acceleration: bounds.horizontal_acceleration + drag * bounds.horizontal_speed,
        jerk: bounds.jerk + drag * bounds.horizontal_acceleration,
        snap: bounds.snap + drag * bounds.jerk,
        ..*bounds
    }
}

/// Section 4 of the document: no attitude but the target is an equilibrium.
fn equilibrium(attitude: &AttitudeParameters) -> [Inequality; 2] {
    let qbar = switching_scalar(attitude.delta);
    let AttitudeParameters { w, eta, m_t, eta_t, .. } = attitude;
    let pull = f64::from(*w) * f64::from(*eta_t) * math::sqrt_of_rounded(1.0 - qbar * qbar);
    [
        Inequality::new("E switch qbar < eta", "1", qbar, f64::from(*eta)),
        Inequality::new("E tilt 2 qbar M_t < w eta_t sqrt(1 - qbar^2)", "N m", 2.0 * qbar * f64::from(*m_t), pull),
    ]
}

/// The floor's place, thrust and torques.
fn commands(configuration: &Configuration, bounds: &ExtendedBounds) -> [Inequality; 5] {
    let limits = configuration.limits();
    let available = limits.torque_max.map(f64::from);
    let ([floor, least], torque) = (bounds.floor, &bounds.torque);
    [
        Inequality::new("G floor at the target < m |u|", "N", floor, least),
        Inequality::new("T1 greatest thrust", "N", bounds.thrust.greatest, f64::from(limits.thrust_max)),
        Inequality::new("T2 roll torque", "N m", torque.x, available.x),
        Inequality::new("T2 pitch torque", "N m", torque.y, available.y),
        Inequality::new("T2 yaw torque", "N m", torque.z, available.z),
    ]
}

/// What each rotor is asked for beyond hovering, against what it has beyond it.
fn rotors<'a>(configuration: &'a Configuration, bounds: &'a ExtendedBounds) -> impl Iterator<Item = Inequality> + 'a {
    let hover = f64::from(configuration.vehicle().mass) * f64::from(configuration.vehicle().gravity);
    let all = configuration.rotors().into_iter().flat_map(|rotors| rotors.iter().zip(rotors.pseudo_inverse()));
    all.zip(&bounds.rotors).zip(&ROTORS).map(move |(((rotor, row), asked), name)| {
        let share = row.x * hover;
        Inequality::new(name, "N", asked.greatest - share, f64::from(rotor.thrust_max) - share).or_equal()
    })
}

#[cfg(test)]
mod tests;
