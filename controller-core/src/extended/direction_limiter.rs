//! How the thrust direction turns: as fast as the torque at hand can turn the vehicle. Section 3 of
//! `docs/extended-law.md`.
//!
//! With n = |u|, rho = u / n, r = rho . u', in the axes of the desired frame, where rho = e3:
//!
//! | here | equation |
//! |---|---|
//! | p = (u'_1, u'_2) / n | rho', [`crate::attitude_reference::DirectionMotion::rate`] |
//! | q = ((u''_1, u''_2) - 2 r p) / n | rho'', without its radial part |
//! | \|q\| <= alpha, the greatest torque over J_max | [`DirectionLimiter::limited`] |
//! | (p + h q) . z >= -sqrt(alpha / 2) (rho_z - cos gamma) | rho stays in its cone; z is e3 without its part along rho |
//! | \|p + h q\| <= Omega | |
//! | J R~^T omega_rho', omega_rho' = (-q_2, q_1, 0) | spent last: the tick shortens q to what its [budget](super::budget) has left |
//! | c_z'' >= -2 k c_z' - k^2 (c_z + A_-) | [`DirectionLimiter::change`]: c_z stays above -A_- |
//! | n'' <= -2 k r - k^2 (n - U) | \|u\| stays below U, which goes first |
//! | n* = n + (y_z - c_z) / rho_z, at most U; the change is at most 5 m/s^2 across | [`DirectionLimiter::length`]: the thrust is m n* rho . b |
//!
//! q is shortened; thrust itself is free, for rotors lag by milliseconds only: so the last three rows are along rho.
//! With n* the vertical gets what it wants, whatever the direction of u lags behind; n itself has come through the
//! filters. Where rho has left its cone, a little along the vertical is much along rho: there c_z is left to the
//! filters' own end ([`super::position`]), or u would grow without bound. The drive takes up the change of u'': x' =
//! drive + (change of u'') / k_f.

use super::parameters::ExtendedParameters;
use crate::attitude_reference::DirectionMotion;
use crate::math;
use crate::math::real::Real;
use core::hint::cold_path;
use nalgebra::{Vector2, Vector3};

/// k, 1/s: how softly u arrives at its ends; at most half a tick's.
pub const END_SOFTNESS_PER_S: f32 = 10.0;

/// How much of what thrust takes at once may push across, m/s^2.
pub const PUSH_ACROSS_MAX_M_PER_S2: f32 = 5.0;

/// The limiter's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionLimiter {
    period: f32,
    rate: f32,
    acceleration: f32,
    cosine: f32,
    /// sqrt(alpha / 2), 1/s.
    closing: f32,
    /// k, 1/s.
    softness: f32,
    a_down: f32,
}

impl DirectionLimiter {
    /// For an alpha of `acceleration`, rad/s^2, and steps of `period`, s.
    pub fn new(parameters: &ExtendedParameters, acceleration: f32, period: f32) -> Self {
        let p = parameters;
        Self {
            period,
            rate: p.turn_rate,
            acceleration,
            cosine: (1.0 / math::hypot(1.0, math::tan(f64::from(p.tilt_max)))) as f32,
            closing: closing(f64::from(acceleration)) as f32,
            softness: math::min(END_SOFTNESS_PER_S, 0.5 / period),
            a_down: p.a_down,
        }
    }

    /// n*, m/s^2, for n, y_z - c_z as `more`, e3 in the axes of the desired frame and U.
    #[inline(always)] // into the law's step
    pub fn length(&self, magnitude: f32, more: f32, up: &Vector3<f32>, max: f32) -> f32 {
        let most = PUSH_ACROSS_MAX_M_PER_S2 / math::sqrt(up.xy().norm_squared() + f32::MIN_POSITIVE);
        let length = magnitude + math::saturate(more / math::max(up.z, self.cosine), most);
        math::min(math::max(length, 0.0), max)
    }

    /// q for a wanted `turn`, rad/s^2; `up` is e3 in the axes of the desired frame.
    #[inline(always)] // into the law's step
    pub fn limited(&self, turn: &DirectionMotion, up: &Vector3<f32>) -> Vector2<f32> {
        let DirectionMotion { rate, acceleration, .. } = turn;
        let q = self.kept_in_cone(shortened(*acceleration, self.acceleration), rate, up);
        let next = rate + q * self.period;
        if next.norm_squared() > self.rate * self.rate {
            cold_path();
            return shortened((shortened(next, self.rate) - rate) / self.period, self.acceleration);
        }
        q
    }

    /// The change of u'' where the turn is `acceleration` instead of the wanted one, and for u to stay within its ends;
    /// axes of the desired frame, m/s^4. None if nothing is changed. `max` is U, m/s^2; `vertical` c_z, c_z' and
    /// c_z'' as wanted, m/s^2, m/s^3, m/s^4.
    #[inline(always)]
    pub fn change(
        &self,
        turn: &DirectionMotion,
        acceleration: &Vector2<f32>,
        up: &Vector3<f32>,
        max: f32,
        vertical: [f32; 3],
    ) -> Option<Vector3<f32>> {
        let DirectionMotion { rate, acceleration: wanted, magnitude, radial_rate, radial_acceleration } = turn;
        let [c, c_rate, c_wanted] = vertical;
        // In nearly every tick nothing is shortened.
        let turned = acceleration != wanted;
        let (mut tangential, mut along) = (Vector2::zeros(), 0.0);
        if turned {
            cold_path();
            tangential = (acceleration - wanted) * *magnitude;
        }
        let k = self.softness;
        let falling = if turned { c_wanted + tangential.dot(&up.xy()) } else { c_wanted };
        let least_rising = -2.0 * k * c_rate - k * k * (c + self.a_down);
        if falling < least_rising {
            cold_path();
            along = (least_rising - falling) / up.z;
        }
        let swelling = radial_acceleration + magnitude * rate.norm_squared() + along;
        let least_shrinking = -2.0 * k * radial_rate - k * k * (magnitude - max);
        if swelling > least_shrinking {
            cold_path();
            along += least_shrinking - swelling;
        }
        (turned || along != 0.0).then(|| Vector3::new(tangential.x, tangential.y, along))
    }

    /// `q` with so much towards the vertical that rho stays in its cone, and so much less across that it is at most
    /// alpha.
    fn kept_in_cone(&self, q: Vector2<f32>, rate: &Vector2<f32>, up: &Vector3<f32>) -> Vector2<f32> {
        let z = up.xy();
        let min = -self.closing * (up.z - self.cosine);
        if (rate + q * self.period).dot(&z) >= min {
            return q;
        }
        cold_path();
        // Beyond the cone's edge by rounding alone: z is as long as the sine of the cone's angle.
        let length = math::sqrt(math::max(z.norm_squared(), 1e-6));
        let (z, max) = (z / length, self.acceleration);
        let along = math::saturate((min / length - rate.dot(&z)) / self.period, max);
        let left = math::sqrt(math::max(max * max - along * along, 0.0));
        shortened(shortened(q - z * q.dot(&z), left) + z * along, max)
    }
}

/// How fast rho_z may fall towards the edge of the cone, per distance from it, 1/s, for an alpha in rad/s^2: braking
/// takes half of alpha from upright on, and less from there.
pub fn closing<R: Real>(acceleration: R) -> R {
    (acceleration * 0.5).sqrt_of_rounded()
}

/// `v`, at most `length` long.
fn shortened(v: Vector2<f32>, length: f32) -> Vector2<f32> {
    let square = v.norm_squared();
    if square > length * length {
        cold_path();
        v * (length / math::sqrt(square))
    } else {
        v
    }
}
