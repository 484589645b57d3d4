//! The requirements on the gains that a search may present.

use scenario::stability::LoopMargin;

/// Longest recovery that a search may fly thousands of times.
pub const RECOVERY_MAX_S: f64 = 3600.0;
/// Shortest recovery: in less time a vehicle that is upside down has hardly begun to fall, and no law could
/// have brought it back.
pub const RECOVERY_MIN_S: f64 = 2.0;

/// The requirements on every accepted candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirements {
    /// Least relative margin of every inequality.
    pub margin: f64,
    /// Least margin of every sampled loop; not below [`LoopMargin::FLYABLE_MIN`].
    pub loops: LoopMargin,
    /// Greatest position error of the file's own flight in its last quarter, m.
    pub position_error: f64,
    /// Greatest norm of its modified Rodrigues parameters there.
    pub mrp_error: f64,
    /// How long a recovery from upside down may take, s; its last quarter must be still.
    pub recovery: f64,
    /// Whether the thrust projection may be used.
    pub projection: bool,
}

impl Default for Requirements {
    /// The defaults of `host-sim tune`.
    fn default() -> Self {
        Self {
            margin: 0.0,
            loops: LoopMargin { gain: 1.75, delay: 0.003 },
            position_error: 0.02,
            mrp_error: 0.01,
            recovery: 20.0,
            projection: true,
        }
    }
}
