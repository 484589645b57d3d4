//! What single precision may do to one tick of the extended law.
//!
//! As for the paper's law (`support::oracle::rounding`): the oracle computes how far its own answer moves when each
//! quantity the law reads or forms moves by one rounding of the magnitudes that were added up to form it, one at a
//! time; the sum of these movements is what one rounding everywhere can do.

use super::oracle::Law;
use super::oracle::estimates::Averages;
use super::oracle::tick::{Answer, Last, Nudge, PART_COUNT, Tick};
use crate::support::oracle::rounding::{ROUNDINGS_MAX, ULP};
use nalgebra::{Matrix3, Rotation3, Vector2, Vector3, Vector4};

/// What is compared.
pub const NAMES: [&str; 15] = [
    "thrust", "torque", "P", "lambda D", "omega_d", "omega_d'", "c", "x", "y", "zeta", "bias", "averages", "scale",
    "side", "yaw room",
];

/// The place of omega_d' among them.
pub const ACCELERATION_PLACE: usize = 5;

/// The distances between two answers, in SI units.
pub fn distances(a: &Answer, b: &Answer) -> [f64; NAMES.len()] {
    let (s, t) = (&a.averages, &b.averages);
    [
        (a.thrust - b.thrust).abs(),
        (a.torque - b.torque).norm(),
        (a.pull - b.pull).norm(),
        (a.damping - b.damping).norm(),
        (a.omega_d - b.omega_d).norm(),
        (a.omega_d_dot - b.omega_d_dot).norm(),
        (a.filters[0] - b.filters[0]).norm(),
        (a.filters[1] - b.filters[1]).norm(),
        (a.filters[2] - b.filters[2]).norm(),
        (s.force - t.force).norm(),
        (s.bias - t.bias).norm(),
        apart(s.slow, t.slow).hypot((s.offset - t.offset).norm()),
        (s.scale - t.scale).abs(),
        (a.side - b.side).norm(),
        (a.yaw_room - b.yaw_room).abs(),
    ]
}

/// The distance between slow averages.
fn apart(a: Option<[Vector3<f64>; 2]>, b: Option<[Vector3<f64>; 2]>) -> f64 {
    match (a, b) {
        (Some(a), Some(b)) => (a[0] - b[0]).norm().hypot((a[1] - b[1]).norm()),
        (None, None) => 0.0,
        _ => f64::INFINITY,
    }
}

/// What positions and velocities were subtracted from, m and m/s, and what the acceleration fed forward in the last
/// tick is known to, rad/s^2.
#[derive(Debug, Clone, Copy)]
pub struct Scales {
    pub far: f64,
    pub fast: f64,
    pub forward: f64,
}

