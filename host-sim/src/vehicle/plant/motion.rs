//! The motion of rigid bodies under held commands, written once for any number of them side by side.
//!
//! The equations of [`super`] form a cascade (omega' needs omega only; q' needs q and omega; v' needs q; p' needs v),
//! so a Runge-Kutta step runs the four stages of each level before the next level and folds the factors and the
//! position's stages together: the same method, half the work.

use super::body::Body;
use super::lanes::{Lanes, Vectors};
use pulp::Simd;

const ONE_THIRD: f64 = 1.0 / 3.0;

/// Where the bodies are and how they move.
#[derive(Debug, Clone, Copy)]
pub struct BodyMotion<S: Simd> {
    /// m, world.
    pub position: Vectors<S, 3>,
    /// m/s, world.
    pub velocity: Vectors<S, 3>,
    /// Body to world; x, y, z, w.
    pub attitude: Vectors<S, 4>,
    /// rad/s, body.
    pub angular_velocity: Vectors<S, 3>,
}

impl<S: Simd> BodyMotion<S> {
    /// After so many steps under thrust, N, and torque, N m.
    #[inline(always)]
    pub fn advanced(mut self, unit: S, body: &Body, thrust: Lanes<S>, torque: Vectors<S, 3>, steps: u32) -> Self {
        let motion = EquationsOfMotion::new(unit, body, thrust, torque);
        self.angular_velocity = self.angular_velocity * (0.25 * body.step);
        for _ in 0..steps {
            self = motion.step(unit, &self);
        }
        self.angular_velocity = self.angular_velocity * (4.0 / body.step);
        self
    }
}

/// The equations of motion under one held command, scaled for one step h.
///
/// With the body rate as r = h omega / 4, half a step of q' is q (0, r) and half a step of r' is
/// r_i += 2 (J_jj - J_kk) / J_ii r_j r_k + h^2 tau_i / (8 J_ii): the factors of the method are spent once per command
/// instead of four times per step.
struct EquationsOfMotion<S: Simd> {
    /// 2 (J_jj - J_kk) / J_ii.
    gyroscopic: Vectors<S, 3>,
    /// h^2 tau_i / (8 J_ii).
    torque: Vectors<S, 3>,
    /// h.
    step: f64,
    /// Change of velocity in one step per unit of the summed thrust directions, and the same in free fall with T along
    /// z.
    velocity: (Lanes<S>, Vectors<S, 3>),
    /// Change of position beyond h v, likewise.
    position: (Lanes<S>, Vectors<S, 3>),
}

impl<S: Simd> EquationsOfMotion<S> {
    #[inline(always)]
    fn new(unit: S, body: &Body, thrust: Lanes<S>, torque: Vectors<S, 3>) -> Self {
        let constant = |numbers: [f64; 3]| Vectors(numbers.map(|number| Lanes::all(unit, number)));
        let upwards = |length: Lanes<S>| Vectors([length * 0.0, length * 0.0, length]);
        let h = body.step;
        let specific_thrust = thrust * body.inverse_mass;
        let vertical = specific_thrust - Lanes::all(unit, body.gravity);
        Self {
            gyroscopic: constant((body.gyroscopic * 2.0).into()),
            torque: torque.times(constant(body.inverse_inertia.into())) * (0.125 * h * h),
            step: h,
            velocity: (specific_thrust * h / 3.0, upwards(vertical * h)),
            position: (specific_thrust * h * h / 3.0, upwards(vertical * 0.5 * h * h)),
        }
    }

    /// One Runge-Kutta step; the angular velocity is the scaled rate.
    #[inline(always)]
    fn step(&self, unit: S, moving: &BodyMotion<S>) -> BodyMotion<S> {
        let BodyMotion { position: p, velocity: v, attitude: q, angular_velocity: r } = *moving;
        // The stages r_2 to r_4; with e_4 the last half step, the weighted mean of all four changes is
        // (r_2 + 2 r_3 + r_4 - r + e_4) / 3 added up from the stages themselves.
        let (gyroscopic, torque) = (self.gyroscopic, self.torque);
        let pushed = r + torque;
        let r_2 = pushed + gyroscopic.times(products(r));
        let r_3 = pushed + gyroscopic.times(products(r_2));
        let half_step_3 = torque + gyroscopic.times(products(r_3));
        let r_4 = r + (half_step_3 + half_step_3);
        let half_step_4 = torque + gyroscopic.times(products(r_4));
        let r_next = ((r_2 + r_3) + (r_3 + r_4) - r + half_step_4) * ONE_THIRD;

        let q_2 = rotated(q, q, r);
        let q_3 = rotated(q, q_2, r_2);
        let q_4 = rotated(q, q_3, r_3 + r_3);
        let sum = (q_2 + q_3) + (q_3 + q_4) - q;
        // One Newton step towards unit length; taken from the length before the step, so that nothing waits for it.
        let to_unit = Lanes::all(unit, 1.5) - norm_squared(q) * 0.5;
        let q_next = rotated(sum, q_4, r_4) * (to_unit * ONE_THIRD);

        // The weights of v' = a are 1, 2, 2, 1 sixths; those of p, whose stages are v + h a / 2 and so on, 1, 1, 1, 0.
        let middle = lean(q_2) + lean(q_3);
        let p_lean = lean(q) + middle;
        let v_lean = p_lean + middle + lean(q_4);
        BodyMotion {
            position: p + v * self.step + p_lean * self.position.0 + self.position.1,
            velocity: v + v_lean * self.velocity.0 + self.velocity.1,
            attitude: q_next,
            angular_velocity: r_next,
        }
    }
}

/// The factors of the gyroscopic term.
#[inline(always)]
fn products<S: Simd>(Vectors([x, y, z]): Vectors<S, 3>) -> Vectors<S, 3> {
    Vectors([y * z, z * x, x * y])
}

/// `from` after half a step of q' = q (0, omega) / 2: from + q (0, r).
#[inline(always)]
fn rotated<S: Simd>(from: Vectors<S, 4>, q: Vectors<S, 4>, r: Vectors<S, 3>) -> Vectors<S, 4> {
    let (Vectors([i, j, k, w]), Vectors([x, y, z])) = (q, r);
    Vectors([
        (from[0] + w * x) + (j * z - k * y),
        (from[1] + w * y) + (k * x - i * z),
        (from[2] + w * z) + (i * y - j * x),
        (from[3] - i * x) - (j * y + k * z),
    ])
}

/// |q|^2.
#[inline(always)]
fn norm_squared<S: Simd>(Vectors([i, j, k, w]): Vectors<S, 4>) -> Lanes<S> {
    (i * i + k * k) + (j * j + w * w)
}

/// Half of R(q) e3 - e3: how far the thrust axis leans.
#[inline(always)]
fn lean<S: Simd>(Vectors([i, j, k, w]): Vectors<S, 4>) -> Vectors<S, 3> {
    Vectors([i * k + w * j, j * k - w * i, -(i * i + j * j)])
}
