//! One step of the extended law: state and reference in, wrench out.
//!
//! ```text
//! the last interval, Measured -> learning (thrust_scale, force, torque_bias)
//! State, Reference -> position -> attitude_reference -> path_lifting, attitude
//!                  -> budget: bias, feedback, turning about the tilt's axes -> heading -> thrust_range -> Wrench
//! ```
//!
//! `sections` has the parts, `without_a_rotor` what flies once a rotor has failed. The order within a tick: first what
//! can be refused, up to the desired motion, from the filters as they stand and with the averages that have taken in
//! the last interval. Nothing is remembered before that. From there on every part of the memory advances by one period
//! as soon as its last value has served. So the wrench is the one for the instant the state was taken, as in the
//! paper's [`controller`](crate::controller).

use super::actuators::ActuatorModel;
use super::attitude::AttitudeLaw;
use super::budget::{Ceiling, TickBudget};
use super::demand::Demand;
use super::direction_limiter::DirectionLimiter;
use super::estimates::{Learning, held};
use super::heading::HeadingLaw;
use super::measured::Measured;
use super::memory::{Averages, Estimates, LastTick, Memory};
use super::position::{FeedbackLimits, Filters, PositionLaw};
use super::rotor_loss::detector::Detector;
use super::rotor_loss::spinning::RotorLossLaw;
use super::rotor_speeds::RotorSpeeds;
use super::thrust_range::ThrustRange;
use crate::allocation::Rotors;
use crate::configuration::ExtendedLaw;
use crate::controller::Diagnostics;
use crate::error::InputError;
use crate::reference::{Reference, admit};
use crate::state::{State, Wrench, length_squared};
use crate::vehicle::{Limits, Vehicle};
use core::hint::cold_path;
use nalgebra::{Quaternion, Vector3, Vector4};

/// Where ubar comes from.
enum FeedbackSource<'a> {
    /// The law, with these levels at most.
    Law(&'a FeedbackLimits),
    Policy(&'a Demand),
    /// From what the wrench of these speeds, which flies in place of the law's, makes of the vehicle.
    Rotors(&'a RotorSpeeds, &'a [f32; 4]),
}

/// What rotors have made of past commands, as commanded: thrust, N, and torque, N m.
struct PastCommands {
    /// The mean wrench since the last tick.
    acted: Vector4<f32>,
    /// The impulse that is still to come, N s and N m s.
    pending: Vector4<f32>,
    /// E of [`measured`](crate::extended::measured).
    lasting: Option<Vector4<f32>>,
}

/// The extended law for one vehicle, one set of constants and one period.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    vehicle: Vehicle,
    limits: Limits,
    law: ExtendedLaw,
    rotors: Option<Rotors>,
    period: f32,
    switching_scalar: f32,
    /// A_- - g: the reference's vertical acceleration stays above it, m/s^2.
    steepest_fall: f32,
    ceiling: Ceiling,
    /// Lag and delay of the actuators together, s.
    late: f32,
    position: PositionLaw,
    /// The same, slowed: the fallback's.
    slowed: PositionLaw,
    /// M_s, m/s^2.
    slow: FeedbackLimits,
    attitude: AttitudeLaw,
    heading: HeadingLaw,
    budget: TickBudget,
    /// J_max alpha_0, N m.
    reserve: f32,
    turning: DirectionLimiter,
    /// For the interval since the last tick.
    learning: Learning,
    /// For the next interval, if its length differs.
    changed: Option<Learning>,
    range: ThrustRange,
    actuators: ActuatorModel,
    /// Ticks for which the wrench that acts still depends on one that was not delivered.
    settling: u32,
    memory: Memory,
    detector: Detector,
    /// In force once a rotor is lost.
    spinning: Option<RotorLossLaw>,
    /// For the next step.
    measured: Measured,
}

impl Controller {
    /// Filters to zero, path lifted anew, nothing estimated: how a flight begins.
    pub fn reset(&mut self) {
        let averages = Averages::known(Vector3::zeros(), 1.0);
        self.memory = Memory::fresh(&self.vehicle, averages);
        self.spinning = None;
    }

    /// The same, but the estimates of the vehicle itself stay: how a flight goes on without a pose. The force across is
    /// forgotten, because it came from velocities that are no longer known. The vertical force stays: most of it is a
    /// lack of thrust.
    pub fn restart(&mut self) {
        let vertical = Vector3::new(0.0, 0.0, self.estimates().force.z);
        let Averages { torque, scale, .. } = self.memory.averages;
        let averages = Averages { force: vertical, ..Averages::known(torque, scale.scale) };
        self.memory = Memory { filters: Filters::at(-vertical), ..Memory::fresh(&self.vehicle, averages) };
    }

