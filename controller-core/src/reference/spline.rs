//! The smoothest way through given points: which velocity, acceleration, jerk and snap to pass each one with.
//!
//! Minimises the integral of |p^(5)|^2 over all segments, p(t) of degree 9 in each, with p given at every point and
//! velocity to snap zero at both ends. (The minimiser is continuous to the eighth derivative; continuity to snap holds
//! by construction, because both neighbours of a point share what is found here.)
//!
//! On a segment of length T, scaled to s in [0, 1], q = d^5 p / ds^5 has degree 4, so its squared integral is the sum
//! of its squared coefficients along the orthonormal Legendre polynomials sqrt(2 m + 1) P_m, m = 0..4. Integrating by
//! parts five times leaves only the segment's ends:
//!
//! integral of q P_m = sum over k = 0..4 of (-1)^k [ P_m^(k) p^(4-k) ] from s = 0 to 1,
//! P_m^(k)(1) = (m + k)! / (k! (m - k)!), P_m^(k)(0) = (-1)^(m+k) P_m^(k)(1),
//!
//! five linear equations "= 0" per segment in the four derivatives at either end, weighted by T^(-9/2): a least-squares
//! problem. Its normal equations would be block-tridiagonal with 4x4 blocks; triangularising the equations themselves,
//! one segment after the other, needs the same storage and only the square root of the condition number. Measured with
//! a segment a thousand times shorter than its neighbours: snap within 1e-7 of its largest value.
//!
//! All four axes (x, y, z, heading) share the equations and differ in their right-hand sides.

use super::knot::{Derivatives, Knot, REST, runs};
use crate::math;
use nalgebra::Vector4;

/// P_m^(k)(1) of the shifted Legendre polynomials: one row per k, in it m = 0..4.
const LEGENDRE_DERIVATIVES: [[f64; 5]; 5] = [
    [1.0, 1.0, 1.0, 1.0, 1.0],
    [0.0, 2.0, 6.0, 12.0, 20.0],
    [0.0, 0.0, 12.0, 60.0, 180.0],
    [0.0, 0.0, 0.0, 120.0, 840.0],
    [0.0, 0.0, 0.0, 0.0, 1680.0],
];

/// Four equations carried over from earlier segments, then a segment's five.
const EQUATIONS_CARRIED: usize = 4;
const EQUATIONS_MAX: usize = EQUATIONS_CARRIED + 5;
/// One unknown's coefficients, or one axis' right-hand sides.
type Column = [f64; EQUATIONS_MAX];
/// Unknowns at the segment's start (velocity to snap), unknowns at its end, right-hand sides of the four axes.
const MATRIX_COLUMNS: usize = 12;
const UNKNOWN_COUNT: usize = 8;
/// What is left of a segment's equations for its start once its end is known: the first rows of its columns.
#[derive(Debug, Clone, Copy)]
pub struct Stage([Vector4<f64>; MATRIX_COLUMNS]);

impl Stage {
    /// Nothing yet.
    pub const EMPTY: Self = Self([Vector4::new(0.0, 0.0, 0.0, 0.0); MATRIX_COLUMNS]);
}

/// Finds how to pass each of the `knots`, whose times increase, with room for as many `stages`. Knots without a stage
/// are passed at rest.
pub fn solve(knots: &mut [Knot], stages: &mut [Stage]) {
    runs(knots, |run| solve_run(run, stages));
}

/// One run from rest to rest.
fn solve_run(knots: &mut [Knot], stages: &mut [Stage]) {
    let segments = knots.len().saturating_sub(1);
    let mut carried = [[0.0; EQUATIONS_CARRIED]; MATRIX_COLUMNS - EQUATIONS_CARRIED];
    // A knot's stage is written while the segment that begins there is looked at.
    for (i, (pair, stage)) in knots.windows(2).zip(stages.iter_mut()).enumerate() {
        let [knot, next] = pair else { return };
        let mut columns = equations(knot, next, i > 0, i + 1 < segments);
        // The carried equations are about this segment's start, and their right-hand sides.
        let (start_and_end, right) = columns.split_at_mut(UNKNOWN_COUNT);
        let about = start_and_end.iter_mut().take(EQUATIONS_CARRIED).chain(right);
        for (column, old) in about.zip(&carried) {
            column.iter_mut().zip(old).for_each(|(to, from)| *to = *from);
        }
        triangularise(&mut columns);
        for (new, column) in carried.iter_mut().zip(columns.iter().skip(EQUATIONS_CARRIED)) {
            new.iter_mut().zip(column.iter().skip(EQUATIONS_CARRIED)).for_each(|(to, from)| *to = *from);
        }
        *stage = Stage(columns.map(|[a, b, c, d, ..]| Vector4::new(a, b, c, d)));
    }
    let mut after = REST;
    for (knot, stage) in knots.iter_mut().zip(stages.iter()).take(segments).skip(1).rev() {
        after = substitute(stage, &after);
        knot.derivatives = after;
    }
}

