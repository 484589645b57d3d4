//! The desired attitude and its motion, from the thrust direction and the heading: Sections III and V of the paper.
//!
//! | paper | here | equation |
//! |---|---|---|
//! | rho = u / \|u\| | `acceleration_command`, not normalised | Section V |
//! | R_d = \[v, rho x v, rho\] | [`DesiredAttitude::attitude`] | (DesiredRotationMatrix) |
//! | omega_d | [`AngularMotion::velocity`] | (DesiredAngularVelocity) |
//! | omega_d' | [`AngularMotion::acceleration`] | (DesiredAngularAcceleration) |
//!
//! The paper builds R_d's first column by projecting the heading onto the plane orthogonal to rho, such that its
//! horizontal part points exactly along nu_d. That matrix is a product of three plane rotations,
//!
//! R_d = R_z(psi) R_y(theta) R_x(phi),
//!
//! and needs no projector: turn u into the heading frame, h = R_z(psi)^T u, and read theta and phi as polar angles,
//! theta of (h_z, h_x) with radius r, phi of (r, -h_y) with radius n = |u|. Everything is defined while u_z > 0, which
//! M_p < g - K_a3 guarantees. The sine and cosine of theta and phi are ratios of h's components: no trigonometric
//! function is called.
//!
//! The motion follows from u = n R_d e3. Its derivatives, in the axes of the desired body frame, are
//!
//! R_d^T u'  = n' e3 + n omega_d x e3,
//! R_d^T u'' = n'' e3 + 2 n' omega_d x e3 + n (omega_d' x e3 + omega_d x (omega_d x e3)),
//!
//! which give the first two components: with (a, b, n') = R_d^T u' and (c, d, .) = R_d^T u''
//!
//! omega_x = -b / n,  omega_x' = -(d + 2 n' omega_x) / n + omega_y omega_z,
//! omega_y = a / n,   omega_y' = (c - 2 n' omega_y) / n - omega_x omega_z.
//!
//! The third is the heading's. The three plane rotations turn by omega_d = (phi' - psi' sin theta, theta' cos phi +
//! psi' cos theta sin phi, psi' cos theta cos phi - theta' sin phi), so omega_y sin phi + omega_z cos phi = psi' cos
//! theta and its derivative say, with theta' = omega_y cos phi - omega_z sin phi and phi' = omega_x + psi' sin theta,
//!
//! omega_z  = (psi' cos theta - omega_y sin phi) / cos phi,
//! omega_z' = (psi'' cos theta - omega_y' sin phi - theta' (omega_x + 2 psi' sin theta)) / cos phi.
//!
//! The law needs R_d for R~ = R_d^T R only. That is three plane rotations of the vehicle's quaternion, each by half an
//! angle a: along (1 + cos a, sin a) or (sin a, 1 - cos a), whichever does not cancel. The quaternion's length is left
//! as it comes out: what follows divides by it once.

use crate::heading::Heading;
use crate::math;
use crate::state::{STATE_RANGE, sum_of_squares};
use nalgebra::{Quaternion, Vector2, Vector3};

/// R_d with its angular velocity and acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttitudeReference {
    /// |u|, m/s^2: the thrust per unit of mass.
    pub magnitude: f32,
    /// R_d as a unit quaternion, body to world.
    pub attitude: Quaternion<f32>,
    /// omega_d, rad/s, axes of the desired body frame.
    pub angular_velocity: Vector3<f32>,
    /// omega_d', rad/s^2, axes of the desired body frame.
    pub angular_acceleration: Vector3<f32>,
}

/// The attitude that points body z along `command` and body x's horizontal part along `heading`, with its motion.
///
/// `command`, `command_rate` and `command_acceleration` are u, u', u'' in the world frame; u_z > 0.
pub fn attitude_reference(
    command: &Vector3<f32>,
    command_rate: &Vector3<f32>,
    command_acceleration: &Vector3<f32>,
    heading: &Heading,
) -> AttitudeReference {
    let desired = DesiredAttitude::new(command, heading);
    let AngularMotion { velocity, acceleration } = desired.motion(command_rate, command_acceleration, heading);
    AttitudeReference {
        magnitude: desired.magnitude(),
        attitude: desired.attitude(),
        angular_velocity: velocity,
        angular_acceleration: acceleration,
    }
}

