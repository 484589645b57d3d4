//! Numbers of several vehicles side by side, in a vector register of the processor: one number of each.
//!
//! Every operation is IEEE 754's, on each number by itself: a vehicle has the same bits whatever flies beside it and
//! however many a register holds. No multiplication is fused with an addition.

use pulp::Simd;
use std::ops::{Add, Div, Index, Mul, Neg, Sub};

/// One double-precision number of each of as many vehicles as the registers of `S` hold.
#[derive(Debug, Clone, Copy)]
pub struct Lanes<S: Simd> {
    unit: S,
    numbers: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// The numbers as they are in memory.
    #[inline(always)]
    pub fn new(unit: S, numbers: S::f64s) -> Self {
        Self { unit, numbers }
    }

    /// The same number for every vehicle.
    #[inline(always)]
    pub fn all(unit: S, number: f64) -> Self {
        Self { unit, numbers: unit.splat_f64s(number) }
    }

    /// The numbers for memory.
    #[inline(always)]
    pub fn numbers(self) -> S::f64s {
        self.numbers
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { numbers: self.unit.add_f64s(self.numbers, other.numbers), ..self }
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { numbers: self.unit.sub_f64s(self.numbers, other.numbers), ..self }
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { numbers: self.unit.mul_f64s(self.numbers, other.numbers), ..self }
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { numbers: self.unit.neg_f64s(self.numbers), ..self }
    }
}

impl<S: Simd> Mul<f64> for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * Self::all(self.unit, factor)
    }
}

impl<S: Simd> Div<f64> for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn div(self, divisor: f64) -> Self {
        Self { numbers: self.unit.div_f64s(self.numbers, self.unit.splat_f64s(divisor)), ..self }
    }
}

/// A vector of each vehicle.
#[derive(Debug, Clone, Copy)]
pub struct Vectors<S: Simd, const N: usize>(pub [Lanes<S>; N]);

impl<S: Simd, const N: usize> Vectors<S, N> {
    /// Component by component.
    #[inline(always)]
    pub fn zip(mut self, other: Self, combined: impl Fn(Lanes<S>, Lanes<S>) -> Lanes<S>) -> Self {
        for (component, other) in self.0.iter_mut().zip(other.0) {
            *component = combined(*component, other);
        }
        self
    }

    /// The products of the components.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        self.zip(other, Lanes::mul)
    }
}

impl<S: Simd, const N: usize> Index<usize> for Vectors<S, N> {
    type Output = Lanes<S>;

    #[inline(always)]
    fn index(&self, component: usize) -> &Lanes<S> {
        &self.0[component]
    }
}

impl<S: Simd, const N: usize> Add for Vectors<S, N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, Lanes::add)
    }
}

impl<S: Simd, const N: usize> Sub for Vectors<S, N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, Lanes::sub)
    }
}

impl<S: Simd, const N: usize> Mul<Lanes<S>> for Vectors<S, N> {
    type Output = Self;

    #[inline(always)]
    fn mul(mut self, factor: Lanes<S>) -> Self {
        for component in &mut self.0 {
            *component = *component * factor;
        }
        self
    }
}

impl<S: Simd, const N: usize> Mul<f64> for Vectors<S, N> {
    type Output = Self;

    #[inline(always)]
    fn mul(mut self, factor: f64) -> Self {
        for component in &mut self.0 {
            *component = *component * factor;
        }
        self
    }
}
