//! The desired attitude and its motion, from the thrust direction and the heading: Sections III and V of the paper.
//!
//! | paper | here | equation |
//! |---|---|---|
//! | rho = u / \|u\| | `acceleration_command`, not normalised | Section V |
//! | R_d = \[v, rho x v, rho\] | [`AttitudeReference::attitude`] | (DesiredRotationMatrix) |
//! | omega_d | [`AttitudeReference::angular_velocity`] | (DesiredAngularVelocity) |
//! | omega_d' | [`AttitudeReference::angular_acceleration`] | (DesiredAngularAcceleration) |
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
//! divides by all of them at once.

use crate::heading::Heading;
use crate::math;
use nalgebra::{Quaternion, Vector3};

/// R_d with its angular velocity and acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttitudeReference {
    /// |u|, m/s^2: the thrust per unit of mass.
    pub magnitude: f32,
    /// R_d as a unit quaternion, body to world.
    pub attitude: Quaternion<f32>,
    half_angles: HalfAngles,
    /// omega_d, rad/s, axes of the desired body frame.
    pub angular_velocity: Vector3<f32>,
    /// omega_d', rad/s^2, axes of the desired body frame.
    pub angular_acceleration: Vector3<f32>,
}

impl AttitudeReference {
    /// R~ = R_d^T R for the vehicle's `attitude`, as a quaternion of any length and either sign.
    #[inline(always)]
    #[must_use]
    pub fn error(&self, attitude: &Quaternion<f32>) -> Quaternion<f32> {
        self.half_angles.turn_back(attitude)
    }
}

/// Yaw, pitch and roll of R_d, each as (cos a/2, sin a/2) times anything but zero.
#[derive(Debug, Clone, Copy, PartialEq)]
struct HalfAngles {
    yaw: (f32, f32),
    pitch: (f32, f32),
    roll: (f32, f32),
}

impl HalfAngles {
    /// From the cosine and sine of yaw, and of pitch and roll, whose cosines are positive.
    #[inline(always)]
    fn new(yaw: (f32, f32), pitch: &Polar, roll: &Polar) -> Self {
        let (cos, sin) = yaw;
        Self {
            yaw: if cos >= 0.0 { (1.0 + cos, sin) } else { (sin, 1.0 - cos) },
            pitch: (1.0 + pitch.cos, pitch.sin),
            roll: (1.0 + roll.cos, roll.sin),
        }
    }

    /// (R_z R_y R_x)^T in front of `q`: the conjugates (c, 0, 0, -s), (c, 0, -s, 0) and (c, -s, 0, 0), one after the other.
    #[inline(always)]
    fn turn_back(&self, q: &Quaternion<f32>) -> Quaternion<f32> {
        let (w, x, y, z) = (q.w, q.i, q.j, q.k);
        let (c, s) = self.yaw;
        let (w, x, y, z) = (c * w + s * z, c * x + s * y, c * y - s * x, c * z - s * w);
        let (c, s) = self.pitch;
        let (w, x, y, z) = (c * w + s * y, c * x - s * z, c * y - s * w, c * z + s * x);
        let (c, s) = self.roll;
        Quaternion::new(c * w + s * x, c * x - s * w, c * y + s * z, c * z - s * y)
    }

    /// R_z R_y R_x as a unit quaternion.
    #[inline(always)]
    fn product(&self) -> Quaternion<f32> {
        let back = self.turn_back(&Quaternion::new(1.0, 0.0, 0.0, 0.0));
        back.conjugate() * (1.0 / math::sqrt(back.norm_squared()))
    }
}

/// A pair of components read as polar coordinates, with two derivatives.
#[derive(Clone, Copy)]
struct Polar {
    cos: f32,
    sin: f32,
    radius: f32,
    radius_rate: f32,
    radius_acceleration: f32,
    angle_rate: f32,
    angle_acceleration: f32,
}