/// `t` with one quantity at a time moved by one rounding.
fn one_rounding_each(law: &Law, t: &Tick, answer: &Answer, scales: &Scales) -> Vec<Tick> {
    let (p, h) = (&law.p, law.period);
    let gains = law.gains(t.fallback.slow);
    let ([k_f, k_s, k_d], drag) = (gains.filters, f64::from(p.drag_across));
    let Scales { far, fast, forward } = *scales;
    let averages = t.averages;
    let (zeta, slow) = (averages.force.norm(), averages.slow.map(|slow| slow.map(|x| x.norm())));
    let d = f64::from(p.force_across).hypot(f64::from(p.force_up.max(p.force_down))).min(zeta);
    let [c, x, y] = t.filters.map(|x| x.norm());
    let [v_d, a_d, j_d, s_d] = t.reference.map(|r| r.norm());
    // The terms that add up to z_1 and z_2, and to u, u' and u''.
    let [f, s, of_y] = [1.0 / k_f, 1.0 / k_s, 1.0 / k_d];
    let z_1 = far + fast * (f + s + of_y) + (c + d) * (f * (s + of_y)) + (x + d) * (s * of_y);
    let z_2 = fast + (c + d) * f + (x + d) * s + (y + d) * of_y;
    let u = c + law.gravity + a_d + drag * v_d;
    let u_dot = k_f * (c + x) + j_d + drag * a_d;
    let level = law.gravity + f64::from(p.a_across) + d;
    let u_ddot = k_f * (k_s * (level + y + x) + k_f * (c + x)) + s_d + drag * j_d;
    // rho'' is a difference over a period where the frame's rate or its cone limits it.
    let spin = answer.omega_d.norm() + f64::from(p.turn_reserve / p.turn_rate);
    let turn = answer.omega_d_dot.norm() + spin * spin + spin / (h * f64::from(p.tilt_max.sin()));
    let mut moved = Vec::new();
    for axis in 0..3 {
        let along = |size: f64| Vector3::ith(axis, ULP * size);
        moved.push(Tick { position_error: t.position_error + along(z_1), ..*t });
        moved.push(Tick { nudge: Nudge { z_2: along(z_2), ..t.nudge }, ..*t });
        for (order, size) in [u, u_dot, u_ddot].into_iter().enumerate() {
            let mut command = [Vector3::zeros(); 3];
            command[order] = along(size);
            moved.push(Tick { nudge: Nudge { command, ..t.nudge }, ..*t });
        }
        moved.push(Tick { nudge: Nudge { turn: along(turn), ..t.nudge }, ..*t });
        moved.push(Tick { nudge: Nudge { rest: along(u - c + d), ..t.nudge }, ..*t });
        let turned: Matrix3<f64> = Rotation3::new(Vector3::ith(axis, ULP)).into_inner();
        moved.push(Tick { rotation: t.rotation * turned, ..*t });
        moved.push(Tick { omega: t.omega + along(t.omega.norm()), ..*t });
        let mut heading = t.heading;
        heading[axis] += ULP * if axis == 0 { 1.0 } else { heading[axis].abs() };
        moved.push(Tick { heading, ..*t });
        let mut filters = t.filters;
        filters[0] += along(c + x);
        moved.push(Tick { filters, ..*t });
        for averages in [
            Averages { force: averages.force + along(zeta), ..averages },
            Averages { bias: averages.bias + along(averages.bias.norm()), ..averages },
        ] {
            moved.push(Tick { averages, ..*t });
        }
        if let (Some([made, commanded]), Some(sizes)) = (averages.slow, slow) {
            for slow in [[made + along(sizes[0]), commanded], [made, commanded + along(sizes[1])]] {
                moved.push(Tick { averages: Averages { slow: Some(slow), ..averages }, ..*t });
            }
        }
        if let Some(last) = t.last {
            // Gravity, thrust and drag over the period, beside the difference of velocities.
            let change = t.acted[0].abs() * averages.scale / law.mass + law.gravity + drag * t.velocity.norm();
            let slow: f64 = slow.into_iter().flatten().sum();
            let speed = along((t.velocity - last.velocity).norm() + (change + slow) * h);
            moved.push(Tick { last: Some(Last { velocity: last.velocity + speed, ..last }), ..*t });
            moved.push(Tick { last: Some(Last { axis: last.axis + along(1.0), ..last }), ..*t });
            let offset = averages.offset.norm();
            let felt = t.felt.map(|felt| felt + along(felt.norm() + offset + change + slow));
            moved.push(Tick { felt, ..*t });
            let rate = along((t.omega - last.omega).norm() + last.omega.norm() * last.omega.norm() * h);
            moved.push(Tick { last: Some(Last { omega: last.omega + rate, ..last }), ..*t });
            let known = along(last.forward.norm() + forward / ULP);
            moved.push(Tick { last: Some(Last { forward: last.forward + known, ..last }), ..*t });
        }
    }
    for (part, size) in [t.acted[0].abs(), t.acted.norm(), t.acted.norm(), t.acted.norm()].into_iter().enumerate() {
        let mut acted = t.acted;
        acted[part] += ULP * size;
        moved.push(Tick { acted, ..*t });
        let pending = t.pending + Vector4::ith(part, ULP * t.pending.norm());
        moved.push(Tick { pending, ..*t });
    }
    moved.push(Tick { averages: Averages { scale: averages.scale * (1.0 + ULP), ..averages }, ..*t });
    for part in 0..PART_COUNT {
        let mut rooms = [0.0; PART_COUNT];
        rooms[part] = ULP;
        moved.push(Tick { nudge: Nudge { rooms, ..t.nudge }, ..*t });
        for axis in 0..2 {
            let mut parts = [Vector2::zeros(); PART_COUNT];
            parts[part][axis] = ULP * answer.sizes[part];
            moved.push(Tick { nudge: Nudge { parts, ..t.nudge }, ..*t });
        }
    }
    let (per_torque, per_yaw) = per_torque(law);
    let thrust = ULP * (answer.thrust.abs() + per_torque * answer.torque.norm());
    for nudge in [
        Nudge { greatest: ULP, ..t.nudge },
        Nudge { lift: ULP * (level + d), ..t.nudge },
        Nudge { thrust, ..t.nudge },
        Nudge { yaw: [ULP * answer.sizes[PART_COUNT], 0.0], ..t.nudge },
        Nudge { yaw: [0.0, thrust * per_yaw], ..t.nudge },
    ] {
        moved.push(Tick { nudge, ..*t });
    }
    moved
}

/// The greatest |beta|, 1/m, and the greatest 1 / |beta_3|, m.
fn per_torque(law: &Law) -> (f64, f64) {
    let most = |of: fn(Vector3<f64>) -> f64| law.rotors.iter().map(|rotor| of(rotor.beta())).fold(0.0, f64::max);
    (most(|beta| beta.norm()), most(|beta| 1.0 / beta.z.abs()))
}

/// What `ROUNDINGS_MAX` roundings everywhere can do to the answer.
pub fn tolerances(law: &Law, t: &Tick, answer: &Answer, scales: &Scales) -> [f64; NAMES.len()] {
    // The results' own last roundings.
    let rate = answer.omega_d.norm();
    let acceleration = answer.omega_d_dot.norm() + rate * rate;
    let (per_torque, per_yaw) = per_torque(law);
    let thrust = answer.thrust.abs() + per_torque * answer.torque.norm();
    let (after, before) = (&answer.averages, &t.averages);
    // The drive moves both filters by less than what is left of them.
    let moved = (answer.filters[1] - t.filters[1]).norm();
    let slow = |averages: &Averages| averages.slow.into_iter().flatten().map(|x| x.norm()).sum::<f64>();
    let mut sums = [
        thrust,
        answer.torque.norm(),
        answer.pull.norm(),
        answer.damping.norm(),
        rate,
        acceleration,
        answer.filters[0].norm() + t.filters[0].norm() + t.filters[1].norm() + moved,
        answer.filters[1].norm() + t.filters[1].norm() + moved,
        answer.filters[2].norm() + t.filters[2].norm(),
        after.force.norm() + before.force.norm(),
        after.bias.norm() + before.bias.norm(),
        slow(after) + slow(before),
        after.scale,
        1.0,
        answer.yaw_room + thrust * per_yaw,
    ]
    .map(|size| ULP * size);
    for moved in one_rounding_each(law, t, answer, scales) {
        for (sum, distance) in sums.iter_mut().zip(distances(&law.evaluate(&moved), answer)) {
            *sum += distance;
        }
    }
    sums.map(|sum| ROUNDINGS_MAX * sum)
}
