//! The certificate of the extended law: the inequalities that its construction does not ensure. Derived in
//! `docs/extended-law.md`, section 11.
//!
//! | inequality | consequence |
//! |---|---|
//! | A_- < g - K_a3 | T1: u_z > 0, the law is defined |
//! | m \|g e3 + p_d'' + kappa p_d'\| < (1 - mu) m U at s_lo | A1: near the target the thrust is not cut |
//! | \|p\| < Omega, \|q\| < alpha_0 for the reference and the slowed law | A1: near the target, and slowed, the thrust direction turns as it is wanted to |
//! | the floor beside J_33 A and J_max alpha_0 < (1 - mu) m n | G: near the target the thrust is not raised |
//! | \|w*_3'\| < A for the reference, with d up to F_h across and D_z+ | A1: the heading arrives |
//! | M_theta + J_max alpha_0 < R(s) in every row | T2: roll and pitch within their limits; R: each rotor within its range; T1: the floor below T_max |
//! | sqrt(2) D_t + J_max alpha_0 < R(s) | D: the greatest bias, about both axes, leaves the reserve |
//! | J_33 A < the limit of yaw, and what the reference's thrust leaves | T2: yaw |
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
use crate::extended::budget::{BudgetRow, RowSource, TORQUE_THRUST_SHARE, TorqueBudget};
use crate::extended::fallback::Slowed;
use crate::extended::parameters::Extended;
use crate::math::real::Real;
use crate::reference::ReferenceBounds;
use crate::vehicle::Vehicle;
use heapless::Vec;
use nalgebra::Vector3;

/// The greatest number of inequalities.
const INEQUALITIES_MAX: usize = 11;

/// Everything the extended law can command.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtendedBounds<R = f64> {
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
    pub inequalities: Vec<Inequality<R>, INEQUALITIES_MAX>,
}

impl<R: Real> ExtendedCertificate<R> {
    /// Works out every inequality for `law`, the one of `configuration`.
    ///
    /// # Errors
    /// None today; the paper's law has some.
    #[inline(never)] // as the paper law's
    pub fn new(configuration: &Configuration, law: &ExtendedLaw) -> Result<Self, ParameterError> {
        let parameters = &law.parameters;
        let budget = TorqueBudget::new(parameters.floor_margin, configuration.limits(), configuration.rotors());
        let all = feasibility(configuration, parameters, &budget)
            .into_iter()
            .chain([heading(configuration, parameters)])
            .chain(torques(configuration, parameters, &budget));
        Ok(Self { bounds: bounds(configuration, parameters, &budget), inequalities: collected(all) })
    }
}

/// The reference with its drag, and room for it.
fn feasibility<R: Real>(
    configuration: &Configuration,
    parameters: &Extended,
    budget: &TorqueBudget<R>,
) -> [Inequality<R>; 5] {
    let (vehicle, bounds) = (configuration.vehicle(), configuration.bounds());
    let [mass, gravity] = [vehicle.mass, vehicle.gravity].map(R::from);
    let p = parameters;
    let reference = with_drag(bounds, p.drag_across);
    let raised = R::from(1.0) + ARITHMETIC_ALLOWANCE;
    let left = R::from(1.0) - TORQUE_THRUST_SHARE;
    let vertical = R::from(bounds.vertical_acceleration);
    let up = R::from(p.force_up);

    let [tilt_reach, yaw_reach] = budget.reach;
    let yaw = yaw_reach * R::from(vehicle.inertia.z) * R::from(p.yaw_acceleration);
    let [bottom, _] = budget.ends;
    let available = mass * budget.held_acceleration(vehicle, configuration.limits(), R::from(p.scale_least));

    let slowed = Slowed::<R>::new(p, vehicle.gravity);
    let [slow_jerk, slow_snap] = slowed.derivatives(p);
    let jerk = R::from(reference.jerk) + slow_jerk;
    let snap = R::from(reference.snap) + slow_snap;
    let least = gravity - vertical - up - slowed.level;
    let rate = jerk / least * raised;
    // 2 p r / n is at most rate^2 where p^2 + r^2 / n^2 = rate^2.
    let acceleration = (snap / least + rate * rate) * raised;
    let [most_rate, max] = [p.turn_rate, p.turn_reserve].map(R::from);
    let turning = tilt_reach * tilt_inertia::<R>(vehicle) * max;
    let floor = (R::from(p.scale_greatest) * bottom + budget.margin + yaw + turning) * raised;
    let weakest = left * mass * (gravity - vertical - up);
    [
        Inequality::new("T1 fall A_- < g - K_a3", "m/s^2", R::from(p.a_down), gravity - vertical),
        Inequality::new(
            "A1 thrust for the reference",
            "N",
            reference_thrust::<R>(configuration, p) * raised,
            available,
        ),
        Inequality::new("A1 turning rate for the reference", "rad/s", positive(rate, least), most_rate),
        Inequality::new("A1 turning acceleration", "rad/s^2", positive(acceleration, least), max),
        Inequality::new("G floor at the target < thrust", "N", floor, weakest),
    ]
}

