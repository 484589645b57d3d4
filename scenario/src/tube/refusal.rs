//! Why there is no radius.

use super::limits::Reached;
use crate::sampled_loop::Axis;
use std::fmt;

/// Why there is no radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoTube {
    /// The law is the paper's.
    OtherLaw,
    /// The cells leave something of the tolerances out.
    LeftOut,
    /// It was not to go on.
    Stopped,
    /// A loop does not settle for a lag and a moment of inertia within the tolerances.
    Unsettled {
        /// Which.
        axis: Axis,
        /// Times the file's lag.
        lag_factor: f64,
        /// Times the file's torque over moment of inertia.
        gain: f64,
    },
    /// What differs from the loops makes more of itself.
    Grows {
        /// The gust's.
        axis: Axis,
    },
    /// A limit of the law is reached.
    Reached {
        /// The gust's.
        axis: Axis,
        /// Which.
        limit: Reached,
    },
    /// The fallback could take over.
    Fallback {
        /// The gust's.
        axis: Axis,
    },
}

impl fmt::Display for NoTube {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherLaw => write!(f, "there is no such proof for the paper's law; fly law = \"extended\""),
            Self::LeftOut => write!(f, "the cells of the tolerances leave something out"),
            Self::Stopped => write!(f, "stopped before its end"),
            Self::Unsettled { axis, lag_factor, gain } => write!(
                f,
                "the loop {} is not shown to settle with {lag_factor:.2} times the rotors' lag and {gain:.2} times its \
                 gain",
                axis.name()
            ),
            Self::Grows { axis } => write!(
                f,
                "{}: what saturations and large angles add grows without end; a smaller --gust may have a radius",
                axis.name()
            ),
            Self::Reached { axis, limit: Reached { what, unit, needed, available } } => write!(
                f,
                "{}: {what} may be reached, {needed:.3} of {available:.3} {unit}; a smaller --gust may have a radius",
                axis.name()
            ),
            Self::Fallback { axis } => write!(
                f,
                "{}: the fallback may take over, so far does this gust carry it; a smaller --gust may have a radius",
                axis.name()
            ),
        }
    }
}
