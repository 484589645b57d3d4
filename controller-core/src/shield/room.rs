//! A room: a box along the world's axes, one of those that a vehicle has to stay in.

use crate::error::{ParameterError, Reason, require};
use crate::math;
use crate::state::check_vectors;
use nalgebra::Vector3;

/// The least side of a room without its margins, m: twice the refuges' distance from the walls, and something to be in.
pub const ROOM_SIDE_MIN_M: f32 = 0.6;

/// The farthest corner of a room, m.
const ROOM_CORNER_MAX_M: f32 = 1e5;

/// How far inside a room refuges are, m.
const REFUGE_INSET_M: f32 = 0.25;

/// A room. World frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Room {
    /// The lower corner, m: the least height included.
    pub low: Vector3<f32>,
    /// The upper corner, m.
    pub high: Vector3<f32>,
}

impl Room {
    /// From corner to corner.
    pub const fn new(low: Vector3<f32>, high: Vector3<f32>) -> Self {
        Self { low, high }
    }

    /// Checks it, with a margin along its walls, m.
    ///
    /// # Errors
    /// Names the corner that makes no sense, or a side that is too short.
    pub fn check(&self, margin: f32) -> Result<(), ParameterError> {
        for (corner, field) in [(&self.low, "shield.low"), (&self.high, "shield.high")] {
            require(corner.iter().all(|place| place.is_finite()), field, Reason::NotFinite)?;
            require(
                check_vectors(&[(corner, ROOM_CORNER_MAX_M, field)]).is_ok(),
                field,
                Reason::Above(ROOM_CORNER_MAX_M),
            )?;
        }
        let least = ROOM_SIDE_MIN_M + 2.0 * margin;
        require((self.high - self.low).min() >= least, "shield.high - shield.low", Reason::Below(least))
    }

    /// The same without a margin along its walls, m.
    pub fn within(&self, margin: f32) -> Self {
        let margin = Vector3::repeat(margin);
        Self { low: self.low + margin, high: self.high - margin }
    }

    /// The place nearest to `place` that is a quarter of a metre inside.
    pub fn refuge(&self, place: &Vector3<f32>) -> Vector3<f32> {
        self.nearest(place, REFUGE_INSET_M)
    }

    /// How far `place` is outside, m; zero inside.
    pub fn distance(&self, place: &Vector3<f32>) -> f32 {
        math::sqrt((place - self.nearest(place, 0.0)).norm_squared())
    }

    /// Whether `place` is in it.
    pub fn contains(&self, place: &Vector3<f32>) -> bool {
        // Not a comparison that a NaN passes.
        let inside = |(place, (low, high)): (&f32, (&f32, &f32))| low <= place && place <= high;
        place.iter().zip(self.low.iter().zip(self.high.iter())).all(inside)
    }

    fn nearest(&self, place: &Vector3<f32>, inset: f32) -> Vector3<f32> {
        let axis = |place: f32, low: f32, high: f32| math::clamp(place, low + inset, high - inset);
        let (low, high) = (&self.low, &self.high);
        Vector3::new(axis(place.x, low.x, high.x), axis(place.y, low.y, high.y), axis(place.z, low.z, high.z))
    }
}
