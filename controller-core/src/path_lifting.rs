//! The hybrid path lifting from rotations to modified Rodrigues parameters, the paper's Appendix A.
//!
//! | paper | here | equation |
//! |---|---|---|
//! | Q(R~) | {q, -q} of the error quaternion | Section II |
//! | Phi(q_hat, R~): the lift nearest to the memory | `nearest`, its sign | Appendix A |
//! | q_hat := Phi when dist(q_hat, Q(R~)) >= alpha | first jump | D_q, G_l |
//! | m* := -m* when \|phi(m* Phi)\| >= 1 + delta | second jump | D_m, G_l |
//! | theta~ = phi(m* Phi) | [`Lifted::mrp`] | output of H_l |
//!
//! The memory follows the error along its path, so that the lift never flips at a half turn; m* chooses between the
//! parameters and their shadow with hysteresis delta, so that noise cannot make it chatter. Where both jumps are due
//! the paper allows either order; the memory goes first, then the sign.
//!
//! |phi(q)| = sqrt((1 - q_0) / (1 + q_0)), so |phi(q)| >= 1 + delta is q_0 <= (1 - (1 + delta)^2) / (1 + (1 + delta)^2): a
//! comparison, and no division comes near the singularity of phi.
//!
//! A fresh lift takes q_0 >= 0 and m* = +1; at q_0 = 0 exactly, the lift whose first non-zero vector component is
//! positive.

use crate::math;
use crate::math::real::Real;
use crate::mrp;
use crate::state::length_squared;
use core::hint::cold_path;
use nalgebra::{Quaternion, Vector3};

/// The mechanism's memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lift {
    /// q_hat, a unit quaternion near the error's path.
    pub memory: Quaternion<f32>,
    /// m*: +1 or -1.
    pub sign: f32,
}

/// The lifted attitude error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lifted {
    /// m* Phi(q_hat, R~), a unit quaternion with q_0 above [`switching_scalar`].
    pub quaternion: Quaternion<f32>,
    /// +1 or -1: the error given is N times this along the lift.
    pub factor: f32,
    /// theta~ = phi of it, |theta~| <= 1 + delta.
    pub mrp: Vector3<f32>,
    /// The memory after this instant's jumps.
    pub lift: Lift,
}

/// qbar: |phi(q)| = 1 + `delta` where the scalar part of q is its negative.
pub fn switching_magnitude<R: Real>(delta: f32) -> R {
    let radius = R::from(delta) + 1.0;
    let square = radius * radius;
    (square - 1.0) / (square + 1.0)
}

/// The scalar part at which |phi(q)| = 1 + `delta`, to the nearest number in single precision.
pub fn switching_scalar(delta: f32) -> f32 {
    -switching_magnitude::<f64>(delta) as f32
}

/// Lifts the attitude error `error`, continuing from `lift` or starting afresh.
///
/// `error` is a quaternion along R~, of either sign and any length N: both sides of each comparison are multiplied by
/// N. A memory that does not jump is at least 1 - alpha along one lift, so that one comparison says both that nothing
/// jumps and which lift is the nearest. `switching_scalar` is [`switching_scalar`] of delta; `alpha` is the memory's
/// distance, 1 - q_hat . p.
#[inline(always)]
pub fn lift(previous: Option<&Lift>, error: &Quaternion<f32>, switching_scalar: f32, alpha: f32) -> Lifted {
    let length = math::sqrt(length_squared(error));
    let Lift { mut memory, mut sign } = match previous {
        Some(lift) => *lift,
        None => Lift { memory: *error * (canonical_sign(error) / length), sign: 1.0 },
    };
    let agreement = memory.w * error.w + memory.i * error.i + memory.j * error.j + memory.k * error.k;
    let near = (1.0 - alpha) * length;
    let mut factor = sign; // m* times the nearest lift's sign
    let mut follows = false;
    if agreement <= near {
        if agreement < 0.0 || agreement == 0.0 && canonical_sign(error) < 0.0 {
            factor = -sign;
        }
        follows = agreement >= -near;
    }
    if factor * error.w <= switching_scalar * length {
        cold_path();
        sign = -sign;
        factor = -factor;
    }
    let quaternion = *error * (factor / length);
    if follows {
        cold_path();
        memory = quaternion * sign;
    }
    let mrp = mrp::from_multiple(error, factor, length);
    Lifted { quaternion, factor, mrp, lift: Lift { memory, sign } }
}

/// The sign of the one of ±q with q_0 > 0, or at q_0 = 0 with its first non-zero vector component positive.
#[cold]
fn canonical_sign(q: &Quaternion<f32>) -> f32 {
    let leading = [q.w, q.i, q.j, q.k].into_iter().find(|component| *component != 0.0).unwrap_or(0.0);
    if leading < 0.0 { -1.0 } else { 1.0 }
}

#[cfg(test)]
mod tests;
