//! Every constant from a vehicle's numbers. Section 14 of `docs/extended-law.md` derives each formula.
//!
//! With T the rotors' lag and the delay together, h the period, J the mean moment of inertia of the tilt, J_max the
//! greater of its two, and the rotors' greatest torque and thrust:
//!
//! | what | formula |
//! |---|---|
//! | M, greatest torque about the tilt's axes | the least room of the budget's rows |
//! | w_0 | 0.22 / (h/2 + 0.12 T + 10 ms) |
//! | w_a, bandwidth of the tilt, rad/s | w_0 sqrt(0.15 m / r), at most w_0 and sqrt(2 M / J); r = 2 sqrt(J / m) |
//! | k_theta; k_omega | 4 J w_a^2; 1.7 w_a J |
//! | alpha_0; M_theta | 0.13 M / J_max; 0.95 (M - J_max alpha_0) |
//! | r_0 | M_theta^2 / (8 J w_a^2 M): beyond it the tilt brakes along a parabola |
//! | Omega | 0.5 sqrt(M / J_max) |
//! | k_f, k_s, k_d | 1.12 w_a, 3.1 k_f, 1.5 w_a |
//! | k_v, k_p across | 0.54 w_a, 0.55 k_v^2 |
//! | k_v, k_p along the vertical | 1.4 and 1.96 times that, less where k_v T would be above 0.42 |
//! | A_h, gamma | the thrust beside 0.7 of the weight; 75 degrees or the angle that the least lift allows |
//! | braking across and along the vertical | 0.7 |
//! | v_c across and up; down | 15 m/s; 8 m/s |
//! | D_h, D_z- | 0.98 A_h, 0.95 of the lift beside the weight: a tick cuts the estimate to what thrust holds |
//! | L across; vertical | 1.5 w_a; 1.33 times that, or as much less as k_v |
//! | A | half of yaw's torque near the target over J_33, at most 20 rad/s^2 |
//! | W_max; w_y, bandwidth of the heading | 3.2 sqrt(A), at most 0.4 w_a; 2.4 sqrt(A), at most 0.3 w_a |
//! | c_1, c_2 | w_y^2, 1.5 w_y |
//! | D_t, D_y | 0.4 M, half of the limit of yaw |

use super::actuators::ActuatorParameters;
use super::budget::{TORQUE_THRUST_SHARE, TorqueBudget};
use super::fallback::Slowed;
use super::parameters::ExtendedParameters;
use crate::allocation::Rotors;
use crate::math::{self, max_f64, min_f64};
use crate::reference::ReferenceBounds;
use crate::vehicle::{Limits, Vehicle};

/// The numbers of a vehicle.
#[derive(Debug, Clone, Copy)]
pub struct Airframe<'a> {
    /// The body.
    pub vehicle: &'a Vehicle,
    /// Its limits.
    pub limits: &'a Limits,
    /// Its rotors, if it has any.
    pub rotors: Option<&'a Rotors>,
    /// How they respond.
    pub actuators: ActuatorParameters,
    /// Between ticks, s.
    pub period: f32,
    /// Known drag across per velocity and mass, 1/s.
    pub drag: f32,
}

/// delta and alpha.
const PATH_LIFTING: [f32; 2] = [0.01, 0.25];
/// The least and the greatest estimate of the thrust scale.
const THRUST_SCALE_RANGE: [f64; 2] = [0.9, 1.15];
/// A vehicle that falls with this acceleration still has thrust to turn, in shares of g.
const FALL_SHARE: f64 = 0.63;
/// The references' vertical acceleration that the thrust floor allows, m/s^2.
const REFERENCE_FALL_M_PER_S2: f64 = 1.0;

/// Constants that the file gives, in the table's order; the others follow from them.
pub type Given = [Option<f32>; ExtendedParameters::COUNT];

/// No constant given.
pub const NOTHING_GIVEN: Given = [None; ExtendedParameters::COUNT];

