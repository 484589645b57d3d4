//! Tolerances, cut into cells that cover them.

/// By what shares rotor lag and moments of inertia may be off, either way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Of the rotors' lag.
    pub lag: f64,
    /// Of the moments of inertia, as they are in what a torque turns.
    pub inertia: f64,
}

impl Tolerances {
    /// What `certify --recovery` proves.
    pub const USUAL: Self = Self { lag: 0.3, inertia: 0.1 };

    /// The least and the greatest factor on the lag, and on what a command makes: the inverse of that on the inertia.
    pub fn ranges(&self) -> [[f64; 2]; 2] {
        let Self { lag, inertia } = *self;
        [[1.0 - lag, 1.0 + lag], [1.0 / (1.0 + inertia), 1.0 / (1.0 - inertia)]]
    }
}

/// The cells of a tolerance: their middles as factors, and by what share the factor differs from a cell's middle at
/// most.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    pub middles: Vec<f64>,
    pub share: f64,
}

impl Cells {
    /// So many for all factors of a range, each `share` wide either way.
    pub fn new([low, high]: [f64; 2], count: usize) -> Self {
        // Neighbours meet: middle (1 + share) = next (1 - share).
        let ratio = (high / low).powf(1.0 / count as f64);
        let share = (ratio - 1.0) / (ratio + 1.0);
        let middles = (0..count).map(|cell| low * ratio.powi(cell as i32) / (1.0 - share)).collect();
        Self { middles, share: share * (1.0 + 1e-9) }
    }

    /// Whether every factor of a range is in a cell.
    pub fn cover(&self, [low, high]: [f64; 2]) -> bool {
        let mut reached = low;
        for middle in &self.middles {
            if middle * (1.0 - self.share) > reached {
                return false;
            }
            reached = reached.max(middle * (1.0 + self.share));
        }
        reached >= high
    }
}