impl Polar {
    /// From (x, y) with first and second derivatives; the radius must not be zero.
    #[inline(always)]
    fn new(x: [f32; 3], y: [f32; 3]) -> Self {
        let ([x, dx, ddx], [y, dy, ddy]) = (x, y);
        let radius = math::sqrt(x * x + y * y);
        let inverse = 1.0 / radius;
        let (cos, sin) = (x * inverse, y * inverse);
        let radius_rate = cos * dx + sin * dy;
        let angle_rate = (cos * dy - sin * dx) * inverse;
        let radius_acceleration = cos * ddx + sin * ddy + radius * angle_rate * angle_rate;
        let angle_acceleration = (cos * ddy - sin * ddx - 2.0 * radius_rate * angle_rate) * inverse;
        Self { cos, sin, radius, radius_rate, radius_acceleration, angle_rate, angle_acceleration }
    }
}

/// The attitude that points body z along `command` and body x's horizontal part along `heading`.
///
/// `command`, `command_rate` and `command_acceleration` are u, u', u'' in the world frame; u_z > 0.
#[inline(always)]
#[must_use]
pub fn attitude_reference(
    command: &Vector3<f32>,
    command_rate: &Vector3<f32>,
    command_acceleration: &Vector3<f32>,
    heading: &Heading,
) -> AttitudeReference {
    let nu = heading.direction();
    let (yaw_rate, yaw_acceleration) = (heading.rate(), heading.acceleration());
    let turn = |v: &Vector3<f32>| Vector3::new(nu.x * v.x + nu.y * v.y, nu.x * v.y - nu.y * v.x, v.z);

    // h, h', h'': components in the heading frame, and the derivatives of those components.
    let h = turn(command);
    let turned_rate = turn(command_rate);
    let turned_acceleration = turn(command_acceleration);
    let h_rate = Vector3::new(turned_rate.x + yaw_rate * h.y, turned_rate.y - yaw_rate * h.x, turned_rate.z);
    let h_acceleration = Vector3::new(
        turned_acceleration.x + yaw_rate * (turned_rate.y + h_rate.y) + yaw_acceleration * h.y,
        turned_acceleration.y - yaw_rate * (turned_rate.x + h_rate.x) - yaw_acceleration * h.x,
        turned_acceleration.z,
    );

    let pitch = Polar::new([h.z, h_rate.z, h_acceleration.z], [h.x, h_rate.x, h_acceleration.x]);
    let roll =
        Polar::new([pitch.radius, pitch.radius_rate, pitch.radius_acceleration], [-h.y, -h_rate.y, -h_acceleration.y]);

    let a = pitch.angle_rate;
    let b = yaw_rate * pitch.cos;
    let a_rate = pitch.angle_acceleration;
    let b_rate = yaw_acceleration * pitch.cos - yaw_rate * pitch.sin * a;
    let angular_velocity =
        Vector3::new(roll.angle_rate - yaw_rate * pitch.sin, a * roll.cos + b * roll.sin, b * roll.cos - a * roll.sin);
    let angular_acceleration = Vector3::new(
        roll.angle_acceleration - yaw_acceleration * pitch.sin - b * a,
        a_rate * roll.cos + b_rate * roll.sin + roll.angle_rate * angular_velocity.z,
        b_rate * roll.cos - a_rate * roll.sin - roll.angle_rate * angular_velocity.y,
    );
    let half_angles = HalfAngles::new((nu.x, nu.y), &pitch, &roll);
    AttitudeReference {
        magnitude: roll.radius,
        attitude: half_angles.product(),
        half_angles,
        angular_velocity,
        angular_acceleration,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mrp;
    use nalgebra::Vector2;

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
            let still = Vector3::zeros();
            let desired = attitude_reference(&Vector3::new(3.0, -2.0, 6.0), &still, &still, &heading);
            let (error, expected) = (desired.error(&attitude), desired.attitude.conjugate() * attitude);
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
