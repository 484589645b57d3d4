//! Every constant from a vehicle's numbers. Section 14 of `docs/extended-law.md` derives each formula.
//!
//! With T the rotors' lag and the delay together, h the period, J the mean moment of inertia of the tilt, and the
//! rotors' attainable torque and thrust:
//!
//! | what | formula |
//! |---|---|
//! | w_a, bandwidth of the tilt, rad/s | min(12.5, 1.44 sqrt(g / r), 0.3 / (h/2 + T/4)), r = 2 sqrt(J / m) |
//! | M_all | the rest of the budget's rows: see [`constants`] |
//! | tilt stiffness; damping | J w_a^2 = w/4 + k_t / (2 sqrt(1 + eta_t^2)); 1.7 w_a J |
//! | w, M_t | min(1.45 M_all, 3.2 J w_a^2), as much as keeps \|P\| below 0.93 M_all |
//! | r_0 | M_all / (13 J w_a^2): beyond it M_all brakes along a parabola |
//! | alpha_max, alpha_0 | 0.9 M_all / J, 0.14 M_all / J or less where yaw is weak |
//! | Omega | between 2.5 and 5 rad/s, 0.08 of the rotors' torque / J |
//! | k_f, k_s, k_d | 1.12 w_a, 3.1 k_f, 1.6 w_a |
//! | k_v, k_p across; vertical | 0.54 w_a, 0.435 k_v^2; 1.4 and 1.96 times that |
//! | A_h, gamma | the thrust beside 0.7 of the weight; 75 degrees or the angle that the least lift allows |
//! | v_c across; up, down | 1.6 sqrt(A_h / 1 m/s^2) m/s, at most 9; 4.2, 3.5 m/s |
//! | D_h | 0.8 A_h, or 0.72 of the force that the weakest thrust holds, less the drag at 5 m/s |
//! | L across; vertical | 1.1 w_a; 1.33 times that |
//! | yaw: feedback, A, bias | 6, 6 and 4 % of the greatest yaw torque |

use super::actuators::ActuatorParameters;
use super::budget::{THRUST_LEFT, TorqueBudget};
use super::parameters::ExtendedParameters;
use super::position::net_level;
use super::turning::TURNED;
use crate::allocation::Rotors;
use crate::math::{self, greater_f64, lesser_f64};
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

/// The least eta: above qbar, which delta makes.
const ETA_LEAST: f64 = 0.015;
/// eta_t.
const ETA_T: f64 = 0.5;
/// delta, alpha, c_1 and c_2.
const SHARED: [f32; 4] = [0.01, 0.25, 9.0, 6.0];
/// The least and the greatest estimate of the thrust scale.
const SCALE: [f64; 2] = [0.9, 1.15];
/// A vehicle that falls with this acceleration still has thrust to turn, m/s^2; in shares of g.
const FALL: f64 = 0.63;
/// The references' vertical acceleration that the thrust floor allows, m/s^2.
const FALL_LEAST: f64 = 1.0;

/// Constants that the file gives, in the table's order; the others follow from them.
pub type Given = [Option<f32>; ExtendedParameters::COUNT];

/// No constant given.
pub const NOTHING_GIVEN: Given = [None; ExtendedParameters::COUNT];