/// The constant that the file gives, or its formula.
fn chosen(given: &Given, key: &str, formula: f64) -> f64 {
    let found = ExtendedParameters::TABLE.iter().zip(given).find(|(constant, _)| constant.key == key);
    found.and_then(|(_, value)| *value).map_or(formula, f64::from)
}

/// What stays unknown of when a pose was true and when a command acts, s, beside half a tick and a part of T.
const UNKNOWN_DELAY_S: f64 = 0.01;
/// w_0 times the delay that projection leaves, rad.
const DELAY_PHASE_RAD: f64 = 0.22;
/// r up to which w_a is w_0, m.
const SMALL_RADIUS_M: f64 = 0.15;

/// The bandwidths that inertia, torque, lag and sampling allow.
struct Speeds {
    /// J, kg m^2.
    inertia: f64,
    /// T, s.
    late: f64,
    /// w_a and w_y, rad/s.
    tilt: f64,
    heading: f64,
}

impl Speeds {
    fn of(airframe: &Airframe, strength: &Strength) -> Self {
        let [mass, j_1, j_2] =
            [airframe.vehicle.mass, airframe.vehicle.inertia.x, airframe.vehicle.inertia.y].map(f64::from);
        let inertia = 0.5 * (j_1 + j_2);
        let late = f64::from(airframe.actuators.lag) + f64::from(airframe.actuators.delay);
        let left = 0.5 * f64::from(airframe.period) + 0.12 * late + UNKNOWN_DELAY_S;
        let radius = 2.0 * math::sqrt_f64(inertia / mass);
        let by_size = math::sqrt_f64(min_f64(SMALL_RADIUS_M / radius, 1.0));
        let by_torque = math::sqrt_f64(2.0 * strength.tilt / inertia);
        let tilt = min_f64(by_size * DELAY_PHASE_RAD / left, by_torque);
        let heading = min_f64(0.3 * tilt, 2.4 * math::sqrt_f64(strength.yaw_acceleration));
        Self { inertia, late, tilt, heading }
    }
}

/// What rotors and limits give, and the torques' constants.
struct Strength {
    budget: TorqueBudget,
    floor_margin: f64,
    /// s_lo and s_hi.
    scale: [f64; 2],
    /// M, N m.
    tilt: f64,
    turn_rate: f64,
    turn_reserve: f64,
    m_tilt: f64,
    /// A, rad/s^2.
    yaw_acceleration: f64,
    a_down: f64,
    force_up: f64,
}

impl Strength {
    fn of(airframe: &Airframe, given: &Given) -> Self {
        let or = |key: &str, formula: f64| chosen(given, key, formula);
        let Airframe { vehicle, limits, rotors, .. } = *airframe;
        let [mass, gravity, j_3] = [vehicle.mass, vehicle.gravity, vehicle.inertia.z].map(f64::from);
        // Without rotors the delivered thrust is the commanded one.
        let usual = if rotors.is_some() { THRUST_SCALE_RANGE } else { [1.0, 1.0] };
        let scale = [or("scale_least", usual[0]), or("scale_greatest", usual[1])];
        let floor_margin = or("floor_margin", 1e-3 * mass * gravity);
        let budget = TorqueBudget::<f64>::new(floor_margin as f32, limits, rotors);
        let tilt = min_f64(budget.radius(scale[0]), budget.radius(scale[1]));
        let [tilt_reach, yaw_reach] = budget.reach.map(|reach| max_f64(reach, 1e-12));
        let [bottom, top] = budget.ends;
        let [yaw_limit, thrust_max] = [limits.torque_max.z, limits.thrust_max].map(f64::from);

        // Near the target the least thrust is above the idle thrust and the share of A and alpha_0 in it.
        let a_down = or("a_down", FALL_SHARE * gravity);
        let force_up = or("force_up", 0.36 * a_down);
        let least = (1.0 - TORQUE_THRUST_SHARE) * mass * (gravity - force_up - REFERENCE_FALL_M_PER_S2);
        let above = max_f64(least - scale[1] * bottom - budget.margin, 0.0);
        let below = max_f64(scale[0] * min_f64(top, thrust_max) - 1.1 * mass * gravity, 0.0);
        let yaw = min_f64(yaw_limit, 0.8 * min_f64(above, below) / yaw_reach);
        let yaw_acceleration = or("yaw_acceleration", min_f64(0.5 * yaw / j_3, 20.0));

        let j_max = max_f64(f64::from(vehicle.inertia.x), f64::from(vehicle.inertia.y));
        let lifted = 0.9 * max_f64(above - yaw_reach * j_3 * yaw_acceleration, 0.0) / (tilt_reach * j_max);
        let turn_reserve = or("turn_reserve", min_f64(0.13 * tilt / j_max, lifted));
        Self {
            floor_margin,
            scale,
            tilt,
            turn_rate: or("turn_rate", 0.5 * math::sqrt_f64(tilt / j_max)),
            turn_reserve,
            m_tilt: or("m_tilt", 0.95 * (tilt - j_max * turn_reserve)),
            yaw_acceleration,
            a_down,
            force_up,
            budget,
        }
    }
}

