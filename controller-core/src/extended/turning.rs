//! How the thrust direction turns: as fast as the thrust and torque at hand can turn the vehicle. Section 3 of
//! `docs/extended-law.md`.
//!
//! With n = |u|, rho = u / n, r = rho . u', in the axes of the desired frame, where rho = e3:
//!
//! | here | equation |
//! |---|---|
//! | p = (u'_1, u'_2) / n | rho', [`crate::attitude_reference::Turn::rate`] |
//! | q = ((u''_1, u''_2) - 2 r p) / n | rho'', without its radial part |
//! | \|q + W (p_2, -p_1)\| <= alpha, at least alpha_0 | omega'_d12 and the budget ([`super::budget`]); W turns p in the frame's axes, not its length |
//! | \|q\| <= 0.6 alpha, \|W\| \|p\| <= 0.4 alpha | both get a share: W is cut for the next tick ([`super::heading::advanced`]) |
//! | \|p + h q\| <= Omega | |
//! | (p + h q) . z >= -(alpha_0 / Omega) (rho_z - cos gamma) | rho stays in its cone; z is e3 without its part along rho |
//! | c_z'' >= -2 k c_z' - k^2 (c_z + A_-) | c_z stays above -A_- |
//! | n'' <= -2 k r - k^2 (n - U) | \|u\| stays below U, which goes first |
//!
//! q is shortened; thrust itself is free, for rotors lag by milliseconds only: so the last two rows add along rho.
//! Where rho has left its cone, a little along the vertical is much along rho: there c_z is left to the filters' own
//! end ([`super::position`]), or u would grow without bound. The drive takes up the change of u'': x' = drive + (change
//! of u'') / k_f.

use super::parameters::ExtendedParameters;
use crate::attitude_reference::Turn;
use crate::math;
use core::hint::cold_path;
use nalgebra::{Vector2, Vector3};

/// k, 1/s: how softly u arrives at its ends; at most half a tick's.
const SOFTNESS: f32 = 10.0;

/// The part of alpha that q may take.
pub const TURNED: f32 = 0.6;

/// What |p| counts as at least where the frame is carried about rho, rad/s.
pub const SLOWEST: f32 = 1e-3;

/// The limiter's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningLimit {
    period: f32,
    rate: f32,
    reserve: f32,
    cosine: f32,
    /// alpha_0 / Omega, 1/s.
    closing: f32,
    /// k, 1/s.
    softness: f32,
    a_down: f32,
}

/// The limiter's inputs beside the turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circumstances {
    /// alpha, rad/s^2, as the budget has it.
    pub budget: f32,
    /// W, rad/s.
    pub yaw_rate: f32,
    /// e3 in the axes of the desired frame.
    pub up: Vector3<f32>,
    /// U, m/s^2.
    pub greatest: f32,
    /// c_z, c_z' and c_z'' as wanted, m/s^2, m/s^3, m/s^4.
    pub vertical: [f32; 3],
}

/// The limited turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limited {
    /// q, rad/s^2.
    pub acceleration: Vector2<f32>,
    /// The limit of W at the next tick, rad/s: 0.4 alpha over |p|, or an eighth less.
    pub yaw_rate: f32,
    /// The change of u'', axes of the desired frame, m/s^4; `None` if nothing was limited.
    pub change: Option<Vector3<f32>>,
}

impl TurningLimit {
    /// For steps of `period`, s.
    #[must_use]
    pub fn new(parameters: &ExtendedParameters, period: f32) -> Self {
        let p = parameters;
        Self {
            period,
            rate: p.turn_rate,
            reserve: p.turn_reserve,
            cosine: (1.0 / math::hypot(1.0, math::tan(f64::from(p.tilt_max)))) as f32,
            closing: p.turn_reserve / p.turn_rate,
            softness: math::lesser(SOFTNESS, 0.5 / period),
            a_down: p.a_down,
        }
    }

    /// The limited turn for a wanted one.
    #[must_use]
    #[inline(always)] // likewise: see position.rs
    pub fn limited(&self, turn: &Turn, circumstances: &Circumstances) -> Limited {
        let Circumstances { budget, yaw_rate, up, greatest, vertical: [c, c_rate, c_wanted] } = *circumstances;
        let Turn { rate, acceleration: wanted, magnitude, radial_rate, radial_acceleration } = *turn;
        let most = math::greater(budget, self.reserve);
        let mut q = self.kept_in_cone(shortened(wanted, TURNED * most), &rate, &up, most);
        let next = rate + q * self.period;
        if next.norm_squared() > self.rate * self.rate {
            cold_path();
            q = (shortened(next, self.rate) - rate) / self.period;
        }
        let carried = Vector2::new(rate.y, -rate.x) * yaw_rate;
        let whole = q + carried;
        if whole.norm_squared() > most * most {
            cold_path();
            q = shortened(whole, most) - carried;
        }

        // In nearly every tick nothing is shortened.
        let turned = q != wanted;
        let (mut tangential, mut along) = (Vector2::zeros(), 0.0);
        if turned {
            cold_path();
            tangential = (q - wanted) * magnitude;
        }
        let k = self.softness;
        let falling = if turned { c_wanted + tangential.dot(&up.xy()) } else { c_wanted };
        let least_rising = -2.0 * k * c_rate - k * k * (c + self.a_down);
        if falling < least_rising {
            cold_path();
            along = (least_rising - falling) / up.z;
        }
        let swelling = radial_acceleration + magnitude * rate.norm_squared() + along;
        let least_shrinking = -2.0 * k * radial_rate - k * k * (magnitude - greatest);
        if swelling > least_shrinking {
            cold_path();
            along += least_shrinking - swelling;
        }
        let changed = turned || along != 0.0;
        // An upper bound of |p| without a root, at most an eighth too large.
        let (x, y) = (rate.x.abs(), rate.y.abs());
        let speed = if x > y { x + 0.5 * y } else { y + 0.5 * x };
        let yaw_rate = most * (1.0 - TURNED) / math::greater(speed, SLOWEST);
        Limited { acceleration: q, yaw_rate, change: changed.then(|| Vector3::new(tangential.x, tangential.y, along)) }
    }

    /// `q` with so much towards the vertical, at most `most`, that rho stays in its cone.
    fn kept_in_cone(&self, q: Vector2<f32>, rate: &Vector2<f32>, up: &Vector3<f32>, most: f32) -> Vector2<f32> {
        let z = up.xy();
        let rising = (rate + q * self.period).dot(&z);
        let least = -self.closing * (up.z - self.cosine);
        if rising >= least {
            return q;
        }
        cold_path();
        // Beyond the cone's edge by rounding alone: z is as long as the sine of the cone's angle.
        let square = math::greater(z.norm_squared(), 1e-6);
        let inwards = z * ((least - rising) / (square * self.period));
        shortened(q, most) + shortened(inwards, most)
    }
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