/// The constants for `airframe`; the `given` ones stay as they are.
#[must_use]
pub fn constants(airframe: &Airframe, given: &Given) -> ExtendedParameters {
    let or = |key: &str, formula: f64| {
        let chosen = ExtendedParameters::TABLE.iter().zip(given).find(|(constant, _)| constant.key == key);
        chosen.and_then(|(_, value)| *value).map_or(formula, f64::from)
    };
    let Airframe { vehicle, limits, rotors, actuators, period, drag } = *airframe;
    let [mass, gravity] = [vehicle.mass, vehicle.gravity].map(f64::from);
    let j = vehicle.inertia.map(f64::from);
    let (tilt_inertia, greatest_inertia) = (0.5 * (j.x + j.y), greater_f64(j.x, j.y));
    let late = f64::from(actuators.lag) + f64::from(actuators.delay);
    let left = 0.5 * f64::from(period) + 0.25 * late;
    let size = 2.0 * math::sqrt_f64(tilt_inertia / mass);
    let w_a = [12.5, 1.44 * math::sqrt_f64(gravity / size), 0.3 / left].into_iter().fold(f64::INFINITY, lesser_f64);

    // The rotors' torque and thrust, with constants that use up none of it.
    // Without rotors the delivered thrust is the commanded one.
    let usual = if rotors.is_some() { SCALE } else { [1.0, 1.0] };
    let scale = [or("scale_least", usual[0]), or("scale_greatest", usual[1])];
    let floor_margin = or("floor_margin", 1e-3 * mass * gravity);
    let bare = Numbers { scale, floor_margin, ..Numbers::NOTHING };
    let free = TorqueBudget::new(&bare.parameters(), vehicle, limits, rotors);
    let most = |of: fn(&super::budget::Row) -> f64| {
        let rows = free.rows.iter().filter(|row| of(row) > 0.0).map(|row| row.room / of(row));
        rows.fold(f64::INFINITY, lesser_f64)
    };
    let (tilt_most, yaw_most) = (most(|row| row.tilt), most(|row| row.yaw));

    // The least thrust near the target must exceed the idle thrust plus the rise of the thrust floor by these torques.
    let a_down = or("a_down", FALL * gravity);
    let up = or("force_up", 0.36 * a_down);
    let least = (1.0 - THRUST_LEFT) * mass * (gravity - up - FALL_LEAST);
    let raised = |by: Numbers| TorqueBudget::<f64>::new(&by.parameters(), vehicle, limits, rotors).floor - free.floor;
    let by_tilt = raised(Numbers { torque_tilt: 1.0, ..bare });
    let by_yaw = greater_f64(raised(Numbers { torque_yaw: 1.0, ..bare }), 1e-12);
    let light = lesser_f64(0.056 * yaw_most, 0.15 * mass * gravity / by_yaw);
    let by_tilt = greater_f64(by_tilt, 1e-12);
    let bias_tilt = lesser_f64(0.055 * tilt_most, 0.1 * mass * gravity / by_tilt);
    let bias_yaw = lesser_f64(0.04 * yaw_most, 0.06 * mass * gravity / by_yaw);
    let all = bias_tilt * by_tilt + (bias_yaw + light) * by_yaw;
    let spared = lesser_f64(1.0, 0.92 * (least - free.floor) / greater_f64(all, 1e-12));
    let nimble = tilt_most / greatest_inertia;
    // The gyroscopic torque takes at most an eighth of the torque about z and about the tilt's axes.
    let flatness = greater_f64((j.z - j.x).abs(), (j.z - j.y).abs());
    let of_yaw = yaw_most / greater_f64((j.x - j.y).abs(), 1e-12);
    let product = 0.12 * lesser_f64(of_yaw, tilt_most / greater_f64(flatness, 1e-12));
    let turn_rate = or("turn_rate", lesser_f64((0.08 * nimble).clamp(2.5, 5.0), math::sqrt_f64(product)));
    let yaw_rate = or("yaw_rate", lesser_f64(2.5, math::sqrt_f64(0.65 * product)));
    let yaw_feedback = 0.06 * yaw_most;
    let mut n = Numbers {
        turn_rate,
        yaw_rate,
        yaw_acceleration: or("yaw_acceleration", lesser_f64(spared * light / j.z, 20.0)),
        torque_tilt: or("torque_tilt", spared * bias_tilt),
        torque_yaw: or("torque_yaw", spared * bias_yaw),
        m_omega_z: or("m_omega_z", 0.5 * yaw_feedback),
        w_eta: yaw_feedback,
        ..bare
    };

    // The rest is for the tilt: M_all and the reserve alpha_0 = share M_all / J compete for it.
    let budget = TorqueBudget::new(&n.parameters(), vehicle, limits, rotors);
    let joint = budget.rows.iter().filter(|row| row.tilt > 0.0 && row.yaw > 0.0);
    let weak = joint.map(|row| 0.26 * row.tilt * greatest_inertia / (row.yaw * j.z)).fold(0.14, lesser_f64);
    // The thrust floor with the frame turning at alpha_0 stays below the least thrust near the target.
    let lifted = 0.9 * (least - budget.floor) / greater_f64(budget.floor_per_acceleration, 1e-12);
    let reserve = |m_all: f64| or("turn_reserve", lesser_f64(weak * m_all / greatest_inertia, lifted));
    let mut m_all = 0.0;
    for _ in 0..20 {
        m_all = greater_f64(0.98 * budget.feedback(reserve(m_all)), 0.02 * tilt_most);
    }
    let m_all = or("m_all", m_all);
    let stiffness = tilt_inertia * w_a * w_a;
    let w = or("w", lesser_f64(lesser_f64(1.45 * m_all, 3.2 * stiffness), n.w_eta / ETA_LEAST));
    let eta = or("eta", (n.w_eta / w).clamp(ETA_LEAST, 0.5));
    // The potential is greatest where the tilt's own part falls: three values of r suffice.
    let own = [(0.15, 0.885), (0.35, 0.82), (0.45, 0.66)].map(|(of_w, of_level)| (0.93 * m_all - of_w * w) / of_level);
    let m_t = own.into_iter().fold(m_all, lesser_f64);
    n = Numbers { m_all, w, eta, ..n };
    let yaw_stiffness = 0.25 * w * eta / (1.0 + eta);
    let yaw_damping = 3.2 * math::sqrt_f64(yaw_stiffness * j.z);

    let [weakest, greatest] = held(&budget, airframe, [scale[0], 1.0]);
    // The least lift within the cone at the greatest |u|.
    let cosine = lesser_f64(1.05 * (gravity - a_down) / greatest, 1.0);
    let steepest = math::sqrt_of_rounded(1.0 - cosine * cosine) / cosine;
    let tangent = lesser_f64(lesser_f64(steepest, math::tan(75.0 * core::f64::consts::PI / 180.0)), 10.0);
    let level = |thrust: f64| math::sqrt_of_rounded(thrust * thrust - gravity * gravity);
    let widest = math::sqrt_of_rounded(greatest * greatest - 0.49 * gravity * gravity);
    let a_across = or("a_across", lesser_f64(greater_f64(widest, 0.5), gravity * tangent));
    let force_across =
        or("force_across", lesser_f64(0.8 * a_across, greater_f64(0.72 * level(weakest) - 5.0 * f64::from(drag), 0.0)));
    let force_down = greater_f64(lesser_f64(0.8 * (greatest - gravity), 0.76 * (weakest - gravity)), 0.0);

    let k_f = or("k_f", 1.12 * w_a);
    let k_v = or("k_v_across", 0.54 * w_a);
    let k_p = 0.435 * k_v * k_v;
    let follow = 1.1 * w_a;
    let single = |value: f64| value as f32;
    let [delta, alpha, c_1, c_2] = SHARED;
    let formulas = ExtendedParameters {
        k_p_across: single(k_p),
        k_p_vertical: single(1.96 * k_p),
        k_v_across: single(k_v),
        k_v_vertical: single(1.4 * k_v),
        k_f: single(k_f),
        k_s: single(3.1 * k_f),
        k_d: single(1.6 * w_a),
        a_across: single(a_across),
        a_down: single(a_down),
        tilt_max: single(math::atan(tangent)),
        v_across: single(lesser_f64(1.6 * math::sqrt_f64(a_across), 9.0)),
        v_up: 4.2,
        v_down: 3.5,
        turn_acceleration: single(0.9 * m_all / greatest_inertia),
        turn_reserve: single(reserve(m_all)),
        k_t: single(greater_f64((stiffness - 0.25 * w) * 2.0 * math::hypot(1.0, ETA_T), 1e-6)),
        m_t: single(m_t),
        eta_t: single(ETA_T),
        k_omega_t: single(1.7 * w_a * tilt_inertia),
        r_0: single((m_all / (13.0 * stiffness)).clamp(1e-3, 1e3)),
        k_omega_z: single(lesser_f64(yaw_damping, 0.3 * j.z / left)),
        delta,
        alpha,
        c_1,
        c_2,
        force_across: single(force_across),
        force_heading: single(lesser_f64(force_across, 2.5)),
        force_up: single(up),
        force_down: single(force_down),
        force_bandwidth_across: single(follow),
        force_bandwidth_vertical: single(1.33 * follow),
        drag_across: drag,
        torque_bandwidth: 2.0,
        scale_rate: 0.3,
        ..n.parameters()
    };
    let mut values = formulas.values();
    for ((value, given), constant) in values.iter_mut().zip(given).zip(&ExtendedParameters::TABLE) {
        *value = given.unwrap_or(value.clamp(constant.range.least, constant.range.greatest));
    }
    ExtendedParameters::from_values(values)
}

