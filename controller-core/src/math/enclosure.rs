//! Interval arithmetic: two numbers in double precision with a real number between them, whatever was computed.
//!
//! Every operation is done to nearest at the ends that matter and moved outwards by one double-precision number, which
//! is farther than rounding to nearest can have gone. So no rounding mode is set, and the widths grow by two parts in
//! 10^16 an operation. Multiplication and division are IEEE 754's, the square root is libm's, which rounds correctly.
//! Exponential and logarithm trust no library: a series with its remainder, and a logarithm that the series confirms.

use super::real::Real;
use crate::math;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A real number between two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Enclosure {
    lower: f64,
    upper: f64,
}

impl Enclosure {
    /// Nothing is known.
    const UNDEFINED: Self = Self { lower: f64::NAN, upper: f64::NAN };

    /// Both ends, moved outwards by one number.
    fn outwards(lower: f64, upper: f64) -> Self {
        Self { lower: lower.next_down(), upper: upper.next_up() }
    }

    /// From the least to the greatest of some, moved outwards by one number.
    fn around(ends: [f64; 4]) -> Self {
        let [first, rest @ ..] = ends;
        Self::outwards(rest.into_iter().fold(first, math::min_f64), rest.into_iter().fold(first, math::max_f64))
    }

    /// Itself, if it has both ends.
    fn whole(self) -> Self {
        if self.lower.is_nan() || self.upper.is_nan() { Self::UNDEFINED } else { self }
    }

    /// Its square, which is never below zero.
    fn square(self) -> Self {
        let magnitude = self.abs();
        let Self { lower, upper } = magnitude * magnitude;
        Self { lower: math::max_f64(lower, 0.0), upper }
    }

    /// x (x^2 - p) - q at a point.
    fn cubic(x: f64, p: Self, q: Self) -> Self {
        let x = Self::from(x);
        x * (x.square() - p) - q
    }
}

impl From<f64> for Enclosure {
    /// Exactly this number; infinity too is a number here, and what is computed with it may be undefined.
    fn from(x: f64) -> Self {
        Self { lower: x, upper: x }
    }
}

impl From<f32> for Enclosure {
    fn from(x: f32) -> Self {
        Self::from(f64::from(x))
    }
}

impl Neg for Enclosure {
    type Output = Self;

    fn neg(self) -> Self {
        Self { lower: -self.upper, upper: -self.lower }
    }
}

impl Add for Enclosure {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::outwards(self.lower + other.lower, self.upper + other.upper)
    }
}

impl Sub for Enclosure {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Enclosure {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let [a, b, c, d] = [self.lower, self.upper, other.lower, other.upper];
        Self::around([a * c, a * d, b * c, b * d])
    }
}

impl Div for Enclosure {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let [a, b, c, d] = [self.lower, self.upper, other.lower, other.upper];
        if c > 0.0 || d < 0.0 { Self::around([a / c, a / d, b / c, b / d]) } else { Self::UNDEFINED }
    }
}

/// Each operation with a number of double precision, and in place.
macro_rules! operations {
    ($($operation:ident $name:ident, $assigning:ident $assign:ident);+) => {$(
        impl $operation<f64> for Enclosure {
            type Output = Self;

            fn $name(self, other: f64) -> Self {
                self.$name(Self::from(other))
            }
        }

        impl $assigning for Enclosure {
            fn $assign(&mut self, other: Self) {
                *self = self.$name(other);
            }
        }
    )+};
}

operations!(Add add, AddAssign add_assign; Sub sub, SubAssign sub_assign; Mul mul, MulAssign mul_assign);

impl Div<f64> for Enclosure {
    type Output = Self;

    fn div(self, other: f64) -> Self {
        self / Self::from(other)
    }
}

/// Terms of the exponential's series, and the greatest |x| they are for: the remainder is below |x|^11.
const SERIES_TERMS: u32 = 11;
const SERIES_ARGUMENT_MAX: f64 = 1.0 / 64.0;

/// How often an argument of the exponential may be halved to be small.
const HALVINGS_MAX: u32 = 1_024;

/// How far on either side of a root or a logarithm its confirmation is tried, from near to far.
const CONFIRMATION_WIDTHS: [f64; 5] = [1e-14, 1e-12, 1e-9, 1e-6, 1e-3];

