//! The proof before take-off: every inequality the paper relies on, evaluated for one configuration.
//!
//! From vehicle, limits, gains and reference bounds the certificate works out, as required, available and margin:
//!
//! | inequality | source |
//! |---|---|
//! | K_a3 < g; m (g + sqrt(K_a12^2 + K_a3^2)) < T_max; torque for the reference alone | Assumption 1 |
//! | M_p < g - K_a3 | Section IV |
//! | greatest thrust <= T_max; least thrust > 0, or the floor's place under it | Theorem 1, [`projection`](crate::projection) |
//! | J_ii U_omega' + \|J_jj - J_kk\| U_omega^2 / 2 + iota < tau_max,i, each axis | Theorem 2 |
//! | every rotor's least and greatest thrust within its range | [`crate::allocation`] |
//!
//! Each in two [`Form`]s, always both: *as printed* ([`printed`]) and *sharp* ([`sharp`], derived in `docs/sharp-bound.md`).
//! The sharp form decides. Both bound everything reachable after a reset (x_f = 0, path lifted anew); neither
//! covers flight with any other start of the filters.
//!
//! The proofs are worked out in double precision, once, before flight. The law flies in single precision, so each
//! bound is raised by [`ARITHMETIC_ALLOWANCE`] before it is compared.

pub mod configuration;
pub mod inequality;
pub mod printed;
pub mod reachable;
pub mod rotors;
pub mod sharp;

use crate::allocation::geometry::ROTORS_MAX;
use crate::error::ParameterError;
use crate::math;
use configuration::Configuration;
use heapless::Vec;
use inequality::Inequality;
use nalgebra::Vector3;
use reachable::Reachable;
use rotors::RotorReport;
use sharp::DesiredRates;

/// By how much, relative, bounds are raised to cover the single-precision arithmetic of the law. One evaluation's relative
/// error is below 2e-6 (tests/independent_law.rs); what the filters' rounding adds up to over many ticks is below 2e-5
/// for ticks down to 0.25 ms and bandwidths down to 0.2 1/s (tests/sharp_derivation.rs).
pub const ARITHMETIC_ALLOWANCE: f64 = 1e-4;

/// Least and greatest of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Least value.
    pub least: f64,
    /// Greatest value.
    pub greatest: f64,
}

/// One evaluation of all inequalities on the wrench.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Form {
    /// Lemma 1: bounds on omega_d and omega_d', and the torque they take.
    pub rates: DesiredRates,
    /// Every thrust the law can command, N.
    pub thrust: Interval,
    /// Greatest |torque| about each body axis, N m.
    pub torque: Vector3<f64>,
    /// iota: the greatest length of the attitude and body-rate feedback together, N m.
    pub feedback_torque: f64,
    /// Assumption 1, Theorem 1 and Theorem 2, in that order.
    pub inequalities: [Inequality; 11],
}

impl Form {
    /// Whether every inequality holds.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.inequalities.iter().all(Inequality::holds)
    }

    /// The inequality with the least margin.
    #[must_use]
    pub fn tightest(&self) -> Option<Inequality> {
        inequality::tightest(&self.inequalities)
    }
}

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

/// Which of the two derivations a form follows.
#[derive(Clone, Copy, PartialEq)]
enum Derivation {
    Printed,
    Sharp,
}

