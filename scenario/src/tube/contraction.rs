//! How much at most comes out of a linear system for inputs that may do anything within one.
//!
//! ```text
//! x+ = A x + sum over s of the integral of k_s(t) u(t),  |u| <= 1:
//! sup |c x| = sum over k and s of the integral of |c A^k k_s(t)|
//! ```
//!
//! The sum is taken over the rows c A^k until what follows is small, and what follows and rounding are bounded: with a
//! change of coordinates T, found by a search, the matrix T A T^-1 shortens every vector, |T A T^-1| <= rho < 1. The
//! search may find T as it likes: [`Contraction::new`] takes it only if a Cholesky decomposition of rho^2 - M^T M in
//! double precision, M being T A T^-1 as computed, runs to its end with more to spare than its rounding can have taken
//! (Rump 2006). Then what is left after N steps is at most |c A^N T^-1| / (1 - rho) times a column, and an error of a
//! step fades likewise. A counts as the numbers that it is.

use crate::sampled_loop::disturbed::{DisturbedLoop, Input, Signal, Stretch};
use crate::sampled_loop::spectral_radius;
use nalgebra::{DMatrix, DVector, RowDVector};

/// What one operation in double precision rounds at most, relative.
const ROUNDING_SHARE: f64 = f64::EPSILON;

/// What a decomposition must leave, per row: far more than it rounds.
const TO_SPARE: f64 = 1e-10;

/// Of the sum so far, how little may be left when it ends.
const REST_SHARE: f64 = 1e-3;

/// The longest sum, ticks.
const TICKS_MAX: usize = 200_000;

/// The longest gust that is shown, ticks.
const RESPONSE_TICKS_MAX: usize = 2_000;

/// A system in coordinates in which it shortens everything.
#[derive(Debug, Clone)]
pub struct Contraction {
    /// T and its inverse.
    to: DMatrix<f64>,
    from: DMatrix<f64>,
    /// T A T^-1, as computed.
    matrix: DMatrix<f64>,
    /// Of the true one.
    rho: f64,
    /// By how much the true one differs, in the norm; and a bound on that of the inverse.
    error: f64,
    inverse_norm: f64,
}

impl Contraction {
    /// Of `transition`; none where no such coordinates are found, as for a system that does not settle.
    pub fn new(transition: &DMatrix<f64>) -> Option<Self> {
        let radius = spectral_radius(transition.clone());
        // Between the radius and one, nearer to one as the search for T asks it.
        [0.5, 0.25, 0.1].iter().find_map(|share| {
            let rho = 1.0 - share * (1.0 - radius);
            if radius < 1.0 { Self::with(transition, rho) } else { None }
        })
    }

    /// With this rho, if the coordinates that belong to it bear it out.
    fn with(transition: &DMatrix<f64>, rho: f64) -> Option<Self> {
        let to = coordinates(&(transition / rho))?;
        let from = to.clone().try_inverse()?;
        let matrix = &to * transition * &from;
        Self::checked(transition, to, from, matrix, rho)
    }

    /// The proof: that the computed matrix is near the true one, and shortens.
    fn checked(
        transition: &DMatrix<f64>,
        to: DMatrix<f64>,
        from: DMatrix<f64>,
        matrix: DMatrix<f64>,
        rho: f64,
    ) -> Option<Self> {
        let size = transition.nrows();
        let identity = DMatrix::identity(size, size);
        // |T^-1| <= |X| / (1 - |1 - X T|), X being the computed one.
        let off = difference(&[&from, &to], &[&identity]);
        if off.is_nan() || off >= 0.5 {
            return None;
        }
        let inverse_norm = from.norm() * (1.0 + 1e-9) / (1.0 - off);
        // M T - T A, times T^-1.
        let error = difference(&[&matrix, &to], &[&to, transition]) * inverse_norm;
        let left = identity * (rho * rho - TO_SPARE) - matrix.transpose() * &matrix;
        left.cholesky()?;
        let rho = rho + error;
        (rho < 1.0).then_some(Self { to, from, matrix, rho, error, inverse_norm })
    }

