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
//! and its derivatives need no projector: turn u into the heading frame, h = R_z(psi)^T u, and read theta and phi as polar
//! angles, theta of (h_z, h_x) with radius r, phi of (r, -h_y) with radius n = |u|. With h', h'' the derivatives of those
//! components, for each polar pair (x, y) of radius r and angle a
//!
//! r' = cos a x' + sin a y',  r a' = cos a y' - sin a x',
//! r'' = cos a x'' + sin a y'' + r a'^2,  r a'' = cos a y'' - sin a x'' - 2 r' a'.
//!
//! Then omega_d = (phi' - psi' sin theta, A cos phi + B sin phi, B cos phi - A sin phi) with A = theta', B = psi' cos theta.
//! Everything is defined while u_z > 0, which M_p < g - K_a3 guarantees. The sine and cosine of theta and phi are ratios of
//! h's components: no trigonometric function is called. omega_d is in the axes of the desired body frame.
//!
//! The law needs R_d for R~ = R_d^T R only. That is three plane rotations of the vehicle's quaternion, each by half an angle
//! a: along (1 + cos a, sin a) or (sin a, 1 - cos a), whichever does not cancel. Lengths are left to the path lifting, which
//! divides by all of them at once. R_d comes first and its motion last: fewer numbers wait for each other.

use crate::heading::Heading;
use crate::math;
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
#[must_use]
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

/// R_d by its three angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesiredAttitude {
    /// Cosine and sine of psi.
    nu: Vector2<f32>,
    /// u in the heading frame, m/s^2.
    h: Vector3<f32>,
    pitch: Polar,
    roll: Polar,
}

impl DesiredAttitude {
    /// For u in the world frame, u_z > 0.
    #[inline(always)]
    #[must_use]
    pub fn new(command: &Vector3<f32>, heading: &Heading) -> Self {
        let nu = heading.direction();
        let h = turn(&nu, command);
        let pitch = Polar::new(h.z, h.x);
        Self { nu, h, pitch, roll: Polar::new(pitch.radius, -h.y) }
    }

    /// |u|, m/s^2.
    #[inline(always)]
    #[must_use]
    pub fn magnitude(&self) -> f32 {
        self.roll.radius
    }

    /// R_d as a unit quaternion, body to world.
    #[inline(always)]
    #[must_use]
    pub fn attitude(&self) -> Quaternion<f32> {
        let back = self.error(&Quaternion::new(1.0, 0.0, 0.0, 0.0));
        back.conjugate() * (1.0 / math::sqrt(back.norm_squared()))
    }

    /// R~ = R_d^T R for the vehicle's `attitude`, as a quaternion of any length and either sign.
    ///
    /// Turned back by yaw, pitch and roll: the quaternions (c, 0, 0, -s), (c, 0, -s, 0) and (c, -s, 0, 0) in front, where
    /// (c, s) is along the cosine and sine of half the angle.
    #[inline(always)]
    #[must_use]
    pub fn error(&self, attitude: &Quaternion<f32>) -> Quaternion<f32> {
        let (w, x, y, z) = (attitude.w, attitude.i, attitude.j, attitude.k);
        let (cos, sin) = (self.nu.x, self.nu.y);
        let (c, s) = if cos >= 0.0 { (1.0 + cos, sin) } else { (sin, 1.0 - cos) };
        let (w, x, y, z) = (c * w + s * z, c * x + s * y, c * y - s * x, c * z - s * w);
        // The cosines of pitch and roll are positive.
        let (c, s) = (1.0 + self.pitch.cos, self.pitch.sin);
        let (w, x, y, z) = (c * w + s * y, c * x - s * z, c * y - s * w, c * z + s * x);
        let (c, s) = (1.0 + self.roll.cos, self.roll.sin);
        Quaternion::new(c * w + s * x, c * x - s * w, c * y + s * z, c * z - s * y)
    }

    /// omega_d and omega_d' where the command moves by u' and u''; `heading` as before.
    #[inline(always)]
    #[must_use]
    pub fn motion(
        &self,
        command_rate: &Vector3<f32>,
        command_acceleration: &Vector3<f32>,
        heading: &Heading,
    ) -> AngularMotion {
        let Self { nu, h, pitch, roll } = self;
        let (yaw_rate, yaw_acceleration) = (heading.rate(), heading.acceleration());
        // h', h'': derivatives of the components in the heading frame.
        let turned = turn(nu, command_rate);
        let h_rate = Vector3::new(turned.x + yaw_rate * h.y, turned.y - yaw_rate * h.x, turned.z);
        let turned_again = turn(nu, command_acceleration);
        let h_acceleration = Vector3::new(
            turned_again.x + yaw_rate * (turned.y + h_rate.y) + yaw_acceleration * h.y,
            turned_again.y - yaw_rate * (turned.x + h_rate.x) - yaw_acceleration * h.x,
            turned_again.z,
        );
        let pitching = pitch.rates([h_rate.z, h_acceleration.z], [h_rate.x, h_acceleration.x]);
        let rolling = roll.rates([pitching.radius[0], pitching.radius[1]], [-h_rate.y, -h_acceleration.y]);

        let ([a, a_rate], [phi_rate, phi_acceleration]) = (pitching.angle, rolling.angle);
        let b = yaw_rate * pitch.cos;
        let b_rate = yaw_acceleration * pitch.cos - yaw_rate * pitch.sin * a;
        let velocity =
            Vector3::new(phi_rate - yaw_rate * pitch.sin, a * roll.cos + b * roll.sin, b * roll.cos - a * roll.sin);
        let acceleration = Vector3::new(
            phi_acceleration - yaw_acceleration * pitch.sin - b * a,
            a_rate * roll.cos + b_rate * roll.sin + phi_rate * velocity.z,
            b_rate * roll.cos - a_rate * roll.sin - phi_rate * velocity.y,
        );
        AngularMotion { velocity, acceleration }
    }
}

