//! Numbers that know how they change with N others: formulas that are written for any [`Real`] give their slopes along.
//!
//! Where a formula has an edge these numbers round it, or a search would stop there: |x| is
//! sqrt(x^2 + [`EDGE_ROUNDING_SI`]^2), sqrt(x^2 + y^2) likewise; the greater of a and b is half of a + b + d, the lesser
//! half of a + b - d + e, with d^2 = (a - b)^2 + e^2 and e^2 = [`CORNER_ROUNDING_SI`]^2 (a^2 + b^2). None is less than
//! exact. Constants are exact.

use controller_core::math::real::Real;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// In SI units: m/s^2 to m/s^4 and rad/s, for which it is little.
const EDGE_ROUNDING_SI: f64 = 0.3;
const CORNER_ROUNDING_SI: f64 = 0.02;

/// A number and its slopes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sloped<const N: usize> {
    pub value: f64,
    pub slopes: [f64; N],
    /// Depends on none of the others.
    is_constant: bool,
}

impl<const N: usize> Sloped<N> {
    /// The number that others change with, as the one of this place.
    pub fn variable(value: f64, place: usize) -> Self {
        Self { value, slopes: std::array::from_fn(|i| if i == place { 1.0 } else { 0.0 }), is_constant: false }
    }

    /// A function of two numbers with this value and these slopes.
    fn linear(a: &Self, b: &Self, value: f64, slope: impl Fn(usize) -> f64) -> Self {
        Self { value, slopes: std::array::from_fn(slope), is_constant: a.is_constant && b.is_constant }
    }

    /// A function of the number with this value and derivative.
    fn chained(self, value: f64, derivative: f64) -> Self {
        Self { value, slopes: self.slopes.map(|slope| slope * derivative), ..self }
    }

    /// sqrt(`square` + `edge`^2).
    fn rounded(square: Self, edge: f64) -> Self {
        let root = (square.value + edge * edge).sqrt();
        square.chained(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }

    /// The difference of two numbers with its edge rounded, and what it is where they are equal.
    fn corner(self, other: Self) -> (Self, Self) {
        let difference = self - other;
        let squares = (self * self + other * other) * (CORNER_ROUNDING_SI * CORNER_ROUNDING_SI);
        (Self::rounded(difference * difference + squares, 0.0), Self::rounded(squares, 0.0))
    }

    /// What rounds the edge of a function of the number.
    fn edge(&self) -> f64 {
        if self.is_constant { 0.0 } else { EDGE_ROUNDING_SI }
    }
}

impl<const N: usize> From<f64> for Sloped<N> {
    fn from(value: f64) -> Self {
        Self { value, slopes: [0.0; N], is_constant: true }
    }
}

impl<const N: usize> From<f32> for Sloped<N> {
    fn from(value: f32) -> Self {
        Self::from(f64::from(value))
    }
}

impl<const N: usize> Neg for Sloped<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.chained(-self.value, -1.0)
    }
}

impl<const N: usize> Add for Sloped<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::linear(&self, &other, self.value + other.value, |i| self.slopes[i] + other.slopes[i])
    }
}

impl<const N: usize> Sub for Sloped<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::linear(&self, &other, self.value - other.value, |i| self.slopes[i] - other.slopes[i])
    }
}

impl<const N: usize> Mul for Sloped<N> {
    type Output = Self;
    // The product rule.
    #[expect(clippy::suspicious_arithmetic_impl)]
    fn mul(self, other: Self) -> Self {
        Self::linear(&self, &other, self.value * other.value, |i| {
            self.slopes[i] * other.value + self.value * other.slopes[i]
        })
    }
}

impl<const N: usize> Div for Sloped<N> {
    type Output = Self;
    // The quotient rule.
    #[expect(clippy::suspicious_arithmetic_impl)]
    fn div(self, other: Self) -> Self {
        let ratio = self.value / other.value;
        Self::linear(&self, &other, ratio, |i| (self.slopes[i] - ratio * other.slopes[i]) / other.value)
    }
}

/// The same with a plain number.
macro_rules! with_plain {
    ($($operation:ident, $function:ident;)+) => {$(
        impl<const N: usize> $operation<f64> for Sloped<N> {
            type Output = Self;
            fn $function(self, other: f64) -> Self {
                self.$function(Self::from(other))
            }
        }
    )+};
}

