//! Whether a vehicle that was armed where it stands has left the ground.
//!
//! What holds a standing vehicle up looks like a force and like more thrust than there is, so the law's estimates are
//! held until the vehicle is [`LIFT_OFF_HEIGHT_M`] above where it was armed or faster than [`LIFT_OFF_SPEED_M_PER_S`]
//! in any direction. A vehicle armed in the air falls faster than that within a few ticks if anything is left to be
//! learnt. A later landing is for `detectors` to find.

use controller_core::state::State;
use nalgebra::Vector3;

/// How far above the place of arming the vehicle is off the ground.
const LIFT_OFF_HEIGHT_M: f32 = 0.05;

/// The speed beyond which it does not stand.
const LIFT_OFF_SPEED_M_PER_S: f32 = 0.2;

/// Where a vehicle was armed, until it has left that place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LiftOff {
    standing_at: Option<f32>,
}

impl LiftOff {
    /// Off the ground.
    pub const DONE: Self = Self { standing_at: None };

    /// Standing at `position`, m, world.
    pub fn from(position: &Vector3<f32>) -> Self {
        Self { standing_at: Some(position.z) }
    }

    /// The same vehicle is found to be at `position`, m, world: it has not moved there.
    pub fn displace(&mut self, position: &Vector3<f32>) {
        self.standing_at = self.standing_at.map(|_| position.z);
    }

    /// Whether it stood when it was looked at last.
    pub fn is_standing(&self) -> bool {
        self.standing_at.is_some()
    }

    /// Whether the vehicle still stands in `state`; once it has left the ground it stands no more.
    pub fn stands(&mut self, state: &State) -> bool {
        self.standing_at = self.standing_at.filter(|height| {
            state.position.z - height < LIFT_OFF_HEIGHT_M
                && state.velocity.norm_squared() < LIFT_OFF_SPEED_M_PER_S * LIFT_OFF_SPEED_M_PER_S
        });
        self.standing_at.is_some()
    }
}

#[cfg(test)]
mod tests;