/// The acceleration that the rotors hold near the target at these thrust scales, m/s^2.
fn held<const N: usize>(budget: &TorqueBudget, airframe: &Airframe, scales: [f64; N]) -> [f64; N] {
    let [each, taken] = budget.ceiling;
    let limit = f64::from(airframe.limits.thrust_max);
    let used = (1.0 - THRUST_LEFT) / f64::from(airframe.vehicle.mass);
    scales.map(|scale| lesser_f64(scale * each - taken, limit) * used)
}

/// The numbers that the budget reads.
#[derive(Debug, Clone, Copy)]
struct Numbers {
    turn_rate: f64,
    yaw_rate: f64,
    yaw_acceleration: f64,
    torque_tilt: f64,
    torque_yaw: f64,
    m_omega_z: f64,
    /// w eta: twice yaw's share of the potential, N m.
    w_eta: f64,
    m_all: f64,
    w: f64,
    eta: f64,
    floor_margin: f64,
    scale: [f64; 2],
}

impl Numbers {
    const NOTHING: Self = Self {
        turn_rate: 0.0,
        yaw_rate: 0.0,
        yaw_acceleration: 0.0,
        torque_tilt: 0.0,
        torque_yaw: 0.0,
        m_omega_z: 0.0,
        w_eta: 0.0,
        m_all: 0.0,
        w: 1.0,
        eta: 0.0,
        floor_margin: 0.0,
        scale: [1.0, 1.0],
    };

