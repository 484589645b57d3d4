//! Which measurement is flown: of all that were offered, the newest that can be used.
//!
//! One that cannot be used (not finite, out of range, no rotation, stamped with a time to come) is no measurement: the one
//! before it ages on, and the limits on age in [`super::rules`] decide how long that may go on. So the law never sees a
//! number that it could refuse.

use super::{ImuSample, Pose, Stamped};
use crate::error::InputError;
use crate::governor::{POSITION_RANGE, SPEED_RANGE};
use crate::state::{STATE_RANGE, State, check_vector};

/// How far ahead of the clock a time stamp may be, us: a sample taken while the tick was beginning.
pub const STAMP_LEAD_MAX: u64 = 1_000;

/// The greatest body rate about an axis, rad/s: no gyro that flies measures more.
pub const BODY_RATE_MAX: f32 = 100.0;

/// Something measured that can be told to be usable.
pub(super) trait Measurement: Copy {
    /// It, with its attitude normalised.
    ///
    /// # Errors
    /// Names the field that cannot be used.
    fn checked(self) -> Result<Self, InputError>;
}

impl Measurement for ImuSample {
    fn checked(self) -> Result<Self, InputError> {
        check_vector(&self.angular_velocity, BODY_RATE_MAX, "imu.angular_velocity")?;
        check_vector(&self.specific_force, STATE_RANGE, "imu.specific_force")?;
        Ok(self)
    }
}

impl Measurement for Pose {
    fn checked(self) -> Result<Self, InputError> {
        let Self { position, velocity, attitude } = self;
        check_vector(&position, POSITION_RANGE, "pose.position")?;
        check_vector(&velocity, SPEED_RANGE, "pose.velocity")?;
        let state = State { position, velocity, attitude, angular_velocity: nalgebra::Vector3::zeros() };
        Ok(Self { attitude: state.checked_attitude()?, ..self })
    }
}

/// The newest usable measurement of a kind.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Newest<T> {
    usable: Option<Stamped<T>>,
    refused: bool,
}

impl<T: Measurement> Newest<T> {
    /// None yet.
    pub const NONE: Self = Self { usable: None, refused: false };

    /// Considers what is offered in the tick at `now`. The same measurement may be offered again and again.
    /// Returns it if it is a new one and usable.
    pub fn offer(&mut self, offered: Option<Stamped<T>>, now: u64) -> Option<Stamped<T>> {
        let offered = offered.filter(|offered| self.usable.as_ref().is_none_or(|kept| offered.time > kept.time))?;
        let in_time = offered.time <= now.saturating_add(STAMP_LEAD_MAX);
        self.refused = true;
        let value = offered.value.checked().ok().filter(|_| in_time)?;
        self.refused = false;
        self.usable = Some(Stamped { value, time: offered.time });
        self.usable
    }

    /// The newest usable one, if it is not older than `age_max`, us.
    pub fn within(&self, age_max: u64, now: u64) -> Option<Stamped<T>> {
        self.usable.filter(|kept| kept.age(now) <= age_max)
    }

    /// Whether the newest one offered could not be used.
    pub fn was_refused(&self) -> bool {
        self.refused
    }
}
