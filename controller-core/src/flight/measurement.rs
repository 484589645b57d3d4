//! Which measurement is flown: of all that were offered, the newest that can be used.
//!
//! One that cannot be used (not finite, out of range, no rotation, stamped with a time to come) is no measurement: the one
//! before it ages on, and the limits on age in [`super::rules`] decide how long that may go on. So the law never sees a
//! number that it could refuse.

use super::{ImuSample, Pose, Stamped};
use crate::governor::{POSITION_RANGE, SPEED_RANGE};
use crate::math;
use crate::state::{STATE_RANGE, State, check_vector};
use nalgebra::Vector3;

/// How far ahead of the clock a time stamp may be, us: a sample taken while the tick was beginning.
pub const STAMP_LEAD_MAX: u64 = 1_000;

/// The greatest body rate about an axis, rad/s: no gyro that flies measures more.
pub const BODY_RATE_MAX: f32 = 100.0;

/// Whether a time stamp can be of something that has happened.
pub(super) fn is_in_time(time: u64, now: u64) -> bool {
    time <= now.saturating_add(STAMP_LEAD_MAX)
}

/// Something measured that can be told to be usable.
pub(super) trait Measurement: Copy {
    /// The name of its time stamp.
    const TIME: &'static str;

    /// It, with its attitude normalised.
    ///
    /// # Errors
    /// Names the field that cannot be used.
    fn checked(self) -> Result<Self, &'static str>;
}

/// Passes a vector that is finite and within `range`.
fn require(vector: &Vector3<f32>, range: f32, field: &'static str) -> Result<(), &'static str> {
    check_vector(vector, range, field).map_err(|_| field)
}

impl Measurement for ImuSample {
    const TIME: &'static str = "imu.time";

    fn checked(self) -> Result<Self, &'static str> {
        require(&self.angular_velocity, BODY_RATE_MAX, "imu.angular_velocity")?;
        require(&self.specific_force, STATE_RANGE, "imu.specific_force")?;
        Ok(self)
    }
}

impl Measurement for Pose {
    const TIME: &'static str = "pose.time";

    fn checked(self) -> Result<Self, &'static str> {
        let Self { position, velocity, attitude } = self;
        require(&position, POSITION_RANGE, "pose.position")?;
        require(&velocity, SPEED_RANGE, "pose.velocity")?;
        let state = State { position, velocity, attitude, angular_velocity: Vector3::zeros() };
        state.check().map_err(|_| "pose.attitude")?;
        let attitude = attitude * (1.0 / math::sqrt(attitude.norm_squared()));
        Ok(Self { attitude, ..self })
    }
}

/// The newest usable measurement of a kind.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Newest<T> {
    usable: Option<Stamped<T>>,
    unusable: Option<&'static str>,
}

impl<T: Measurement> Newest<T> {
    /// None yet.
    pub const NONE: Self = Self { usable: None, unusable: None };

    /// Considers what is offered in the tick at `now`; the same measurement may be offered again and again, and one older
    /// than what is here is passed over. Returns it if it is new and usable.
    pub fn offer(&mut self, offered: Option<Stamped<T>>, now: u64) -> Option<Stamped<T>> {
        let Stamped { value, time } =
            offered.filter(|offered| self.usable.as_ref().is_none_or(|kept| offered.time > kept.time))?;
        match if is_in_time(time, now) { value.checked() } else { Err(T::TIME) } {
            Ok(value) => *self = Self { usable: Some(Stamped { value, time }), unusable: None },
            Err(field) => {
                self.unusable = Some(field);
                return None;
            }
        }
        self.usable
    }

    /// The newest usable one, if it is not older than `age_max`, us, and the clock has not run back.
    pub fn within(&self, age_max: u64, now: u64) -> Option<Stamped<T>> {
        self.usable.filter(|kept| kept.age(now) <= age_max && is_in_time(kept.time, now))
    }

    /// The field for which the newest one offered cannot be used, if so.
    pub fn unusable(&self) -> Option<&'static str> {
        self.unusable
    }
}