/// A segment's five equations, in the rows after the carried ones. Ends that are not free are at rest.
fn equations(knot: &Knot, next: &Knot, free_start: bool, free_end: bool) -> [Column; MATRIX_COLUMNS] {
    /// (2 m + 1)^(1/2).
    const LEGENDRE_NORMS: [f64; 5] = [1.0, 1.732_050_807_568_877_2, 2.236_067_977_499_79, 2.645_751_311_064_590_7, 3.0];
    let (t, differences) = (knot.duration_to(next), knot.difference_to(next));
    let weight = 1.0 / (t * t * t * t * math::sqrt_f64(t));
    let mut columns = [[0.0; EQUATIONS_MAX]; MATRIX_COLUMNS];
    let (start, rest) = columns.split_at_mut(4);
    let (end, right) = rest.split_at_mut(4);
    // k = 0 belongs to snap, k = 3 to velocity: the columns run backwards.
    let mut scale = weight * t * t * t * t;
    let mut sign = 1.0;
    for ((start, end), legendre) in start.iter_mut().zip(end).rev().zip(&LEGENDRE_DERIVATIVES) {
        let mut parity = -1.0;
        let rows = start.iter_mut().zip(end).skip(EQUATIONS_CARRIED);
        for ((start, end), (value, norm)) in rows.zip(legendre.iter().zip(&LEGENDRE_NORMS)) {
            let coefficient = scale * norm * value;
            *start = if free_start { parity * coefficient } else { 0.0 };
            *end = if free_end { sign * coefficient } else { 0.0 };
            parity = -parity;
        }
        scale /= t;
        sign = -sign;
    }
    // k = 4 belongs to the positions, which are known.
    for (column, difference) in right.iter_mut().zip(&differences) {
        if let Some(last) = column.last_mut() {
            *last = -3.0 * 1680.0 * weight * difference;
        }
    }
    columns
}

/// Householder reflections that leave the unknowns' columns upper triangular.
///
/// The row with the largest entry goes on top first: without it, the heavy equations of a short segment would drown the
/// lighter ones (Powell and Reid).
fn triangularise(columns: &mut [Column; MATRIX_COLUMNS]) {
    let mut remaining = columns.as_mut_slice();
    for step in 0..UNKNOWN_COUNT {
        let Some((pivot, others)) = remaining.split_first_mut() else { return };
        let below = pivot.iter().enumerate().skip(step);
        let (top, largest) =
            below.fold(
                (step, 0.0_f64),
                |(top, largest), (row, entry)| {
                    if entry.abs() > largest { (row, entry.abs()) } else { (top, largest) }
                },
            );
        if largest > 0.0 {
            exchange(pivot, step, top);
            others.iter_mut().for_each(|column| exchange(column, step, top));
            let length = math::sqrt_f64(pivot.iter().skip(step).map(|entry| entry * entry).sum());
            let mut normal = *pivot;
            normal.iter_mut().take(step).for_each(|entry| *entry = 0.0);
            if let Some(entry) = normal.get_mut(step) {
                *entry += length.copysign(*entry);
            }
            let square = dot(&normal, &normal);
            for column in core::iter::once(&mut *pivot).chain(others.iter_mut()) {
                let share = 2.0 * dot(&normal, column) / square;
                column.iter_mut().zip(&normal).for_each(|(entry, n)| *entry -= share * n);
            }
        }
        remaining = others;
    }
}

fn dot(a: &Column, b: &Column) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Exchanges two entries; nothing to do if they are the same one.
fn exchange(column: &mut Column, i: usize, j: usize) {
    if let Ok([a, b]) = column.get_disjoint_mut([i, j]) {
        core::mem::swap(a, b);
    }
}

/// The derivatives at a segment's start from those at its end.
fn substitute(stage: &Stage, end: &Derivatives) -> Derivatives {
    let mut start = REST;
    let (coefficients, right) = stage.0.split_at(UNKNOWN_COUNT);
    let (own, others) = coefficients.split_at(EQUATIONS_CARRIED);
    for (axis, right) in right.iter().enumerate() {
        let mut rest = *right;
        for (column, derivative) in others.iter().zip(end) {
            rest -= column * derivative.get(axis).copied().unwrap_or(0.0);
        }
        for (row, (column, derivative)) in own.iter().zip(&mut start).enumerate().rev() {
            if let (Some(value), Some(pivot), Some(unknown)) =
                (rest.get(row), column.get(row), derivative.get_mut(axis))
            {
                *unknown = value / pivot;
                rest -= column * *unknown;
            }
        }
    }
    start
}

#[cfg(test)]
mod tests;