    /// At most what `row` shows of inputs within one, for each of several inputs by its stretches.
    pub fn peaks(&self, row: &RowDVector<f64>, inputs: &[Vec<Stretch>]) -> Option<Vec<f64>> {
        let size = self.matrix.nrows();
        let columns: Vec<Vec<Sighted>> = inputs
            .iter()
            .map(|stretches| stretches.iter().map(|stretch| Sighted::new(&self.to, stretch)).collect())
            .collect();
        let longest = columns.iter().flatten().map(|stretch| stretch.length).fold(0.0, f64::max);
        let operations = 4.0 * size as f64 * ROUNDING_SHARE;
        let step_error = self.error + operations * self.matrix.norm();

        let mut now = row * &self.from;
        // How far the computed row is from the true one.
        let mut off = difference(
            &[&DMatrix::from_rows(&[now.clone()]), &self.to],
            &[&DMatrix::from_rows(std::slice::from_ref(row))],
        ) * self.inverse_norm;
        let mut next = now.clone();
        let mut sums = vec![0.0; inputs.len()];
        for tick in 0..TICKS_MAX {
            let length = now.norm();
            let wrong = off + operations * length;
            for (sum, stretches) in sums.iter_mut().zip(&columns) {
                let seen = stretches.iter().filter(|stretch| tick == 0 || !stretch.once);
                *sum += seen.map(|stretch| stretch.seen(&now) + wrong * stretch.length).sum::<f64>();
            }
            let rest = (length + off) * longest / (1.0 - self.rho);
            // An input that moves nothing has no part in it.
            if rest <= REST_SHARE * sums.iter().copied().filter(|sum| *sum > 0.0).fold(f64::INFINITY, f64::min) {
                for (sum, stretches) in sums.iter_mut().zip(&columns) {
                    let all: f64 = stretches.iter().map(|stretch| stretch.length).sum();
                    *sum += self.rho * (length + off) * all / (1.0 - self.rho);
                }
                return Some(sums.iter().map(|sum| sum * (1.0 + 1e-9)).collect());
            }
            now.mul_to(&self.matrix, &mut next);
            core::mem::swap(&mut now, &mut next);
            off = self.rho * off + step_error * length;
        }
        None
    }
}

/// A stretch in the new coordinates.
struct Sighted {
    column: DVector<f64>,
    swing: Vec<(DVector<f64>, f64)>,
    /// At least as long as all of it.
    length: f64,
    once: bool,
}

impl Sighted {
    fn new(to: &DMatrix<f64>, stretch: &Stretch) -> Self {
        let swing: Vec<_> = stretch.swing.iter().map(|(place, most)| (to.column(*place).into_owned(), *most)).collect();
        let column = to * &stretch.column;
        let length = (to.abs() * stretch.column.abs()).norm()
            + swing.iter().map(|(column, most)| column.norm() * most).sum::<f64>();
        Self { column, swing, length, once: stretch.once }
    }

    /// At most the integral of |c k(t)| over the stretch.
    fn seen(&self, row: &RowDVector<f64>) -> f64 {
        let mean = row.tr_dot(&self.column).abs();
        self.swing.iter().fold(mean, |sum, (column, most)| sum + row.tr_dot(column).abs() * most)
    }
}

/// T with |T A T^-1| < 1 for a matrix whose powers vanish: T^T T = sum over k of (A^T)^k A^k, by doubling.
fn coordinates(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    /// Each doubles the number of terms.
    const DOUBLINGS_MAX: usize = 40;
    let size = matrix.nrows();
    let mut sum = DMatrix::identity(size, size);
    let mut power = matrix.clone();
    for _ in 0..DOUBLINGS_MAX {
        let more = power.transpose() * &sum * &power;
        let small = more.norm() < 1e-12 * sum.norm();
        sum += more;
        if small {
            let symmetric = (&sum + sum.transpose()) * 0.5;
            return Some(symmetric.cholesky()?.l().transpose());
        }
        power = &power * &power;
    }
    None
}

/// A bound on the norm of the difference between two products, rounding included.
fn difference(left: &[&DMatrix<f64>], right: &[&DMatrix<f64>]) -> f64 {
    let product = |factors: &[&DMatrix<f64>]| factors.iter().skip(1).fold(factors[0].clone(), |all, next| all * *next);
    let sizes =
        |factors: &[&DMatrix<f64>]| factors.iter().skip(1).fold(factors[0].abs(), |all, next| all * next.abs()).norm();
    let operations = 4.0 * left[0].ncols().max(right[0].ncols()) as f64 * ROUNDING_SHARE;
    (product(left) - product(right)).norm() * (1.0 + 1e-9) + operations * (sizes(left) + sizes(right))
}

/// For each signal of `system` at most what each input within one makes of it; none where it does not settle.
pub fn norms(system: &DisturbedLoop) -> Option<Vec<[f64; Input::ALL.len()]>> {
    let contraction = Contraction::new(&system.transition)?;
    system
        .signals
        .iter()
        .zip(&system.direct)
        .map(|(row, direct)| {
            // A signal that the axis does not have.
            if row.iter().all(|entry| *entry == 0.0) {
                return Some(*direct);
            }
            let peaks = contraction.peaks(row, &system.inputs)?;
            Some(core::array::from_fn(|input| peaks[input] + direct[input]))
        })
        .collect()
}

/// The sign of the force that moves the position of `system` farthest, a tick each, the oldest first: until less than a
/// hundredth is left.
pub fn responses(system: &DisturbedLoop) -> Vec<f64> {
    let mut row = system.signals[Signal::Position as usize].clone();
    let force = &system.inputs[Input::Force as usize];
    let column = force.iter().fold(DVector::zeros(row.len()), |sum, stretch| sum + &stretch.column);
    let mut seen = Vec::new();
    let mut greatest = 0.0_f64;
    loop {
        let response = row.tr_dot(&column);
        greatest = greatest.max(response.abs());
        seen.push(response.signum());
        row = &row * &system.transition;
        let settled = row.amax() * column.amax() < 1e-2 * greatest / row.len() as f64;
        if settled || seen.len() >= RESPONSE_TICKS_MAX {
            seen.reverse();
            return seen;
        }
    }
}

#[cfg(test)]
mod tests;
