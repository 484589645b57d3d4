//! The governor's own limits, beside the bounds of the reference, and their ranges.

/// Ticks of commands remembered: what the three averages may span together.
pub(super) const HISTORY_TICKS: usize = 512;

/// The longest last average, ticks.
pub(super) const LAST_AVERAGE_MAX_TICKS: usize = HISTORY_TICKS / 4;

/// The greatest speed limit and starting speed, m/s.
pub const SPEED_RANGE_M_PER_S: f32 = 256.0;

/// What the governor needs beyond the bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GovernorLimits {
    /// Greatest horizontal speed towards a setpoint, m/s, where the bounds allow it. (A faster start is slowed down.)
    pub horizontal_speed: f32,
    /// Greatest vertical speed towards a setpoint, m/s.
    pub vertical_speed: f32,
    /// How long snap takes from one end of its bound to the other, s.
    pub snap_ramp: f32,
    /// How long psi'' takes from one end of its bound to the other, s.
    pub heading_ramp: f32,
    /// How long velocities, rates and feed-forwards are valid without renewal, s.
    pub timeout: f32,
}

impl Default for GovernorLimits {
    fn default() -> Self {
        Self { horizontal_speed: 5.0, vertical_speed: 2.0, snap_ramp: 0.1, heading_ramp: 0.2, timeout: 0.5 }
    }
}