/// The greatest thrust for the reference with its drag, N.
fn reference_thrust<R: Real>(configuration: &Configuration, parameters: &Extended) -> R {
    let (vehicle, bounds) = (configuration.vehicle(), configuration.bounds());
    let across = R::from(with_drag(bounds, parameters.drag_across).horizontal_acceleration);
    R::from(vehicle.mass) * across.hypot(R::from(vehicle.gravity) + R::from(bounds.vertical_acceleration))
}

/// J_max, kg m^2.
fn tilt_inertia<R: Real>(vehicle: &Vehicle) -> R {
    R::from(vehicle.inertia.x).greater(R::from(vehicle.inertia.y))
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
fn heading<R: Real>(configuration: &Configuration, parameters: &Extended) -> Inequality<R> {
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
    let fastest = if alone.vertical_min.lower() > 0.0 { sharp::turning_rates(&alone, &forced) } else { infinite };
    let acceleration = fastest[1] * (one + ARITHMETIC_ALLOWANCE);
    Inequality::new("A1 heading acceleration", "rad/s^2", acceleration, R::from(parameters.yaw_acceleration))
}

/// The least R(s) of the rows about `bound`, N m; infinite without any.
fn min_capacity<R: Real>(parameters: &Extended, budget: &TorqueBudget<R>, bound: RowSource) -> R {
    let ends = [parameters.scale_least, parameters.scale_greatest].map(R::from);
    let rows = budget.rows.iter().filter(|row| row.bound == bound);
    rows.flat_map(|row| ends.map(|scale| row.capacity(scale))).fold(R::from(f64::INFINITY), R::lesser)
}

/// The torque of the tilt's feedback beside the reserve, and that of the greatest bias; yaw's beside the thrust for the
/// reference.
fn torques<R: Real>(
    configuration: &Configuration,
    parameters: &Extended,
    budget: &TorqueBudget<R>,
) -> impl Iterator<Item = Inequality<R>> {
    let (vehicle, limits) = (configuration.vehicle(), configuration.limits());
    let p = parameters;
    let raised = R::from(1.0) + ARITHMETIC_ALLOWANCE;
    let taken = tilt_inertia::<R>(vehicle) * R::from(p.turn_reserve);
    let rooms = [
        ("T2 roll and pitch torque", RowSource::Limit),
        ("R rotors' range", RowSource::Rotors),
        ("T1 thrust floor at the greatest torque", RowSource::Floor),
    ]
    .map(|(name, bound)| (name, min_capacity(p, budget, bound)));
    let feedback = rooms.map(|(name, room)| Inequality::new(name, "N m", (R::from(p.m_tilt) + taken) * raised, room));
    let least = rooms.into_iter().map(|(_, room)| room).fold(R::from(f64::INFINITY), R::lesser);
    // The level is each axis's.
    let bias = R::from(p.torque_tilt) * R::from(2.0).sqrt();
    let bias = Inequality::new("D greatest torque bias", "N m", (bias + taken) * raised, least);
    let yaw = R::from(vehicle.inertia.z) * R::from(p.yaw_acceleration) * raised;
    let beside =
        R::from(p.scale_least) * budget.ends[1] - budget.margin - reference_thrust::<R>(configuration, p) * raised;
    let limit = R::from(limits.torque_max.z);
    let left = if budget.reach[1].lower() > 0.0 { limit.lesser(beside / budget.reach[1]) } else { limit };
    let yaw = Inequality::new("T2 yaw torque", "N m", yaw, left);
    // Without rotors there are none of their rows.
    feedback.into_iter().filter(|row| row.available.lower() < f64::INFINITY).chain([bias, yaw])
}

/// The greatest commands if every inequality holds.
fn bounds<R: Real>(
    configuration: &Configuration,
    parameters: &Extended,
    budget: &TorqueBudget<R>,
) -> ExtendedBounds<R> {
    let p = parameters;
    let raised = R::from(1.0) + ARITHMETIC_ALLOWANCE;
    let scales = [p.scale_least, p.scale_greatest].map(R::from);
    let zero = R::from(0.0);
    let axes = [[R::from(1.0), zero], [zero, R::from(1.0)]];
    let [roll, pitch] = axes.map(|axis| max_along(&budget.rows, axis, scales));
    let limits = configuration.limits();
    let [mut together, mut yaw] = [limits.thrust_max, limits.torque_max.z].map(R::from);
    let mut rotors = Vec::new();
    if let Some(all) = configuration.rotors() {
        let mut thrust = R::from(0.0);
        // What all rotors together make about the thrust axis, either way.
        let mut twist = [R::from(0.0); 2];
        for (rotor, column) in all.iter().zip(all.effectiveness()) {
            let [least, greatest] = [rotor.thrust_min, rotor.thrust_max].map(R::from);
            let parts = [least, greatest].map(|thrust| thrust * R::from(column.w));
            thrust += greatest;
            twist = [twist[0] + parts[0].greater(parts[1]), twist[1] - parts[0].lesser(parts[1])];
            // As many as there are rotors: it fits.
            let _ = rotors.push(Interval { min: least, max: greatest });
        }
        together = together.lesser(thrust * scales[1]);
        yaw = yaw.lesser(twist[0].greater(twist[1]) * scales[1]);
    }
    ExtendedBounds {
        thrust: Interval { min: R::from(p.floor_margin) / raised, max: together },
        torque: Vector3::new(roll * raised, pitch * raised, yaw * raised),
        rotors,
    }
}

/// The greatest torque along `axis` that all rows allow between two thrust scales, N m: `axis` is a sum of the
/// directions of two rows, and the torque along it at most the sum of their rooms with the same weights.
fn max_along<R: Real>(rows: &[BudgetRow<R>], axis: [R; 2], scales: [R; 2]) -> R {
    let mut least = R::from(f64::INFINITY);
    for (place, a) in rows.iter().enumerate() {
        for b in rows.iter().skip(place + 1) {
            let determinant = a.direction[0] * b.direction[1] - a.direction[1] * b.direction[0];
            if determinant.abs().lower() > 1e-6 {
                let of_a = ((axis[0] * b.direction[1] - axis[1] * b.direction[0]) / determinant).abs();
                let of_b = ((a.direction[0] * axis[1] - a.direction[1] * axis[0]) / determinant).abs();
                let [low, high] = scales.map(|scale| of_a * a.capacity(scale) + of_b * b.capacity(scale));
                least = least.lesser(low.greater(high));
            }
        }
    }
    least
}

#[cfg(test)]
mod tests;
