//! What the rotors give of what they are asked for, as a check of battery, mass and thrust curve.
//!
//! The law estimates it as its thrust scale, and flies with what it finds; the certificate bears what its file says,
//! 0.8 to 1.3 on the vehicles here. With a battery that is compensated and a mass that is right it stays near 1.
//! Farther off than [`DOUBTFUL`], for [`LASTING`], something is not what the file says, and somebody should look before
//! the limit is reached.

/// The distance from 1 beyond which the scale is told.
pub const DOUBTFUL: f32 = 0.15;

/// For how long, us: the estimate takes 2 s after lift-off to settle.
pub const LASTING: u64 = 3_000_000;

/// How often it is told, us.
pub const AGAIN: u64 = 10_000_000;

/// Since when the scale has been doubtful.
#[derive(Debug, Default, PartialEq)]
pub(super) struct ThrustCheck {
    /// When it is to be told, us; none while all is well.
    due: Option<u64>,
}

impl ThrustCheck {
    /// Whether this tick's scale is to be told; none where nothing is flown.
    pub fn is_doubtful(&mut self, scale: Option<f32>, now: u64) -> bool {
        // Written so that a number that is none is doubtful.
        let well = scale.is_none_or(|scale| (scale - 1.0).abs() <= DOUBTFUL);
        let due = *self.due.get_or_insert(now.saturating_add(LASTING));
        if well {
            self.due = None;
        } else if now >= due {
            self.due = Some(now.saturating_add(AGAIN));
            return true;
        }
        false
    }
}

#[cfg(test)]
mod tests;
