//! The certificate of the extended law: the inequalities that its construction does not ensure. Derived in
//! `docs/extended-law.md`, section 11.
//!
//! | inequality | consequence |
//! |---|---|
//! | A_- < g - K_a3 | T1: u_z > 0, the law is defined |
//! | (with d up to its levels) m \|g e3 + p_d'' - d\| < the rotors' thrust less the share of the torques near the target | A1: near the target the thrust is not cut |
//! | \|p\| < Omega, \|q\| < 0.6 alpha_0 for the reference and the net's level | A1: near the target, and in the net, the frame is not limited |
//! | \|w*_3\| < W_max and 0.4 alpha_0 over \|p\|, \|w*_3'\| < A for the reference, with d up to F_h across and D_z+ | A1: the heading arrives |
//! | N_0 + L alpha_0 < (1 - mu) m n | G: near the target the thrust is not raised |
//! | qbar < eta, 2 qbar M_t < w eta_t sqrt(1 - qbar^2) | E: the only equilibrium of the attitude is the target |
//! | \|P\| < M_all | D: damping always has a share |
//! | t (M_all + J_max alpha) + y J_33 alpha <= R with the reserve alpha = alpha_0 | T2: roll, pitch and yaw within the limits; R: every rotor within its range; T1: the thrust floor below T_max |
//!
//! Everything else about commands holds by construction ([`crate::extended`]): a tick uses only the available thrust
//! and torque.

use super::form::{ARITHMETIC_ALLOWANCE, Interval};
use super::inequality::Inequality;
use super::reachable::Reachable;
use super::sharp;
use crate::allocation::collected;
use crate::allocation::geometry::ROTORS_MAX;
use crate::configuration::{Configuration, ExtendedLaw};
use crate::error::ParameterError;
use crate::extended::budget::{RATE_BEYOND, ROWS, THRUST_LEFT, TorqueBudget};
use crate::extended::parameters::Extended;
use crate::extended::position::net_level;
use crate::extended::turning;
use crate::math::real::Real;
use crate::path_lifting::switching_magnitude;
use crate::reference::ReferenceBounds;
use heapless::Vec;
use nalgebra::Vector3;

/// The number of cells of the tilt in the search for the potential's greatest torque.
const POTENTIAL_CELLS: usize = 64;

/// The greatest number of inequalities.
const MOST: usize = 11 + ROWS;

/// Everything the extended law can command.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtendedBounds<R = f64> {
    /// Greatest |omega_d12| and |omega'_d12|, rad/s and rad/s^2.
    pub rates: [R; 2],
    /// Every thrust, N.
    pub thrust: Interval<R>,
    /// Greatest |torque| about each body axis, N m.
    pub torque: Vector3<R>,
    /// Every thrust of each rotor as commanded, divided by the thrust scale, N.
    pub rotors: Vec<Interval<R>, ROTORS_MAX>,
}

/// Every inequality about one configuration of the extended law.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtendedCertificate<R = f64> {
    /// The law's greatest commands.
    pub bounds: ExtendedBounds<R>,
    /// The inequalities, in the order of this module's table.
    pub inequalities: Vec<Inequality<R>, MOST>,
}

impl<R: Real> ExtendedCertificate<R> {
    /// Works out every inequality for `law`, the one of `configuration`.
    ///
    /// # Errors
    /// None today; the paper's law has some.
    #[inline(never)] // as the paper law's
    pub fn new(configuration: &Configuration, law: &ExtendedLaw) -> Result<Self, ParameterError> {
        let parameters = &law.parameters;
        let (vehicle, limits) = (configuration.vehicle(), configuration.limits());
        let budget = TorqueBudget::new(parameters, vehicle, limits, configuration.rotors());
        let all = feasibility(configuration, parameters, &budget)
            .into_iter()
            .chain(heading(configuration, parameters))
            .chain(attitude(parameters))
            .chain(torques(parameters, &budget));
        Ok(Self { bounds: bounds(configuration, parameters, &budget), inequalities: collected(all) })
    }
}

