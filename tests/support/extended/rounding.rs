//! What single precision may do to one tick of the extended law.
//!
//! As for the paper's law (`support::oracle::rounding`): the oracle is asked how far its own answer moves when each quantity the
//! law reads or forms moves by one rounding of the magnitudes that were added up to form it, one at a time; the sum of these
//! movements is what one rounding everywhere can do.

use super::oracle::{Answer, Last, Law, Tick};
use crate::support::oracle::rounding::{ROUNDINGS, ULP};
use nalgebra::{Matrix3, Rotation3, Vector3, Vector4};

/// What is compared.
pub const NAMES: [&str; 12] =
    ["thrust", "torque", "omega_d", "omega_d'", "u_f", "u_s", "zeta", "d", "d'", "bias", "scale", "chi, W"];

/// The distances between two answers, in SI units.
pub fn distances(a: &Answer, b: &Answer) -> [f64; NAMES.len()] {
    let turn = std::f64::consts::TAU;
    let lag = (a.lag[0] - b.lag[0] + 0.5 * turn).rem_euclid(turn) - 0.5 * turn;
    [
        (a.thrust - b.thrust).abs(),
        (a.torque - b.torque).norm(),
        (a.omega_d - b.omega_d).norm(),
        (a.omega_d_dot - b.omega_d_dot).norm(),
        (a.filters[0] - b.filters[0]).norm(),
        (a.filters[1] - b.filters[1]).norm(),
        (a.force[0] - b.force[0]).norm(),
        (a.force[1] - b.force[1]).norm(),
        (a.force[2] - b.force[2]).norm(),
        (a.bias - b.bias).norm(),
        (a.scale - b.scale).abs(),
        lag.hypot(a.lag[1] - b.lag[1]),
    ]
}

