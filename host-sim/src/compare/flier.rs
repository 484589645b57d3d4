//! Who flies in a comparison: ours, as boards fly it, or a rival with its gains.

use crate::flight::Flight;
use crate::rivals::gains::Set;
use crate::rivals::kind::Kind;
use controller_core::certificate::certified::Certified;
use scenario::Scenario;

/// One law of a comparison.
#[derive(Debug, Clone)]
pub enum Flier {
    /// The scenario's own law, certified.
    Ours(Box<Certified>),
    /// Another one, and its gains.
    Rival(Kind, Vec<f64>),
}

/// Ours first, then every rival of `set`.
#[must_use]
pub fn all(certified: Certified, set: &Set) -> Vec<Flier> {
    let rivals = set.rivals.iter().map(|(kind, gains, _)| Flier::Rival(*kind, gains.clone()));
    std::iter::once(Flier::Ours(Box::new(certified))).chain(rivals).collect()
}

impl Flier {
    /// Its name in tables.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Ours(_) => "ours",
            Self::Rival(kind, _) => kind.name(),
        }
    }

    /// A flight in the circumstances of `scenario`; what it knows of the vehicle is what `knowledge` says. None if the law is undefined.
    #[must_use]
    pub fn flight(&self, knowledge: &Scenario, scenario: &Scenario) -> Option<Flight> {
        match self {
            Self::Ours(certified) => Flight::certified(scenario, certified).ok(),
            Self::Rival(kind, gains) => kind.flight(knowledge, scenario, gains),
        }
    }
}
