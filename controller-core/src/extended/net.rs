//! The net: if a flight does not arrive, it goes on with proven gains. Section 13 of `docs/extended-law.md`.
//!
//! While the limiter of [`super::turning`] changes nothing and the thrust is not cut, V_0 falls and the vehicle
//! arrives. That the limiter falls silent is proven near the target; from far away no proof is known for strong gains.
//! So the law counts the time for which the limiter has acted since the vehicle was last near its target. Once that is
//! longer than any flight in the campaigns needed, the filters start afresh (c = x = y = -d) and the feedback is cut to
//! the level of the net, with which the frame never needs more than the reserve alpha_0. Then V_0 decides alone. Near
//! the target the law's own level returns.
//!
//! | state | counts | leaves |
//! |---|---|---|
//! | own level | time with a changed drive or a cut thrust, less a twentieth of the time without; from zero again near the target | to the net after [`PATIENCE`] |
//! | the net | nothing | to its own level near the target |
//!
//! So a flight uses the net at most once for each time that it leaves its target.

use crate::math;
use core::hint::cold_path;
use nalgebra::Vector3;

/// The counted time after which the net comes into force, s.
pub const PATIENCE: f32 = 60.0;

/// The part of the time without limiting that is subtracted from the count: in gusts the limiter acts now and then, and
/// the law should keep its own level.
const FORGIVEN: f32 = 0.05;

/// Near the target: |z_1|, m, and |z_2|, m/s.
const NEAR: f32 = 0.05;

/// The net's memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Net {
    /// Time with a changed drive since the vehicle was last near its target, s.
    acted: f32,
    /// Whether the net's level is in force.
    caught: bool,
    /// How often it came into force since the reset.
    times: u32,
}

impl Net {
    /// After a reset.
    pub const FRESH: Self = Self { acted: 0.0, caught: false, times: 0 };

    /// Whether the net's level is in force.
    #[must_use]
    pub fn is_caught(&self) -> bool {
        self.caught
    }

    /// How often it came into force since the reset.
    #[must_use]
    pub fn times(&self) -> u32 {
        self.times
    }

    /// Whether the time is over: the filters are to start afresh, with the net's level.
    #[must_use]
    pub fn catches(&mut self) -> bool {
        let catches = self.acted > PATIENCE && !self.caught;
        if catches {
            *self = Self { acted: 0.0, caught: true, times: self.times.saturating_add(1) };
        }
        catches
    }

    /// A tick of `period`, s, at z_1, m, and z_2, m/s; `limited`, whether drive or thrust was changed.
    pub fn observe(&mut self, z_1: &Vector3<f32>, z_2: &Vector3<f32>, limited: bool, period: f32) {
        // In nearly every tick there is no count to change.
        if !limited && !self.caught && self.acted == 0.0 {
            return;
        }
        cold_path();
        if z_1.norm_squared() < NEAR * NEAR && z_2.norm_squared() < NEAR * NEAR {
            (self.acted, self.caught) = (0.0, false);
        } else if limited {
            self.acted += period;
        } else {
            self.acted = math::greater(self.acted - FORGIVEN * period, 0.0);
        }
    }
}
