//! Large motions: the law flies a model of its vehicle, from far away, fast, upside down and spinning.
//!
//! The [sampled loops](crate::sampled_loop) are linear: a limit cycle far from the target is beyond them. Here the law
//! itself flies a [model](crate::model) of the vehicle that it is made for, at the scenario's rate, from eleven starts
//! to a hover.
//!
//! A start is refused, by its name, if the law's own [fallback](controller_core::extended::fallback) comes before the
//! vehicle is there, or if half an hour passes. This is no proof: it says nothing about any other start. It shows
//! cycles with these gains at this rate: measured, of vehicles that were given too little [turning
//! rate](controller_core::extended::direction_limiter), or ticks too long for their gains.

pub mod on_path;

use crate::body::BodyState;
use crate::model::Model;
use crate::sampled_loop::LoopTiming;
use controller_core::certificate::certified::Certified;
use controller_core::error::ParameterError;
use controller_core::heading::Heading;
use controller_core::law::Law;
use controller_core::reference::Reference;
use nalgebra::{Quaternion, Vector3};
use std::fmt;

/// Where a flight begins: metres, metres per second, radians about a body axis, radians per second.
struct Start {
    name: &'static str,
    position: [f64; 3],
    velocity: [f64; 3],
    turned: [f64; 3],
    turning: [f64; 3],
}

/// At rest, level, at the target.
const AT_REST: Start = Start { name: "", position: [0.0; 3], velocity: [0.0; 3], turned: [0.0; 3], turning: [0.0; 3] };

/// All of them.
const STARTS: [Start; 11] = [
    Start { name: "10 m beside its target", position: [10.0, 0.0, 0.0], ..AT_REST },
    Start { name: "10 m above its target", position: [0.0, 0.0, 10.0], ..AT_REST },
    Start { name: "10 m below its target", position: [0.0, 0.0, -10.0], ..AT_REST },
    Start { name: "8 m/s past its target", position: [0.0, 3.0, 0.0], velocity: [8.0, 0.0, 0.0], ..AT_REST },
    Start { name: "a dive at 7 m/s", position: [5.0, 0.0, 5.0], velocity: [0.0, 5.0, -5.0], ..AT_REST },
    Start { name: "upside down", turned: [3.1, 0.2, 0.0], ..AT_REST },
    Start { name: "half a turn of heading", turned: [0.0, 0.0, 3.1], ..AT_REST },
    Start { name: "a tumble", turned: [1.5, -1.0, 0.5], turning: [6.0, -6.0, 4.0], ..AT_REST },
    Start { name: "a fast tumble", turned: [0.5, 1.0, 0.0], turning: [12.0, -8.0, 8.0], ..AT_REST },
    Start { name: "a spin on its side", turned: [1.7, 0.0, 0.0], turning: [2.0, -2.0, 15.0], ..AT_REST },
    Start { name: "a spin upside down", turned: [2.8, 0.4, 0.0], turning: [-2.0, 4.0, -15.0], ..AT_REST },
];

/// Most arrive in seconds; a weak vehicle that starts spinning falls for minutes, and then has far to come.
const FLIGHT_DURATION_MAX_S: f64 = 1800.0;

/// So near the target, m and m/s, and so near upright and its heading, rad, for so long, s, a vehicle has arrived.
const ARRIVAL_DISTANCE_M: f64 = 0.05;
const ARRIVAL_SPEED_M_PER_S: f64 = 0.1;
const ARRIVAL_ANGLE_RAD: f64 = 0.05;
const ARRIVAL_TIME_S: f64 = 1.0;

/// The flight that was farthest from its target on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Farthest {
    /// What its start is called.
    pub start: &'static str,
    /// m.
    pub distance: f64,
}

/// A start from which the vehicle did not arrive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NotArrived {
    /// What the start is called.
    pub start: &'static str,
    /// When it was clear, s.
    pub time: f64,
    /// How far from its target the vehicle then was, m.
    pub distance: f64,
    /// How far from its heading, rad.
    pub turned: f64,
}

impl fmt::Display for NotArrived {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { start, time, distance, turned } = self;
        write!(
            f,
            "model flight from {start}: does not arrive, {distance:.2} m and {:.0} degrees",
            turned.to_degrees()
        )?;
        write!(f, " off after {time:.0} s; a higher control.rate, more torque, more gains.turn_rate")?;
        write!(f, " or less gains.v_across may help")
    }
}

/// How `certified` arrives from all starts, or the first from which it does not.
///
/// # Errors
/// If the law refuses the period or the delay.
pub fn flown(certified: &Certified, timing: &LoopTiming) -> Result<Result<Farthest, NotArrived>, ParameterError> {
    let law = Law::new(certified, timing.period as f32)?;
    let vehicle = certified.configuration().vehicle();
    Ok(STARTS.iter().try_fold(Farthest { start: "", distance: 0.0 }, |farthest, start| {
        let distance = arrives(Model::new(vehicle, timing, start.body()), law.clone(), start.name)?;
        Ok(if distance > farthest.distance { Farthest { start: start.name, distance } } else { farthest })
    }))
}

impl Start {
    fn body(&self) -> BodyState {
        let turned = Vector3::from(self.turned);
        let half = 0.5 * turned.norm();
        let axis = turned.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        BodyState {
            position: Vector3::from(self.position),
            velocity: Vector3::from(self.velocity),
            attitude: Quaternion::from_parts(half.cos(), axis * half.sin()),
            angular_velocity: Vector3::from(self.turning),
        }
    }
}

/// How far `model` was from its target on the way, m, or where it was when it had not arrived.
fn arrives(mut model: Model, mut law: Law, start: &'static str) -> Result<f64, NotArrived> {
    let reference = Reference::resting(Vector3::zeros(), Heading::FORWARD);
    let period = model.period();
    let (mut time, mut stayed, mut farthest) = (0.0, 0.0, 0.0_f64);
    loop {
        let command = law.command(&model.body.measured(), &reference);
        let [distance, turned] = [model.body.position.norm(), model.body.heading_error(&reference.heading)];
        let (Ok(command), 0, true) = (command, law.fallback_times(), time < FLIGHT_DURATION_MAX_S) else {
            return Err(NotArrived { start, time, distance, turned });
        };
        farthest = farthest.max(distance);
        model.advance(&command.wrench);
        time += period;
        let near = distance < ARRIVAL_DISTANCE_M && model.body.velocity.norm() < ARRIVAL_SPEED_M_PER_S;
        let arrived = near && turned < ARRIVAL_ANGLE_RAD && model.body.thrust_axis().z > ARRIVAL_ANGLE_RAD.cos();
        stayed = if arrived { stayed + period } else { 0.0 };
        if stayed > ARRIVAL_TIME_S {
            return Ok(farthest);
        }
    }
}

#[cfg(test)]
mod tests;
