//! Least squares with parts left out: what numbers a flight shows, and how well.
//!
//! A flight's noise is not white: gusts and drifts last. So uncertainty is the jackknife's: the fit is made again
//! without each of G parts of the flight, and the standard uncertainty is the root of (G - 1)/G times the sum of
//! squares of how far each of these fits is from their mean. Intervals are Student's t of G - 1 degrees of freedom,
//! 95 %.

use nalgebra::{DMatrix, DVector};

/// How many parts a flight is cut into: each must last longer than a gust.
pub const PART_COUNT: usize = 8;
/// Student's t, 97.5 %, of one degree of freedom less.
const STUDENT_T: f64 = 2.365;

/// A number that a flight shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    pub value: f64,
    /// Standard.
    pub uncertainty: f64,
}

impl Shown {
    /// From the whole fit, and those without each part.
    pub fn of_parts(value: f64, without: &[f64]) -> Self {
        let count = without.len() as f64;
        let mean = without.iter().sum::<f64>() / count;
        let squares = without.iter().map(|one| (one - mean).powi(2)).sum::<f64>();
        Self { value, uncertainty: ((count - 1.0) / count * squares).sqrt() }
    }

    /// The numbers between which it is, with 95 %.
    pub fn interval(&self) -> [f64; 2] {
        [self.value - STUDENT_T * self.uncertainty, self.value + STUDENT_T * self.uncertainty]
    }
}

/// The sums of a least-squares problem: rows are added once, and parts taken away.
#[derive(Debug, Clone, PartialEq)]
pub struct Sums {
    squares: DMatrix<f64>,
    products: DVector<f64>,
    outputs: f64,
    pub count: f64,
}

impl Sums {
    pub fn new(unknowns: usize) -> Self {
        Self {
            squares: DMatrix::zeros(unknowns, unknowns),
            products: DVector::zeros(unknowns),
            outputs: 0.0,
            count: 0.0,
        }
    }

    pub fn add(&mut self, row: &DVector<f64>, output: f64) {
        self.squares.ger(1.0, row, row, 1.0);
        self.products.axpy(output, row, 1.0);
        self.outputs += output * output;
        self.count += 1.0;
    }

    /// The sums of all but `others`.
    fn without(&self, others: &Self) -> Self {
        Self {
            squares: &self.squares - &others.squares,
            products: &self.products - &others.products,
            outputs: self.outputs - others.outputs,
            count: self.count - others.count,
        }
    }

    fn plus(&self, others: &Self) -> Self {
        Self {
            squares: &self.squares + &others.squares,
            products: &self.products + &others.products,
            outputs: self.outputs + others.outputs,
            count: self.count + others.count,
        }
    }

    /// The unknowns, and the sum of squared remainders; none where the rows do not show them apart. An unknown of
    /// which there is nothing in the rows is zero.
    pub fn solved(&self) -> Option<(DVector<f64>, f64)> {
        let scale = self.squares.diagonal().map(|square| if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 });
        let scaled = DMatrix::from_fn(scale.len(), scale.len(), |i, j| {
            let number = self.squares[(i, j)] * scale[i] * scale[j];
            if i == j { number.max(1e-12) + 1e-9 } else { number }
        });
        let solution = scaled.cholesky()?.solve(&self.products.component_mul(&scale)).component_mul(&scale);
        let left = self.outputs - self.products.dot(&solution);
        Some((solution, left.max(0.0)))
    }
}

/// The sums of each part of a flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Parts(Vec<Sums>);

impl Parts {
    pub fn new(unknowns: usize) -> Self {
        Self(vec![Sums::new(unknowns); PART_COUNT])
    }

    /// Adds a row to the part of `sample` among `count`.
    pub fn add(&mut self, sample: usize, count: usize, row: &DVector<f64>, output: f64) {
        if let Some(part) = self.0.get_mut(part_of(sample, count)) {
            part.add(row, output);
        }
    }

    /// The sums of the whole flight.
    pub fn whole(&self) -> Option<Sums> {
        let (first, others) = self.0.split_first()?;
        Some(others.iter().fold(first.clone(), |all, part| all.plus(part)))
    }

    /// What `of` makes of the unknowns; none where the flight does not show them apart.
    pub fn shown(&self, of: impl Fn(&DVector<f64>) -> f64) -> Option<Shown> {
        let whole = self.whole()?;
        let without = self.0.iter().filter_map(|part| Some(of(&whole.without(part).solved()?.0)));
        Some(Shown::of_parts(of(&whole.solved()?.0), &without.collect::<Vec<_>>()))
    }
}

/// The part of `sample` among `count`.
pub fn part_of(sample: usize, count: usize) -> usize {
    (PART_COUNT * sample / count.max(1)).min(PART_COUNT - 1)
}
