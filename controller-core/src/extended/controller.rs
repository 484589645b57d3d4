//! One step of the extended law: state and reference in, wrench out.
//!
//! ```text
//! what happened since the last tick -> force, torque_bias, thrust_scale
//! State, Reference -> position -> attitude_reference -> heading -> path_lifting -> attitude -> thrust_floor -> Wrench
//! ```
//!
//! The order within a tick: what can be refused first, up to the desired motion, from filters and generators as they stand and
//! with the averages that have taken in what happened. Nothing is remembered before that. From there on every part of the memory
//! advances by one period as soon as its last value has served. So the wrench is the one for the instant the state was taken, as
//! in the paper's [`controller`](crate::controller).

use super::actuators::ActuatorModel;
use super::attitude::{AttitudeLaw, AttitudeTorque};
use super::force::{ForceEstimate, ForceGenerator, ForceObserver};
use super::heading::{self, HeadingLag};
use super::memory::{Estimates, Last, Memory};
use super::parameters::{AttitudeParameters, EstimateParameters, Extended};
use super::position::PositionLaw;
use super::thrust_floor::ThrustFloor;
use super::thrust_scale::ThrustScale;
use super::torque_bias::TorqueBias;
use crate::allocation::Rotors;
use crate::attitude_reference::DesiredAttitude;
use crate::certificate::certified::Certified;
use crate::certificate::configuration::{ExtendedLaw, LawParameters};
use crate::controller::{Command, Diagnostics};
use crate::error::{InputError, ParameterError, Reason, require, require_positive};
use crate::path_lifting;
use crate::position::{FilterState, FilterTransition};
use crate::reference::{DERIVATIVE_RANGE, Reference};
use crate::state::{State, Wrench, length_squared};
use crate::vehicle::Vehicle;
use core::hint::cold_path;
use nalgebra::{Quaternion, Vector3, Vector4};

/// What the estimates learn of an interval with. That is the one since the last tick, and not the one to come, where a period
/// has been changed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Learning {
    force: ForceObserver,
    torque: TorqueBias,
    scale: ThrustScale,
}

impl Learning {
    fn new(estimates: &EstimateParameters, vehicle: &Vehicle, period: f32) -> Self {
        Self {
            force: ForceObserver::new(estimates, vehicle.gravity, period),
            torque: TorqueBias::new(estimates, &vehicle.inertia, period),
            scale: ThrustScale::new(estimates, period),
        }
    }
}

/// The extended law for one vehicle, one set of constants and one period.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    vehicle: Vehicle,
    law: ExtendedLaw,
    rotors: Option<Rotors>,
    parameters: Extended,
    period: f32,
    per_mass: f32,
    switching_scalar: f32,
    /// M_z- + D_z - g: the reference's vertical acceleration stays above it, m/s^2.
    steepest_fall: f32,
    position: PositionLaw,
    force: ForceGenerator,
    attitude: AttitudeLaw,
    /// Of the interval since the last tick.
    learning: Learning,
    /// Of the one to come, if it is another.
    changed: Option<Learning>,
    floor: ThrustFloor,
    actuators: ActuatorModel,
    /// Ticks for which the wrench that acts still depends on one that was not delivered.
    settling: u32,
    memory: Memory,
}

impl Controller {
    /// A controller for a certified configuration of this law, as after a reset. `period` is the time between steps, s, in
    /// (0, 0.1].
    ///
    /// # Errors
    /// Names `control.period` if it is outside, `estimates.force_bandwidth_…`, `gains.c_1`, `gains.c_2` or `sampling.delay` if it is
    /// beyond what they allow, `control.law` if the configuration's is another.
    pub fn new(certified: &Certified, period: f32) -> Result<Self, ParameterError> {
        let configuration = certified.configuration();
        let LawParameters::Extended(law) = configuration.law() else {
            return Err(ParameterError { field: "control.law", reason: Reason::OtherLaw });
        };
        Self::build(configuration.vehicle(), law, configuration.rotors(), period)
    }

    pub(crate) fn build(
        vehicle: &Vehicle,
        law: &ExtendedLaw,
        rotors: Option<&Rotors>,
        period: f32,
    ) -> Result<Self, ParameterError> {
        let ExtendedLaw { parameters, actuators } = law;
        require_positive(period, "control.period")?;
        let longest = FilterTransition::LONGEST_PERIOD;
        require(period <= longest, "control.period", Reason::Above(longest))?;
        Self::check_period(parameters, period)?;
        let p = &parameters.position;
        Ok(Self {
            vehicle: *vehicle,
            law: *law,
            rotors: rotors.cloned(),
            parameters: *parameters,
            period,
            per_mass: 1.0 / vehicle.mass,
            switching_scalar: path_lifting::switching_scalar(parameters.attitude.delta),
            steepest_fall: p.m_down + parameters.estimates.force_vertical - vehicle.gravity,
            position: PositionLaw::new(p, period)?,
            force: ForceGenerator::new(&parameters.estimates, period)?,
            attitude: AttitudeLaw::new(&parameters.attitude, &vehicle.inertia),
            learning: Learning::new(&parameters.estimates, vehicle, period),
            changed: None,
            floor: ThrustFloor::new(rotors, parameters.floor_margin),
            actuators: ActuatorModel::new(actuators, period)?,
            settling: actuators.settling(period),
            memory: Memory::fresh(vehicle, Estimates::NONE),
        })
    }

