//! A law near the origin as what it is: a linear system that measures and commands.
//!
//! ```text
//! x+ = A x + B y,   w = C x + D y
//! ```
//!
//! y are the integrals of the actuator's command that an axis has (see [`super::lag`]), w the command, x whatever the
//! law remembers. What it remembers of its own commands is closed inside: w = C x + D y is inserted before A and B are
//! formed.
//!
//! For responses A is kept in upper Hessenberg form as well, to which an orthogonal change of x takes it: z - A is then
//! solved by one elimination per column, for every frequency that is looked at.

use super::lag::INTEGRATORS_MAX;
use nalgebra::linalg::Hessenberg;
use nalgebra::{Complex, DMatrix, RowDVector, RowSVector};

/// w per y_m at some z; entry m - 1.
pub(super) type Response = [Complex<f64>; INTEGRATORS_MAX];

/// Of the law for one axis.
#[derive(Debug, Clone)]
pub(super) struct Compensator {
    /// A.
    pub transition: DMatrix<f64>,
    /// B, a column for each y_m.
    pub input: DMatrix<f64>,
    /// C.
    pub output: RowDVector<f64>,
    /// D.
    pub direct: RowSVector<f64, INTEGRATORS_MAX>,
    reduced: Reduced,
}

/// A in upper Hessenberg form, with the B and C that belong to it. The turn rounds relative to A's largest entries, so
/// the closed loop is not made of it.
#[derive(Debug, Clone)]
struct Reduced {
    transition: DMatrix<f64>,
    input: DMatrix<f64>,
    output: RowDVector<f64>,
}

impl Reduced {
    fn reduce(transition: &DMatrix<f64>, input: &DMatrix<f64>, output: &RowDVector<f64>) -> Self {
        if transition.nrows() < 3 {
            return Self { transition: transition.clone(), input: input.clone(), output: output.clone() };
        }
        let (turn, transition) = Hessenberg::new(transition.clone()).unpack();
        Self { transition, input: turn.tr_mul(input), output: output * &turn }
    }
}

impl Compensator {
    /// The system that `tick` steps: it takes x and y, puts the next x in x's place and returns w. It must be linear.
    /// `size` is the number of its states.
    pub fn from_tick(size: usize, tick: impl Fn(&mut [f64], &[f64; INTEGRATORS_MAX]) -> f64) -> Self {
        let mut transition = DMatrix::zeros(size, size);
        let mut input = DMatrix::zeros(size, INTEGRATORS_MAX);
        let mut output = RowDVector::zeros(size);
        let mut direct = RowSVector::zeros();
        let mut x = vec![0.0; size];
        for i in 0..size {
            x.fill(0.0);
            x[i] = 1.0;
            output[i] = tick(&mut x, &[0.0; INTEGRATORS_MAX]);
            transition.column_mut(i).copy_from_slice(&x);
        }
        for m in 0..INTEGRATORS_MAX {
            x.fill(0.0);
            direct[m] = tick(&mut x, &core::array::from_fn(|i| f64::from(u8::from(i == m))));
            input.column_mut(m).copy_from_slice(&x);
        }
        let reduced = Reduced::reduce(&transition, &input, &output);
        Self { transition, input, output, direct, reduced }
    }

    /// The number of states.
    pub fn size(&self) -> usize {
        self.transition.nrows()
    }

    /// w per y_m at z: C (z - A)^-1 B + D.
    pub fn response(&self, z: Complex<f64>) -> Response {
        let Reduced { transition, input, output } = &self.reduced;
        let size = self.size();
        let complex = |value: f64| Complex::new(value, 0.0);
        // r (z - A) = C: combining columns from the right makes z - A triangular, r is then found from the left.
        let mut columns: Vec<Complex<f64>> = transition.iter().map(|entry| complex(-entry)).collect();
        for i in 0..size {
            columns[i * size + i] += z;
        }
        let mut row: Vec<Complex<f64>> = output.iter().copied().map(complex).collect();
        for j in (1..size).rev() {
            let (left, right) = columns.split_at_mut(j * size);
            let (left, right) = (&mut left[(j - 1) * size..], &mut right[..size]);
            if left[j].norm_sqr() > right[j].norm_sqr() {
                left.swap_with_slice(right);
                row.swap(j - 1, j);
            }
            let factor = left[j] / right[j];
            for (left, right) in left[..j].iter_mut().zip(&right[..j]) {
                *left -= factor * right;
            }
            row[j - 1] = row[j - 1] - factor * row[j];
        }
        for i in 0..size {
            let column = &columns[i * size..];
            let known: Complex<f64> = row[..i].iter().zip(column).map(|(r, entry)| r * entry).sum();
            row[i] = (row[i] - known) / column[i];
        }
        core::array::from_fn(|m| {
            row.iter().zip(&input.column(m)).fold(complex(self.direct[m]), |sum, (r, entry)| sum + r * entry)
        })
    }
}

#[cfg(test)]
mod tests;
