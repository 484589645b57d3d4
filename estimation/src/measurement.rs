//! Measurements, with the time at which they were true.
//!
//! A pose is checked once, where it is made: [`Pose::new`] is the only way to one, and its attitude is a unit
//! quaternion from there on. Increments of the IMU are checked by the estimator, which begins anew where one cannot be.
//! So the law never sees a number that it could refuse.

use controller_core::governor::SPEED_RANGE_M_PER_S;
use controller_core::math;
use core::fmt;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// How far ahead of the clock a time stamp may be, us: a sample taken while the tick was beginning.
pub const STAMP_LEAD_MAX_US: u64 = 1_000;

/// How far from the origin a pose may be, m: single precision resolves millimetres up to here.
pub const DISTANCE_MAX_M: f32 = 10_000.0;

/// How far from one the length of a pose's quaternion may be; closer ones are normalised.
pub const QUATERNION_LENGTH_TOLERANCE: f32 = 0.05;

/// A value and when it was true, microseconds of the vehicle's clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stamped<T> {
    /// The value.
    pub value: T,
    /// When, us.
    pub time: u64,
}

impl<T> Stamped<T> {
    /// Something that follows from it, true at the same time.
    pub fn map<U>(self, of: impl FnOnce(T) -> U) -> Stamped<U> {
        Stamped { value: of(self.value), time: self.time }
    }

    /// How old it is at `now`, us; zero for a time to come.
    pub fn age(&self, now: u64) -> u64 {
        now.saturating_sub(self.time)
    }
}

/// A sample of the inertial measurement unit, body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImuSample {
    /// omega, rad/s.
    pub angular_velocity: Vector3<f32>,
    /// Specific force (acceleration less gravity), m/s^2: +g along z at rest.
    pub specific_force: Vector3<f32>,
}

/// A checked pose: its numbers are finite and within range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    position: Vector3<f32>,
    velocity: Vector3<f32>,
    attitude: Quaternion<f32>,
}

/// A velocity, m/s, in the axes in which a source gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Velocity {
    /// World.
    World(Vector3<f32>),
    /// Body.
    Body(Vector3<f32>),
}

/// Why a pose is invalid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseError {
    /// This field has a NaN or an infinity.
    NotFinite(&'static str),
    /// This field is further away, or faster, than any pose.
    OutOfRange(&'static str),
    /// The quaternion's length is not one within [`QUATERNION_LENGTH_TOLERANCE`].
    NotARotation,
}

impl fmt::Display for PoseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite(field) => write!(f, "{field} is not finite"),
            Self::OutOfRange(field) => write!(f, "{field} is out of range"),
            Self::NotARotation => write!(f, "quaternion not of unit length"),
        }
    }
}

impl Pose {
    /// The pose at `position` (m, world) with this velocity and `attitude` (body to world, scalar first, either sign),
    /// which is normalised.
    ///
    /// # Errors
    /// Names the field that is not finite, further than [`DISTANCE_MAX_M`], faster than [`SPEED_RANGE_M_PER_S`], or no
    /// rotation.
    pub fn new(position: Vector3<f32>, velocity: Velocity, attitude: Quaternion<f32>) -> Result<Self, PoseError> {
        let (Velocity::World(given) | Velocity::Body(given)) = velocity;
        within(&position, DISTANCE_MAX_M, "position")?;
        within(&given, SPEED_RANGE_M_PER_S, "velocity")?;
        if !attitude.coords.iter().all(|component| component.is_finite()) {
            return Err(PoseError::NotFinite("attitude"));
        }
        let length = math::sqrt(attitude.norm_squared());
        if !((1.0 - QUATERNION_LENGTH_TOLERANCE)..=(1.0 + QUATERNION_LENGTH_TOLERANCE)).contains(&length) {
            return Err(PoseError::NotARotation);
        }
        let attitude = attitude / length;
        let velocity = match velocity {
            Velocity::World(velocity) => velocity,
            Velocity::Body(velocity) => UnitQuaternion::new_unchecked(attitude) * velocity,
        };
        Ok(Self { position, velocity, attitude })
    }

    /// p, m, world.
    pub fn position(&self) -> Vector3<f32> {
        self.position
    }

    /// v, m/s, world.
    pub fn velocity(&self) -> Vector3<f32> {
        self.velocity
    }

    /// q, body to world, unit.
    pub fn attitude(&self) -> Quaternion<f32> {
        self.attitude
    }
}

/// Refuses a vector that is longer than `most`.
fn within(vector: &Vector3<f32>, max: f32, field: &'static str) -> Result<(), PoseError> {
    if !vector.iter().all(|component| component.is_finite()) {
        return Err(PoseError::NotFinite(field));
    }
    if vector.norm_squared() <= max * max { Ok(()) } else { Err(PoseError::OutOfRange(field)) }
}

/// Whether something true at `time` is not older than `age_max` at `now`, us, and the clock has not run back.
pub fn is_fresh(time: u64, age_max: u64, now: u64) -> bool {
    now.saturating_sub(time) <= age_max && time <= now.saturating_add(STAMP_LEAD_MAX_US)
}

#[cfg(test)]
mod tests;
