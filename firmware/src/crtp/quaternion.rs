//! Unit quaternions in 32 bits.
//!
//! ```text
//! largest component's place (2 bits: x y z w) | the other three in that order, each: sign (1 bit) | sqrt(2) |q_i| of 511
//! ```
//!
//! The largest component is positive, because q and -q are one rotation, and follows from the others.

use controller_core::math;
use core::f32::consts::SQRT_2;
use nalgebra::Quaternion;

/// The greatest magnitude of one of the other three, as it is written.
const MAGNITUDE_MAX: u32 = 511;

/// The quaternion in these bits, scalar last as they have it; of unit length but for rounding.
pub fn unpacked(mut bits: u32) -> Quaternion<f32> {
    let largest = (bits >> 30) as usize;
    let mut components = [0.0; 4];
    let mut squares = 0.0;
    for (_, component) in components.iter_mut().enumerate().rev().filter(|(place, _)| *place != largest) {
        let magnitude = (bits & MAGNITUDE_MAX) as f32 / (MAGNITUDE_MAX as f32 * SQRT_2);
        *component = if bits >> 9 & 1 == 1 { -magnitude } else { magnitude };
        squares += magnitude * magnitude;
        bits >>= 10;
    }
    if let Some(component) = components.get_mut(largest) {
        *component = math::sqrt(math::max(0.0, 1.0 - squares));
    }
    let [x, y, z, w] = components;
    Quaternion::new(w, x, y, z)
}

/// The bits of a unit quaternion.
pub fn packed(q: &Quaternion<f32>) -> u32 {
    let components = [q.i, q.j, q.k, q.w];
    let mut largest = (0, 0.0_f32);
    for (place, component) in components.into_iter().enumerate() {
        if component.abs() > largest.1.abs() {
            largest = (place, component);
        }
    }
    components.into_iter().enumerate().filter(|(place, _)| *place != largest.0).fold(
        largest.0 as u32,
        |bits, (_, component)| {
            let is_negative = (component < 0.0) != (largest.1 < 0.0);
            let magnitude = (component.abs() * SQRT_2 * MAGNITUDE_MAX as f32 + 0.5) as u32;
            bits << 10 | u32::from(is_negative) << 9 | magnitude.min(MAGNITUDE_MAX)
        },
    )
}

#[cfg(test)]
mod tests;
