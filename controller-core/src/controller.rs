//! The whole law as one step: state and reference in, wrench out.
//!
//! ```text
//! State, Reference -> position -> attitude_reference -> path_lifting -> attitude -> Wrench
//! ```
//!
//! T = m |u| (or its [projection](crate::projection) where that is turned on) and tau as in Section V. The step uses
//! the filters as they stand and then advances them by one period, so the wrench is the one for the instant the state
//! was taken. The only way a step can fail is an input it cannot use; then the memory is what it was before, and the
//! next good input is served as if the bad one had never come.
//!
//! ```
//! use controller_core::prelude::*;
//!
//! let vehicle = Vehicle::new(VehicleParameters {
//!     mass: 0.46, inertia: Vector3::new(2.24e-3, 2.9e-3, 5.3e-3), gravity: 9.81,
//! })?;
//! let gains = Gains::new(GainParameters {
//!     k_p: 9.0, k_v: 6.0, k_f: 2.0, k_s: 20.0, k_theta: 100.0, k_omega: 0.1,
//!     m_p: 2.0, m_theta: 0.206, m_omega: 0.045, delta: 0.02, alpha: 0.25,
//! }, &vehicle)?;
//! let hover = Hover::new(Vector3::new(0.0, 0.0, 2.0), Heading::FORWARD)?;
//! let torque_max = Vector3::repeat(0.5);
//! let limits = Limits::new(LimitParameters { thrust_max: 7.0, torque_max }, &vehicle)?;
//! let configuration = Configuration::new(vehicle, limits, gains, hover.bounds())?;
//! let certified = Certified::new(configuration).expect("Table I holds its limits");
//! let mut controller = Controller::new(&certified, 0.01)?;
//!
//! let upside_down = State {
//!     position: Vector3::zeros(),
//!     velocity: Vector3::zeros(),
//!     attitude: Quaternion::new(0.0, 1.0, 0.0, 0.0),
//!     angular_velocity: Vector3::zeros(),
//! };
//! let (wrench, _) = controller.step(&upside_down, &hover.at(0)).unwrap();
//! assert!((wrench.thrust - 0.46 * 9.81).abs() < 1e-5); // the filters start at zero
//! assert!((wrench.torque.x.abs() - 0.5 * 0.206).abs() < 1e-3); // and the roll torque at its bound
//! # Ok::<(), controller_core::error::ParameterError>(())
//! ```

use crate::attitude::{AttitudeLaw, TorqueCommand};
use crate::attitude_reference::DesiredAttitude;
use crate::error::{InputError, ParameterError};
use crate::gains::Gains;
use crate::path_lifting::{self, Lift};
use crate::position::{CommandRates, FilterState, FilterTransition, PositionLaw};
use crate::projection::projected_thrust;
use crate::reference::{Reference, admit};
use crate::state::{State, Wrench};
use crate::vehicle::Vehicle;
use nalgebra::{Quaternion, Vector3};

/// Everything the law remembers from one tick to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Memory {
    /// x_f, the filters' states.
    pub filter: FilterState,
    /// The path lifting's memory; none before the first step.
    pub lift: Option<Lift>,
}

impl Memory {
    /// What a reset leaves: x_f = 0, the path to be lifted anew.
    pub const RESET: Self = Self { filter: FilterState::ZERO, lift: None };
}

/// What a step went through, at the state it was given and before the filters advance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Diagnostics {
    /// p~ = p - p_d, m, world.
    pub position_error: Vector3<f32>,
    /// v~ = v - p_d', m/s, world.
    pub velocity_error: Vector3<f32>,
    /// z_1, m, world.
    pub z_1: Vector3<f32>,
    /// z_2, m/s, world.
    pub z_2: Vector3<f32>,
    /// ubar_p, m/s^2, world.
    pub feedback: Vector3<f32>,
    /// u_f as used, m/s^2, world.
    pub filtered: Vector3<f32>,
    /// u_s as used, m/s^2, world.
    pub intermediate: Vector3<f32>,
    /// u, m/s^2, world.
    pub acceleration_command: Vector3<f32>,
    /// R_d as a unit quaternion, body to world.
    pub desired_attitude: Quaternion<f32>,
    /// omega_d, rad/s, axes of the desired body frame.
    pub desired_angular_velocity: Vector3<f32>,
    /// omega_d', rad/s^2, axes of the desired body frame.
    pub desired_angular_acceleration: Vector3<f32>,
    /// m* Phi(q_hat, R~), unit quaternion.
    pub attitude_error: Quaternion<f32>,
    /// theta~.
    pub mrp: Vector3<f32>,
    /// m*: +1 or -1.
    pub lift_sign: f32,
    /// omega~, rad/s, body.
    pub angular_velocity_error: Vector3<f32>,
    /// s_theta, N m, body.
    pub attitude_feedback: Vector3<f32>,
    /// s_omega, N m, body.
    pub rate_feedback: Vector3<f32>,
}

impl Diagnostics {
    /// Of no error and no motion.
    pub(crate) const NONE: Self = {
        const ZERO: Vector3<f32> = Vector3::new(0.0, 0.0, 0.0);
        const LEVEL: Quaternion<f32> = Quaternion::new(1.0, 0.0, 0.0, 0.0);
        Self {
            position_error: ZERO,
            velocity_error: ZERO,
            z_1: ZERO,
            z_2: ZERO,
            feedback: ZERO,
            filtered: ZERO,
            intermediate: ZERO,
            acceleration_command: ZERO,
            desired_attitude: LEVEL,
            desired_angular_velocity: ZERO,
            desired_angular_acceleration: ZERO,
            attitude_error: LEVEL,
            mrp: ZERO,
            lift_sign: 1.0,
            angular_velocity_error: ZERO,
            attitude_feedback: ZERO,
            rate_feedback: ZERO,
        }
    };
}

