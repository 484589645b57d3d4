//! The effort of a search.

/// The effort of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Generations.
    pub generations: u32,
    /// Members of the population, at least 4.
    pub population: usize,
    /// Seed of the search.
    pub seed: u64,
}

impl Default for Effort {
    /// The default of `host-sim tune` for our law and of `host-sim compare` for each rival.
    fn default() -> Self {
        Self { generations: 60, population: 24, seed: 1 }
    }
}
