//! Something to stand on.
//!
//! A vehicle on the ground stands still: its legs carry what of its weight the rotors do not, friction and the legs' spread
//! hold it against any torque, and nothing moves until the upward thrust exceeds the weight. So it can rest for ever without
//! drifting. In the air the ground does nothing.
//!
//! A vehicle that comes down stops where it touches: the impact is perfectly plastic, without a bounce. The legs put it
//! upright again if it leaned by no more than [`LEGS_TILT_MAX`]; one that leaned further lies as it fell. No energy comes
//! from any of this: motion only ends, and the body is not lifted back to the ground's height, which it passes by at most
//! what it falls in one plant step.
//!
//! There is no sliding, no tipping over an edge and no ground effect, and a fall breaks nothing.

use crate::plant::Plant;
use controller_core::vehicle::Vehicle;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use scenario::body::BodyState;
use scenario::body::attitude_from_euler;

/// How far a vehicle may lean when it touches the ground for its legs to put it upright, rad: 30 degrees.
pub const LEGS_TILT_MAX: f64 = 0.52;

/// A vehicle that came down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touchdown {
    /// How fast it fell, m/s.
    pub speed: f64,
    /// How far it leaned, rad.
    pub tilt: f64,
}

/// Level ground under one vehicle.
#[derive(Debug, Clone)]
pub struct Ground {
    /// Height of the vehicle's origin when it stands, m.
    height: f64,
    /// m g, N.
    weight: f64,
    /// g, m/s^2.
    gravity: f64,
    standing: bool,
}

impl Ground {
    /// Ground on which `vehicle` stands with its origin at `height`, m; and there it stands, where `start` says, level.
    #[must_use]
    pub fn under(vehicle: &Vehicle, height: f64, start: &BodyState) -> (Self, BodyState) {
        let gravity = f64::from(vehicle.gravity);
        let ground = Self { height, weight: f64::from(vehicle.mass) * gravity, gravity, standing: true };
        let position = Vector3::new(start.position.x, start.position.y, height);
        (ground, standing(position, upright(start)))
    }

    /// Ground on which a vehicle of `mass`, kg, stands with its origin at `height`, m; and where it is, if it was at `start`: on
    /// its legs if that is down there.
    #[must_use]
    pub fn at(height: f64, mass: f64, gravity: f64, start: &BodyState) -> (Self, BodyState) {
        let mut ground = Self { height, weight: mass * gravity, gravity, standing: false };
        let state = ground.touch(start).map_or(*start, |(state, _)| state);
        (ground, state)
    }

    /// Whether the vehicle stands on it.
    #[must_use]
    pub fn stands(&self) -> bool {
        self.standing
    }

    /// Whether a vehicle on which an upward force of `lift`, N, acts besides its weight stands still.
    #[must_use]
    pub fn carries(&self, lift: f64) -> bool {
        self.standing && lift <= self.weight
    }

    /// Where a vehicle that moved to `state` ends if it touches the ground there.
    pub fn touch(&mut self, state: &BodyState) -> Option<(BodyState, Touchdown)> {
        self.standing = state.position.z <= self.height && state.velocity.z <= 0.0;
        if !self.standing {
            return None;
        }
        let touchdown = Touchdown { speed: -state.velocity.z, tilt: up(state).z.clamp(-1.0, 1.0).acos() };
        let attitude = if touchdown.tilt <= LEGS_TILT_MAX { upright(state) } else { state.attitude };
        Some((standing(state.position, attitude), touchdown))
    }

    /// One plant step under thrust, N, and torque, N m, as the ground lets it happen.
    pub fn act(&mut self, plant: &mut Plant, thrust: f64, torque: &Vector3<f64>) -> Option<Touchdown> {
        if self.carries(thrust * up(plant.state()).z) {
            return None;
        }
        plant.act(thrust, torque);
        let (state, touchdown) = self.touch(plant.state())?;
        plant.place(state);
        Some(touchdown)
    }

    /// Specific force, m/s^2, body frame: what an accelerometer shows after a step under `thrust`, N.
    #[must_use]
    pub fn specific_force(&self, state: &BodyState, thrust: f64) -> Vector3<f64> {
        if self.standing {
            UnitQuaternion::new_unchecked(state.attitude).inverse() * Vector3::new(0.0, 0.0, self.gravity)
        } else {
            Vector3::new(0.0, 0.0, thrust * self.gravity / self.weight)
        }
    }
}

/// R(q) e3.
fn up(state: &BodyState) -> Vector3<f64> {
    UnitQuaternion::new_unchecked(state.attitude) * Vector3::z()
}

/// Level, with the yaw that `state` has.
fn upright(state: &BodyState) -> Quaternion<f64> {
    attitude_from_euler(0.0, 0.0, state.yaw())
}

/// At rest.
fn standing(position: Vector3<f64>, attitude: Quaternion<f64>) -> BodyState {
    BodyState { position, velocity: Vector3::zeros(), attitude, angular_velocity: Vector3::zeros() }
}

#[cfg(test)]
mod tests;
