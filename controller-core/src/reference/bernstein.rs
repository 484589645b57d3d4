//! Curves in Bernstein form: evaluated inside their convex hull, and bounded by it.
//!
//! p(s) = sum over i of B_i(s) p_i with B_i(s) = C(n, i) (1 - s)^(n-i) s^i on s in [0, 1]. The weights B_i are positive
//! and add up to one, so p(s) lies in the convex hull of its control points p_i, and a convex function of p(s) is
//! nowhere above its largest value at a control point. Splitting the curve in two brings the control points closer to
//! it, four times closer each time: [`Supremum`] splits where it pays until the bound is tight.

use crate::math;
use core::ops::{Add, Mul};

/// Weights of the highest degree used, 9; those of a lower degree n fill the first n + 1.
pub(super) type Weights = [f32; 10];

/// The one weight of degree zero.
pub(super) const DEGREE_ZERO: Weights = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];

/// How far a curve summed up in single precision may leave its hull, relative to the largest control point.
///
/// With u = 2^-24: `rest` and `done` carry 3 u each (two conversions, one division), a step of [`raise`] adds 2 u, so
/// weights of degree n carry 5 n u, and the sum adds (n + 1) u: at most 55 u = 3.3e-6 for n = 9. A bound on
/// (psi''^2 + psi'^4)^(1/2) sees psi' twice (2 * 49 u, degree 8) and psi'' once (43 u, degree 7), 8.4e-6 in all.
const EVALUATION_ROUNDING: f64 = 1e-5;

/// Raises the weights' degree by one: B_i of degree n + 1 is (1 - s) B_i + s B_(i-1) of degree n.
pub(super) fn raise(weights: &mut Weights, rest: f32, done: f32) {
    let mut lower = 0.0;
    for weight in weights.iter_mut() {
        let old = *weight;
        *weight = rest * old + done * lower;
        lower = old;
    }
}

/// The point with these weights.
pub(super) fn combine<V: Copy + Default + Add<Output = V> + Mul<f32, Output = V>>(
    weights: &Weights,
    points: &[V],
) -> V {
    points.iter().zip(weights).fold(V::default(), |sum, (point, weight)| sum + *point * *weight)
}

/// Control points of the curve's two halves.
fn split<V: Copy + Add<Output = V> + Mul<f64, Output = V>, const N: usize>(points: &[V; N]) -> ([V; N], [V; N]) {
    let mut left = *points;
    let mut right = *points;
    // De Casteljau: each round replaces neighbours by their midpoints. The first of each round builds the left half;
    // the last of each round stays where it is and builds the right half.
    for (first, length) in left.iter_mut().zip((1..=N).rev()) {
        let mut next = None;
        for point in right.iter_mut().take(length).rev() {
            let old = *point;
            if let Some(next) = next {
                *point = (old + next) * 0.5;
            }
            next = Some(old);
        }
        if let Some(next) = next {
            *first = next;
        }
    }
    (left, right)
}

/// The square of a bound in the making: the largest value a convex function, the `square`, takes along some curves.
pub(super) struct Supremum<F> {
    square: F,
    attained: f64,
    bound: f64,
    hull: f64,
}

impl<F> Supremum<F> {
    /// Greatest number of times a curve is halved.
    const HALVINGS_MAX: u32 = 10;
    /// How close, relative, the bound on the square comes before splitting stops.
    const BOUND_TOLERANCE: f64 = 1e-6;

    /// Of no curve yet: zero.
    pub(super) fn new(square: F) -> Self {
        Self { square, attained: 0.0, bound: 0.0, hull: 0.0 }
    }

    /// Takes in a curve with finite control points.
    pub(super) fn include<V, const N: usize>(&mut self, points: &[V; N])
    where
        V: Copy + Add<Output = V> + Mul<f64, Output = V>,
        F: Fn(&V) -> f64,
    {
        self.hull = self.hull.max(self.largest(points));
        self.refine(points, Self::HALVINGS_MAX);
    }

    fn largest<V>(&self, points: &[V]) -> f64
    where
        F: Fn(&V) -> f64,
    {
        points.iter().map(&self.square).fold(0.0, f64::max)
    }

    fn refine<V, const N: usize>(&mut self, points: &[V; N], depth: u32)
    where
        V: Copy + Add<Output = V> + Mul<f64, Output = V>,
        F: Fn(&V) -> f64,
    {
        let above = self.largest(points);
        // The curve begins and ends on its control points.
        for end in points.first().into_iter().chain(points.last()) {
            self.attained = self.attained.max((self.square)(end));
        }
        if depth == 0 || above <= self.attained * (1.0 + Self::BOUND_TOLERANCE) {
            self.bound = self.bound.max(above);
        } else {
            let (left, right) = split(points);
            self.refine(&left, depth - 1);
            self.refine(&right, depth - 1);
        }
    }

    /// The bound in exact arithmetic.
    pub(super) fn bound(&self) -> f64 {
        math::sqrt_f64(self.bound)
    }

    /// The bound on what [`combine`] computes, to be rounded outwards to single precision by the caller.
    pub(super) fn bound_when_evaluated(&self) -> f64 {
        self.bound() + EVALUATION_ROUNDING * math::sqrt_f64(self.hull)
    }
}

#[cfg(test)]
mod tests;