/// The envelope of the position law, m/s^2.
struct Envelope {
    a_across: f64,
    /// tan gamma.
    tangent: f64,
    force_across: f64,
    force_down: f64,
}

impl Envelope {
    fn of(airframe: &Airframe, given: &Given, strength: &Strength) -> Self {
        let gravity = f64::from(airframe.vehicle.gravity);
        let held = |scale: f64| strength.budget.held_acceleration(airframe.vehicle, airframe.limits, scale);
        let greatest = held(1.0);
        // The least lift within the cone at the greatest |u|.
        let cosine = min_f64(1.05 * (gravity - strength.a_down) / greatest, 1.0);
        let steepest = math::sqrt_of_rounded(1.0 - cosine * cosine) / cosine;
        let tangent = min_f64(min_f64(steepest, math::tan(75.0 * core::f64::consts::PI / 180.0)), 10.0);
        let widest = math::sqrt_of_rounded(greatest * greatest - 0.49 * gravity * gravity);
        let a_across = chosen(given, "a_across", min_f64(max_f64(widest, 0.5), gravity * tangent));
        let force_across = chosen(given, "force_across", 0.98 * a_across);
        let force_down = max_f64(0.95 * (greatest - gravity), 0.0);
        Self { a_across, tangent, force_across, force_down }
    }
}

/// The constants for `airframe`; the `given` ones stay as they are.
#[must_use]
pub fn constants(airframe: &Airframe, given: &Given) -> ExtendedParameters {
    let strength = Strength::of(airframe, given);
    let speeds = Speeds::of(airframe, &strength);
    let envelope = Envelope::of(airframe, given, &strength);
    let single = |value: f64| value as f32;

    let (inertia, w_a, w_y) = (speeds.inertia, speeds.tilt, speeds.heading);
    let stiffness = inertia * w_a * w_a;
    let k_f = chosen(given, "k_f", 1.12 * w_a);
    let k_v = chosen(given, "k_v_across", 0.54 * w_a);
    let k_p = 0.55 * k_v * k_v;
    let stiffer = min_f64(1.4, 0.42 / (k_v * max_f64(speeds.late, 1e-3)));
    let follow = 1.5 * w_a;
    let yaw_acceleration = strength.yaw_acceleration;
    let [delta, alpha] = PATH_LIFTING;
    let formulas = ExtendedParameters {
        k_p_across: single(k_p),
        k_p_vertical: single(stiffer * stiffer * k_p),
        k_v_across: single(k_v),
        k_v_vertical: single(stiffer * k_v),
        k_f: single(k_f),
        k_s: single(3.1 * k_f),
        k_d: single(1.5 * w_a),
        a_across: single(envelope.a_across),
        a_down: single(strength.a_down),
        tilt_max: single(math::atan(envelope.tangent)),
        v_across: 15.0,
        v_up: 15.0,
        v_down: 8.0,
        braking_across: 0.7,
        braking_vertical: 0.7,
        turn_rate: single(strength.turn_rate),
        turn_reserve: single(strength.turn_reserve),
        k_tilt: single(4.0 * stiffness),
        m_tilt: single(strength.m_tilt),
        k_omega_t: single(1.7 * w_a * inertia),
        r_0: single((strength.m_tilt * strength.m_tilt / (8.0 * stiffness * strength.tilt)).clamp(1e-3, 1e3)),
        delta,
        alpha,
        yaw_acceleration: single(yaw_acceleration),
        yaw_rate: single(min_f64(0.4 * w_a, 3.2 * math::sqrt_f64(yaw_acceleration))),
        c_1: single(w_y * w_y),
        c_2: single(1.5 * w_y),
        floor_margin: single(strength.floor_margin),
        force_across: single(envelope.force_across),
        force_heading: single(min_f64(envelope.force_across, 2.5)),
        force_up: single(strength.force_up),
        force_down: single(envelope.force_down),
        force_bandwidth_across: single(follow),
        force_bandwidth_vertical: single(min_f64(1.33, 0.95 * stiffer) * follow),
        drag_across: airframe.drag,
        torque_tilt: single(0.4 * strength.tilt),
        torque_yaw: 0.5 * airframe.limits.torque_max.z,
        torque_bandwidth: 2.0,
        scale_least: single(strength.scale[0]),
        scale_greatest: single(strength.scale[1]),
        scale_rate: 0.3,
    };
    let mut values = formulas.values();
    for ((value, given), constant) in values.iter_mut().zip(given).zip(&ExtendedParameters::TABLE) {
        *value = given.unwrap_or(value.clamp(constant.range.min, constant.range.max));
    }
    ExtendedParameters::from_values(values)
}

