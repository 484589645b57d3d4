//! One step of the extended law: state and reference in, wrench out.
//!
//! ```text
//! what happened since the last tick -> learning (thrust_scale, force, torque_bias)
//! State, Reference -> position -> attitude_reference -> path_lifting -> attitude (feedback) -> budget -> turning
//!                  -> heading -> attitude (torque) -> thrust_range -> Wrench
//! ```
//!
//! The order within a tick: what can be refused first, up to the desired motion, from filters and generators as they
//! stand and with the averages that have taken in what happened. Nothing is remembered before that. From there on every
//! part of the memory advances by one period as soon as its last value has served. So the wrench is the one for the
//! instant the state was taken, as in the paper's [`controller`](crate::controller).

use super::actuators::ActuatorModel;
use super::attitude::{AttitudeLaw, Late};
use super::budget::TurningBudget;
use super::demand::Demand;
use super::heading::{self, HeadingLag};
use super::learning::Learning;
use super::memory::{Averages, Estimates, Last, Memory};
use super::position::{Filters, Most, PositionLaw};
use super::thrust_range::ThrustRange;
use super::turning::{Circumstances, TurningLimit};
use crate::allocation::Rotors;
use crate::attitude::rotate_back;
use crate::attitude_reference::DesiredAttitude;
use crate::configuration::ExtendedLaw;
use crate::controller::Diagnostics;
use crate::error::InputError;
use crate::math;
use crate::path_lifting;
use crate::reference::{DERIVATIVE_RANGE, Reference};
use crate::state::{State, Wrench, length_squared};
use crate::vehicle::{Limits, Vehicle};
use core::hint::cold_path;
use nalgebra::{Quaternion, Vector3, Vector4};