    /// As constants; those that the budget does not read are zero.
    fn parameters(&self) -> ExtendedParameters {
        // Before w is known, only w eta counts.
        let eta = if self.eta > 0.0 { self.eta } else { self.w_eta / self.w };
        ExtendedParameters {
            turn_rate: self.turn_rate as f32,
            yaw_rate: self.yaw_rate as f32,
            yaw_acceleration: self.yaw_acceleration as f32,
            torque_tilt: self.torque_tilt as f32,
            torque_yaw: self.torque_yaw as f32,
            m_omega_z: self.m_omega_z as f32,
            m_all: self.m_all as f32,
            w: self.w as f32,
            eta: eta as f32,
            floor_margin: self.floor_margin as f32,
            scale_least: self.scale[0] as f32,
            scale_greatest: self.scale[1] as f32,
            ..ExtendedParameters::from_values([0.0; ExtendedParameters::COUNT])
        }
    }
}

/// Bounds of the motions that `parameters` can fly on `airframe`: the governor's limits.
#[must_use]
pub fn reference_bounds(airframe: &Airframe, parameters: &ExtendedParameters) -> ReferenceBounds {
    let p = parameters;
    let budget = TorqueBudget::new(p, airframe.vehicle, airframe.limits, airframe.rotors);
    let [weakest] = held(&budget, airframe, [f64::from(p.scale_least)]);
    let [gravity, across, down, up, rate, reserve, yaw_rate, yaw_acceleration] = [
        airframe.vehicle.gravity,
        p.a_across,
        p.a_down,
        p.force_up,
        p.turn_rate,
        p.turn_reserve,
        p.yaw_rate,
        p.yaw_acceleration,
    ]
    .map(f64::from);
    let held_beyond = weakest - gravity;
    let horizontal = lesser_f64(lesser_f64(3.0, 0.2 * across), math::sqrt_of_rounded(0.1 * gravity * held_beyond));
    let spare = 0.5 * (held_beyond - f64::from(p.force_down));
    let vertical = lesser_f64(lesser_f64(1.0, 0.15 * lesser_f64(down, across)), spare);
    // The rest of Omega and alpha_0 beside the net, at the least |u|.
    let net = math::sqrt_f64(2.0) * net_level::<f64>(p, airframe.vehicle.gravity);
    let [k_f, k_s] = [p.k_f, p.k_s].map(f64::from);
    let least = gravity - up - vertical - net;
    let jerk = lesser_f64(8.0, 0.5 * lesser_f64(rate, math::sqrt_f64(0.2 * reserve)) * least - 2.0 * k_f * net);
    let turned = (jerk + 2.0 * k_f * net) / least;
    let [of_turn, of_heading] = [f64::from(TURNED) * reserve, (1.0 - f64::from(TURNED)) * reserve];
    let snap = 0.8 * ((of_turn - turned * turned) * least - 2.0 * k_f * (k_s + k_f) * net);
    let carried = 0.7 * of_heading / greater_f64(turned, 1e-9);
    // The heading of a tilted frame turns faster by 1 / cos of its tilt.
    let tilt = math::hypot(1.0, (f64::from(p.force_heading) + horizontal) / (gravity - up));
    let single = |value: f64| greater_f64(value, 0.0) as f32;
    ReferenceBounds {
        horizontal_speed: 5.0,
        horizontal_acceleration: single(horizontal),
        vertical_acceleration: single(vertical),
        jerk: single(jerk),
        snap: single(lesser_f64(snap, 40.0)),
        heading_rate: single(lesser_f64(0.5 * yaw_rate, carried) / tilt),
        heading_second_derivative: single(0.3 * yaw_acceleration / tilt),
    }
}
