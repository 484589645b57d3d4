//! Where each piece of a path is looked at: denser towards its ends.

use super::piece::PiecePlace;

/// Where a piece is looked at: of each pair all rows at the first, and the corridor at both.
pub struct Places(Vec<(PiecePlace, PiecePlace)>);

impl Places {
    /// So many pairs.
    pub fn new(count: usize) -> Self {
        let place = |place: f64| PiecePlace::new(0.5 - 0.5 * (std::f64::consts::PI * place / count as f64).cos());
        Self((0..count).map(|number| (place(number as f64), place(number as f64 + 0.5))).collect())
    }

    /// How many pairs there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The pairs.
    pub fn each(&self) -> impl Iterator<Item = (&PiecePlace, &PiecePlace)> {
        self.0.iter().map(|(place, between)| (place, between))
    }
}
