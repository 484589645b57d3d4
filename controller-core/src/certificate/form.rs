//! One evaluation of the inequalities on the wrench: the paper's bounds as printed, or the sharp ones.
//!
//! | inequality | source |
//! |---|---|
//! | K_a3 < g; m (g + sqrt(K_a12^2 + K_a3^2)) < T_max; torque for the reference alone | Assumption 1 |
//! | M_p < g - K_a3 | Section IV |
//! | greatest thrust <= T_max; least thrust > 0, or the floor's place under it | Theorem 1, [`projection`](crate::projection) |
//! | J_ii U_omega' + \|J_jj - J_kk\| U_omega^2 / 2 + iota < tau_max,i, each axis | Theorem 2 |
//!
//! The proofs are worked out in double precision, once, before flight. The law flies in single precision, so each
//! bound is raised by [`ARITHMETIC_ALLOWANCE`] before it is compared.

use super::inequality::{self, Inequality};
use super::printed;
use super::reachable::Reachable;
use super::sharp::{self, DesiredRates};
use crate::configuration::{Configuration, PaperLaw};
use crate::gains::Gains;
use crate::math::real::Real;
use nalgebra::Vector3;

/// By how much, relative, bounds are raised to cover the single-precision arithmetic of the law. One evaluation's
/// relative error is below 2e-6 (tests/law/independent_law.rs); what the filters' rounding adds up to over many ticks
/// is below 2e-5 for ticks down to 0.25 ms and bandwidths down to 0.2 1/s (tests/proof/sharp_derivation.rs).
pub const ARITHMETIC_ALLOWANCE: f64 = 1e-4;

/// Least and greatest of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval<R = f64> {
    /// Least value.
    pub min: R,
    /// Greatest value.
    pub max: R,
}

/// One evaluation of all inequalities on the wrench.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Form<R = f64> {
    /// Lemma 1: bounds on omega_d and omega_d', and the torque they take.
    pub rates: DesiredRates<R>,
    /// Every thrust the law can command, N.
    pub thrust: Interval<R>,
    /// Greatest |torque| about each body axis, N m.
    pub torque: Vector3<R>,
    /// iota: the greatest length of the attitude and body-rate feedback together, N m.
    pub feedback_torque: R,
    /// Assumption 1, Theorem 1 and Theorem 2, in that order.
    pub inequalities: [Inequality<R>; 11],
}

impl Form {
    /// Whether every inequality holds.
    pub fn holds(&self) -> bool {
        self.inequalities.iter().all(Inequality::holds)
    }

    /// The inequality with the least margin.
    pub fn tightest(&self) -> Option<Inequality> {
        inequality::tightest(&self.inequalities)
    }
}

/// Which of the two derivations a form follows.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Derivation {
    Printed,
    Sharp,
}

/// Bounds on the desired rates with the position feedback at `m_p` (zero: the reference alone).
fn desired_rates<R: Real>(
    configuration: &Configuration,
    gains: &Gains,
    m_p: R,
    derivation: Derivation,
) -> DesiredRates<R> {
    let bounds = configuration.bounds();
    let inertia = configuration.vehicle().inertia.map(R::from);
    let [gravity, k_f, k_s] = [configuration.vehicle().gravity, gains.k_f, gains.k_s].map(R::from);
    let printed = printed::desired_rates(k_f, k_s, m_p, gravity, bounds, &inertia);
    match derivation {
        Derivation::Printed => printed,
        // Both are bounds, so the lesser one is: far from hover the lemma can be the sharper of the two.
        Derivation::Sharp => {
            sharp::desired_rates(&Reachable::new(k_f, k_s, m_p, gravity, bounds), bounds, &inertia).min(&printed)
        }
    }
}

/// The inequalities of `law`, the one of `configuration`, after `derivation`.
pub(super) fn form<R: Real>(configuration: &Configuration, law: &PaperLaw, derivation: Derivation) -> Form<R> {
    let PaperLaw { gains, thrust_floor } = law;
    let (vehicle, limits) = (configuration.vehicle(), configuration.limits());
    let bounds = configuration.bounds();
    let [mass, gravity, m_p] = [vehicle.mass, vehicle.gravity, gains.m_p].map(R::from);
    let [horizontal, vertical] = [bounds.horizontal_acceleration, bounds.vertical_acceleration].map(R::from);
    let raised = R::from(1.0) + ARITHMETIC_ALLOWANCE;

    let reach = Reachable::new(R::from(gains.k_f), R::from(gains.k_s), m_p, gravity, bounds);
    let magnitude = match derivation {
        Derivation::Printed => R::from(3.0).sqrt() * m_p + horizontal.hypot(vertical + gravity),
        Derivation::Sharp => reach.magnitude(),
    };
    let least_law = mass * reach.vertical_min;
    let floor = R::from(thrust_floor.unwrap_or(0.0));
    let min = if floor.lower() > 0.0 { floor } else { least_law };
    let thrust = Interval { min: min / raised, max: mass * magnitude * raised };

    let alone = desired_rates(configuration, gains, R::from(0.0), derivation).feedforward_torque * raised;
    let rates = desired_rates(configuration, gains, m_p, derivation);
    let feedback_torque = feedback_torque(gains, derivation);
    let torque = rates.feedforward_torque.map(|torque| (torque + feedback_torque) * raised);
    let available = limits.torque_max.map(R::from);
    let thrust_max = R::from(limits.thrust_max);
    let feasible = mass * (gravity + horizontal.hypot(vertical)) * raised;

    let inequalities = [
        Inequality::new("A1 vertical acceleration K_a3 < g", "m/s^2", vertical, gravity),
        Inequality::new("A1 thrust for the reference", "N", feasible, thrust_max),
        Inequality::new("A1 roll torque for the reference", "N m", alone.x, available.x),
        Inequality::new("A1 pitch torque for the reference", "N m", alone.y, available.y),
        Inequality::new("A1 yaw torque for the reference", "N m", alone.z, available.z),
        Inequality::new("T1 saturation level M_p < g - K_a3", "m/s^2", m_p, gravity - vertical),
        Inequality::new("T1 least thrust > 0 and >= floor", "N", floor, least_law).or_equal(),
        Inequality::new("T1 greatest thrust", "N", thrust.max, thrust_max),
        Inequality::new("T2 roll torque", "N m", torque.x, available.x),
        Inequality::new("T2 pitch torque", "N m", torque.y, available.y),
        Inequality::new("T2 yaw torque", "N m", torque.z, available.z),
    ];
    Form { rates, thrust, torque, feedback_torque, inequalities }
}

/// iota of Theorem 2. The sharp form uses what the saturation reaches at |theta| = 1 + delta instead of its limit.
fn feedback_torque<R: Real>(gains: &Gains, derivation: Derivation) -> R {
    let [m_theta, m_omega, k_theta] = [gains.m_theta, gains.m_omega, gains.k_theta].map(R::from);
    let radius = R::from(gains.delta) + 1.0;
    let attitude = match derivation {
        Derivation::Printed => m_theta,
        Derivation::Sharp => {
            let argument = k_theta * radius;
            m_theta * argument / m_theta.hypot(argument)
        }
    };
    (radius * radius + 1.0) * attitude / 4.0 + m_omega
}
