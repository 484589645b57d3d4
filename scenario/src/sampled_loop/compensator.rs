//! A law near the origin as what it is: a linear system that measures and commands.
//!
//! ```text
//! x+ = A x + B y,   w = C x + D y
//! ```
//!
//! y are the integrals of the actuator's command that an axis has (see [`super::lag`]), w the command, x whatever the law
//! remembers. What it remembers of its own commands is closed inside: w = C x + D y is inserted before A and B are formed.
//!
//! A is kept in upper Hessenberg form, to which an orthogonal change of x takes it. (z - A) x = B y is then solved for a
//! frequency by one elimination per column.

use super::lag::INTEGRATORS;
use nalgebra::linalg::Hessenberg;
use nalgebra::{Complex, DMatrix, RowDVector, RowSVector};

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
    pub direct: RowSVector<f64, INTEGRATORS>,
}

impl Compensator {
    /// The system that `tick` steps: it takes x and y, puts the next x in x's place and returns w. It must be linear. `size` is
    /// the number of its states.
    pub fn of(size: usize, tick: impl Fn(&mut [f64], &[f64; INTEGRATORS]) -> f64) -> Self {
        let mut transition = DMatrix::zeros(size, size);
        let mut input = DMatrix::zeros(size, INTEGRATORS);
        let mut output = RowDVector::zeros(size);
        let mut direct = RowSVector::zeros();
        let mut x = vec![0.0; size];
        for i in 0..size {
            x.fill(0.0);
            x[i] = 1.0;
            output[i] = tick(&mut x, &[0.0; INTEGRATORS]);
            transition.column_mut(i).copy_from_slice(&x);
        }
        for m in 0..INTEGRATORS {
            x.fill(0.0);
            direct[m] = tick(&mut x, &core::array::from_fn(|i| f64::from(u8::from(i == m))));
            input.column_mut(m).copy_from_slice(&x);
        }
        Self { transition, input, output, direct }.in_hessenberg_form()
    }

    /// The number of states.
    pub fn size(&self) -> usize {
        self.transition.nrows()
    }

    fn in_hessenberg_form(self) -> Self {
        if self.size() < 3 {
            return self;
        }
        let (turn, transition) = Hessenberg::new(self.transition).unpack();
        Self { transition, input: turn.tr_mul(&self.input), output: self.output * &turn, direct: self.direct }
    }

    /// w for the `measured` y at z.
    pub fn response(&self, z: Complex<f64>, measured: &[Complex<f64>; INTEGRATORS]) -> Complex<f64> {
        let zero = Complex::new(0.0, 0.0);
        let through = |row: &dyn Fn(usize) -> f64| (0..INTEGRATORS).fold(zero, |sum, m| sum + measured[m] * row(m));
        let size = self.size();
        // Rows of (z - A | B y), eliminated from above; below the diagonal only one entry of each column is not zero.
        let width = size + 1;
        let mut rows: Vec<Complex<f64>> = Vec::with_capacity(size * width);
        for i in 0..size {
            rows.extend((0..size).map(|j| Complex::new(-self.transition[(i, j)], 0.0)));
            rows[i * width + i] += z;
            rows.push(through(&|m| self.input[(i, m)]));
        }
        for j in 1..size {
            let (above, below) = rows.split_at_mut(j * width);
            let (above, below) = (&mut above[(j - 1) * width..], &mut below[..width]);
            if below[j - 1].norm_sqr() > above[j - 1].norm_sqr() {
                above.swap_with_slice(below);
            }
            if below[j - 1] != zero {
                let factor = below[j - 1] / above[j - 1];
                for (below, above) in below[j..].iter_mut().zip(&above[j..]) {
                    *below -= factor * above;
                }
            }
        }
        let mut command = through(&|m| self.direct[m]);
        for i in (0..size).rev() {
            let row = &rows[i * width..(i + 1) * width];
            let x = row[size] / row[i];
            command += x * self.output[i];
            for above in 0..i {
                let entry = rows[above * width + i];
                rows[above * width + size] -= entry * x;
            }
        }
        command
    }
}

