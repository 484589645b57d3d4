//! The parts of a tick, by the sections of `docs/extended-law.md`.

use super::{Controller, FeedbackSource, PastCommands};
use crate::attitude::rotate_back;
use crate::attitude_reference::{AngularMotion, DesiredAttitude, DirectionMotion};
use crate::controller::Diagnostics;
use crate::extended::attitude::{Late, Tilt};
use crate::extended::budget::TORQUE_THRUST_SHARE;
use crate::extended::demand::Demand;
use crate::extended::memory::Memory;
use crate::extended::position::{Filters, PositionFeedback, PositionLaw};
use crate::math;
use crate::path_lifting::{self, Lifted};
use crate::reference::Reference;
use crate::state::{State, Wrench};
use core::hint::cold_path;
use nalgebra::{Quaternion, Vector2, Vector3, Vector4};

/// The least share of M_theta that a bias leaves.
const LEVEL_SHARE_MIN: f32 = 0.05;

/// The least cosine of a tilt by which a lift is divided; what is beyond the envelope is cut anyway.
const UPRIGHT_COSINE_MIN: f32 = 0.1;

/// Where u points, and how it would turn.
pub(super) struct DirectionCommand {
    /// u, m/s^2.
    pub command: Vector3<f32>,
    /// n*, m/s^2: the length that the thrust takes.
    pub length: f32,
    pub desired: DesiredAttitude,
    pub turn: DirectionMotion,
    /// e3 in the axes of the desired frame.
    pub up: Vector3<f32>,
    /// c_z, c_z' and the desired c_z'', m/s^2, m/s^3, m/s^4.
    pub vertical: [f32; 3],
}

/// The attitude's errors. Angular velocities in rad/s, body frame.
pub(super) struct AttitudeErrors {
    /// R~ along R_d^T R, of any length.
    pub error: Quaternion<f32>,
    /// r, which turns rho, and f, which turns the desired frame.
    pub turning: Vector3<f32>,
    pub frame: Vector3<f32>,
    /// omega~_12, as it is and projected.
    pub rate: Vector2<f32>,
    pub projected: Vector2<f32>,
    /// omega_3 - f_3, projected.
    pub projected_yaw: f32,
    pub lifted: Lifted,
    pub tilt: Tilt,
}

/// The torque about the tilt's axes, N m, with its feedback.
pub(super) struct TiltTorque {
    pub torque: Vector2<f32>,
    /// P and lambda D.
    pub potential: Vector2<f32>,
    pub damping: Vector2<f32>,
    /// q as rho turns, rad/s^2.
    pub turn: Vector2<f32>,
    /// R^T omega_rho', rad/s^2.
    pub acceleration: Vector3<f32>,
}

/// The torque about z, N m, before it is limited.
pub(super) struct YawTorque {
    pub torque: f32,
    /// What comes before thrust.
    pub braking: f32,
    /// The acceleration fed forward, rad/s^2.
    pub forward: f32,
}

impl Controller {
    /// The position law in force.
    #[inline(always)]
    pub(super) fn position_law(&self) -> &PositionLaw {
        if self.memory.fallback.is_slow() { &self.slowed } else { &self.position }
    }

    /// Section 1: ubar, and the drive for it.
    #[inline(always)]
    pub(super) fn feedback(
        &self,
        state: &State,
        reference: &Reference,
        filters: &Filters,
        force: &Vector3<f32>,
        acceleration_max: f32,
        source: &FeedbackSource,
    ) -> PositionFeedback {
        let law = self.position_law();
        match source {
            FeedbackSource::Law(limits) => {
                let limits = if self.memory.fallback.is_slow() { &self.slow } else { *limits };
                law.feedback(state, reference, filters, force, acceleration_max, limits)
            }
            FeedbackSource::Policy(demand) => {
                let feedback = self.demanded_feedback(state, demand, force);
                law.feedback_on_demand(state, reference, filters, force, acceleration_max, &feedback)
            }
            FeedbackSource::Rotors(..) => {
                law.feedback_on_demand(state, reference, filters, force, acceleration_max, &filters.smoothed)
            }
        }
    }

    /// c, x and y as the law would have them if it had pointed the thrust where the vehicle does, turned it across as
    /// the vehicle turns, and held the height: the law begins with the lift that holds, not with what flew before.
    pub(super) fn filters_beside(
        &self,
        state: &State,
        axis: &Vector3<f32>,
        force: &Vector3<f32>,
        acceleration_max: f32,
    ) -> Filters {
        let lift = self.vehicle.gravity - force.z;
        let mut wanted = axis * (lift / math::max(axis.z, UPRIGHT_COSINE_MIN));
        let turning = rotate_back(&state.attitude.conjugate(), &state.angular_velocity).cross(&wanted);
        wanted.z = -force.z;
        self.position_law().filters_at(&wanted, &Vector3::new(turning.x, turning.y, 0.0), acceleration_max)
    }

