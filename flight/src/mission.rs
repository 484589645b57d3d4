//! A mission: items that are flown one after the other, each a position setpoint of the governor.
//!
//! The list is its keeper's. The pilot says which item it [needs](super::Pilot::mission_item) and is given that one
//! alone, so it needs no memory for the list. A mission begins, pauses and ends by the rules that setpoints, a hold and
//! a landing have: it is one more source of setpoints.
//!
//! ```text
//! item needed -> checked, to the governor -> its reference within the radius, for the hold time -> next item
//!                                                            none left -> hold there;  a landing -> land
//! ```

use super::settings::FlightSettings;
use controller_core::governor::HeadingSetpoint;
use core::fmt;
use nalgebra::{Vector2, Vector3};

/// Of a take-off.
pub const TAKE_OFF_HEIGHTS_M: core::ops::RangeInclusive<f32> = 0.5..=50.0;

/// Of an item that names none.
pub const ACCEPTANCE_RADIUS_M: f32 = 0.3;

/// How near the place of its landing, and how slow, the reference has to be before the vehicle goes down.
const LANDING_PLACE_DISTANCE_MAX_M: f32 = 0.05;
const LANDING_PLACE_SPEED_MAX_M_PER_S: f32 = 0.05;

/// How near its height a reference that goes straight up has to be.
const RISEN_DISTANCE_MAX_M: f32 = 0.1;

/// What an item is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leg {
    /// Going straight up to its height.
    TakeOff,
    /// Flying to its place.
    Waypoint,
    /// Landing at its place.
    Land,
    /// Landing where the vehicle was armed.
    Return,
}

/// An item.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MissionItem {
    /// What for.
    pub leg: Leg,
    /// Where to, m, world. A take-off uses the height alone, a landing all but that, a return nothing.
    pub position: Vector3<f32>,
    /// Which way to point.
    pub turn: HeadingSetpoint,
    /// How near the reference has to come, m.
    pub radius: f32,
    /// For how long it stays, us.
    pub hold: u64,
}

estimation::worded! {
    /// Why an item is not flown.
    pub enum MissionRefusal {
        /// There is no item of that number.
        NoItem = "no such mission item",
        /// A number of it is not finite, or out of the governor's range.
        Number = "a number is out of range",
        /// It leads out of the fence.
        OutsideFence = "outside the fence",
        /// It is lower than the place of arming.
        BelowHome = "below the place of arming",
        /// Its height is not one of a take-off.
        TakeOffHeight = "take-off not 0.5 to 50 m high",
    }
}

impl MissionItem {
    /// Whether it may be flown by a vehicle that was armed at `home`, m, world, with these settings.
    ///
    /// # Errors
    /// Why not.
    pub fn check(&self, home: &Vector3<f32>, settings: &FlightSettings) -> Result<(), MissionRefusal> {
        let away = self.position - home;
        let is_finite = away.iter().all(|component| component.is_finite());
        let (across, height) = match self.leg {
            Leg::TakeOff => (Vector2::zeros(), away.z),
            Leg::Waypoint => (away.xy(), away.z),
            Leg::Land => (away.xy(), 0.0),
            Leg::Return => return Ok(()),
        };
        if !is_finite {
            Err(MissionRefusal::Number)
        } else if self.leg == Leg::TakeOff && !TAKE_OFF_HEIGHTS_M.contains(&height) {
            Err(MissionRefusal::TakeOffHeight)
        } else if height < 0.0 {
            Err(MissionRefusal::BelowHome)
        } else if across.norm_squared() > settings.fence_radius * settings.fence_radius
            || height > settings.fence_height
        {
            Err(MissionRefusal::OutsideFence)
        } else {
            Ok(())
        }
    }

    /// Whether it ends on the ground.
    #[must_use]
    pub fn lands(&self) -> bool {
        matches!(self.leg, Leg::Land | Leg::Return)
    }

    /// Where its reference goes from `here`, m, world.
    pub(super) fn target(&self, here: &Vector3<f32>, home: &Vector3<f32>, rises: bool) -> Vector3<f32> {
        match self.leg {
            Leg::TakeOff => Vector3::new(here.x, here.y, self.position.z),
            Leg::Waypoint if rises => Vector3::new(here.x, here.y, self.position.z),
            Leg::Waypoint => self.position,
            Leg::Land => Vector3::new(self.position.x, self.position.y, here.z),
            Leg::Return => Vector3::new(home.x, home.y, here.z),
        }
    }

    /// Whether a reference has come to the target, so far from it, m, and so fast, m/s.
    pub(super) fn is_reached(&self, away: f32, speed: f32, rises: bool) -> bool {
        if rises || self.leg == Leg::TakeOff {
            away < RISEN_DISTANCE_MAX_M
        } else if self.lands() {
            away < LANDING_PLACE_DISTANCE_MAX_M && speed < LANDING_PLACE_SPEED_MAX_M_PER_S
        } else {
            away < self.radius
        }
    }
}

/// What a mission did in a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MissionStep {
    /// The item of this number is done.
    Reached(u8),
    /// The item of this number is done, and the vehicle lands.
    Lands(u8),
    /// No item is left: the vehicle holds at the last.
    Over,
    /// The item of this number is not flown: the vehicle holds.
    Refused(u8, MissionRefusal),
}

impl fmt::Display for MissionStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Reached(item) => write!(f, "Mission item {item} reached"),
            Self::Lands(_) => f.write_str("Mission over: landing"),
            Self::Over => f.write_str("Mission over: holding position"),
            Self::Refused(item, refusal) => write!(f, "Mission item {item}: {refusal}"),
        }
    }
}

/// How far it is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Progress {
    /// The item that is flown, or will be.
    pub next: u8,
    /// Whether it is flown.
    pub is_flown: bool,
    /// Whether the vehicle first rises to the item's height.
    pub rises: bool,
    /// Where the reference goes for this item, m, world; none before the governor has it.
    pub target: Option<Vector3<f32>>,
    /// Since when the reference has been there, us.
    pub since: Option<u64>,
}

impl Progress {
    /// At an item, flown or not as before.
    pub fn at(self, next: u8) -> Self {
        Self { next, is_flown: self.is_flown, ..Self::default() }
    }

    /// The same item, not flown.
    pub fn paused(self) -> Self {
        Self { next: self.next, ..Self::default() }
    }
}

#[cfg(test)]
mod tests;