/// Where ubar comes from.
enum Wanted<'a> {
    /// The law, with these levels at most.
    Feedback(&'a Most),
    /// A policy.
    Demand(&'a Demand),
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
    /// U for each unit of s, the part that bias and yaw use up, and the greatest U, m/s^2.
    greatest: [f32; 3],
    /// Lag and delay of the actuators together, s.
    late: f32,
    position: PositionLaw,
    attitude: AttitudeLaw,
    budget: TurningBudget,
    turning: TurningLimit,
    /// For the interval since the last tick.
    learning: Learning,
    /// For the next interval, if its length differs.
    changed: Option<Learning>,
    range: ThrustRange,
    actuators: ActuatorModel,
    /// Ticks for which the wrench that acts still depends on one that was not delivered.
    settling: u32,
    memory: Memory,
}

impl Controller {
    /// Filters to zero, path lifted anew, no lag in heading, nothing estimated: how a flight begins.
    pub fn reset(&mut self) {
        let averages = Averages::known(Vector3::zeros(), 1.0);
        self.memory = Memory::fresh(&self.vehicle, averages);
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

    /// The estimated thrust scale, delivered over commanded: the caller divides the wrench by it before commanding
    /// rotors.
    #[must_use]
    pub fn thrust_scale(&self) -> f32 {
        self.memory.averages.scale.scale
    }

    /// The law's memory.
    #[must_use]
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// The estimates; force and torque bias cut to their levels.
    #[must_use]
    pub fn estimates(&self) -> Estimates {
        self.learning.believed(&self.memory.averages)
    }

    /// One tick of the law.
    ///
    /// # Errors
    /// [`InputError`] names the field of `state` or `reference` that is not finite, out of range, not a rotation, or
    /// (the reference's acceleration) falls faster than the thrust direction allows. The memory is then unchanged.
    // Always inlined: diagnostics that a caller does not read then cost it nothing.
    #[inline(always)]
    pub fn step(&mut self, state: &State, reference: &Reference) -> Result<(Wrench, Diagnostics), InputError> {
        self.tick(state, reference, &Wanted::Feedback(&Most::ALL))
    }

    /// One tick with a demand in place of the position law's feedback. The reference gives the heading, and where the
    /// errors in the diagnostics are counted from; it has to be at rest. The net does not count.
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
        self.shielded_tick(state, reference, &Wanted::Demand(demand))
    }

    /// One tick whose feedback has levels of at most `most`. Every theorem on feedback holds for lower levels as well.
    ///
    /// # Errors
    /// As [`Self::step`]'s.
    pub fn step_within(
        &mut self,
        state: &State,
        reference: &Reference,
        most: &Most,
    ) -> Result<(Wrench, Diagnostics), InputError> {
        self.shielded_tick(state, reference, &Wanted::Feedback(most))
    }

    /// Behind a shield: compiled once for both.
    #[inline(never)]
    fn shielded_tick(
        &mut self,
        state: &State,
        reference: &Reference,
        wanted: &Wanted,
    ) -> Result<(Wrench, Diagnostics), InputError> {
        self.tick(state, reference, wanted)
    }

    #[inline(always)]
    fn tick(
        &mut self,
        state: &State,
        reference: &Reference,
        wanted: &Wanted,
    ) -> Result<(Wrench, Diagnostics), InputError> {
        self.admit(state, reference)?;
        let axis = thrust_axis(&state.attitude);
        let learnt = self.learning.learnt(&self.memory, state, &axis);
        let Estimates { force, torque: bias, scale } = self.learning.believed(&learnt);

        let mut net = self.memory.net;
        let counts = matches!(wanted, Wanted::Feedback(_));
        let catches = counts && net.catches();
        let filters = if catches { Filters::at(-force) } else { self.memory.filters };
        let greatest = self.greatest(scale);
        let feedback = match wanted {
            Wanted::Feedback(most) => {
                let most = if net.is_caught() { self.position.net() } else { **most };
                self.position.feedback(state, reference, &filters, &force, greatest, &most)
            }
            Wanted::Demand(demand) => {
                let wanted = self.wanted(state, demand, &force);
                self.position.demanded(state, reference, &filters, &force, greatest, &wanted)
            }
        };
        let command = self.acceleration_command(reference, &filters.command);
        let wanted = (feedback.drive - feedback.rate) * self.position.k_f();
        let jerk = self.with_drag(&reference.jerk, &reference.acceleration) + feedback.rate;
        let snap = self.with_drag(&reference.snap, &reference.jerk) + wanted;
        let desired = DesiredAttitude::new(&command, &reference.heading);
        let turn = desired.turn(&jerk, &snap);
        let yaw_rate = desired.yaw_rate(&turn.rate, &reference.heading);
        let lag = self.memory.heading.unwrap_or_else(|| HeadingLag::none(yaw_rate, &self.law.parameters));
        let velocity = heading::velocity(&lag, &Vector3::new(-turn.rate.y, turn.rate.x, yaw_rate));

        let error = lag.turned_back(&desired.error(&state.attitude));
        let rate = rotate_back(&error, &velocity);
        let angular_velocity_error = state.angular_velocity - rate;
        let (projected, projected_rate) =
            self.attitude.projected(&error, &angular_velocity_error, &self.late(scale, &bias));
        let lifted =
            path_lifting::lift(self.memory.lift.as_ref(), &projected, self.switching_scalar, self.law.parameters.alpha);
        let torques = self.attitude.feedback(&lifted.quaternion, &projected_rate);

        let limited = self.turning.limited(
            &turn,
            &Circumstances {
                budget: self.budget.acceleration(turn.magnitude, torques.tilt(), sine_of_tilt(&error)),
                yaw_rate: velocity.z,
                up: desired.up(),
                greatest,
                vertical: [filters.command.z, feedback.rate.z, wanted.z],
            },
        );
        let papers = desired.motion_of(&turn.rate, &limited.acceleration, &reference.heading);
        // Inputs in range can overflow together, on a reference that all but cancels gravity.
        if !papers.is_in_range() {
            return Err(InputError::OutOfRange { field: "reference" });
        }

        // Nothing can fail from here on: every part of the memory advances as soon as its last value has served.
        let drive = match limited.change {
            None => feedback.drive,
            Some(change) => {
                cold_path();
                feedback.drive + desired.turned(&change) * (1.0 / self.position.k_f())
            }
        };
        self.memory.filters = self.position.advance(&filters, &feedback.smoothed, &drive);
        self.memory.averages = learnt;
        let turning = heading::turning(&lag, &papers, &self.law.parameters, self.period);
        self.memory.heading = Some(heading::advanced(&lag, &turning, self.period, limited.yaw_rate));
        self.memory.lift = Some(lifted.lift);

        let acceleration = rotate_back(&error, &turning.acceleration);
        let torque = self.attitude.torque(&torques, &rate, &acceleration) - bias;
        let along = self.vehicle.mass * command.dot(&axis);
        let thrust = self.range.admitted(along, &torque, scale);
        if counts {
            net.observe(
                &feedback.errors.z_1,
                &feedback.errors.z_2,
                limited.change.is_some() || thrust < along,
                self.period,
            );
        }

        if let Some(changed) = self.changed {
            cold_path();
            self.learning = changed;
            self.changed = None;
        }
        let memory = &mut self.memory;
        memory.net = net;
        memory.held = memory.held.saturating_sub(1);
        memory.last = Some(Last {
            velocity: state.velocity,
            thrust_axis: axis,
            angular_velocity: state.angular_velocity,
            wanted: acceleration,
        });
        memory.actuators.command(Vector4::new(thrust, torque.x, torque.y, torque.z) * (1.0 / scale));
        memory.acted = self.actuators.advance(&mut memory.actuators);

        let diagnostics = Diagnostics {
            position_error: feedback.errors.position,
            velocity_error: feedback.errors.velocity,
            z_1: feedback.errors.z_1,
            z_2: feedback.errors.z_2,
            feedback: feedback.feedback,
            filtered: filters.command,
            intermediate: filters.intermediate,
            acceleration_command: command,
            desired_attitude: desired.attitude(),
            desired_angular_velocity: turning.velocity,
            desired_angular_acceleration: turning.acceleration,
            attitude_error: lifted.quaternion,
            mrp: lifted.mrp,
            lift_sign: lifted.lift.sign,
            angular_velocity_error: projected_rate,
            attitude_feedback: torques.potential,
            rate_feedback: torques.damping,
        };
        Ok((Wrench { thrust, torque }, diagnostics))
    }

    /// U for a thrust scale, m/s^2.
    #[inline(always)]
    fn greatest(&self, scale: f32) -> f32 {
        let [each, taken, most] = self.greatest;
        math::lesser(scale * each - taken, most)
    }

    /// ubar for a demand, before it is cut to the envelope, m/s^2.
    fn wanted(&self, state: &State, demand: &Demand, force: &Vector3<f32>) -> Vector3<f32> {
        match demand {
            // v' = c - kappa v_h + D for a reference at rest.
            Demand::Acceleration { acceleration, .. } => self.with_drag(acceleration, &state.velocity) - force,
            Demand::Attitude { attitude, thrust } => {
                let mut wanted = thrust_axis(attitude) * (thrust / self.vehicle.mass);
                wanted.z -= self.vehicle.gravity;
                wanted
            }
        }
    }

    /// The part of past commands that has not acted yet, for the current thrust scale and torque bias.
    #[inline(always)] // see position.rs
    fn late(&self, scale: f32, bias: &Vector3<f32>) -> Late {
        let pending = self.actuators.pending(&self.memory.actuators);
        let impulse = Vector3::new(pending.y, pending.z, pending.w) * scale + bias * self.late;
        let wanted = self.memory.last.as_ref().map_or_else(Vector3::zeros, |last| last.wanted);
        Late { time: self.late, impulse, wanted }
    }

    /// u = c + g e3 + p_d'' + kappa p_d'.
    fn acceleration_command(&self, reference: &Reference, c: &Vector3<f32>) -> Vector3<f32> {
        let mut command = self.with_drag(&reference.acceleration, &reference.velocity) + c;
        command.z += self.vehicle.gravity;
        command
    }

    /// A derivative of the reference plus the drag from the next lower derivative.
    fn with_drag(&self, derivative: &Vector3<f32>, below: &Vector3<f32>) -> Vector3<f32> {
        let drag = self.law.parameters.drag_across;
        Vector3::new(derivative.x + drag * below.x, derivative.y + drag * below.y, derivative.z)
    }

    /// Refuses inputs for which the law is undefined. Nearly every input passes the first comparison.
    #[inline(always)] // see position.rs
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

/// The sine of the angle from b to rho, one beyond a right angle, of an error quaternion of any length.
fn sine_of_tilt(q: &Quaternion<f32>) -> f32 {
    let (across, along) = (q.i * q.i + q.j * q.j, q.w * q.w + q.k * q.k);
    if across >= along { 1.0 } else { 2.0 * math::sqrt(across * along) / (across + along) }
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
mod prospect;

pub use prospect::Prospect;

#[cfg(test)]
mod tests;
