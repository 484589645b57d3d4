//! What single precision may do to the law: the core's inputs in the oracle's terms, and tolerances derived from
//! rounding.
//!
//! Single precision gives at best the exact answer to a slightly different question. So the oracle computes how far its
//! own answer moves when each quantity the law reads or forms (each axis of p~, v~, u, u', u'', psi
//! with its derivatives, R, omega) moves by one rounding, 2^-24 of the magnitudes that were added up to form it, one at
//! a time. The sum of these movements is what one rounding everywhere can do. A quantity of the law is formed by about
//! ten operations, whose roundings add up like a random walk: sqrt(10) to [`ROUNDINGS_MAX`]. The worst found is 2.1.

use super::{Evaluation, Law, Situation, lifting};
use controller_core::controller::Diagnostics;
use controller_core::position::FilterState;
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};
use nalgebra::{Matrix3, Quaternion, Rotation3, Vector3, Vector4};

/// One rounding of single precision, relative.
pub const ULP: f64 = 1.0 / 16_777_216.0;

/// How many roundings a quantity may collect.
pub const ROUNDINGS_MAX: f64 = 4.0;

/// Worst absolute error of the core's tanh, in roundings (its module states 2.0e-7).
pub const TANH_ROUNDINGS: f64 = 3.4;

pub fn vector4(q: &Quaternion<f32>) -> Vector4<f64> {
    Vector4::new(q.w.into(), q.i.into(), q.j.into(), q.k.into())
}

/// The same tick in the oracle's terms: errors formed in f64, the attitude as a matrix, the heading as an angle.
pub fn situation(state: &State, reference: &Reference, filter: &FilterState) -> Situation {
    let cast = |v: &Vector3<f32>| v.cast::<f64>();
    let nu = reference.heading.direction();
    Situation {
        position_error: cast(&state.position) - cast(&reference.position),
        velocity_error: cast(&state.velocity) - cast(&reference.velocity),
        rotation: lifting::rotation(&vector4(&state.attitude)),
        angular_velocity: cast(&state.angular_velocity),
        acceleration: cast(&reference.acceleration),
        jerk: cast(&reference.jerk),
        snap: cast(&reference.snap),
        heading: [
            f64::from(nu.y).atan2(nu.x.into()),
            reference.heading.rate().into(),
            reference.heading.acceleration().into(),
        ],
        u_f: cast(&filter.filtered),
        u_s: cast(&filter.intermediate),
    }
}

/// What is compared, from either side.
#[derive(Clone, Copy)]
pub struct Answer {
    pub thrust: f64,
    pub omega_d: Vector3<f64>,
    pub omega_d_dot: Vector3<f64>,
    pub torque: Vector3<f64>,
}

impl Answer {
    pub fn of_oracle(law: &Law, e: &Evaluation, lifted: &Vector4<f64>) -> Self {
        let torque = law.torque(e, lifting::mrp(lifted));
        Self { thrust: e.thrust, omega_d: e.omega_d, omega_d_dot: e.omega_d_dot, torque }
    }

    pub fn of_core(wrench: &Wrench, diagnostics: &Diagnostics) -> Self {
        Self {
            thrust: wrench.thrust.into(),
            omega_d: diagnostics.desired_angular_velocity.cast(),
            omega_d_dot: diagnostics.desired_angular_acceleration.cast(),
            torque: wrench.torque.cast(),
        }
    }

    /// Distances in thrust, omega_d, omega_d' and torque.
    pub fn distances(&self, other: &Self) -> [f64; 4] {
        [
            (self.thrust - other.thrust).abs(),
            (self.omega_d - other.omega_d).norm(),
            (self.omega_d_dot - other.omega_d_dot).norm(),
            (self.torque - other.torque).norm(),
        ]
    }
}