with_plain! {
    Add, add;
    Sub, sub;
    Mul, mul;
    Div, div;
}

/// The same in place.
macro_rules! in_place {
    ($($operation:ident, $function:ident, $plain:ident;)+) => {$(
        impl<const N: usize> $operation for Sloped<N> {
            fn $function(&mut self, other: Self) {
                *self = self.$plain(other);
            }
        }
    )+};
}

in_place! {
    AddAssign, add_assign, add;
    SubAssign, sub_assign, sub;
    MulAssign, mul_assign, mul;
}

impl<const N: usize> Real for Sloped<N> {
    fn lower(self) -> f64 {
        self.value
    }

    fn upper(self) -> f64 {
        self.value
    }

    fn greater(self, other: Self) -> Self {
        if self.is_constant && other.is_constant {
            return Self::from(self.value.max(other.value));
        }
        let (difference, _) = self.corner(other);
        (self + other + difference) * 0.5
    }

    fn lesser(self, other: Self) -> Self {
        if self.is_constant && other.is_constant {
            return Self::from(self.value.min(other.value));
        }
        let (difference, corner) = self.corner(other);
        (self + other - difference + corner) * 0.5
    }

    fn abs(self) -> Self {
        Self::rounded(self * self, self.edge())
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chained(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }

    fn sqrt_of_rounded(self) -> Self {
        if self.value > 0.0 { self.sqrt() } else { Self::from(0.0) }
    }

    fn hypot(self, other: Self) -> Self {
        Self::rounded(self * self + other * other, (self + other).edge())
    }

    fn exp(self) -> Self {
        let power = self.value.exp();
        self.chained(power, power)
    }

    fn ln_1p(self) -> Self {
        self.chained(self.value.ln_1p(), 1.0 / (1.0 + self.value))
    }

    /// From x^3 = p x + q follows (3 x^2 - p) x' = p' x + q'.
    fn max_cubic_root(p: Self, q: Self) -> Self {
        let root = f64::max_cubic_root(p.value, q.value);
        let steepness = 3.0 * root * root - p.value;
        Self::linear(&p, &q, root, |i| (p.slopes[i] * root + q.slopes[i]) / steepness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation, with x and y.
    fn formula(x: Sloped<2>, y: Sloped<2>) -> Sloped<2> {
        let mut z = (x * y - x / y + 2.0).abs() + x.hypot(y) * 3.0 - 0.5;
        z += x.greater(y * 2.0).sqrt() / 4.0;
        z -= x.lesser(y).ln_1p().exp();
        z *= -y + 7.0;
        z + Sloped::max_cubic_root(x * 9.0, y).sqrt_of_rounded()
    }

    #[test]
    fn slopes_are_those_of_the_formula() {
        for (x, y) in [(0.7, 1.3), (2.0, 0.4), (1.1, 1.1)] {
            let value = |x: f64, y: f64| formula(Sloped::variable(x, 0), Sloped::variable(y, 1)).value;
            let slopes = formula(Sloped::variable(x, 0), Sloped::variable(y, 1)).slopes;
            let step = 1e-6;
            let along_x = (value(x + step, y) - value(x - step, y)) / (2.0 * step);
            let along_y = (value(x, y + step) - value(x, y - step)) / (2.0 * step);
            assert!(
                (slopes[0] - along_x).abs() < 1e-6 && (slopes[1] - along_y).abs() < 1e-6,
                "{slopes:?} {along_x} {along_y}"
            );
        }
    }

    #[test]
    fn edges_are_rounded_upwards_and_constants_are_exact() {
        let [zero, one] = [0.0, 1.0].map(|value| Sloped::<1>::variable(value, 0));
        assert_eq!((zero.abs().value, zero.abs().slopes), (EDGE_ROUNDING_SI, [0.0]));
        assert!(one.abs().value > 1.0 && one.greater(one).value > 1.0 && one.lesser(one).value >= 1.0);
        let [two, three] = [2.0, 3.0].map(Sloped::<1>::from);
        assert_eq!([(-two).abs(), two.greater(three), two.lesser(three)].map(|x| x.value), [2.0, 3.0, 2.0]);
        // Nothing in a sum with infinity is lost.
        assert_eq!(Sloped::<1>::from(f64::INFINITY).lesser(two).value, 2.0);
    }
}