/// e^x: the series about zero, after x was halved until it is small; then squared as often.
fn exponential(x: f64) -> Enclosure {
    let (mut small, mut halvings) = (x, 0);
    while small.abs() > SERIES_ARGUMENT_MAX && halvings < HALVINGS_MAX {
        // Exact: a power of two. Arguments that could fall below the normal numbers are small already.
        small *= 0.5;
        halvings += 1;
    }
    if small.abs() <= SERIES_ARGUMENT_MAX {
        let point = Enclosure::from(small);
        let one = Enclosure::from(1.0);
        let series = (1..SERIES_TERMS).rev().fold(one, |sum, term| one + point * sum / f64::from(term));
        // What follows is below |x|^11 / 11! (1 + |x| + …), and |x|^11 is below |x| / 64^10.
        let rest = small.abs() * 1e-18;
        let sum = series + Enclosure { lower: -rest, upper: rest };
        (0..halvings).fold(sum, |power, _| power.square())
    } else {
        Enclosure::UNDEFINED
    }
}

/// ln(1 + x): what the library says, widened until the exponential confirms both ends.
fn logarithm(x: f64) -> Enclosure {
    let near = math::ln_1p(x);
    let argument = Enclosure::from(x) + 1.0;
    let confirmed = |width: &f64| {
        let away = (near.abs() + 1.0) * width;
        let (lower, upper) = (near - away, near + away);
        let inside = exponential(lower).upper <= argument.lower && argument.upper <= exponential(upper).lower;
        inside.then_some(Enclosure { lower, upper })
    };
    CONFIRMATION_WIDTHS.iter().find_map(confirmed).unwrap_or(Enclosure::UNDEFINED)
}

impl Real for Enclosure {
    fn lower(self) -> f64 {
        self.lower
    }

    fn upper(self) -> f64 {
        self.upper
    }

    fn greater(self, other: Self) -> Self {
        Self { lower: math::max_f64(self.lower, other.lower), upper: math::max_f64(self.upper, other.upper) }
    }

    fn lesser(self, other: Self) -> Self {
        Self { lower: math::min_f64(self.lower, other.lower), upper: math::min_f64(self.upper, other.upper) }
    }

    fn abs(self) -> Self {
        if self.lower >= 0.0 {
            self
        } else if self.upper <= 0.0 {
            -self
        } else {
            Self { lower: math::max_f64(self.lower, 0.0), upper: math::max_f64(-self.lower, self.upper) }
        }
    }

    fn sqrt(self) -> Self {
        let Self { lower, upper } = Self::outwards(math::sqrt_f64(self.lower), math::sqrt_f64(self.upper));
        Self { lower: math::max_f64(lower, 0.0), upper }.whole()
    }

    fn sqrt_of_rounded(self) -> Self {
        self.greater(Self::from(0.0)).sqrt()
    }

    fn hypot(self, other: Self) -> Self {
        (self.square() + other.square()).sqrt_of_rounded()
    }

    fn exp(self) -> Self {
        Self { lower: exponential(self.lower).lower, upper: exponential(self.upper).upper }.whole()
    }

    fn ln_1p(self) -> Self {
        Self { lower: logarithm(self.lower).lower, upper: logarithm(self.upper).upper }.whole()
    }

    /// Beyond sqrt(p/3), where it turns, the cubic rises: where it is positive there, the greatest root is below, and
    /// where it is negative, above.
    fn max_cubic_root(p: Self, q: Self) -> Self {
        let middle = |x: Self| 0.5 * (x.lower + x.upper);
        let near = f64::max_cubic_root(middle(p), middle(q));
        let turn = (p / 3.0).sqrt_of_rounded();
        let above = |width: &f64| {
            let x = near * (1.0 + width);
            (x >= turn.upper && Self::cubic(x, p, q).lower >= 0.0).then_some(x)
        };
        let below = |width: &f64| {
            let x = near * (1.0 - width);
            (Self::cubic(x, p, q).upper <= 0.0).then_some(x)
        };
        Self {
            lower: CONFIRMATION_WIDTHS.iter().find_map(below).unwrap_or(turn.lower),
            upper: CONFIRMATION_WIDTHS.iter().find_map(above).unwrap_or((turn * 2.0).upper),
        }
    }
}

#[cfg(test)]
mod tests;
