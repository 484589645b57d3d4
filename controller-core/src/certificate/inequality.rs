//! One inequality of the certificate: what is required, what is available, and the margin between.

use crate::math::real::Real;
use core::fmt;

/// `required < available`, or `<=` where the paper's inequality is not strict.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inequality<R = f64> {
    /// Where it comes from (A1: Assumption 1, T1 and T2: Theorems 1 and 2, R: a rotor) and what it is about.
    pub name: &'static str,
    /// Unit of both sides.
    pub unit: &'static str,
    /// The left side.
    pub required: R,
    /// The right side.
    pub available: R,
    strict: bool,
}

impl<R: Real> Inequality<R> {
    /// `required < available`.
    pub fn new(name: &'static str, unit: &'static str, required: R, available: R) -> Self {
        Self { name, unit, required, available, strict: true }
    }

    /// The same with equality allowed.
    #[must_use]
    pub fn or_equal(self) -> Self {
        Self { strict: false, ..self }
    }

    /// Whether it holds, whatever numbers the sides enclose; with a NaN on either side it does not.
    pub fn holds(&self) -> bool {
        let (required, available) = (self.required.upper(), self.available.lower());
        required < available || (!self.strict && required == available)
    }
}

impl Inequality {
    /// The margin as a share of what is available; negative where the inequality fails.
    pub fn margin(&self) -> f64 {
        if self.available > 0.0 { 1.0 - self.required / self.available } else { f64::NEG_INFINITY }
    }
}

impl fmt::Display for Inequality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, unit, required, available, .. } = self;
        write!(f, "{name}: {required:.4} of {available:.4} {unit}")
    }
}

/// The inequality with the least margin of a list that is not empty.
pub(crate) fn tightest<'a>(inequalities: impl IntoIterator<Item = &'a Inequality>) -> Option<Inequality> {
    inequalities.into_iter().copied().reduce(|a, b| if b.margin() < a.margin() { b } else { a })
}

#[cfg(test)]
mod tests;
