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
