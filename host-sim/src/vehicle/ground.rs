//! Level ground: standing, sliding, touching down, lifting off.
//!
//! A vehicle on the ground stands still: its legs carry what of its weight the rotors do not, their spread holds it
//! against any torque, and friction against as much force as `friction` says; beyond that it slides. So it can rest
//! for ever without drifting, and one that nearly hovers is hardly held. In the air the ground does nothing.
//!
//! A vehicle that comes down stops its fall and its turning where it touches: the impact is perfectly plastic, without
//! a bounce. Along the ground it stops if friction suffices, and else slides on, slower. One that leans is then on its
//! lowest foot, and falls back onto all of them if it leaned by no more than [`TILT_MAX_RAD`] (its `rocking`); one that
//! leaned further lies as it fell, and does not slide: arms and rotors catch on what they lie on. No energy comes from
//! any of this: a body is not lifted back to the ground's height, which it passes by at most what it falls in one plant
//! step, or, after a hop that leaned, by what its foot did.
//!
//! There is no turning about the vertical, no tipping over an edge by a torque from standing, and a fall breaks
//! nothing. What the ground does to rotors above it is `crate::vehicle::reality::air`'s.

mod friction;
mod rocking;

pub use rocking::TILT_MAX_RAD;

use crate::vehicle::plant::Plant;
use controller_core::vehicle::Vehicle;
use friction::{FRICTION_COEFFICIENT, slowed};
use nalgebra::{Quaternion, Vector3};
use rocking::{Lean, Rocked, Rocking, Weight, tilt, up};
use scenario::body::BodyState;
use scenario::body::attitude_from_euler;
use scenario::reality::truth::Truth;

/// A vehicle that came down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touchdown {
    /// How fast it fell, m/s.
    pub speed: f64,
    /// How far it leaned, rad.
    pub tilt: f64,
    /// Where its origin was, m, world.
    pub position: Vector3<f64>,
}

/// How a vehicle is on the ground.
#[derive(Debug, Clone)]
enum Stance {
    /// Not at all.
    Air,
    /// On all feet: at rest, or sliding.
    Feet,
    /// As it fell: what it lies on holds it.
    Lying,
    /// On one foot.
    Rocking(Rocking),
}

/// Level ground under one vehicle.
#[derive(Debug, Clone)]
pub struct Ground {
    /// Height of the vehicle's origin when it stands, m.
    height: f64,
    weight: Weight,
    /// Plant step, s.
    step: f64,
    stance: Stance,
}

impl Ground {
    /// Ground on which `vehicle` stands with its origin at `height`, m; and there it stands, where `start` says, level.
    /// `step` is the plant's, s.
    pub fn under(vehicle: &Vehicle, height: f64, start: &BodyState, step: f64) -> (Self, BodyState) {
        let (mass, inertia) = (f64::from(vehicle.mass), vehicle.inertia.map(f64::from));
        let weight = Weight { mass, inertia, gravity: f64::from(vehicle.gravity) };
        let position = Vector3::new(start.position.x, start.position.y, height);
        (Self { height, weight, step, stance: Stance::Feet }, standing(position, upright(start)))
    }

    /// Ground on which a vehicle that truly is `truth` stands with its origin at `height`, m; and where it is, if it
    /// was at `start`: at rest on it if that is down there.
    pub fn at(height: f64, truth: &Truth, gravity: f64, start: &BodyState, step: f64) -> (Self, BodyState) {
        let weight = Weight { mass: truth.mass, inertia: truth.inertia, gravity };
        let mut ground = Self { height, weight, step, stance: Stance::Air };
        let state = ground.touch(start).map_or(*start, |(state, _)| state);
        (ground, state)
    }

    /// Whether the vehicle is on it, on all its feet or on one.
    pub fn stands(&self) -> bool {
        !matches!(self.stance, Stance::Air)
    }

    /// An outside force takes hold of it: off its foot, if it was on one.
    pub fn take_off_foot(&mut self) {
        if let Stance::Rocking(_) = self.stance {
            self.stance = Stance::Air;
        }
    }

    /// Where a vehicle at `state`, on which `force`, N, world, acts besides its weight, and `torque`, N m, body, is
    /// after a step on the ground; none if that does not hold it.
    pub fn hold(&mut self, state: &BodyState, force: &Vector3<f64>, torque: &Vector3<f64>) -> Option<BodyState> {
        let rocked = match &mut self.stance {
            Stance::Air => Rocked::Off,
            Stance::Feet | Stance::Lying if force.z > self.weight.newtons() => Rocked::Off,
            Stance::Feet => Rocked::Ended(self.weight.slide(state, force, self.step)),
            Stance::Lying => Rocked::Ended(*state),
            Stance::Rocking(rocking) => rocking.advance(&self.weight, force, torque, self.step),
        };
        match rocked {
            Rocked::Leaning(state) => Some(state),
            Rocked::Ended(state) => {
                self.stance = if is_upright(&state) { Stance::Feet } else { Stance::Lying };
                Some(state)
            }
            Rocked::Off => None,
        }
    }

    /// Where a vehicle that moved freely to `state` ends if it touches the ground there.
    pub fn touch(&mut self, state: &BodyState) -> Option<(BodyState, Touchdown)> {
        let (lean, climbing) = (Lean::measure(state), state.velocity.z);
        let (rise, rising) = lean.as_ref().map_or((0.0, 0.0), Lean::rise);
        // What is not a number touches nothing.
        let touches = state.position.z <= self.height + rise && climbing <= 0.0 && climbing <= rising;
        if !touches {
            self.stance = Stance::Air;
            return None;
        }
        let touchdown = Touchdown { speed: -climbing, tilt: tilt(state), position: state.position };
        let lies = lean.is_none() && !is_upright(state);
        let sliding = slowed(&state.velocity, FRICTION_COEFFICIENT * touchdown.speed);
        let velocity = if lies { Vector3::zeros() } else { sliding };
        let touched = BodyState { velocity, ..standing(state.position, state.attitude) };
        let flat = if lies { Stance::Lying } else { Stance::Feet };
        self.stance = lean.map_or(flat, |lean| Stance::Rocking(Rocking::begin(&touched, lean, &self.weight)));
        Some((touched, touchdown))
    }

    /// One plant step under thrust, N, and torque, N m, as the ground lets it happen.
    pub fn act(&mut self, plant: &mut Plant, thrust: f64, torque: &Vector3<f64>) -> Option<Touchdown> {
        let force = up(plant.state()) * thrust;
        if let Some(state) = self.hold(plant.state(), &force, torque) {
            plant.place(state);
            return None;
        }
        plant.act(thrust, torque);
        let (state, touchdown) = self.touch(plant.state())?;
        plant.place(state);
        Some(touchdown)
    }
}

/// Whether a vehicle that is on no single foot is on all of them.
fn is_upright(state: &BodyState) -> bool {
    tilt(state) <= TILT_MAX_RAD
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
