//! Which measurement is flown: of all that were offered, the newest that can be used.
//!
//! One that cannot be used (not finite, out of range, no rotation, stamped with a time to come) is no measurement: the one
//! before it ages on, and the limits on age in [`super::rules`] decide how long that may go on. So the law never sees a
//! number that it could refuse.

use super::reason::field;
use super::{ImuSample, Pose, Stamped};
use crate::governor::{POSITION_RANGE, SPEED_RANGE};
use crate::math;
use crate::state::{STATE_RANGE, check_vectors, is_rotation};

/// How far ahead of the clock a time stamp may be, us: a sample taken while the tick was beginning.
pub const STAMP_LEAD_MAX: u64 = 1_000;

/// The greatest body rate about an axis, rad/s: no gyro that flies measures more.
pub const BODY_RATE_MAX: f32 = 100.0;

/// Whether a time stamp can be of something that has happened.
fn is_in_time(time: u64, now: u64) -> bool {
    time <= now.saturating_add(STAMP_LEAD_MAX)
}

/// Whether something true at `time` is not older than `age_max` at `now`, us, and the clock has not run back.
pub(super) fn is_fresh(time: u64, age_max: u64, now: u64) -> bool {
    now.saturating_sub(time) <= age_max && is_in_time(time, now)
}

/// Something measured that can be told to be usable.
pub(super) trait Measurement: Copy {
    /// The name of its time stamp.
    const TIME: &'static str;

    /// Whether it can be used.
    ///
    /// # Errors
    /// Names the field that cannot.
    fn check(&self) -> Result<(), &'static str>;

    /// Makes a unit quaternion of an attitude that passes for one.
    fn normalise(&mut self) {}
}

impl Measurement for ImuSample {
    const TIME: &'static str = "imu.time";

    fn check(&self) -> Result<(), &'static str> {
        let rates = (&self.angular_velocity, BODY_RATE_MAX, "imu.angular_velocity");
        check_vectors(&[rates, (&self.specific_force, STATE_RANGE, "imu.specific_force")]).map_err(field)
    }
}

impl Measurement for Pose {
    const TIME: &'static str = "pose.time";

    fn check(&self) -> Result<(), &'static str> {
        let position = (&self.position, POSITION_RANGE, "pose.position");
        check_vectors(&[position, (&self.velocity, SPEED_RANGE, "pose.velocity")]).map_err(field)?;
        if is_rotation(&self.attitude) { Ok(()) } else { Err("pose.attitude") }
    }

    fn normalise(&mut self) {
        self.attitude *= 1.0 / math::sqrt(self.attitude.norm_squared());
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
    pub fn offer(&mut self, offered: &Option<Stamped<T>>, now: u64) -> Option<&Stamped<T>> {
        let offered = offered.as_ref()?;
        if self.usable.as_ref().is_some_and(|kept| offered.time <= kept.time) {
            return None;
        }
        let checked = if is_in_time(offered.time, now) { offered.value.check() } else { Err(T::TIME) };
        self.unusable = checked.err();
        if self.unusable.is_some() {
            return None;
        }
        let usable = self.usable.insert(*offered);
        usable.value.normalise();
        Some(usable)
    }

    /// The newest usable one, if it is not older than `age_max`, us, and the clock has not run back.
    pub fn within(&self, age_max: u64, now: u64) -> Option<&Stamped<T>> {
        self.usable.as_ref().filter(|kept| is_fresh(kept.time, age_max, now))
    }

    /// The field for which the newest one offered cannot be used, if so.
    pub fn unusable(&self) -> Option<&'static str> {
        self.unusable
    }
}
