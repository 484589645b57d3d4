//! The attitude law: the paper's saturated feedback of modified Rodrigues parameters, for the tilt alone. Section 6 of
//! `docs/extended-law.md`.
//!
//! b is the vehicle's thrust axis, rho the desired one, theta the angle from rho to b, and e the axis in the body about
//! which the vehicle has turned from rho to b. omega_rho = rho x rho' turns rho and nothing else; r = R^T omega_rho.
//!
//! | here | equation |
//! |---|---|
//! | [`Tilt::mrp`] | vartheta = e tan(theta / 4) |
//! | omega~_12 | omega_12 - r_12 |
//! | P | s(k_theta vartheta; M), M at most M_theta |
//! | D | k_omega omega~_12 / (1 + (r / r_0)^2)^(1/4), here r = sin(theta / 2) |
//! | [`AttitudeLaw::gyroscopic`] | g, the torque that a turning body with spin takes |
//! | [`AttitudeLaw::precession`] | h = J_3 omega_3 (omega~_2, -omega~_1), so that a body that spins turns as one that does not |
//! | tau_12 | J (R^T omega_rho')_12 + g - P - lambda D + nu h - tau_b, lambda and nu what [the budget](super::budget) leaves |
//!
//! Then V = 1/2 omega~_12^T J omega~_12 + integral of |P| d theta falls by lambda omega~_12 . D, whatever the vehicle
//! does about its thrust axis: h is at right angles to omega~_12.
//!
//! **Half a turn** has no nearest way back. As the paper's path lifting does, the law remembers the side m that b came
//! from, once cos(theta / 2) < 2 qbar: theta counts on beyond half a turn until |vartheta| >= 1 + delta, and only then
//! the other way round is taken.
//!
//! **Actuators that are late.** With the lag and the delay together T and the angular impulse I that commands of the
//! past will still deliver, the law is evaluated for the errors projected over T ([`Late`]),
//!
//! q_p = q (1, T omega~ / 2),   omega_p = omega~ + J^-1 (I + T tau_b) - T a:
//!
//! a is the acceleration fed forward in the last tick: this tick's omega_d' is known only after the budget is spent.
//! With a first-order lag and small motions omega_p' is the commanded acceleration and the projected angle's rate is
//! omega_p, as if the actuators were ideal. The paper's z_1 and z_2 do the same for its filters. Every bound holds for
//! any errors, so also for projected ones. Torques in the body frame, N m.

use super::parameters::ExtendedParameters;
use crate::attitude::rotate_back;
use crate::math;
use crate::path_lifting::switching_scalar;
use crate::state::length_squared;
use core::hint::cold_path;
use nalgebra::{Quaternion, Vector2, Vector3};

/// The tilt's error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tilt {
    /// vartheta, axes of the body.
    pub mrp: Vector2<f32>,
    /// sin(theta / 2)^2.
    pub sine_squared: f32,
    /// Along m, axes of the desired frame, of any length: the memory.
    pub side: Vector2<f32>,
}

/// The part of past commands that has not acted yet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Late {
    /// T, s: lag and delay together.
    pub time: f32,
    /// I + T tau_b, N m s, body frame.
    pub impulse: Vector3<f32>,
    /// a, rad/s^2.
    pub forward: Vector3<f32>,
}

/// The attitude law's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttitudeLaw {
    /// k_theta, N m.
    gain: f32,
    /// k_omega, N m s, and 1 / r_0^2.
    damping: f32,
    easing: f32,
    /// -qbar: the cosine of theta / 2 beyond which the other way round is taken.
    switching: f32,
    /// The diagonal of J, kg m^2.
    inertia: Vector3<f32>,
    per_inertia: Vector3<f32>,
}

impl AttitudeLaw {
    /// For the diagonal of J, kg m^2.
    pub fn new(parameters: &ExtendedParameters, inertia: &Vector3<f32>) -> Self {
        let p = parameters;
        Self {
            gain: p.k_tilt,
            damping: p.k_omega_t,
            easing: 1.0 / (p.r_0 * p.r_0),
            switching: switching_scalar(p.delta),
            per_inertia: inertia.map(|moment| 1.0 / moment),
            inertia: *inertia,
        }
    }

    /// The errors as they will be once `late` has arrived: q_p, of any length, and omega_p.
    pub fn projected(
        &self,
        error: &Quaternion<f32>,
        rate_error: &Vector3<f32>,
        late: &Late,
    ) -> (Quaternion<f32>, Vector3<f32>) {
        let Late { time, impulse, forward } = late;
        let half = rate_error * (0.5 * time);
        let (w, v) = (error.w, error.imag());
        let turned = v + half * w + v.cross(&half);
        let quaternion = Quaternion::new(w - v.dot(&half), turned.x, turned.y, turned.z);
        (quaternion, rate_error + self.per_inertia.component_mul(impulse) - forward * *time)
    }