/// The reference with its drag, and room for it.
fn feasibility<R: Real>(
    configuration: &Configuration,
    parameters: &Extended,
    budget: &TorqueBudget<R>,
) -> [Inequality<R>; 6] {
    let (vehicle, bounds) = (configuration.vehicle(), configuration.bounds());
    let [mass, gravity] = [vehicle.mass, vehicle.gravity].map(R::from);
    let p = parameters;
    let reference = with_drag(bounds, p.drag_across);
    let raised = R::from(1.0) + ARITHMETIC_ALLOWANCE;
    let left = R::from(1.0) - THRUST_LEFT;
    let [across, vertical] = [reference.horizontal_acceleration, bounds.vertical_acceleration].map(R::from);
    let [force_across, up, down] = [p.force_across, p.force_up, p.force_down].map(R::from);

    let [each, taken] = budget.ceiling;
    let limit = R::from(configuration.limits().thrust_max);
    let available = left * (R::from(p.scale_least) * each - taken).lesser(limit);
    let thrust = |across: R, vertical: R| mass * across.hypot(gravity + vertical) * raised;

    // Across and along the vertical the net's level is reached at once.
    let net = R::from(2.0).sqrt() * net_level::<R>(p, vehicle.gravity);
    let [k_f, k_s] = [p.k_f, p.k_s].map(R::from);
    let jerk = R::from(reference.jerk) + k_f * 2.0 * net;
    let snap = R::from(reference.snap) + k_f * 2.0 * (k_s + k_f) * net;
    let least = gravity - vertical - up - net;
    let rate = jerk / least * raised;
    // 2 p r / n is at most rate^2 where p^2 + r^2 / n^2 = rate^2.
    let acceleration = (snap / least + rate * rate) * raised / R::from(turning::TURNED);
    let [most_rate, most] = [p.turn_rate, p.turn_reserve].map(R::from);
    let floor = (budget.floor + budget.floor_per_acceleration * most) * raised;
    let weakest = left * mass * (gravity - vertical - up);
    [
        Inequality::new("T1 fall A_- < g - K_a3", "m/s^2", R::from(p.a_down), gravity - vertical),
        Inequality::new("A1 thrust against force across", "N", thrust(across + force_across, vertical), available),
        Inequality::new("A1 thrust against force down", "N", thrust(across, vertical + down), available),
        Inequality::new("A1 turning rate for the reference", "rad/s", positive(rate, least), most_rate),
        Inequality::new("A1 turning acceleration", "rad/s^2", positive(acceleration, least), most),
        Inequality::new("G floor at the target < thrust", "N", floor, weakest),
    ]
}

/// `value` where its divisor `least` is positive; otherwise a value with which no inequality holds.
fn positive<R: Real>(value: R, least: R) -> R {
    if least.lower() > 0.0 { value } else { R::from(f64::INFINITY) }
}

/// `bounds` of p_d'' + kappa p_d' and its derivatives, `drag` being kappa, 1/s.
fn with_drag(bounds: &ReferenceBounds, drag: f32) -> ReferenceBounds {
    ReferenceBounds {
        horizontal_acceleration: at_least(bounds.horizontal_acceleration, drag, bounds.horizontal_speed),
        jerk: at_least(bounds.jerk, drag, bounds.horizontal_acceleration),
        snap: at_least(bounds.snap, drag, bounds.jerk),
        ..*bounds
    }
}

/// value + factor by, none of them negative: the next number is not below it, whatever two roundings took.
fn at_least(value: f32, factor: f32, by: f32) -> f32 {
    if factor > 0.0 { (value + factor * by).next_up() } else { value }
}

/// The heading of the reference, with the force that tilts u.
fn heading<R: Real>(configuration: &Configuration, parameters: &Extended) -> [Inequality<R>; 2] {
    let reference = with_drag(configuration.bounds(), parameters.drag_across);
    let forced = ReferenceBounds {
        horizontal_acceleration: at_least(reference.horizontal_acceleration, parameters.force_heading, 1.0),
        ..reference
    };
    let gravity = R::from(configuration.vehicle().gravity) - R::from(parameters.force_up);
    let one = R::from(1.0);
    // With a feedback of zero the filters stay at zero, whatever their bandwidths.
    let alone = Reachable::new(one, one, R::from(0.0), gravity, &forced);
    let infinite = [R::from(f64::INFINITY); 2];
    let fastest = if alone.vertical_least.lower() > 0.0 { sharp::turning_rates(&alone, &forced) } else { infinite };
    let [rate, acceleration] = fastest.map(|rate| rate * (one + ARITHMETIC_ALLOWANCE));
    // The part of alpha_0 that q leaves carries the frame about rho; the law divides it by sqrt(5/4) |p| at most.
    let turned = R::from(1.25).sqrt() * R::from(reference.jerk) / alone.vertical_least;
    let carried =
        (one - R::from(turning::TURNED)) * R::from(parameters.turn_reserve) / turned.greater(R::from(turning::SLOWEST));
    let most = R::from(parameters.yaw_rate).lesser(carried);
    [
        Inequality::new("A1 heading rate for the reference", "rad/s", rate, most),
        Inequality::new("A1 heading acceleration", "rad/s^2", acceleration, R::from(parameters.yaw_acceleration)),
    ]
}

