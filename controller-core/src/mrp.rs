//! Modified Rodrigues parameters, Section II of the paper.
//!
//! | paper | here | equation |
//! |---|---|---|
//! | R(q) | [`rotation`] | I + 2 q_0 \[q_1\]x + 2 \[q_1\]x^2 |
//! | phi(q) | [`from_quaternion`] | q_1 / (1 + q_0) |
//! | Upsilon(theta) | [`shadow`] | -theta / \|theta\|^2 |
//! | T(theta) | [`kinematics`] | ((1 - \|theta\|^2) I + 2 \[theta\]x + 2 theta theta^T) / 4 |
//! | R_theta(theta), eq. (1) | [`to_rotation`] | I + (8 \[theta\]x^2 + 4 (1 - \|theta\|^2) \[theta\]x) / (1 + \|theta\|^2)^2 |
//!
//! The printed eq. (1) has a minus before its middle term, which with the paper's own R(q), phi and T gives the
//! transpose; here it is the plus that makes R_theta(phi(q)) = R(q).
//!
//! The tick uses [`from_multiple`] only, behind the path lifting, which keeps 1 + q_0 away from zero.

use nalgebra::{Matrix3, Quaternion, Vector3};

/// R(q) for a unit quaternion, body to world.
pub fn rotation(q: &Quaternion<f32>) -> Matrix3<f32> {
    let cross = q.imag().cross_matrix();
    Matrix3::identity() + cross * (2.0 * q.w) + cross * cross * 2.0
}

/// phi(q) for a unit quaternion other than (-1, 0, 0, 0), where it is infinite.
pub fn from_quaternion(q: &Quaternion<f32>) -> Vector3<f32> {
    from_multiple(q, 1.0, 1.0)
}

/// phi of the unit quaternion `sign` Q / N for a quaternion Q of length N: `sign` Q_1 / (N + `sign` Q_0).
#[inline(always)]
pub fn from_multiple(q: &Quaternion<f32>, sign: f32, length: f32) -> Vector3<f32> {
    q.imag() * (sign / (length + sign * q.w))
}

/// The shadow parameters of the same rotation, Upsilon(theta), theta not zero.
pub fn shadow(theta: &Vector3<f32>) -> Vector3<f32> {
    -theta / theta.norm_squared()
}

/// T(theta): theta' = T(theta) omega, omega in the body frame.
pub fn kinematics(theta: &Vector3<f32>) -> Matrix3<f32> {
    let diagonal = Matrix3::identity() * (1.0 - theta.norm_squared());
    (diagonal + theta.cross_matrix() * 2.0 + theta * theta.transpose() * 2.0) * 0.25
}

/// R_theta(theta), with the sign that makes it agree with R(q).
pub fn to_rotation(theta: &Vector3<f32>) -> Matrix3<f32> {
    let square = theta.norm_squared();
    let cross = theta.cross_matrix();
    let scale = 1.0 / ((1.0 + square) * (1.0 + square));
    Matrix3::identity() + (cross * cross * 8.0 + cross * (4.0 * (1.0 - square))) * scale
}
