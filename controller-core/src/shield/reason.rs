//! Why the law flies in place of a policy.

use core::fmt;

/// Why the law took over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reason {
    /// No demand for too long.
    Silent,
    /// A demand that is not finite, out of range or not a rotation.
    Demand,
    /// The vehicle could soon no longer stop inside a room.
    Stop,
    /// Too fast.
    Speed,
    /// The thrust axis is too far from where it is wanted.
    Tilt,
    /// It turns too fast.
    Rate,
    /// An estimate was held or at its level for too long.
    Estimate,
}

impl Reason {
    /// All of them, in the order in which they are looked for.
    pub const ALL: [Self; 7] =
        [Self::Demand, Self::Silent, Self::Tilt, Self::Rate, Self::Speed, Self::Stop, Self::Estimate];

    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Silent => "silent",
            Self::Demand => "demand",
            Self::Stop => "stop",
            Self::Speed => "speed",
            Self::Tilt => "tilt",
            Self::Rate => "rate",
            Self::Estimate => "estimate",
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Silent => "the policy is silent",
            Self::Demand => "the policy's demand is unusable",
            Self::Stop => "too near the walls to stop",
            Self::Speed => "too fast",
            Self::Tilt => "thrust axis too far off",
            Self::Rate => "turns too fast",
            Self::Estimate => "estimates in doubt",
        })
    }
}
