//! One inequality of the certificate: what is required, what is available, and the margin between.

use core::fmt;

/// `required < available`, or `<=` where the paper's inequality is not strict.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inequality {
    /// Where it comes from (A1: Assumption 1, T1 and T2: Theorems 1 and 2, R: a rotor) and what it is about.
    pub name: &'static str,
    /// Unit of both sides.
    pub unit: &'static str,
    /// The left side.
    pub required: f64,
    /// The right side.
    pub available: f64,
    strict: bool,
}

impl Inequality {
    /// `required < available`.
    #[must_use]
    pub fn new(name: &'static str, unit: &'static str, required: f64, available: f64) -> Self {
        Self { name, unit, required, available, strict: true }
    }

    /// The same with equality allowed.
    #[must_use]
    pub fn or_equal(self) -> Self {
        Self { strict: false, ..self }
    }

    /// Whether it holds; a NaN on either side does not.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.required < self.available || (!self.strict && self.required == self.available)
    }

    /// The part of what is available that is left over; negative where the inequality fails.
    #[must_use]
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
mod tests {
    use super::*;

    #[test]
    fn a_strict_inequality_fails_at_equality_and_on_nan() {
        let equal = Inequality::new("x", "N", 1.0, 1.0);
        assert!(!equal.holds() && equal.or_equal().holds());
        assert!(!Inequality::new("x", "N", f64::NAN, 1.0).or_equal().holds());
    }

    #[test]
    fn the_tightest_has_the_least_margin_and_one_that_fails_has_less_than_none() {
        let all = [(3.0, 4.0), (9.0, 10.0), (1.0, 2.0)]
            .map(|(required, available)| Inequality::new("x", "N", required, available));
        assert_eq!(tightest(&all), Some(all[1]));
        let failing = Inequality::new("x", "N", 1.0, 0.0);
        assert_eq!(tightest([&failing].into_iter().chain(&all)), Some(failing));
    }

    #[test]
    fn the_margin_is_what_is_left_of_the_available() {
        assert!((Inequality::new("x", "N", 3.0, 4.0).margin() - 0.25).abs() < 1e-15);
        assert!(Inequality::new("x", "N", 5.0, 4.0).margin() < 0.0);
    }
}
