//! The rigid body's state: where a flight starts, and what a plant integrates.

use controller_core::heading::Heading;
use controller_core::state::State;
use nalgebra::{Quaternion, Vector3};

/// Beyond it an integrator no longer follows the rotation.
pub const ROTATION_PER_STEP_MAX_RAD: f64 = 0.5;

/// The rigid body's state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyState {
    /// p, m, world frame (z up).
    pub position: Vector3<f64>,
    /// v, m/s, world frame.
    pub velocity: Vector3<f64>,
    /// q, body to world, unit, scalar first.
    pub attitude: Quaternion<f64>,
    /// omega, rad/s, body frame.
    pub angular_velocity: Vector3<f64>,
}

impl BodyState {
    /// The state as the control law sees it: rounded to single precision.
    #[must_use]
    pub fn measured(&self) -> State {
        State {
            position: self.position.map(|value| value as f32),
            velocity: self.velocity.map(|value| value as f32),
            attitude: Quaternion::from(self.attitude.coords.map(|value| value as f32)),
            angular_velocity: self.angular_velocity.map(|value| value as f32),
        }
    }

    /// Yaw psi of R = Rz(yaw) Ry(pitch) Rx(roll), rad, in (-pi, pi].
    #[must_use]
    pub fn yaw(&self) -> f64 {
        let q = &self.attitude;
        (2.0 * (q.w * q.k + q.i * q.j)).atan2(1.0 - 2.0 * (q.j * q.j + q.k * q.k))
    }

    /// The angle from a heading to the vehicle's, rad, at most pi.
    #[must_use]
    pub fn heading_error(&self, heading: &Heading) -> f64 {
        let desired = heading.direction().map(f64::from);
        let difference = self.yaw() - desired.y.atan2(desired.x);
        difference.sin().atan2(difference.cos()).abs()
    }

    /// b = R e3, the thrust axis, world frame.
    #[must_use]
    pub fn thrust_axis(&self) -> Vector3<f64> {
        (self.attitude * Quaternion::from_imag(Vector3::z()) * self.attitude.conjugate()).imag()
    }

    /// Whether every component is a finite number.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        (self.position.sum() + self.velocity.sum() + self.attitude.coords.sum() + self.angular_velocity.sum())
            .is_finite()
    }
}

/// The attitude R = Rz(yaw) Ry(pitch) Rx(roll), angles in rad.
#[must_use]
pub fn attitude_from_euler(roll: f64, pitch: f64, yaw: f64) -> Quaternion<f64> {
    let about = |angle: f64, x: f64, y: f64, z: f64| {
        let (sin, cos) = (0.5 * angle).sin_cos();
        Quaternion::new(cos, sin * x, sin * y, sin * z)
    };
    about(yaw, 0.0, 0.0, 1.0) * about(pitch, 0.0, 1.0, 0.0) * about(roll, 1.0, 0.0, 0.0)
}
