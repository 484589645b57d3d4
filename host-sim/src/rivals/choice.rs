//! Which law flies: ours, or a rival with its gains. It can be written and read.

use super::kind::RivalKind;

/// Our law's name beside others.
pub const OUR_LAW: &str = "ours";

/// Which law.
#[derive(Debug, Clone, PartialEq)]
pub enum LawChoice {
    /// The scenario's own.
    Ours,
    /// Another one with its gains, each in the place of its name.
    Rival(RivalKind, Vec<f64>),
}

impl LawChoice {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Ours => OUR_LAW,
            Self::Rival(kind, _) => kind.name(),
        }
    }

    /// The names of a rival's gains with their values; none of ours, which are the scenario's.
    pub fn gains(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let (names, values) = match self {
            Self::Ours => (&[][..], &[][..]),
            Self::Rival(kind, gains) => (kind.gains(), gains.as_slice()),
        };
        names.iter().copied().zip(values.iter().copied())
    }
}
