//! The only door to elementary functions: the same bits on every machine.
//!
//! Operators stay separate multiplications and additions (no fused operations), so a desktop, a Cortex-M4F and a
//! Cortex-M7 agree to the last bit. Stated errors are the worst ones found by this module's tests over the ranges
//! given.
//!
//! | function | range | worst absolute error |
//! |---|---|---|
//! | [`sqrt`] | x >= 0 | correctly rounded |
//! | [`sin_cos_turns`] | all phases | 1.2e-7 |
//! | [`tanh_of_scaled`], [`tanh_of_all_scaled`] | all numbers | 1.97e-7 |
//!
//! Double precision is for configuration time: `libm`'s functions under the names that std gives them.

#![allow(unsafe_code)] // one instruction, in `sqrtf`

pub mod enclosure;
pub mod real;

use core::hint::cold_path;
pub use libm::{atan, exp, expm1 as exp_m1, floor, hypot, log1p as ln_1p, round, sqrt as sqrt_f64, tan};
use nalgebra::Vector3;

/// Square root, correctly rounded: the hardware instruction on bare-metal ARM with hardware floating point, which the
/// target's ABI shows (stable compilers hide its feature `vfp2`).
#[inline(always)]
pub fn sqrt(x: f32) -> f32 {
    #[cfg(all(target_arch = "arm", target_abi = "eabihf", target_os = "none"))]
    return sqrtf(x);
    #[cfg(not(all(target_arch = "arm", target_abi = "eabihf", target_os = "none")))]
    libm::sqrtf(x)
}

/// `x` cut to ± `level`; a NaN stays one. One comparison where nothing is cut, which is nearly always.
pub fn saturate(x: f32, level: f32) -> f32 {
    if x.abs() > level {
        cold_path();
        level.copysign(x)
    } else {
        x
    }
}

/// `x` cut to an interval; a NaN stays one. Two comparisons, where `f32::min` and `f32::max` are calls on a Cortex-M.
pub fn clamp(x: f32, min: f32, max: f32) -> f32 {
    let x = if x > max { max } else { x };
    if x < min { min } else { x }
}