    /// Checks what is defined for ticks that are not too long only: the generators of the force and of the heading, `period` in s.
    ///
    /// # Errors
    /// Names `estimates.force_bandwidth_…`, `gains.c_1` or `gains.c_2`.
    pub fn check_period(parameters: &Extended, period: f32) -> Result<(), ParameterError> {
        ForceGenerator::check(&parameters.estimates, period)?;
        heading::check(&parameters.heading, period)
    }

    /// Filters to zero, path lifted anew, no lag in heading, nothing estimated: how a flight begins.
    pub fn reset(&mut self) {
        self.memory = Memory::fresh(&self.vehicle, Estimates::NONE);
    }

    /// The same with what has been estimated of the vehicle itself kept, torque and thrust scale: how a flight goes on without a
    /// pose. The force is forgotten: it came from velocities that are no longer known.
    pub fn restart(&mut self) {
        let estimates = Estimates { force: ForceEstimate::NONE, ..self.memory.estimates };
        self.memory = Memory::fresh(&self.vehicle, estimates);
    }

    /// Keeps the estimates as they are until the wrench that acts no longer depends on the last one commanded. For every tick on
    /// the ground, without a velocity, or of which the rotors could not deliver the wrench.
    pub fn hold_estimates(&mut self) {
        self.memory.held = self.settling;
    }

    /// What the rotors deliver of what is commanded, as far as it is known: they are to be asked for a wrench divided by it.
    #[must_use]
    pub fn thrust_scale(&self) -> f32 {
        self.memory.estimates.scale
    }

    /// Changes the time to the next step, s, and from there on.
    ///
    /// # Errors
    /// As [`Self::new`]; the period then stays what it was.
    pub fn set_period(&mut self, period: f32) -> Result<(), ParameterError> {
        let rebuilt = Self::build(&self.vehicle, &self.law, self.rotors.as_ref(), period)?;
        *self = Self { memory: self.memory, learning: self.learning, changed: Some(rebuilt.learning), ..rebuilt };
        Ok(())
    }

    /// What the law remembers.
    #[must_use]
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// What has been estimated; the torque bias as far as it is believed.
    #[must_use]
    pub fn estimates(&self) -> Estimates {
        let estimates = self.memory.estimates;
        Estimates { torque: self.learning.torque.estimate(&estimates.torque), ..estimates }
    }

    /// [`Self::step`] as it is flown: compiled once, in this crate, however small its callers are compiled.
    ///
    /// # Errors
    /// As [`Self::step`].
    #[inline(never)]
    pub fn command(&mut self, state: &State, reference: &Reference) -> Result<Command, InputError> {
        let (wrench, Diagnostics { mrp, .. }) = self.step(state, reference)?;
        Ok(Command { wrench, mrp })
    }

    /// One tick of the law.
    ///
    /// # Errors
    /// [`InputError`] names the field of `state` or `reference` that is not finite, out of range, not a rotation, or (the
    /// reference's acceleration) falls faster than the thrust direction allows. The memory is then unchanged.
    // Always inlined: diagnostics that a caller does not read then cost it nothing.
    #[inline(always)]
    pub fn step(&mut self, state: &State, reference: &Reference) -> Result<(Wrench, Diagnostics), InputError> {
        self.admit(state, reference)?;
        let filter = self.memory.filter;
        let axis = thrust_axis(&state.attitude);
        let (force, scale) = self.force_and_scale(state, &axis);

        let feedback = self.position.feedback(state, reference, &filter);
        let force_acceleration = self.force.acceleration(&force);
        let command = self.acceleration_command(reference, &filter, &force);
        let jerk = self.with_drag(&reference.jerk, &reference.acceleration) + feedback.filtered_rate - force.rate;
        let snap =
            self.with_drag(&reference.snap, &reference.jerk) + feedback.filtered_acceleration - force_acceleration;
        let desired = DesiredAttitude::new(&command, &reference.heading);
        let papers = desired.motion(&jerk, &snap, &reference.heading);
        // Inputs in range can overflow together, on a reference that all but cancels gravity.
        if !papers.is_in_range() {
            return Err(InputError::OutOfRange { field: "reference" });
        }

        // Nothing can fail from here on: every part of the memory advances as soon as its last value has served.
        self.memory.filter = self.position.advance(&filter, &feedback.feedback);
        self.memory.estimates.force = self.force.advanced(&force, &force_acceleration);
        self.memory.estimates.scale = scale;

        let heading = self.memory.heading;
        let heading = heading.unwrap_or_else(|| HeadingLag::none(papers.velocity.z, &self.parameters.heading));
        let turning = heading::turning(&heading, &papers, &self.parameters.heading, self.period);
        self.memory.heading = Some(heading::advanced(&heading, &turning, self.period));

        let error = heading.turned_back(&desired.error(&state.attitude));
        let AttitudeParameters { alpha, .. } = self.parameters.attitude;
        let lifted = path_lifting::lift(self.memory.lift.as_ref(), &error, self.switching_scalar, alpha);
        self.memory.lift = Some(lifted.lift);

        let AttitudeTorque { angular_velocity_error, potential, damping, torque } =
            self.attitude.torque(&lifted.quaternion, &state.angular_velocity, &turning.velocity, &turning.acceleration);
        let average = self.torque_average(state, scale);
        self.memory.estimates.torque = average;
        let torque = torque - self.learning.torque.estimate(&average);
        let along = self.vehicle.mass * command.dot(&axis);
        let thrust = self.floor.raised(along, &torque, scale);

        if let Some(changed) = self.changed {
            cold_path();
            self.learning = changed;
            self.changed = None;
        }
        let memory = &mut self.memory;
        memory.held = memory.held.saturating_sub(1);
        memory.last =
            Some(Last { velocity: state.velocity, thrust_axis: axis, angular_velocity: state.angular_velocity });
        memory.actuators.command(Vector4::new(thrust, torque.x, torque.y, torque.z) * (1.0 / scale));
        memory.acted = self.actuators.advance(&mut memory.actuators);

        let diagnostics = Diagnostics {
            position_error: feedback.position_error,
            velocity_error: feedback.velocity_error,
            z_1: feedback.z_1,
            z_2: feedback.z_2,
            feedback: feedback.feedback,
            filtered: filter.filtered,
            intermediate: filter.intermediate,
            acceleration_command: command,
            desired_attitude: desired.attitude(),
            desired_angular_velocity: turning.velocity,
            desired_angular_acceleration: turning.acceleration,
            attitude_error: lifted.quaternion,
            mrp: lifted.mrp,
            lift_sign: lifted.lift.sign,
            angular_velocity_error,
            attitude_feedback: potential,
            rate_feedback: damping,
        };
        Ok((Wrench { thrust, torque }, diagnostics))
    }

