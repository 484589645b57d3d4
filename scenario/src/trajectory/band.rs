//! Least squares whose rows touch six neighbouring unknowns: normal equations in a band, solved by Cholesky's
//! decomposition. Each of the four axes has its own matrix, since its rows have their own weights.

use nalgebra::Vector4;

/// Unknowns that one row touches.
const UNKNOWNS_PER_ROW: usize = 6;

/// Normal equations: the matrices' bands, of row i the entries with columns i - 5 to i, and the right-hand sides.
pub struct Band {
    matrix: Vec<[Vector4<f64>; UNKNOWNS_PER_ROW]>,
    right: Vec<Vector4<f64>>,
}

impl Band {
    /// Of so many unknowns.
    pub fn new(unknowns: usize) -> Self {
        Self { matrix: vec![[Vector4::zeros(); UNKNOWNS_PER_ROW]; unknowns], right: vec![Vector4::zeros(); unknowns] }
    }

    /// Adds the row: `weights` of the unknowns from `first` on, times the axes' `scale`, are to be `target`.
    pub fn add(
        &mut self,
        first: usize,
        weights: &[f64; UNKNOWNS_PER_ROW],
        target: &Vector4<f64>,
        scale: &Vector4<f64>,
    ) {
        let squares = scale.component_mul(scale);
        for (k, weight) in weights.iter().enumerate() {
            self.right[first + k] += target.component_mul(scale) * *weight;
            for (l, other) in weights.iter().enumerate().take(k + 1) {
                self.matrix[first + k][UNKNOWNS_PER_ROW - 1 + l - k] += squares * (weight * other);
            }
        }
    }

    /// The solution. Unknowns that no row tells anything of are zero.
    pub fn solve(mut self) -> Vec<Vector4<f64>> {
        let n = self.right.len();
        for i in 0..n {
            for j in i.saturating_sub(UNKNOWNS_PER_ROW - 1)..=i {
                let mut sum = self.entry(i, j);
                for k in i.saturating_sub(UNKNOWNS_PER_ROW - 1).max(j.saturating_sub(UNKNOWNS_PER_ROW - 1))..j {
                    sum -= self.entry(i, k).component_mul(&self.entry(j, k));
                }
                self.matrix[i][UNKNOWNS_PER_ROW - 1 + j - i] = if i == j {
                    sum.map(|square| if square > 0.0 { square.sqrt() } else { f64::INFINITY })
                } else {
                    sum.component_div(&self.entry(j, j))
                };
            }
        }
        for i in 0..n {
            for k in i.saturating_sub(UNKNOWNS_PER_ROW - 1)..i {
                let known = self.entry(i, k).component_mul(&self.right[k]);
                self.right[i] -= known;
            }
            self.right[i] = self.right[i].component_div(&self.entry(i, i));
        }
        for i in (0..n).rev() {
            for k in i + 1..(i + UNKNOWNS_PER_ROW).min(n) {
                let known = self.entry(k, i).component_mul(&self.right[k]);
                self.right[i] -= known;
            }
            self.right[i] = self.right[i].component_div(&self.entry(i, i));
        }
        self.right
    }

    fn entry(&self, row: usize, column: usize) -> Vector4<f64> {
        self.matrix[row][UNKNOWNS_PER_ROW - 1 + column - row]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rows_say_exactly_is_found() {
        let target = |i: usize| Vector4::new(i as f64, (i * i) as f64, -1.0, (i as f64).sin());
        let mut band = Band::new(20);
        for first in 0..15 {
            for shift in 0..6 {
                let weights: [f64; 6] =
                    std::array::from_fn(|k| 1.0 / (1.0 + (k + shift) as f64) + f64::from(k == shift));
                let sum: Vector4<f64> = weights.iter().enumerate().map(|(k, weight)| target(first + k) * *weight).sum();
                let scale = Vector4::new(1.0, 2.0, 0.5, 3.0);
                band.add(first, &weights, &sum.component_mul(&scale), &scale);
            }
        }
        for (i, found) in band.solve().iter().enumerate() {
            assert!((found - target(i)).norm() < 1e-9, "{i}: {found}");
        }
    }
}