    /// Keeps the estimates as they are until the wrench that acts no longer depends on the last one commanded. For
    /// every tick on the ground, without a velocity, or whose wrench the rotors could not deliver.
    pub fn hold_estimates(&mut self) {
        self.memory.held = self.settling;
    }

    /// Likewise, for every tick whose velocity is not the vehicle's: what rates tell is learnt on, and what is measured
    /// of the acceleration tells whether a rotor fails.
    pub fn hold_without_velocity(&mut self) {
        self.memory.without_velocity = self.settling;
    }

    /// What was measured since the last step: for the next one alone, whether that is refused or not. Without it the
    /// estimates rest on the states and the commands.
    pub fn measured(&mut self, measured: &Measured) {
        self.measured = *measured;
    }

    /// The estimated thrust scale, delivered over commanded: the caller divides the wrench by it before commanding
    /// rotors.
    pub fn thrust_scale(&self) -> f32 {
        self.memory.averages.scale.scale
    }

    /// The law's memory.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// The estimates; force and torque bias cut to their levels.
    pub fn estimates(&self) -> Estimates {
        let believed = self.learning.estimates(&self.memory.averages);
        self.spinning.as_ref().map_or(believed, |law| Estimates { force: law.force(), ..believed })
    }

    /// The vehicle's rotors, where they are known.
    pub fn rotors(&self) -> Option<&Rotors> {
        self.rotors.as_ref()
    }

    /// The law without a rotor, once one is lost.
    pub fn spinning(&self) -> Option<&RotorLossLaw> {
        self.spinning.as_ref()
    }

    /// One tick of the law.
    ///
    /// # Errors
    /// [`InputError`] names the field of `state` or `reference` that is not finite, out of range, not a rotation, or
    /// (the reference's acceleration) falls faster than the thrust direction allows. The memory is then unchanged.
    // Always inlined: diagnostics that a caller does not read then cost it nothing.
    #[inline(always)]
    pub fn step(&mut self, state: &State, reference: &Reference) -> Result<(Wrench, Diagnostics), InputError> {
        self.tick(state, reference, &FeedbackSource::Law(&FeedbackLimits::UNLIMITED))
    }

    /// One tick with a demand in place of the position law's feedback. The reference gives the heading, and where the
    /// errors in the diagnostics are counted from; it has to be at rest. The fallback does not count.
    ///
    /// # Errors
    /// As [`Self::step`]'s, and for a demand that cannot be used.
    pub fn step_on_demand(
        &mut self,
        state: &State,
        reference: &Reference,
        demand: &Demand,
    ) -> Result<(Wrench, Diagnostics), InputError> {
        demand.check()?;
        if matches!(demand, Demand::Rotors { .. }) {
            return Err(InputError::OutOfRange { field: "demand.speeds" });
        }
        self.shielded_tick(state, reference, &FeedbackSource::Policy(demand))
    }

    /// One tick in which the rotors turn at `speeds`, in the law's place: their wrench, within ranges and limits, is
    /// what comes back, unless a rotor is lost. The law goes through its tick beside it: it learns from what flew, and
    /// its filters are put where the thrust points, with the rate at which the vehicle turns it and the lift that holds
    /// the height, all cut to the envelope. So the law can take over at any tick from a memory that its own flights
    /// could have. The reference as for a demand.
    ///
    /// # Errors
    /// As [`Self::step`]'s.
    pub fn step_on_rotors(
        &mut self,
        state: &State,
        reference: &Reference,
        rotors: &RotorSpeeds,
        speeds: &[f32; 4],
    ) -> Result<(Wrench, Diagnostics), InputError> {
        self.shielded_tick(state, reference, &FeedbackSource::Rotors(rotors, speeds))
    }

    /// The newest command, (T, tau) divided by the thrust scale: what the rotors were told, N and N m.
    pub fn commanded(&self) -> Vector4<f32> {
        self.memory.actuators.newest()
    }

    /// One tick whose feedback keeps to `limits`. Every theorem on feedback holds for lower levels as well.
    ///
    /// # Errors
    /// As [`Self::step`]'s.
    pub fn step_within(
        &mut self,
        state: &State,
        reference: &Reference,
        limits: &FeedbackLimits,
    ) -> Result<(Wrench, Diagnostics), InputError> {
        self.shielded_tick(state, reference, &FeedbackSource::Law(limits))
    }

    /// Behind a shield: compiled once for both.
    #[inline(never)]
    fn shielded_tick(
        &mut self,
        state: &State,
        reference: &Reference,
        source: &FeedbackSource,
    ) -> Result<(Wrench, Diagnostics), InputError> {
        self.tick(state, reference, source)
    }

