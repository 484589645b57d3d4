//! How hard a search tries.

/// How hard to search.
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
    /// What `host-sim tune` spends on our law and `host-sim compare` on each rival, unless they are asked for another
    /// effort.
    fn default() -> Self {
        Self { generations: 60, population: 24, seed: 1 }
    }
}
