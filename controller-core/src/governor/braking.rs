//! How fast one may approach a point and still stop on it: the sampled double integrator, solved exactly.
//!
//! Per tick u+ = u + alpha with |alpha| <= 1 and x+ = x + u+. From speed w the shortest stop, this tick's step
//! included, covers w + (w-1) + (w-2) + ... With n = floor(w), f = w - n that is n(n+1)/2 + (n+1) f, increasing in w,
//! so the greatest speed from which a distance d is not overrun is its inverse:
//!
//! w(d) = n + f,  n = floor((sqrt(1+8d)-1)/2),  f = (d - n(n+1)/2)/(n+1).
//!
//! Having taken the step w(d), the distance left is d - w(d) and w(d - w(d)) = max(w(d) - 1, 0): following the law
//! costs exactly one unit of deceleration a tick and ends on the point, at rest, in a finite number of ticks.

use crate::math;

/// w(d): both in units of the deceleration available per tick squared (and tick).
pub(super) fn approach_speed(distance: f32) -> f32 {
    let whole = (0.5 * (math::sqrt(1.0 + 8.0 * distance) - 1.0)) as i32 as f32;
    whole + (distance - 0.5 * whole * (whole + 1.0)) / (whole + 1.0)
}

/// The share of the acceleration that planned braking uses. What is left absorbs rounding, so that the stop planned is
/// always one that can be made, and turns the velocity of a vehicle that does not head for the target yet.
pub(super) const BRAKING_SHARE: f32 = 0.95;

#[cfg(test)]
mod tests;