    #[inline(always)]
    fn tick(
        &mut self,
        state: &State,
        reference: &Reference,
        source: &FeedbackSource,
    ) -> Result<(Wrench, Diagnostics), InputError> {
        let measured = core::mem::take(&mut self.measured);
        admit(state, reference, self.steepest_fall)?;
        let suspicion = self.memory.suspicion;
        let axis = thrust_axis(&state.attitude);
        let PastCommands { acted, pending, lasting } = self.past_commands(measured.wrench.as_ref());
        // By the commands alone: what a rotor's speed has lost is missing in the motion, and not to be explained away.
        let commanded = self.memory.acted;
        if self.has_lost(state, &axis, &measured, &commanded) {
            cold_path();
            return Ok(self.spin(state, reference, &axis, &pending));
        }
        let averages = self.learning.updated(&self.memory, state, &axis, &measured, &acted);
        let Estimates { force, torque: bias, scale } = self.learning.estimates(&averages);
        let acceleration_max = self.ceiling.at(scale, &bias);
        let rest = self.acceleration_command(reference, &Vector3::zeros());
        let force = held(&force, &rest, acceleration_max);

        // With the scale by which the caller will divide it.
        let turned = match source {
            FeedbackSource::Rotors(rotors, speeds) => Some(rotors.wrench(speeds, scale)),
            _ => None,
        };
        let filters = match &turned {
            Some(_) => self.filters_beside(state, &axis, &force, acceleration_max),
            None => self.memory.filters,
        };
        let feedback = self.feedback(state, reference, &filters, &force, acceleration_max, source);
        let direction = self.direction_command(reference, &filters, &feedback, acceleration_max);
        let errors = self.attitude_errors(state, reference, &direction, &self.late(scale, &bias, &pending));
        let tilt = self.tilt_torque(state, &direction, &errors, &bias, scale);
        let motion = direction.desired.motion_of_direction(&direction.turn.rate, &tilt.turn, &reference.heading);
        // Inputs in range can overflow together, on a reference that all but cancels gravity.
        if !motion.is_in_range() {
            self.memory.suspicion = suspicion;
            return Err(InputError::OutOfRange { field: "reference" });
        }

        // Nothing can fail from here on: every part of the memory advances as soon as its last value has served.
        let drive = self.drive(&feedback, &direction, &tilt, acceleration_max);
        self.memory.filters = self.position_law().advance(&filters, &feedback.smoothed, &drive, acceleration_max);
        self.memory.averages = averages;
        self.memory.lift = Some(errors.lifted.lift);
        self.memory.side = Some(errors.tilt.side);
        let counts = matches!(source, FeedbackSource::Law(_));
        if counts && self.memory.fallback.observe(&feedback.errors.position, &feedback.errors.velocity, self.period) {
            cold_path();
            self.memory.filters = Filters::at(-force);
        }

        let yaw = self.yaw_torque(&state.angular_velocity, &errors, &motion, bias.z);
        let along = self.vehicle.mass * direction.length * direction.command.dot(&axis) / direction.turn.magnitude;
        let (own, yaw_torque_left) = self.range.limited(along, &tilt.torque, [yaw.torque, yaw.braking], scale);
        let wrench = turned.unwrap_or(own);
        self.memory.yaw_torque_left = yaw_torque_left;
        self.memory.wrench_offset = lasting;
        let forward = Vector3::new(tilt.acceleration.x, tilt.acceleration.y, yaw.forward);
        self.remember(state, axis, forward, &wrench, scale);
        Ok((wrench, Self::diagnostics(&filters, &feedback, &direction, &errors, &tilt, &motion)))
    }

    /// What the next tick needs of this one.
    #[inline(always)]
    fn remember(
        &mut self,
        state: &State,
        thrust_axis: Vector3<f32>,
        forward: Vector3<f32>,
        wrench: &Wrench,
        scale: f32,
    ) {
        if let Some(changed) = self.changed {
            cold_path();
            self.learning = changed;
            self.changed = None;
        }
        let memory = &mut self.memory;
        memory.held = memory.held.saturating_sub(1);
        memory.without_velocity = memory.without_velocity.saturating_sub(1);
        let State { velocity, angular_velocity, .. } = *state;
        memory.last = Some(LastTick { velocity, thrust_axis, angular_velocity, forward });
        let Wrench { thrust, torque } = *wrench;
        memory.actuators.command(Vector4::new(thrust, torque.x, torque.y, torque.z) * (1.0 / scale));
        memory.acted = self.actuators.advance(&mut memory.actuators);
    }
}

/// R e3 of a quaternion near unit length.
fn thrust_axis(q: &Quaternion<f32>) -> Vector3<f32> {
    let double = 2.0 / length_squared(q);
    Vector3::new(
        double * (q.i * q.k + q.w * q.j),
        double * (q.j * q.k - q.w * q.i),
        1.0 - double * (q.i * q.i + q.j * q.j),
    )
}

mod building;
mod forecast;
mod sections;
mod without_a_rotor;

pub use forecast::{FlownBy, StoppingForecast};

#[cfg(test)]
mod tests;
