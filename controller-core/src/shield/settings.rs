//! What the user of a shield decides: the rooms to stay in, and the numbers of the rules that concern time and speed.

use super::room::Room;
use crate::error::{ParameterError, Reason, require, require_finite, require_positive};
use crate::math;
use nalgebra::Vector3;

/// The greatest number of rooms.
pub const ROOMS_MAX: usize = 4;

/// The greatest margin along walls, m.
const MARGIN_MAX_M: f32 = 100.0;

/// The latest velocity, s.
const LATE_MAX_S: f32 = 0.1;

/// The settings. World frame, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The rooms, of which the vehicle has to stay in one or another. Where two overlap it goes from one to the other.
    pub rooms: [Option<Room>; ROOMS_MAX],
    /// How far inside its rooms a vehicle is kept, m: as far as its estimated place may be from the true one.
    pub margin: f32,
    /// How late the velocity of its states is where the acceleration has just changed, s: estimators average.
    pub late: f32,
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
    /// The usual settings for one room.
    pub const fn new(low: Vector3<f32>, high: Vector3<f32>) -> Self {
        Self {
            rooms: [Some(Room::new(low, high)), None, None, None],
            margin: 0.0,
            late: 0.0,
            speed: 10.0,
            silence: 0.1,
            patience: 1.0,
            patience_greatest: 16.0,
            hand_overs: 10,
        }
    }

    /// Checks them.
    ///
    /// # Errors
    /// Names the first setting that makes no sense.
    pub fn check(&self) -> Result<(), ParameterError> {
        for (value, most, field) in
            [(self.margin, MARGIN_MAX_M, "shield.margin"), (self.late, LATE_MAX_S, "shield.late")]
        {
            require_finite(value, field)?;
            require(value >= 0.0, field, Reason::Below(0.0))?;
            require(value <= most, field, Reason::Above(most))?;
        }
        require(self.rooms.iter().any(Option::is_some), "shield.rooms", Reason::TooFew(1))?;
        self.rooms.iter().flatten().try_for_each(|room| room.check(self.margin))?;
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

    /// A room without its margin in which all of these places are: `last` if it is one, or else the first.
    pub fn room_of(&self, places: &[Vector3<f32>], last: Option<&Room>) -> Option<Room> {
        let holds = |room: &Room| places.iter().all(|place| room.contains(place));
        last.copied().filter(holds).or_else(|| self.within().find(holds))
    }

    /// The room without its margin that is nearest to `place`. None of settings that have no room.
    pub fn nearest_room(&self, place: &Vector3<f32>) -> Option<Room> {
        let nearer = |best: Option<(Room, f32)>, room: Room| {
            let distance = room.distance(place);
            best.filter(|(_, least)| *least <= distance).or(Some((room, distance)))
        };
        self.within().fold(None, nearer).map(|(room, _)| room)
    }

    fn within(&self) -> impl Iterator<Item = Room> + '_ {
        self.rooms.iter().flatten().map(|room| room.within(self.margin))
    }
}