/// omega_d and omega_d', axes of the desired body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngularMotion {
    /// rad/s.
    pub velocity: Vector3<f32>,
    /// rad/s^2.
    pub acceleration: Vector3<f32>,
}

impl AngularMotion {
    /// Whether every component is finite, and its square as well.
    #[inline(always)]
    pub(crate) fn is_in_range(&self) -> bool {
        sum_of_squares(&[&self.velocity, &self.acceleration]) <= STATE_RANGE * STATE_RANGE
    }
}

/// How the thrust direction turns, axes of the desired frame without heading's turn: rho' and rho'' across rho.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionMotion {
    /// p, rad/s.
    pub rate: Vector2<f32>,
    /// q, rad/s^2.
    pub acceleration: Vector2<f32>,
    /// n, m/s^2.
    pub magnitude: f32,
    /// r = n', m/s^3.
    pub radial_rate: f32,
    /// rho . u'', m/s^4.
    pub radial_acceleration: f32,
}

/// R_d by its three angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesiredAttitude {
    /// Cosine and sine of psi.
    yaw: Vector2<f32>,
    /// Cosine and sine of theta.
    pitch: Vector2<f32>,
    /// Cosine and sine of phi.
    roll: Vector2<f32>,
    /// 1 / cos phi.
    roll_secant: f32,
    /// n, m/s^2.
    magnitude: f32,
    /// 1 / n, s^2/m.
    inverse_magnitude: f32,
}

impl DesiredAttitude {
    /// For u in the world frame, u_z > 0.
    #[inline(always)]
    pub fn new(command: &Vector3<f32>, heading: &Heading) -> Self {
        let yaw = heading.direction();
        let h = turned_back_by_yaw(&yaw, command);
        let square = h.z * h.z + h.x * h.x;
        let radius = math::sqrt(square);
        let magnitude = math::sqrt(square + h.y * h.y);
        let (inverse_radius, inverse_magnitude) = (1.0 / radius, 1.0 / magnitude);
        Self {
            yaw,
            pitch: Vector2::new(h.z * inverse_radius, h.x * inverse_radius),
            roll: Vector2::new(radius * inverse_magnitude, -h.y * inverse_magnitude),
            roll_secant: magnitude * inverse_radius,
            magnitude,
            inverse_magnitude,
        }
    }

    /// |u|, m/s^2.
    #[inline(always)]
    pub fn magnitude(&self) -> f32 {
        self.magnitude
    }

    /// R_d as a unit quaternion, body to world.
    #[inline(always)]
    pub fn attitude(&self) -> Quaternion<f32> {
        let back = self.error(&Quaternion::new(1.0, 0.0, 0.0, 0.0));
        back.conjugate() * (1.0 / math::sqrt(back.norm_squared()))
    }

    /// R~ = R_d^T R for the vehicle's `attitude`, as a quaternion of any length and either sign.
    ///
    /// Turned back by yaw, pitch and roll: the quaternions (c, 0, 0, -s), (c, 0, -s, 0) and (c, -s, 0, 0) in front,
    /// where (c, s) is along the cosine and sine of half the angle.
    #[inline(always)]
    pub fn error(&self, attitude: &Quaternion<f32>) -> Quaternion<f32> {
        let (w, x, y, z) = (attitude.w, attitude.i, attitude.j, attitude.k);
        let (cos, sin) = (self.yaw.x, self.yaw.y);
        let (c, s) = if cos >= 0.0 { (1.0 + cos, sin) } else { (sin, 1.0 - cos) };
        let (w, x, y, z) = (c * w + s * z, c * x + s * y, c * y - s * x, c * z - s * w);
        // The cosines of pitch and roll are positive.
        let (c, s) = (1.0 + self.pitch.x, self.pitch.y);
        let (w, x, y, z) = (c * w + s * y, c * x - s * z, c * y - s * w, c * z + s * x);
        let (c, s) = (1.0 + self.roll.x, self.roll.y);
        Quaternion::new(c * w + s * x, c * x - s * w, c * y + s * z, c * z - s * y)
    }

    /// omega_d and omega_d' where the command moves by u' and u''; `heading` as before.
    #[inline(always)]
    pub fn motion(
        &self,
        command_rate: &Vector3<f32>,
        command_acceleration: &Vector3<f32>,
        heading: &Heading,
    ) -> AngularMotion {
        let turn = self.direction_motion(command_rate, command_acceleration);
        self.motion_of_direction(&turn.rate, &turn.acceleration, heading)
    }