impl Certificate {
    /// Works out every inequality for `configuration`, in a bounded amount of work.
    ///
    /// # Errors
    /// If a bound is beyond double precision; no configuration that its constructors accept leads there.
    pub fn new(configuration: &Configuration) -> Result<Self, ParameterError> {
        let printed = form(configuration, Derivation::Printed);
        let sharp = form(configuration, Derivation::Sharp);
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

/// Bounds on the desired rates with the position feedback at `m_p` (zero: the reference alone).
fn desired_rates(configuration: &Configuration, m_p: f64, derivation: Derivation) -> DesiredRates {
    let (gains, bounds) = (configuration.gains(), configuration.bounds());
    let gravity = f64::from(configuration.vehicle().gravity);
    let inertia = configuration.vehicle().inertia.map(f64::from);
    let (k_f, k_s) = (f64::from(gains.k_f), f64::from(gains.k_s));
    let printed = printed::desired_rates(k_f, k_s, m_p, gravity, bounds, &inertia);
    match derivation {
        Derivation::Printed => printed,
        // Both are bounds, so the lesser one is: far from hover the lemma can be the sharper of the two.
        Derivation::Sharp => {
            sharp::desired_rates(&Reachable::new(k_f, k_s, m_p, gravity, bounds), bounds, &inertia).min(&printed)
        }
    }
}

fn form(configuration: &Configuration, derivation: Derivation) -> Form {
    let (vehicle, limits, gains) = (configuration.vehicle(), configuration.limits(), configuration.gains());
    let bounds = configuration.bounds();
    let (mass, gravity, m_p) = (f64::from(vehicle.mass), f64::from(vehicle.gravity), f64::from(gains.m_p));
    let (horizontal, vertical) = (f64::from(bounds.horizontal_acceleration), f64::from(bounds.vertical_acceleration));
    let raised = 1.0 + ARITHMETIC_ALLOWANCE;

    let reach = Reachable::new(f64::from(gains.k_f), f64::from(gains.k_s), m_p, gravity, bounds);
    let magnitude = match derivation {
        Derivation::Printed => math::SQRT_3 * m_p + math::hypot(horizontal, vertical + gravity),
        Derivation::Sharp => reach.magnitude(),
    };
    let least_law = mass * reach.vertical_least;
    let floor = configuration.thrust_floor().map_or(0.0, f64::from);
    let least = if floor > 0.0 { floor } else { least_law };
    let thrust = Interval { least: least / raised, greatest: mass * magnitude * raised };

    let alone = desired_rates(configuration, 0.0, derivation).feedforward_torque * raised;
    let rates = desired_rates(configuration, m_p, derivation);
    let feedback_torque = feedback_torque(configuration, derivation);
    let torque = rates.feedforward_torque.add_scalar(feedback_torque) * raised;
    let available = limits.torque_max.map(f64::from);
    let thrust_max = f64::from(limits.thrust_max);
    let feasible = mass * (gravity + math::hypot(horizontal, vertical)) * raised;

    let inequalities = [
        Inequality::new("A1 vertical acceleration K_a3 < g", "m/s^2", vertical, gravity),
        Inequality::new("A1 thrust for the reference", "N", feasible, thrust_max),
        Inequality::new("A1 roll torque for the reference", "N m", alone.x, available.x),
        Inequality::new("A1 pitch torque for the reference", "N m", alone.y, available.y),
        Inequality::new("A1 yaw torque for the reference", "N m", alone.z, available.z),
        Inequality::new("T1 saturation level M_p < g - K_a3", "m/s^2", m_p, gravity - vertical),
        Inequality::new("T1 least thrust > 0, floor at most m (g - M_p - K_a3)", "N", floor, least_law).or_equal(),
        Inequality::new("T1 greatest thrust", "N", thrust.greatest, thrust_max),
        Inequality::new("T2 roll torque", "N m", torque.x, available.x),
        Inequality::new("T2 pitch torque", "N m", torque.y, available.y),
        Inequality::new("T2 yaw torque", "N m", torque.z, available.z),
    ];
    Form { rates, thrust, torque, feedback_torque, inequalities }
}

/// iota of Theorem 2. The sharp form uses what the saturation reaches at |theta| = 1 + delta instead of its limit.
fn feedback_torque(configuration: &Configuration, derivation: Derivation) -> f64 {
    let gains = configuration.gains();
    let (m_theta, m_omega) = (f64::from(gains.m_theta), f64::from(gains.m_omega));
    let radius = 1.0 + f64::from(gains.delta);
    let attitude = match derivation {
        Derivation::Printed => m_theta,
        Derivation::Sharp => {
            let argument = f64::from(gains.k_theta) * radius;
            m_theta * argument / math::hypot(m_theta, argument)
        }
    };
    (1.0 + radius * radius) * attitude / 4.0 + m_omega
}

#[cfg(test)]
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