/// Components in the heading frame, R_z(psi)^T v.
#[inline(always)]
fn turn(nu: &Vector2<f32>, v: &Vector3<f32>) -> Vector3<f32> {
    Vector3::new(nu.x * v.x + nu.y * v.y, nu.x * v.y - nu.y * v.x, v.z)
}

/// A pair of components (x, y) read as polar coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Polar {
    cos: f32,
    sin: f32,
    radius: f32,
    /// 1 / radius.
    inverse: f32,
}

/// First and second derivatives of polar coordinates.
#[derive(Clone, Copy)]
struct PolarRates {
    radius: [f32; 2],
    angle: [f32; 2],
}

impl Polar {
    /// The radius must not be zero.
    #[inline(always)]
    fn new(x: f32, y: f32) -> Self {
        let radius = math::sqrt(x * x + y * y);
        let inverse = 1.0 / radius;
        Self { cos: x * inverse, sin: y * inverse, radius, inverse }
    }

    /// From the first and second derivatives of x and y.
    #[inline(always)]
    fn rates(&self, [dx, ddx]: [f32; 2], [dy, ddy]: [f32; 2]) -> PolarRates {
        let Self { cos, sin, inverse, .. } = self;
        let radius_rate = cos * dx + sin * dy;
        let tangential = cos * dy - sin * dx;
        let angle_rate = tangential * inverse;
        let radius_acceleration = cos * ddx + sin * ddy + tangential * angle_rate;
        let angle_acceleration = (cos * ddy - sin * ddx - (radius_rate + radius_rate) * angle_rate) * inverse;
        PolarRates { radius: [radius_rate, radius_acceleration], angle: [angle_rate, angle_acceleration] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mrp;

    #[test]
    fn body_z_points_along_the_command_and_body_x_over_the_heading() {
        let u = Vector3::new(3.0, -2.0, 6.0);
        for (cos, sin) in [(1.0, 0.0), (-0.8, 0.6), (-1.0, 0.0), (0.28, -0.96)] {
            let heading = Heading::new(Vector2::new(cos, sin), 0.0, 0.0).unwrap();
            let desired = attitude_reference(&u, &Vector3::zeros(), &Vector3::zeros(), &heading);
            let r = mrp::rotation(&desired.attitude);
            assert!((r.column(2) - u / 7.0).norm() < 1e-6);
            let x = r.column(0);
            assert!((cos * x[1] - sin * x[0]).abs() < 1e-6 && cos * x[0] + sin * x[1] > 0.0);
            assert!((desired.magnitude - 7.0).abs() < 1e-6);
        }
    }

    #[test]
    fn the_error_is_the_conjugate_of_the_desired_attitude_times_the_attitude() {
        let attitude = Quaternion::new(0.5, -0.1, 0.7, 0.5);
        for (cos, sin) in [(1.0, 0.0), (-0.8, 0.6), (-1.0, 0.0), (0.28, -0.96)] {
            let heading = Heading::new(Vector2::new(cos, sin), 0.0, 0.0).unwrap();
            let desired = DesiredAttitude::new(&Vector3::new(3.0, -2.0, 6.0), &heading);
            let (error, expected) = (desired.error(&attitude), desired.attitude().conjugate() * attitude);
            assert!((error * expected.dot(&error).signum() / error.norm() - expected / expected.norm()).norm() < 1e-6);
        }
    }

    #[test]
    fn a_turning_heading_over_a_level_vehicle_is_pure_yaw() {
        let heading = Heading::new(Vector2::new(0.6, 0.8), 1.5, -0.5).unwrap();
        let still = Vector3::zeros();
        let desired = attitude_reference(&Vector3::new(0.0, 0.0, 9.81), &still, &still, &heading);
        assert!((desired.angular_velocity - Vector3::new(0.0, 0.0, 1.5)).norm() < 1e-6);
        assert!((desired.angular_acceleration - Vector3::new(0.0, 0.0, -0.5)).norm() < 1e-6);
    }
}