    /// How rho turns where the command moves by u' and u''.
    #[inline(always)]
    pub fn direction_motion(
        &self,
        command_rate: &Vector3<f32>,
        command_acceleration: &Vector3<f32>,
    ) -> DirectionMotion {
        let rate = self.turned_back(command_rate);
        let acceleration = self.turned_back(command_acceleration);
        let double_magnitude_rate = rate.z + rate.z;
        let p = rate.xy() * self.inverse_magnitude;
        DirectionMotion {
            rate: p,
            acceleration: (acceleration.xy() - p * double_magnitude_rate) * self.inverse_magnitude,
            magnitude: self.magnitude,
            radial_rate: rate.z,
            radial_acceleration: acceleration.z,
        }
    }

    /// The third component of omega_d where rho turns by `rate`, p.
    #[inline(always)]
    pub fn yaw_rate(&self, rate: &Vector2<f32>, heading: &Heading) -> f32 {
        (heading.rate() * self.pitch.x - rate.x * self.roll.y) * self.roll_secant
    }

    /// omega_d and omega_d' where rho turns by p = `rate` and q = `acceleration`; `heading` as before.
    #[inline(always)]
    pub fn motion_of_direction(
        &self,
        rate: &Vector2<f32>,
        acceleration: &Vector2<f32>,
        heading: &Heading,
    ) -> AngularMotion {
        let ([cos_theta, sin_theta], [cos_phi, sin_phi]) = (self.pitch.into(), self.roll.into());
        let (yaw_rate, yaw_acceleration) = (heading.rate(), heading.acceleration());
        let x = -rate.y;
        let y = rate.x;
        let z = self.yaw_rate(rate, heading);
        let x_rate = y * z - acceleration.y;
        let y_rate = acceleration.x - x * z;
        let theta_rate = y * cos_phi - z * sin_phi;
        let turning = x + (yaw_rate + yaw_rate) * sin_theta;
        let z_rate = (yaw_acceleration * cos_theta - y_rate * sin_phi - theta_rate * turning) * self.roll_secant;
        AngularMotion { velocity: Vector3::new(x, y, z), acceleration: Vector3::new(x_rate, y_rate, z_rate) }
    }

    /// e3 in the axes of the desired frame: R_d^T e3.
    #[inline(always)]
    pub fn up(&self) -> Vector3<f32> {
        let ([cos_theta, sin_theta], [cos_phi, sin_phi]) = (self.pitch.into(), self.roll.into());
        Vector3::new(-sin_theta, sin_phi * cos_theta, cos_phi * cos_theta)
    }

    /// R_d v.
    #[inline(always)]
    pub fn turned(&self, v: &Vector3<f32>) -> Vector3<f32> {
        let ([cos_theta, sin_theta], [cos_phi, sin_phi]) = (self.pitch.into(), self.roll.into());
        let (y, along) = (cos_phi * v.y - sin_phi * v.z, sin_phi * v.y + cos_phi * v.z);
        let (x, z) = (cos_theta * v.x + sin_theta * along, cos_theta * along - sin_theta * v.x);
        Vector3::new(self.yaw.x * x - self.yaw.y * y, self.yaw.y * x + self.yaw.x * y, z)
    }

    /// R_d^T v.
    #[inline(always)]
    fn turned_back(&self, v: &Vector3<f32>) -> Vector3<f32> {
        let ([cos_theta, sin_theta], [cos_phi, sin_phi]) = (self.pitch.into(), self.roll.into());
        let h = turned_back_by_yaw(&self.yaw, v);
        let along = cos_theta * h.z + sin_theta * h.x;
        Vector3::new(
            cos_theta * h.x - sin_theta * h.z,
            cos_phi * h.y + sin_phi * along,
            cos_phi * along - sin_phi * h.y,
        )
    }
}

/// Components in the heading frame, R_z(psi)^T v, for the cosine and sine of psi.
#[inline(always)]
fn turned_back_by_yaw(yaw: &Vector2<f32>, v: &Vector3<f32>) -> Vector3<f32> {
    Vector3::new(yaw.x * v.x + yaw.y * v.y, yaw.x * v.y - yaw.y * v.x, v.z)
}

#[cfg(test)]
mod tests;