/// The controller of the paper for one vehicle, one set of gains and one period.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    vehicle: Vehicle,
    gains: Gains,
    position_law: PositionLaw,
    attitude_law: AttitudeLaw,
    transition: FilterTransition,
    switching_scalar: f32,
    thrust_floor: Option<f32>,
    /// M_p - g: the reference's vertical acceleration stays above it, m/s^2.
    steepest_fall: f32,
    memory: Memory,
}

impl Controller {
    /// A controller for gains that nothing is proven about: for simulation, never for flight. `thrust_floor` in N turns
    /// the [projection](crate::projection) on.
    ///
    /// # Errors
    /// Names `control.period` if it is outside (0, 0.1] s.
    #[cfg(any(test, feature = "uncertified"))]
    pub fn uncertified(
        vehicle: Vehicle,
        gains: Gains,
        thrust_floor: Option<f32>,
        period: f32,
    ) -> Result<Self, ParameterError> {
        Self::build(vehicle, gains, thrust_floor, period)
    }

    pub(crate) fn build(
        vehicle: Vehicle,
        gains: Gains,
        thrust_floor: Option<f32>,
        period: f32,
    ) -> Result<Self, ParameterError> {
        let transition = FilterTransition::new(gains.k_f, gains.k_s, period)?;
        let switching_scalar = path_lifting::switching_scalar(gains.delta);
        let position_law = PositionLaw::new(&gains, vehicle.gravity);
        let attitude_law = AttitudeLaw::new(&gains, &vehicle.inertia);
        Ok(Self {
            vehicle,
            gains,
            position_law,
            attitude_law,
            transition,
            switching_scalar,
            thrust_floor,
            steepest_fall: gains.m_p - vehicle.gravity,
            memory: Memory::RESET,
        })
    }

    /// Changes the time by which the next steps advance the filters, s.
    ///
    /// # Errors
    /// Names `control.period` if it is outside (0, 0.1]; the period then stays what it was.
    pub fn set_period(&mut self, period: f32) -> Result<(), ParameterError> {
        self.transition = FilterTransition::new(self.gains.k_f, self.gains.k_s, period)?;
        Ok(())
    }

    /// Filters to zero, path lifted anew with m* = +1: the only way into flight.
    pub fn reset(&mut self) {
        self.memory = Memory::RESET;
    }

    /// What the law remembers.
    pub fn memory(&self) -> Memory {
        self.memory
    }

    /// Puts any memory in place, for experiments: the certificate covers only what follows a reset.
    #[cfg(any(test, feature = "uncertified"))]
    pub fn restore(&mut self, memory: Memory) {
        self.memory = memory;
    }

    /// One tick of the law.
    ///
    /// # Errors
    /// [`InputError`] names the field of `state` or `reference` that is not finite, out of range, not a rotation, or
    /// (the reference's acceleration) falls faster than the thrust direction allows. The memory is then unchanged.
    // Always inlined: diagnostics that a caller does not read then cost it nothing.
    #[inline(always)]
    pub fn step(&mut self, state: &State, reference: &Reference) -> Result<(Wrench, Diagnostics), InputError> {
        admit(state, reference, self.steepest_fall)?;
        let Memory { filter, lift } = self.memory;

        let command = self.position_law.command(state, reference, &filter);
        let CommandRates { jerk_command, snap_command } =
            self.position_law.rates(reference, &filter, &command.feedback);

        let desired = DesiredAttitude::new(&command.acceleration_command, &reference.heading);
        let motion = desired.motion(&jerk_command, &snap_command, &reference.heading);

        let error = desired.error(&state.attitude);
        let lifted = path_lifting::lift(lift.as_ref(), &error, self.switching_scalar, self.gains.alpha);

        let thrust = self.vehicle.mass * desired.magnitude();
        let thrust = self.thrust_floor.map_or(thrust, |floor| projected_thrust(thrust, &error, floor));
        let TorqueCommand { angular_velocity_error, attitude_feedback, rate_feedback, torque } = self
            .attitude_law
            .command(&error, lifted.factor, &state.angular_velocity, &motion.velocity, &motion.acceleration);

        // Inputs in range can overflow together, on a reference that all but cancels gravity.
        let wrench = Wrench { thrust, torque };
        if !wrench.is_finite() {
            return Err(InputError::OutOfRange { field: "reference" });
        }
        let FilterState { filtered, intermediate } = filter;
        self.memory = Memory { filter: self.transition.advance(&filter, &command.feedback), lift: Some(lifted.lift) };

        let diagnostics = Diagnostics {
            position_error: command.position_error,
            velocity_error: command.velocity_error,
            z_1: command.z_1,
            z_2: command.z_2,
            feedback: command.feedback,
            filtered,
            intermediate,
            acceleration_command: command.acceleration_command,
            desired_attitude: desired.attitude(),
            desired_angular_velocity: motion.velocity,
            desired_angular_acceleration: motion.acceleration,
            attitude_error: lifted.quaternion,
            mrp: lifted.mrp,
            lift_sign: lifted.lift.sign,
            angular_velocity_error,
            attitude_feedback,
            rate_feedback,
        };
        Ok((wrench, diagnostics))
    }
}

#[cfg(test)]
mod tests;