    /// Section 3: where u points, and how it would turn.
    #[inline(always)]
    pub(super) fn direction_command(
        &self,
        reference: &Reference,
        filters: &Filters,
        feedback: &PositionFeedback,
        acceleration_max: f32,
    ) -> DirectionCommand {
        let command = self.acceleration_command(reference, &filters.command);
        let desired_bend = (feedback.drive - feedback.rate) * self.position_law().k_f();
        let jerk = self.with_drag(&reference.jerk, &reference.acceleration) + feedback.rate;
        let snap = self.with_drag(&reference.snap, &reference.jerk) + desired_bend;
        let desired = DesiredAttitude::new(&command, &reference.heading);
        let turn = desired.direction_motion(&jerk, &snap);
        let vertical = [filters.command.z, feedback.rate.z, desired_bend.z];
        let up = desired.up();
        let length =
            self.turning.length(turn.magnitude, feedback.smoothed.z - filters.command.z, &up, acceleration_max);
        DirectionCommand { command, length, up, desired, turn, vertical }
    }

    /// Sections 5 and 6: the attitude's errors, projected over what is late.
    #[inline(always)]
    pub(super) fn attitude_errors(
        &self,
        state: &State,
        reference: &Reference,
        direction: &DirectionCommand,
        late: &Late,
    ) -> AttitudeErrors {
        let DirectionCommand { desired, turn, .. } = direction;
        let error = desired.error(&state.attitude);
        let yaw_rate = desired.yaw_rate(&turn.rate, &reference.heading);
        let turning = rotate_back(&error, &Vector3::new(-turn.rate.y, turn.rate.x, 0.0));
        let frame = rotate_back(&error, &Vector3::new(-turn.rate.y, turn.rate.x, yaw_rate));
        let (quaternion, projected) = self.attitude.projected(&error, &(state.angular_velocity - frame), late);
        let alpha = self.law.parameters.alpha;
        AttitudeErrors {
            error,
            turning,
            frame,
            rate: (state.angular_velocity - turning).xy(),
            projected: (projected + (frame - turning)).xy(),
            projected_yaw: projected.z,
            lifted: path_lifting::lift(self.memory.lift.as_ref(), &quaternion, self.switching_scalar, alpha),
            tilt: self.attitude.tilt(&quaternion, self.memory.side.as_ref()),
        }
    }

    /// Sections 3, 4 and 6: the torque about the tilt's axes, part by part.
    #[inline(always)]
    pub(super) fn tilt_torque(
        &self,
        state: &State,
        direction: &DirectionCommand,
        errors: &AttitudeErrors,
        bias: &Vector3<f32>,
        scale: f32,
    ) -> TiltTorque {
        let AttitudeErrors { error, turning, rate, projected, tilt, .. } = errors;
        let level_max = self.law.parameters.m_tilt;
        let mut spending = self.budget.spending(scale);
        let lean = bias.xy();
        spending.spend(&-lean, 0.0);
        let left = spending.radius() - math::sqrt(lean.norm_squared()) - self.reserve;
        let potential =
            self.attitude.potential(tilt, math::min(level_max, math::max(left, LEVEL_SHARE_MIN * level_max)));
        spending.spend(&-potential, self.reserve);
        spending.spend(&self.attitude.gyroscopic(turning, &state.angular_velocity, rate), self.reserve);
        let damping = self.attitude.damping(tilt, projected);
        let damping = damping * spending.spend(&-damping, self.reserve);
        spending.spend(&self.attitude.precession(&state.angular_velocity, rate), self.reserve);

        let q = self.turning.limited(&direction.turn, &direction.up);
        let acceleration = rotate_back(error, &Vector3::new(-q.y, q.x, 0.0));
        let torque = self.attitude.torque(&acceleration);
        let thrust = (1.0 - TORQUE_THRUST_SHARE as f32) * self.vehicle.mass * direction.length;
        let mut share = self.range.share(&spending.spent, &torque, thrust, scale);
        if share < 1.0 {
            cold_path();
            let always = self.law.parameters.turn_reserve / math::sqrt(q.norm_squared());
            share = math::max(share, math::min(always, 1.0));
        }
        share *= spending.spend(&(torque * share), 0.0);
        let (turn, acceleration) = if share < 1.0 { (q * share, acceleration * share) } else { (q, acceleration) };
        TiltTorque { torque: spending.spent, potential, damping, turn, acceleration }
    }

    /// Section 3: the drive for the turn as it is.
    #[inline(always)]
    pub(super) fn drive(
        &self,
        feedback: &PositionFeedback,
        direction: &DirectionCommand,
        tilt: &TiltTorque,
        acceleration_max: f32,
    ) -> Vector3<f32> {
        match self.turning.change(&direction.turn, &tilt.turn, &direction.up, acceleration_max, direction.vertical) {
            None => feedback.drive,
            Some(change) => {
                cold_path();
                feedback.drive + direction.desired.turned(&change) * (1.0 / self.position_law().k_f())
            }
        }
    }