/// `s` with one quantity at a time moved by one rounding.
pub fn one_rounding_each(law: &Law, state: &State, reference: &Reference, s: &Situation) -> Vec<Situation> {
    let abs = |a: &Vector3<f32>, b: &Vector3<f32>| a.cast::<f64>().abs() + b.cast::<f64>().abs();
    let (u_f, u_s) = (s.u_f.abs(), s.u_s.abs());
    let position = abs(&state.position, &reference.position);
    let velocity = abs(&state.velocity, &reference.velocity);
    // The terms that add up to k_p z_1 + k_v z_2, per unit of k_p.
    let z = position
        + velocity * (1.0 / law.k_f + 1.0 / law.k_s + law.k_v / law.k_p)
        + u_f * (1.0 / (law.k_s * law.k_f) + law.k_v / (law.k_p * law.k_f))
        + u_s * (law.k_v / (law.k_p * law.k_s));
    let gravity = Vector3::new(0.0, 0.0, law.gravity);
    // The terms that add up to u, u' and u''.
    let u = s.acceleration.abs() + gravity + u_f;
    let u_dot = s.jerk.abs() + law.k_f * (u_f + u_s);
    let from_feedback = law.k_f * law.k_s * law.m_p;
    let u_ddot = s.snap.abs()
        + law.k_f * law.k_f * (u_f + u_s)
        + law.k_f * law.k_s * u_s
        + Vector3::repeat(from_feedback * (1.0 + TANH_ROUNDINGS / ROUNDINGS_MAX));
    let rate = Vector3::repeat(s.angular_velocity.norm());
    let mut moved = Vec::new();
    for axis in 0..3 {
        let along = |scale: Vector3<f64>| Vector3::ith(axis, ULP * scale[axis]);
        let turn: Matrix3<f64> = Rotation3::new(Vector3::ith(axis, ULP)).into_inner();
        moved.push(Situation { position_error: s.position_error + along(z), ..*s });
        moved.push(Situation { acceleration: s.acceleration + along(u), ..*s });
        moved.push(Situation { jerk: s.jerk + along(u_dot), ..*s });
        moved.push(Situation { snap: s.snap + along(u_ddot), ..*s });
        moved.push(Situation { angular_velocity: s.angular_velocity + along(rate), ..*s });
        moved.push(Situation { rotation: s.rotation * turn, ..*s });
        let mut heading = s.heading;
        heading[axis] += ULP * if axis == 0 { 1.0 } else { heading[axis].abs() };
        moved.push(Situation { heading, ..*s });
    }
    moved
}

/// What `ROUNDINGS_MAX` roundings everywhere can do to the answer.
pub fn tolerances(law: &Law, moved: &[Situation], e: &Evaluation, lifted: &Vector4<f64>) -> [f64; 4] {
    let nominal = Answer::of_oracle(law, e, lifted);
    // The results' own last roundings.
    let (rate, acceleration) = (e.omega_d.norm(), e.omega_d_dot.norm() + e.omega_d.norm_squared());
    let torque = law.inertia.max() * acceleration + law.m_theta + law.m_omega;
    let mut sums = [nominal.thrust, rate, acceleration, torque].map(|scale| scale * ULP);
    for situation in moved {
        let e = law.evaluate(situation);
        let answer = Answer::of_oracle(law, &e, &lifting::nearest(lifted, &e.error));
        for (sum, distance) in sums.iter_mut().zip(answer.distances(&nominal)) {
            *sum += distance;
        }
    }
    sums.map(|sum| ROUNDINGS_MAX * sum)
}

/// What the same roundings can do to the lifted quaternion and to theta~.
pub fn lift_tolerances(law: &Law, moved: &[Situation], lifted: &Vector4<f64>) -> [f64; 2] {
    let mut sums = [ULP; 2];
    for situation in moved {
        let other = lifting::nearest(lifted, &law.evaluate(situation).error);
        sums[0] += (other - lifted).norm();
        sums[1] += (lifting::mrp(&other) - lifting::mrp(lifted)).norm();
    }
    sums.map(|sum| ROUNDINGS_MAX * sum)
}
