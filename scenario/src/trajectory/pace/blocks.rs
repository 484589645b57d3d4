//! Symmetric equations in blocks, each of which touches its neighbours only, solved by Cholesky's decomposition.

use nalgebra::{SMatrix, SVector};

/// Unknowns of a block.
pub const BLOCK_SIZE: usize = 21;
pub type Block = SMatrix<f64, BLOCK_SIZE, BLOCK_SIZE>;
pub type Part = SVector<f64, BLOCK_SIZE>;

/// The blocks on the diagonal, of each two neighbours the one below, and the right-hand sides.
#[derive(Debug, Clone)]
pub struct Blocks {
    pub diagonal: Vec<Block>,
    pub below: Vec<Block>,
    pub right: Vec<Part>,
}

impl Blocks {
    /// Of so many blocks.
    pub fn new(blocks: usize) -> Self {
        Self {
            diagonal: vec![Block::zeros(); blocks],
            below: vec![Block::zeros(); blocks.saturating_sub(1)],
            right: vec![Part::zeros(); blocks],
        }
    }

    /// Makes an unknown zero.
    pub fn hold(&mut self, block: usize, unknown: usize) {
        self.diagonal[block].fill_row(unknown, 0.0);
        self.diagonal[block].fill_column(unknown, 0.0);
        self.diagonal[block][(unknown, unknown)] = 1.0;
        self.right[block][unknown] = 0.0;
        if let Some(before) = block.checked_sub(1) {
            self.below[before].fill_row(unknown, 0.0);
        }
        if let Some(below) = self.below.get_mut(block) {
            below.fill_column(unknown, 0.0);
        }
    }

    /// The solution with `added` on the diagonal of each block; none where the equations are not positive.
    pub fn solve(&self, added: impl Fn(usize, &Part) -> Part) -> Option<Vec<Part>> {
        let mut lowers: Vec<Block> = Vec::with_capacity(self.diagonal.len());
        let mut crossed: Vec<Block> = Vec::with_capacity(self.below.len());
        let mut parts: Vec<Part> = Vec::with_capacity(self.diagonal.len());
        for (number, (diagonal, right)) in self.diagonal.iter().zip(&self.right).enumerate() {
            let mut block = diagonal + Block::from_diagonal(&added(number, &diagonal.diagonal()));
            let mut right = *right;
            if let (Some(crossed), Some(before)) = (crossed.last(), parts.last()) {
                block -= crossed * crossed.transpose();
                right -= crossed * before;
            }
            let lower = block.cholesky()?.l();
            parts.push(lower.solve_lower_triangular(&right)?);
            if let Some(below) = self.below.get(number) {
                crossed.push(lower.solve_lower_triangular(&below.transpose())?.transpose());
            }
            lowers.push(lower);
        }
        let mut after: Option<Part> = None;
        for (number, lower) in lowers.iter().enumerate().rev() {
            if let Some(after) = after {
                parts[number] -= crossed[number].tr_mul(&after);
            }
            parts[number] = lower.tr_solve_lower_triangular(&parts[number])?;
            after = Some(parts[number]);
        }
        Some(parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_solves_the_equations() {
        // Diagonally dominant, with entries of no pattern.
        let entry = |i: usize| ((i * 7919 % 104_729) as f64 / 104_729.0) - 0.5;
        let mut blocks = Blocks::new(4);
        for number in 0..4 {
            let any = Block::from_fn(|i, j| entry(441 * number + 21 * i + j + 1));
            blocks.diagonal[number] = any + any.transpose() + Block::identity() * 60.0;
            blocks.right[number] = Part::from_fn(|i, _| entry(1000 + 21 * number + i));
            if let Some(below) = blocks.below.get_mut(number) {
                *below = Block::from_fn(|i, j| entry(5000 + 441 * number + 21 * i + j));
            }
        }
        blocks.hold(2, 5);
        let parts = blocks.solve(|_, diagonal| diagonal * 0.5).unwrap();
        assert_eq!(parts[2][5], 0.0);
        for number in 0..4 {
            let block = blocks.diagonal[number];
            let mut left = block * parts[number] + block.diagonal().component_mul(&parts[number]) * 0.5;
            if number > 0 {
                left += blocks.below[number - 1] * parts[number - 1];
            }
            if number < 3 {
                left += blocks.below[number].transpose() * parts[number + 1];
            }
            assert!((left - blocks.right[number]).amax() < 1e-12, "{number}: {left} {}", blocks.right[number]);
        }
    }

    #[test]
    fn equations_that_are_not_positive_have_no_solution() {
        let mut blocks = Blocks::new(2);
        blocks.diagonal[0] = Block::identity();
        assert!(blocks.solve(|_, _| Part::zeros()).is_none());
    }
}