    /// ubar for a demand, before it is cut to the envelope, m/s^2.
    fn demanded_feedback(&self, state: &State, demand: &Demand, force: &Vector3<f32>) -> Vector3<f32> {
        match demand {
            // v' = c - kappa v_h + D for a reference at rest.
            Demand::Acceleration { acceleration, .. } => self.with_drag(acceleration, &state.velocity) - force,
            Demand::Attitude { attitude, thrust } => {
                let mut feedback = super::thrust_axis(attitude) * (thrust / self.vehicle.mass);
                feedback.z -= self.vehicle.gravity;
                feedback
            }
            // Refused before.
            Demand::Rotors { .. } => -force,
        }
    }

    /// The yaw torque beside the bias, what of it brakes a spin, and the acceleration fed forward.
    #[inline(always)]
    pub(super) fn yaw_torque(
        &self,
        velocity: &Vector3<f32>,
        errors: &AttitudeErrors,
        motion: &AngularMotion,
        bias: f32,
    ) -> YawTorque {
        let acceleration = rotate_back(&errors.error, &motion.acceleration).z;
        let forward = self.heading.forward(&errors.frame, acceleration, velocity);
        let [angle, rate] = [2.0 * errors.lifted.quaternion.k, errors.projected_yaw];
        let torque = self.heading.torque(angle, rate, forward, velocity, self.memory.yaw_torque_left) - bias;
        YawTorque { torque, braking: self.heading.braking(torque, rate), forward }
    }

    /// The wrench of past commands: by the model, corrected by what was `measured` of it.
    #[inline(always)]
    pub(super) fn past_commands(&self, measured: Option<&Wrench>) -> PastCommands {
        let Memory { acted, wrench_offset: lasting, held, without_velocity: blind, ref actuators, .. } = self.memory;
        let pending = self.actuators.pending(actuators);
        let sensors = &self.learning.sensors;
        let Some([beside, slower]) =
            measured.and_then(|wrench| sensors.quick_difference(wrench, &acted, lasting.as_ref()))
        else {
            return PastCommands { acted, pending, lasting };
        };
        PastCommands {
            acted: acted + beside,
            pending: pending + beside * self.law.actuators.lag,
            // What was not delivered does not last.
            lasting: if held == 0 && blind == 0 { Some(slower) } else { lasting },
        }
    }

    /// The part of past commands that has not acted yet, for the current thrust scale and torque bias.
    #[inline(always)]
    pub(super) fn late(&self, scale: f32, bias: &Vector3<f32>, pending: &Vector4<f32>) -> Late {
        let impulse = Vector3::new(pending.y, pending.z, pending.w) * scale + bias * self.late;
        let forward = self.memory.last.as_ref().map_or_else(Vector3::zeros, |last| last.forward);
        Late { time: self.late, impulse, forward }
    }

    /// u = c + g e3 + p_d'' + kappa p_d'.
    pub(super) fn acceleration_command(&self, reference: &Reference, c: &Vector3<f32>) -> Vector3<f32> {
        let mut command = self.with_drag(&reference.acceleration, &reference.velocity) + c;
        command.z += self.vehicle.gravity;
        command
    }

    /// A derivative of the reference plus the drag from the next lower derivative.
    fn with_drag(&self, derivative: &Vector3<f32>, below: &Vector3<f32>) -> Vector3<f32> {
        let drag = self.law.parameters.drag_across;
        Vector3::new(derivative.x + drag * below.x, derivative.y + drag * below.y, derivative.z)
    }

    /// What a tick went through.
    #[inline(always)]
    pub(super) fn diagnostics(
        filters: &Filters,
        feedback: &PositionFeedback,
        direction: &DirectionCommand,
        errors: &AttitudeErrors,
        tilt: &TiltTorque,
        motion: &AngularMotion,
    ) -> Diagnostics {
        Diagnostics {
            position_error: feedback.errors.position,
            velocity_error: feedback.errors.velocity,
            z_1: feedback.errors.z_1,
            z_2: feedback.errors.z_2,
            feedback: feedback.feedback,
            filtered: filters.command,
            intermediate: filters.intermediate,
            acceleration_command: direction.command,
            desired_attitude: direction.desired.attitude(),
            desired_angular_velocity: motion.velocity,
            desired_angular_acceleration: motion.acceleration,
            attitude_error: errors.lifted.quaternion,
            mrp: errors.lifted.mrp,
            lift_sign: errors.lifted.lift.sign,
            angular_velocity_error: errors.projected.push(errors.projected_yaw),
            attitude_feedback: tilt.potential.push(0.0),
            rate_feedback: tilt.damping.push(0.0),
        }
    }
}
