//! The heading generator: the desired frame may lag in heading, so that its motion about the thrust axis is bounded by
//! design. Section 5 of `docs/extended-law.md`.
//!
//! R_d = R_d*(rho, nu_d) R_z(chi), where R_d* is the paper's frame with rates w* and accelerations w*':
//!
//! | here | equation |
//! |---|---|
//! | chi | chi' = W - w*_3, kept as (cos, sin) of chi / 2, cos >= 0 |
//! | W, [`Turning::velocity`]'s third | W' = sat(w*_3' - c_2 (W - w*_3) - 2 c_1 sin(chi / 2); A), \|W\| <= W_max |
//! | omega_d | (R_z(-chi) (w*_1, w*_2), W) |
//! | omega_d' | (R_z(-chi) (w*_1', w*_2') + chi' (omega_d2, -omega_d1), W') |
//!
//! The thrust's direction does not depend on chi. Exact heading under a changing tilt can need more yaw torque than a
//! vehicle has; here yaw needs at most J_33 A and a gyroscopic term, and the heading catches up. For small chi, 2 c_1
//! sin(chi/2) is c_1 chi; at half a turn it is greatest, and its sign there follows that of sin(chi / 2), which only
//! then changes at once.

use super::parameters::ExtendedParameters;
use crate::attitude_reference::AngularMotion;
use crate::error::{ParameterError, Reason, require};
use crate::math;
use nalgebra::{Quaternion, Vector2, Vector3};

/// chi and W.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeadingLag {
    /// (cos, sin) of chi / 2, the cosine not negative.
    pub half_angle: Vector2<f32>,
    /// W, rad/s.
    pub rate: f32,
}

impl HeadingLag {
    /// No lag, turning at `rate`, rad/s, as far as the generator may.
    #[must_use]
    pub fn none(rate: f32, parameters: &ExtendedParameters) -> Self {
        Self { half_angle: Vector2::new(1.0, 0.0), rate: math::within(rate, parameters.yaw_rate) }
    }

    /// R_z(-chi) of the first two components.
    fn across(&self, v: &Vector3<f32>) -> Vector2<f32> {
        let (c, s) = (self.half_angle.x, self.half_angle.y);
        let (cos, sin) = (c * c - s * s, 2.0 * c * s);
        Vector2::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x)
    }

    /// R_z(-chi) times the paper's error: R~ as a quaternion of any length along R_d^T R.
    #[must_use]
    pub fn turned_back(&self, error: &Quaternion<f32>) -> Quaternion<f32> {
        let (c, s) = (self.half_angle.x, self.half_angle.y);
        let (w, x, y, z) = (error.w, error.i, error.j, error.k);
        Quaternion::new(c * w + s * z, c * x + s * y, c * y - s * x, c * z - s * w)
    }
}

/// Checks the gains for ticks `period` seconds apart. In samples, small chi and W - w*_3 follow
/// z^2 - (2 - h c_2) z + 1 - h c_2 + h^2 c_1, whose roots are inside the unit circle if h c_1 < c_2 and
/// 2 h c_2 < 4 + h^2 c_1. The law requires half of either.
///
/// # Errors
/// Names `gains.c_1` or `gains.c_2`.
pub fn check(parameters: &ExtendedParameters, period: f32) -> Result<(), ParameterError> {
    let ExtendedParameters { c_1, c_2, .. } = *parameters;
    require(c_2 * period <= 1.0, "gains.c_2", Reason::Above(1.0 / period))?;
    let most = 0.5 * c_2 / period;
    require(c_1 <= most, "gains.c_1", Reason::Above(most))
}

/// The desired frame's motion, and the lag's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turning {
    /// omega_d, rad/s, axes of the desired body frame.
    pub velocity: Vector3<f32>,
    /// omega_d', rad/s^2, axes of the desired body frame.
    pub acceleration: Vector3<f32>,
    /// chi', rad/s.
    pub lag_rate: f32,
}

/// omega_d, rad/s, axes of the desired body frame, where the paper's is `paper`.
#[must_use]
pub fn velocity(lag: &HeadingLag, paper: &Vector3<f32>) -> Vector3<f32> {
    let across = lag.across(paper);
    Vector3::new(across.x, across.y, lag.rate)
}

/// The desired motion for the paper's frame's `motion` and the lag at hand, with ticks `period` seconds apart.
#[must_use]
pub fn turning(lag: &HeadingLag, motion: &AngularMotion, parameters: &ExtendedParameters, period: f32) -> Turning {
    let ExtendedParameters { yaw_acceleration: most, yaw_rate: fastest, c_1, c_2, .. } = *parameters;
    let AngularMotion { velocity: w, acceleration: a } = motion;
    let s = lag.half_angle.y;
    let lag_rate = lag.rate - w.z;
    let wanted = math::within(a.z - c_2 * lag_rate - 2.0 * c_1 * s, most);
    // The rate at the end of the period is what W_max bounds.
    let turn = math::within_rate(wanted, lag.rate, fastest, period);

    let (velocity, acceleration) = (lag.across(w), lag.across(a));
    Turning {
        velocity: Vector3::new(velocity.x, velocity.y, lag.rate),
        acceleration: Vector3::new(
            acceleration.x + lag_rate * velocity.y,
            acceleration.y - lag_rate * velocity.x,
            turn,
        ),
        lag_rate,
    }
}

/// The lag one period later, with W at most `fastest`, rad/s: where the thrust direction turns fast, a faster W would
/// exceed the frame's budget.
#[must_use]
pub fn advanced(lag: &HeadingLag, turning: &Turning, period: f32, fastest: f32) -> HeadingLag {
    let half = 0.5 * period * turning.lag_rate;
    let (c, s) = (lag.half_angle.x, lag.half_angle.y);
    let (cos, sin) = (c - half * s, s + half * c);
    let length = math::sqrt(cos * cos + sin * sin);
    let scale = if cos < 0.0 { -1.0 / length } else { 1.0 / length };
    HeadingLag {
        half_angle: Vector2::new(cos * scale, sin * scale),
        rate: math::within(lag.rate + turning.acceleration.z * period, fastest),
    }
}
