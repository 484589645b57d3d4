//! The numbers that a certificate is worked out in.
//!
//! Its formulas are written once, for any [`Real`]: in double precision, rounded to nearest, which decides, on a board
//! too; and in [enclosures](super::enclosure::Enclosure), rounded outwards, which show that rounding decided nothing.
//!
//! Both come from single precision without an error. Comparisons are between ends only: what holds for [`Real::upper`]
//! of one number and [`Real::lower`] of another holds for the numbers.

use crate::math;
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// What a certificate's formulas need of a number. No value, or one that is undefined, is a NaN: it passes through
/// everything here, and nothing holds of it.
pub trait Real:
    Copy
    + Debug
    + PartialEq
    + From<f32>
    + From<f64>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Add<f64, Output = Self>
    + Sub<Output = Self>
    + Sub<f64, Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<Output = Self>
    + Div<f64, Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + 'static
{
    /// The number is at least this.
    fn lower(self) -> f64;

    /// The number is at most this.
    fn upper(self) -> f64;

    /// The greater of two numbers.
    fn greater(self, other: Self) -> Self;

    /// The lesser of two numbers.
    fn lesser(self, other: Self) -> Self;

    /// |x|.
    fn abs(self) -> Self;

    /// The square root, undefined below zero.
    fn sqrt(self) -> Self;

    /// sqrt(x^2 + y^2).
    fn hypot(self, other: Self) -> Self;

    /// e^x.
    fn exp(self) -> Self;

    /// ln(1 + x), for x > -1.
    fn ln_1p(self) -> Self;

    /// The greatest root of x^3 - p x - q, whose roots are all real: p >= 0 and 27 q^2 <= 4 p^3.
    fn max_cubic_root(p: Self, q: Self) -> Self;

    /// The square root of a number that only rounding can have taken below zero.
    fn sqrt_of_rounded(self) -> Self;
}

/// Newton steps for a cubic's greatest root. Each halves the error at least (quarters it, away from a double root), so
/// that these reach the rounding of double precision.
const NEWTON_STEPS: usize = 52;

impl Real for f64 {
    fn lower(self) -> f64 {
        self
    }

    fn upper(self) -> f64 {
        self
    }

    fn greater(self, other: Self) -> Self {
        math::max_f64(self, other)
    }

    fn lesser(self, other: Self) -> Self {
        math::min_f64(self, other)
    }

    fn abs(self) -> Self {
        f64::abs(self)
    }

    fn sqrt(self) -> Self {
        math::sqrt_f64(self)
    }

    fn sqrt_of_rounded(self) -> Self {
        math::sqrt_of_rounded(self)
    }

    fn hypot(self, other: Self) -> Self {
        math::hypot(self, other)
    }

    fn exp(self) -> Self {
        math::exp(self)
    }

    fn ln_1p(self) -> Self {
        math::ln_1p(self)
    }

    /// No root exceeds 2 sqrt(p/3): from there Newton's method falls towards the greatest without passing it.
    fn max_cubic_root(p: Self, q: Self) -> Self {
        let mut root = 2.0 * math::sqrt_f64(p / 3.0);
        for _ in 0..NEWTON_STEPS {
            let value = root * (root * root - p) - q;
            let slope = 3.0 * root * root - p;
            if value <= 0.0 || slope <= 0.0 {
                break;
            }
            root -= value / slope;
        }
        root
    }
}