/// The greater of two numbers; the first where they cannot be compared.
pub fn max(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

/// The lesser of two numbers; the first where they cannot be compared.
pub fn min(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}

/// The greater of two numbers; NaN if either is NaN. For proofs, where a NaN must not pass for the lesser
/// one.
#[cfg_attr(target_os = "none", inline(never))] // a board's image has it in a hundred places: 2 KB
pub fn max_f64(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// The lesser of two numbers; NaN if either is NaN.
#[cfg_attr(target_os = "none", inline(never))]
pub fn min_f64(a: f64, b: f64) -> f64 {
    if a <= b || a.is_nan() { a } else { b }
}

/// The square root of a number that only rounding can have taken below zero.
pub fn sqrt_of_rounded(x: f64) -> f64 {
    sqrt_f64(max_f64(x, 0.0))
}

/// An integer in single precision, to 1.2e-7 of it; exact below 2^24. In its two halves: the processor converts those
/// in one instruction each, where the conversion of 64 bits is a call.
pub fn i64_to_f32(x: i64) -> f32 {
    let low = x as i32;
    let high = (x.wrapping_sub(i64::from(low)) >> 32) as i32;
    high as f32 * 4_294_967_296.0 + low as f32
}

/// The whole part of a number, exactly; beyond 2^61 it saturates, and a NaN gives zero. In two halves,
/// as [`i64_to_f32`].
pub fn f32_to_i64(x: f32) -> i64 {
    const HALF_RANGE: f32 = 2_147_483_648.0;
    let high = (x * (1.0 / HALF_RANGE)) as i32;
    let low = (x - high as f32 * HALF_RANGE) as i32;
    (i64::from(high) << 31) + i64::from(low)
}

/// C's `sqrtf` for machines that have no C library, in one instruction.
///
/// Under this name the code generator knows it, and where a call is optimised it puts the instruction itself in the
/// call's place. Inline assembly could not do that: it takes its operands through core registers, four moves for every
/// root.
#[cfg(all(target_arch = "arm", target_abi = "eabihf", target_os = "none"))]
#[unsafe(no_mangle)]
#[inline(never)]
extern "C" fn sqrtf(x: f32) -> f32 {
    let mut bits = x.to_bits();
    // SAFETY: one register-to-register instruction; it touches no memory and only the register it names.
    unsafe {
        core::arch::asm!(
            "vmov s0, {b}", "vsqrt.f32 s0, s0", "vmov {b}, s0",
            b = inout(reg) bits, out("s0") _, options(pure, nomem, nostack)
        );
    }
    f32::from_bits(bits)
}

/// Sine and cosine of `phase` / 2^64 turns.
///
/// The phase is an integer, so its reduction to an octant is exact however long the clock has run.
pub fn sin_cos_turns(phase: u64) -> (f32, f32) {
    /// Radians per unit of a phase whose full turn is 2^32.
    const RAD_PER_UNIT: f32 = core::f32::consts::TAU / 4_294_967_296.0;
    // The nearest quarter turn, and what is left of it in [-1/8, 1/8) turn as a signed 32-bit phase.
    let rounded = phase.wrapping_add(1 << 61);
    let quadrant = rounded >> 62;
    let rest = (((rounded << 2) >> 2) as i64).wrapping_sub(1 << 61) >> 32;
    let x = rest as f32 * RAD_PER_UNIT;
    let x2 = x * x;
    let sin = x + x * x2 * (-0.166_666_55 + x2 * (0.008_332_161 - x2 * 0.000_195_152_96));
    let cos = 1.0 - 0.5 * x2 + x2 * x2 * (0.041_666_646 + x2 * (-0.001_388_731_6 + x2 * 0.000_024_433_157));
    match quadrant {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// What the argument of tanh is multiplied by to make that of [`tanh_of_scaled`].
pub const TANH_SCALE: f64 = 0.021_492_645_453_276_255;

/// tanh x for z = x [`TANH_SCALE`], odd, never beyond ±1.
///
/// tanh x = 2 t / (1 + t^2) with t = tanh(x / 2) = A / Q, so that one division serves: 2 A Q / (A^2 + Q^2). A and Q are
/// polynomials, of degrees 5 and 6, whose quotient leaves that formula 8e-9 from tanh on the whole range (a minimax
/// fit); the rest of the stated error is rounding. A common factor of A and Q cancels, and the scale of z is the one at
/// which both leading coefficients are one: two multiplications less. In exact arithmetic 2 A Q <= A^2 + Q^2, and the
/// rounded quotient was found at most one for every single-precision number, so nothing is clipped.
pub fn tanh_of_scaled(z: f32) -> f32 {
    let z2 = z * z;
    if z2 <= LINEAR_SQUARE_MAX {
        linear(z)
    } else if z2 <= UNSATURATED_SQUARE_MAX {
        unsaturated(z)
    } else if z.is_nan() {
        z
    } else {
        1.0_f32.copysign(z)
    }
}

/// [`tanh_of_scaled`] of three numbers, to the same bits. Mostly none of them is large: one comparison instead of
/// three.
#[inline(always)]
pub fn tanh_of_all_scaled(z: &Vector3<f32>) -> Vector3<f32> {
    let z2 = z.norm_squared();
    if z2 <= LINEAR_SQUARE_MAX {
        z.map(linear)
    } else if z2 <= UNSATURATED_SQUARE_MAX {
        z.map(unsaturated)
    } else {
        z.map(tanh_of_scaled)
    }
}

/// Up to this z^2 the leading coefficients are all that is left of A and Q after rounding, and Q^2 of the denominator.
const LINEAR_SQUARE_MAX: f32 = 5e-11;

/// Where z^2 is beyond this, |x| > 8.69, tanh is within a rounding of one: so it is one, before a quotient rounds
/// beyond.
const UNSATURATED_SQUARE_MAX: f32 = 0.034_9;

#[inline(always)]
fn unsaturated(z: f32) -> f32 {
    let z2 = z * z;
    let z4 = z2 * z2;
    let a = z * (z4 + 0.120_494_44 * z2 + A_0);
    let q = z2 * z4 + 0.454_219_88 * z4 + 0.019_679_535 * z2 + Q_0;
    2.0 * a * q / (a * a + q * q)
}

/// [`unsaturated`] to the bit, up to [`LINEAR_SQUARE_MAX`]: without the powers of z that fall below the normal numbers,
/// which cost a desktop a quarter of its time where a vehicle has settled.
#[inline(always)]
fn linear(z: f32) -> f32 {
    2.0 * (z * A_0) * Q_0 / (Q_0 * Q_0)
}

const A_0: f32 = 1.869_867_2e-3;
const Q_0: f32 = 8.037_678e-5;

#[cfg(test)]
mod tests;
