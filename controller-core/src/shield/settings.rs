//! What the user of a shield decides: the box, and the numbers of the rules that concern time and speed.

use crate::error::{ParameterError, Reason, require, require_positive};
use crate::math;
use crate::state::check_vectors;
use nalgebra::Vector3;

/// The least side of the box, m.
pub const BOX_SIDE_MIN_M: f32 = 1.0;

/// The farthest corner of a box, m.
const BOX_CORNER_MAX_M: f32 = 1e5;

/// How far inside the box refuges are, m.
const REFUGE_INSET_M: f32 = 0.25;

/// The settings. World frame, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The lower corner of the box that the vehicle has to stay in, m: the least height included.
    pub low: Vector3<f32>,
    /// The upper corner, m.
    pub high: Vector3<f32>,
    /// The greatest speed of a policy, m/s.
    pub speed: f32,
    /// For how long the last demand is flown if none comes, s.
    pub silence: f32,
    /// For how long the vehicle is to be near its refuge before the policy gets it back the first time, s. Twice as
    /// long after each hand-over.
    pub patience: f32,
    /// The longest such time, s.
    pub patience_greatest: f32,
    /// The number of hand-overs after which the law keeps the vehicle.
    pub hand_overs: u32,
}

impl Settings {
    /// The usual settings for a box.
    pub const fn new(low: Vector3<f32>, high: Vector3<f32>) -> Self {
        Self { low, high, speed: 10.0, silence: 0.1, patience: 1.0, patience_greatest: 16.0, hand_overs: 10 }
    }

    /// Checks them.
    ///
    /// # Errors
    /// Names the first setting that makes no sense.
    pub fn check(&self) -> Result<(), ParameterError> {
        for (corner, field) in [(&self.low, "shield.low"), (&self.high, "shield.high")] {
            require(corner.iter().all(|place| place.is_finite()), field, Reason::NotFinite)?;
            require(
                check_vectors(&[(corner, BOX_CORNER_MAX_M, field)]).is_ok(),
                field,
                Reason::Above(BOX_CORNER_MAX_M),
            )?;
        }
        let min = (self.high - self.low).min();
        require(min >= BOX_SIDE_MIN_M, "shield.high - shield.low", Reason::Below(BOX_SIDE_MIN_M))?;
        for (value, field) in [
            (self.speed, "shield.speed"),
            (self.silence, "shield.silence"),
            (self.patience, "shield.patience"),
            (self.patience_greatest, "shield.patience_greatest"),
        ] {
            require_positive(value, field)?;
        }
        require(self.hand_overs > 0, "shield.hand_overs", Reason::NotPositive)
    }

    /// For how long the vehicle is to be near its refuge after so many hand-overs, s.
    pub fn patience(&self, hand_overs: u32) -> f32 {
        let doubled = (1_u32 << hand_overs.saturating_sub(1).min(16)) as f32;
        math::min(self.patience * doubled, self.patience_greatest)
    }

    /// The place nearest to `place` in the box, less a quarter of a metre.
    pub fn refuge(&self, place: &Vector3<f32>) -> Vector3<f32> {
        let axis = |place: f32, low: f32, high: f32| math::clamp(place, low + REFUGE_INSET_M, high - REFUGE_INSET_M);
        let (low, high) = (&self.low, &self.high);
        Vector3::new(axis(place.x, low.x, high.x), axis(place.y, low.y, high.y), axis(place.z, low.z, high.z))
    }

    /// Whether `place` is in the box.
    pub fn contain(&self, place: &Vector3<f32>) -> bool {
        // Not a comparison that a NaN passes.
        let inside = |(place, (low, high)): (&f32, (&f32, &f32))| low <= place && place <= high;
        place.iter().zip(self.low.iter().zip(self.high.iter())).all(inside)
    }
}