/// Bounds of the motions that `parameters` can fly on `airframe`: the governor's limits.
#[must_use]
pub fn reference_bounds(airframe: &Airframe, parameters: &ExtendedParameters) -> ReferenceBounds {
    let p = parameters;
    let budget = TorqueBudget::<f64>::new(p.floor_margin, airframe.limits, airframe.rotors);
    let weakest = budget.held_acceleration(airframe.vehicle, airframe.limits, f64::from(p.scale_least));
    let [gravity, across, down, up, rate, reserve] =
        [airframe.vehicle.gravity, p.a_across, p.a_down, p.force_up, p.turn_rate, p.turn_reserve].map(f64::from);
    let held_beyond = weakest - gravity;
    let horizontal = min_f64(min_f64(3.0, 0.2 * across), math::sqrt_of_rounded(0.1 * gravity * held_beyond));
    let vertical = min_f64(min_f64(1.0, 0.15 * min_f64(down, across)), 0.2 * held_beyond);
    // The rest of Omega and alpha_0 beside the slowed law, at the least |u|.
    let slowed = Slowed::<f64>::new(p, airframe.vehicle.gravity);
    let [slow_jerk, slow_snap] = slowed.derivatives(p);
    let least = gravity - up - vertical - slowed.level;
    // A frame that is tilted turns about its thrust axis as well, by a part of how u turns: yaw has to follow.
    let yaw = f64::from(p.yaw_acceleration);
    let slope = (f64::from(p.force_heading) + horizontal) / (gravity - up);
    let turned = 0.6 * min_f64(rate, math::sqrt_f64(reserve));
    let jerk = min_f64(min_f64(8.0, turned * least - slow_jerk), least * math::sqrt_f64(0.2 * yaw / slope));
    let snap = min_f64(0.8 * ((reserve - turned * turned) * least - slow_snap), 0.4 * yaw * least / slope);
    let tilt = math::hypot(1.0, slope);
    let single = |value: f64| max_f64(value, 0.0) as f32;
    ReferenceBounds {
        horizontal_speed: 5.0,
        horizontal_acceleration: single(horizontal),
        vertical_acceleration: single(vertical),
        jerk: single(jerk),
        snap: single(min_f64(snap, 40.0)),
        heading_rate: single(0.3 * f64::from(p.yaw_rate) / tilt),
        heading_second_derivative: single(0.3 * f64::from(p.yaw_acceleration) / tilt),
    }
}