    /// The last tick, if there is something to be learnt from what happened since.
    fn last(&self) -> Option<&Last> {
        self.memory.last.as_ref().filter(|_| self.memory.held == 0)
    }

    /// The estimates of the force and of the thrust scale with what happened since the last tick.
    fn force_and_scale(&self, state: &State, axis: &Vector3<f32>) -> (ForceEstimate, f32) {
        let Memory { estimates, acted, .. } = &self.memory;
        let Some(last) = self.last() else {
            return (estimates.force, estimates.scale);
        };
        let commanded = acted.x * self.per_mass;
        let thrust = (last.thrust_axis + axis) * (0.5 * commanded);
        let Learning { force: observer, scale: learner, .. } = &self.learning;
        let lift = observer.lift(&last.velocity, &state.velocity);
        let scale = learner.learnt(estimates.scale, commanded, thrust.z, lift);
        let force = observer.observed([&last.velocity, &state.velocity], &(thrust * scale));
        (observer.averaged(&estimates.force, &force), scale)
    }

    /// The average of the torque bias with what happened since the last tick.
    fn torque_average(&self, state: &State, scale: f32) -> Vector3<f32> {
        let Memory { estimates, acted, .. } = &self.memory;
        let Some(last) = self.last() else {
            return estimates.torque;
        };
        let torque = Vector3::new(acted.y, acted.z, acted.w) * scale;
        let learner = &self.learning.torque;
        let torque = learner.observed([&last.angular_velocity, &state.angular_velocity], &torque);
        learner.averaged(&estimates.torque, &torque)
    }

    /// u = u_f + g e3 + p_d'' + kappa p_d' - d.
    fn acceleration_command(&self, reference: &Reference, filter: &FilterState, force: &ForceEstimate) -> Vector3<f32> {
        let mut command = self.with_drag(&reference.acceleration, &reference.velocity) + filter.filtered - force.value;
        command.z += self.vehicle.gravity;
        command
    }

    /// A derivative of the reference with the drag that the one below it makes.
    fn with_drag(&self, derivative: &Vector3<f32>, below: &Vector3<f32>) -> Vector3<f32> {
        let drag = self.parameters.estimates.drag_across;
        Vector3::new(derivative.x + drag * below.x, derivative.y + drag * below.y, derivative.z)
    }

    /// Refuses what the law cannot be evaluated for. Nearly every input passes at a glance.
    fn admit(&self, state: &State, reference: &Reference) -> Result<(), InputError> {
        let small = state.squares() + reference.squares() <= DERIVATIVE_RANGE * DERIVATIVE_RANGE;
        let climbs = reference.acceleration.z > self.steepest_fall;
        if small & climbs & state.has_unit_attitude() { Ok(()) } else { self.examine(state, reference) }
    }

    #[cold]
    #[inline(never)]
    fn examine(&self, state: &State, reference: &Reference) -> Result<(), InputError> {
        state.check()?;
        reference.check()?;
        if reference.acceleration.z > self.steepest_fall { Ok(()) } else { Err(InputError::FallsTooFast) }
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

#[cfg(test)]
mod tests;