/// Section 6 of the document: no attitude but the target is an equilibrium, and damping always has a share.
fn attitude<R: Real>(parameters: &Extended) -> [Inequality<R>; 3] {
    let qbar: R = switching_magnitude(parameters.delta);
    let [w, eta, m_t, eta_t, m_all] =
        [parameters.w, parameters.eta, parameters.m_t, parameters.eta_t, parameters.m_all].map(R::from);
    let one = R::from(1.0);
    let raised = one + ARITHMETIC_ALLOWANCE;
    let pull = w * eta_t * (one - qbar * qbar).sqrt_of_rounded();
    let potential = greatest_potential::<R>(parameters) * raised;
    [
        Inequality::new("E switch qbar < eta", "1", qbar * raised, eta),
        Inequality::new("E tilt 2 qbar M_t < w eta_t sqrt(1 - qbar^2)", "N m", qbar * 2.0 * m_t * raised, pull),
        Inequality::new("D potential |P| < M_all", "N m", potential, m_all),
    ]
}

/// Greatest w r / 2 + G r sqrt(1 - r^2), N m, over r in [0, 1]: in cells, each term at the end where it is greatest.
#[must_use]
pub fn greatest_potential<R: Real>(parameters: &Extended) -> R {
    let p = parameters;
    let [w, k_t, m_t, eta_t] = [p.w, p.k_t, p.m_t, p.eta_t].map(R::from);
    let rest = |r: R| (R::from(1.0) - r * r).sqrt_of_rounded();
    let of = |cell: usize| {
        let [near, far] = [cell, cell + 1].map(|end| R::from(end as f64 / POTENTIAL_CELLS as f64));
        // k_t r / sqrt(M_t^2 + k_t^2 r^2) rises with r, sqrt(1 - r^2) / sqrt(1 - r^2 + eta_t^2) falls.
        let rising = m_t * k_t * far / m_t.hypot(k_t * far);
        w * 0.5 * far + rising * rest(near) / rest(near).hypot(eta_t)
    };
    (0..POTENTIAL_CELLS).map(of).fold(R::from(0.0), R::greater)
}

/// The rows of the budget, with the reserve.
fn torques<R: Real>(parameters: &Extended, budget: &TorqueBudget<R>) -> impl Iterator<Item = Inequality<R>> {
    const NAMES: [&str; ROWS] =
        ["T2 roll and pitch torque", "T2 yaw torque", "R rotors' range", "T1 thrust floor at the greatest torque"];
    const UNITS: [&str; ROWS] = ["N m", "N m", "N", "N"];
    let reserves: Vec<[R; 2], ROWS> =
        collected(budget.reserves(R::from(parameters.m_all), R::from(parameters.turn_reserve)));
    reserves.into_iter().zip(NAMES).zip(UNITS).map(|(([required, available], name), unit)| {
        Inequality::new(name, unit, required * (R::from(1.0) + ARITHMETIC_ALLOWANCE), available)
    })
}

/// The greatest commands if every inequality holds.
fn bounds<R: Real>(
    configuration: &Configuration,
    parameters: &Extended,
    budget: &TorqueBudget<R>,
) -> ExtendedBounds<R> {
    let p = parameters;
    let raised = R::from(1.0) + ARITHMETIC_ALLOWANCE;
    let [tilt_inertia, yaw_inertia] = budget.inertia;
    let turning = R::from(p.turn_acceleration);
    let (mut tilt, mut yaw) = (R::from(p.m_all) + tilt_inertia * turning, yaw_inertia * turning);
    for row in &budget.rows {
        if row.tilt.lower() > 0.0 {
            tilt = tilt.lesser(row.room / row.tilt);
        }
        if row.yaw.lower() > 0.0 {
            yaw = yaw.lesser(row.room / row.yaw);
        }
    }
    let across = tilt + budget.fixed[0] + R::from(p.torque_tilt);
    let about = yaw + budget.fixed[1] + R::from(p.torque_yaw);
    let mut rotors = Vec::new();
    let mut together = R::from(configuration.limits().thrust_max);
    if let Some(all) = configuration.rotors() {
        for rotor in all.iter() {
            let [least, greatest] = [rotor.thrust_min, rotor.thrust_max].map(R::from);
            // As many as there are rotors: it fits.
            let _ = rotors.push(Interval { least, greatest });
        }
        let thrust = rotors.iter().fold(R::from(0.0), |sum, rotor: &Interval<R>| sum + rotor.greatest);
        together = together.lesser(thrust * R::from(p.scale_greatest));
    }
    ExtendedBounds {
        rates: [R::from(p.turn_rate) * RATE_BEYOND * raised, turning * raised],
        thrust: Interval { least: R::from(p.floor_margin) / raised, greatest: together },
        torque: Vector3::new(across * raised, across * raised, about * raised),
        rotors,
    }
}

#[cfg(test)]
mod tests;