/// `t` with one quantity at a time moved by one rounding.
fn one_rounding_each(law: &Law, t: &Tick, far: f64, fast: f64) -> Vec<Tick> {
    let p = &law.p;
    let [across, vertical] = [
        [p.position.k_f_across, p.position.k_s_across, p.position.k_p_across, p.position.k_v_across],
        [p.position.k_f_vertical, p.position.k_s_vertical, p.position.k_p_vertical, p.position.k_v_vertical],
    ]
    .map(|gains| gains.map(f64::from));
    let e = &p.estimates;
    let drag = f64::from(e.drag_across);
    let [u_f, u_s] = t.filters.map(|u| u.norm());
    let [zeta, d, d_rate] = t.force.map(|d| d.norm());
    let [v_d, a_d, j_d, s_d] = t.reference.map(|r| r.norm());
    let mut moved = Vec::new();
    for axis in 0..3 {
        let along = |size: f64| Vector3::ith(axis, ULP * size);
        let [k_f, k_s, k_p, k_v] = if axis == 2 { vertical } else { across };
        let snap = f64::from(if axis == 2 { e.force_snap_vertical } else { e.force_snap_across });
        let bandwidth = f64::from(if axis == 2 { e.force_bandwidth_vertical } else { e.force_bandwidth_across });
        // The terms that add up to z_1 and z_2, and to u, u' and u''.
        let z_1 = far + fast * (1.0 / k_f + 1.0 / k_s) + u_f / (k_f * k_s);
        let z_2 = fast + u_f / k_f + u_s / k_s;
        let u = u_f + law.gravity + a_d + drag * v_d + d;
        let u_dot = k_f * (u_f + u_s) + j_d + drag * a_d + d_rate;
        let level = f64::from(p.position.m_across.max(p.position.m_up).max(p.position.m_down));
        let u_ddot = k_f * (k_s * (level + u_s) + k_f * (u_f + u_s)) + s_d + drag * j_d + snap + d_rate / law.period;
        moved.push(Tick { position_error: t.position_error + along(z_1 + z_2 * k_v / k_p), ..*t });
        moved.push(Tick { nudge: [along(u), Vector3::zeros(), Vector3::zeros()], ..*t });
        moved.push(Tick { nudge: [Vector3::zeros(), along(u_dot), Vector3::zeros()], ..*t });
        moved.push(Tick { nudge: [Vector3::zeros(), Vector3::zeros(), along(u_ddot)], ..*t });
        let turn: Matrix3<f64> = Rotation3::new(Vector3::ith(axis, ULP)).into_inner();
        moved.push(Tick { rotation: t.rotation * turn, ..*t });
        moved.push(Tick { omega: t.omega + along(t.omega.norm()), ..*t });
        let mut heading = t.heading;
        heading[axis] += ULP * if axis == 0 { 1.0 } else { heading[axis].abs() };
        moved.push(Tick { heading, ..*t });
        // d'' is a difference over a period where the rate's limit cuts it.
        let [average, value, rate] = t.force;
        moved.push(Tick { force: [average + along(zeta), value, rate], ..*t });
        moved.push(Tick { force: [average, value + along(d + snap / (bandwidth * bandwidth)), rate], ..*t });
        moved.push(Tick { force: [average, value, rate + along(d_rate + snap * law.period)], ..*t });
        moved.push(Tick { bias: t.bias + along(t.bias.norm()), ..*t });
        if let Some(last) = t.last {
            // Gravity, thrust and drag over the period, beside the difference of velocities.
            let change = t.acted[0] * t.scale / law.mass + law.gravity + drag * t.velocity.norm();
            let speed = along((t.velocity - last.velocity).norm() + change * law.period);
            moved.push(Tick { last: Some(Last { velocity: last.velocity + speed, ..last }), ..*t });
            moved.push(Tick { last: Some(Last { axis: last.axis + along(1.0), ..last }), ..*t });
            let rate = along((t.omega - last.omega).norm() + last.omega.norm() * last.omega.norm() * law.period);
            moved.push(Tick { last: Some(Last { omega: last.omega + rate, ..last }), ..*t });
        }
    }
    for (part, size) in [t.acted[0].abs(), t.acted.norm(), t.acted.norm(), t.acted.norm()].into_iter().enumerate() {
        let mut acted = t.acted;
        acted[part] += ULP * size;
        moved.push(Tick { acted: Vector4::from(acted), ..*t });
    }
    moved.push(Tick { scale: t.scale * (1.0 + ULP), ..*t });
    if let Some([chi, turn]) = t.lag {
        moved.push(Tick { lag: Some([chi + ULP, turn]), ..*t });
        moved.push(Tick { lag: Some([chi, turn * (1.0 + ULP)]), ..*t });
    }
    moved.push(Tick { turn_nudge: ULP * f64::from(p.heading.rate) / law.period, ..*t });
    moved
}

/// What `ROUNDINGS` roundings everywhere can do to the answer; `far` and `fast` are what positions and velocities were subtracted
/// from, m and m/s.
pub fn tolerances(law: &Law, t: &Tick, answer: &Answer, far: f64, fast: f64) -> [f64; NAMES.len()] {
    // The results' own last roundings.
    let inertia = law.inertia.max();
    let (a, h) = (&law.p.attitude, &law.p.heading);
    let rate = answer.omega_d.norm();
    let acceleration = answer.omega_d_dot.norm() + rate * rate;
    let levels = [a.w, a.m_t, a.m_omega_t, a.m_omega_z].map(f64::from).iter().sum::<f64>();
    let torque = inertia * acceleration + levels + answer.torque.norm();
    let thrust =
        answer.thrust.abs() + law.rotors.iter().map(|(_, row)| row.norm() / row[0] * torque).fold(0.0, f64::max);
    let mut sums = [
        thrust,
        torque,
        rate,
        acceleration,
        answer.filters[0].norm(),
        answer.filters[1].norm(),
        answer.force[0].norm() + t.force[0].norm(),
        answer.force[1].norm() + t.force[1].norm(),
        answer.force[2].norm() + t.force[2].norm(),
        answer.bias.norm() + t.bias.norm(),
        answer.scale,
        std::f64::consts::PI + f64::from(h.rate),
    ]
    .map(|size| ULP * size);
    for moved in one_rounding_each(law, t, far, fast) {
        for (sum, distance) in sums.iter_mut().zip(distances(&law.evaluate(&moved), answer)) {
            *sum += distance;
        }
    }
    sums.map(|sum| ROUNDINGS * sum)
}