    /// The tilt of an error quaternion of any length, from the desired frame to the body; `side` is the last tick's.
    #[inline(always)] // into the law's step
    pub fn tilt(&self, error: &Quaternion<f32>, side: Option<&Vector2<f32>>) -> Tilt {
        let (w, x, y, z) = (error.w, error.i, error.j, error.k);
        let (along, across) = (w * w + z * z, x * x + y * y);
        let square = along + across;
        let came_from = Vector2::new(x * z + w * y, y * z - w * x);
        let sine_squared = across / square;
        let near = 2.0 * self.switching;
        if along < near * near * square {
            cold_path();
            if let Some(tilt) = self.held(error, side, &came_from) {
                return tilt;
            }
        }
        // sin(theta / 2) / (1 + cos(theta / 2)), along e.
        let length = math::sqrt(along * square) + along;
        let mrp = Vector2::new(w * x + y * z, w * y - x * z) * (1.0 / length);
        Tilt { mrp, sine_squared, side: came_from }
    }

    /// The tilt near half a turn, counted from the side that is remembered; none once it is beyond the switch. With
    /// b . m = sin theta_s, theta_s near half a turn, e is -b x m without its length.
    #[cold]
    fn held(&self, error: &Quaternion<f32>, side: Option<&Vector2<f32>>, came_from: &Vector2<f32>) -> Option<Tilt> {
        let side = side.copied().unwrap_or(*came_from);
        let length = math::sqrt(side.norm_squared());
        // Exactly half a turn at the start: any side will do.
        let side = if length > 0.0 { side / length } else { Vector2::new(1.0, 0.0) };
        let square = length_squared(error);
        let across = error.i * error.i + error.j * error.j;
        let b = Vector3::new(2.0 * came_from.x, 2.0 * came_from.y, square - 2.0 * across) / square;
        let sine = b.xy().dot(&side);
        let cosine = math::sqrt(math::max(1.0 - sine * sine, 0.0));
        // Of theta_s / 2.
        let half = sine / math::sqrt(2.0 * (1.0 + cosine));
        if half <= self.switching {
            return None;
        }
        let axis = Vector3::new(b.z * side.y, -b.z * side.x, b.y * side.x - b.x * side.y) / cosine;
        let mrp = rotate_back(error, &axis).xy() * (math::sqrt(1.0 - half * half) / (1.0 + half));
        Some(Tilt { mrp, sine_squared: across / square, side })
    }

    /// P, at most `level` long, N m.
    #[inline(always)]
    pub fn potential(&self, tilt: &Tilt, level: f32) -> Vector2<f32> {
        let scaled = tilt.mrp * self.gain;
        scaled * (level / math::sqrt(level * level + scaled.norm_squared()))
    }

    /// D, N m, for omega~_12.
    #[inline(always)]
    pub fn damping(&self, tilt: &Tilt, rate_error: &Vector2<f32>) -> Vector2<f32> {
        rate_error * (self.damping / math::sqrt(math::sqrt(1.0 + tilt.sine_squared * self.easing)))
    }

    /// g about the tilt's axes, N m, for r, omega and omega~_12, rad/s.
    #[inline(always)]
    pub fn gyroscopic(&self, turning: &Vector3<f32>, velocity: &Vector3<f32>, error: &Vector2<f32>) -> Vector2<f32> {
        let [j_1, j_2, j_3] = self.inertia.into();
        let (spin, twist) = (velocity.z, turning.z);
        let odd = 0.5 * (j_1 - j_2) * (spin - twist);
        Vector2::new(
            turning.y * ((j_3 + j_1 - j_2) * spin - j_1 * twist) + odd * error.y,
            -turning.x * ((j_3 + j_2 - j_1) * spin - j_2 * twist) + odd * error.x,
        )
    }

    /// h, N m, for omega and omega~_12, rad/s.
    #[inline(always)]
    pub fn precession(&self, velocity: &Vector3<f32>, error: &Vector2<f32>) -> Vector2<f32> {
        Vector2::new(error.y, -error.x) * (self.inertia.z * velocity.z)
    }

    /// J times an acceleration about the tilt's axes.
    #[inline(always)]
    pub fn torque(&self, acceleration: &Vector3<f32>) -> Vector2<f32> {
        Vector2::new(self.inertia.x * acceleration.x, self.inertia.y * acceleration.y)
    }
}
