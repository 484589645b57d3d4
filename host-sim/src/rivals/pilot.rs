//! A rival at the controls of a flight: its inputs, and the way of its commands.
//!
//! It gets what ours gets, in double precision: the measured state; the reference; and as a part of the
//! reference's acceleration the drag that `[estimates] drag_across` knows of, c v_d across, which ours feeds forward as
//! well. Its wrench goes the way of ours, within the same limits, through the same allocation; it learns at once
//! whether either cuts something of it.

use super::jet::Jet;
use super::rival::{Commanded, Rival, RivalModel, RivalReference, RivalState};
use crate::vehicle::sensed::Sensed;
use controller_core::allocation::Mixer;
use controller_core::configuration::LawParameters;
use controller_core::controller::Diagnostics;
use controller_core::error::InputError;
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};
use controller_core::vehicle::Limits;
use nalgebra::{Quaternion, UnitQuaternion, Vector2, Vector3};
use scenario::Scenario;

/// A rival and its surroundings.
#[derive(Debug)]
pub struct RivalPilot {
    rival: Box<dyn Rival>,
    mixer: Option<Box<Mixer>>,
    /// The file's limits, which bind ours as well.
    limits: Limits,
    /// Known drag across, 1/s.
    drag: f64,
    /// Whether the limits cut something of the last command.
    is_cut: bool,
}

impl Clone for RivalPilot {
    fn clone(&self) -> Self {
        Self { rival: self.rival.boxed(), mixer: self.mixer.clone(), ..*self }
    }
}

/// A rival's model of the vehicle of `scenario`.
#[must_use]
pub fn model(scenario: &Scenario) -> RivalModel {
    let (configuration, timing) = (&scenario.configuration, &scenario.timing);
    let vehicle = configuration.vehicle();
    let limit = f64::from(configuration.limits().thrust_max);
    let rotors = configuration.rotors();
    let together = rotors.map(|rotors| rotors.iter().map(|rotor| f64::from(rotor.thrust_max)).sum::<f64>());
    RivalModel {
        mass: vehicle.mass.into(),
        inertia: vehicle.inertia.map(f64::from),
        gravity: vehicle.gravity.into(),
        period: timing.period(),
        lag: if rotors.is_some() { scenario.rotor_lag } else { 0.0 },
        delay: scenario.delay_steps as f64 * timing.step(),
        thrust_max: together.map_or(limit, |together| together.min(limit)),
    }
}

impl RivalPilot {
    /// `rival` on the vehicle of `scenario`.
    #[must_use]
    pub fn new(scenario: &Scenario, rival: Box<dyn Rival>) -> Self {
        let configuration = &scenario.configuration;
        let limits = configuration.limits();
        let drag = match configuration.law() {
            LawParameters::Paper(_) => 0.0,
            LawParameters::Extended(law) => law.parameters.drag_across.into(),
        };
        Self {
            rival,
            mixer: configuration.rotors().map(|rotors| Box::new(Mixer::new(rotors))),
            limits: *limits,
            is_cut: false,
            drag,
        }
    }

    /// One tick.
    ///
    /// # Errors
    /// [`InputError`] if the state or what the rival makes of it is not finite.
    pub fn step(
        &mut self,
        state: &State,
        sensed: &Sensed,
        reference: &Reference,
    ) -> Result<(Wrench, Diagnostics), InputError> {
        let rival_state = RivalState {
            position: state.position.map(f64::from),
            velocity: state.velocity.map(f64::from),
            attitude: UnitQuaternion::new_normalize(Quaternion::from(state.attitude.coords.map(f64::from))),
            rate: state.angular_velocity.map(f64::from),
            sensed: *sensed,
        };
        let rival_reference = self.rival_reference(reference);
        let commanded = self.rival.step(&rival_state, &rival_reference);
        let wrench =
            Wrench { thrust: commanded.thrust as f32, torque: commanded.torque.map(|component| component as f32) };
        let limited = self.limited(&wrench);
        self.is_cut = limited != wrench || self.is_beyond_the_rotors(&limited)?;
        self.rival.was_cut(self.is_cut);
        Ok((limited, diagnostics(&rival_state, reference, &commanded)))
    }

    fn rival_reference(&self, reference: &Reference) -> RivalReference {
        let [velocity, acceleration, jerk, snap] =
            [reference.velocity, reference.acceleration, reference.jerk, reference.snap].map(|v| v.map(f64::from));
        let drag = Vector3::new(self.drag, self.drag, 0.0);
        let with_drag = |v: &Vector3<f64>, rate: &Vector3<f64>| rate + v.component_mul(&drag);
        let flat = |v: Vector2<f32>| Vector3::new(f64::from(v.x), f64::from(v.y), 0.0);
        let heading = &reference.heading;
        RivalReference {
            position: reference.position.map(f64::from),
            velocity,
            motion: acceleration,
            acceleration: Jet([
                with_drag(&velocity, &acceleration),
                with_drag(&acceleration, &jerk),
                with_drag(&jerk, &snap),
            ]),
            heading: Jet([
                flat(heading.direction()),
                flat(heading.first_derivative()),
                flat(heading.second_derivative()),
            ]),
        }
    }

    /// Whether the limits or the rotors cut something of the last command.
    #[must_use]
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// `wrench` as far as the file's limits let it act.
    fn limited(&self, wrench: &Wrench) -> Wrench {
        let torque = wrench.torque.zip_map(&self.limits.torque_max, |torque, limit| torque.clamp(-limit, limit));
        Wrench { thrust: wrench.thrust.clamp(0.0, self.limits.thrust_max), torque }
    }

    /// Whether the rotors can deliver less than `wrench`.
    fn is_beyond_the_rotors(&self, wrench: &Wrench) -> Result<bool, InputError> {
        match &self.mixer {
            Some(mixer) => Ok(!mixer.allocate(wrench)?.is_exact()),
            None if (wrench.thrust + wrench.torque.sum()).is_finite() => Ok(false),
            None => Err(InputError::NotFinite { field: "wrench" }),
        }
    }
}

/// The paper's quantities as far as any law has them; the rest is zero.
fn diagnostics(rival_state: &RivalState, reference: &Reference, commanded: &Commanded) -> Diagnostics {
    let single = |v: Vector3<f64>| v.map(|component| component as f32);
    let quaternion = |q: &UnitQuaternion<f64>| Quaternion::from(q.coords.map(|component| component as f32));
    let error = commanded.desired.inverse() * rival_state.attitude;
    let error = if error.w < 0.0 { UnitQuaternion::new_unchecked(-error.into_inner()) } else { error };
    let rate = error.inverse() * commanded.desired_rate;
    let zero = Vector3::zeros();
    Diagnostics {
        position_error: single(rival_state.position) - reference.position,
        velocity_error: single(rival_state.velocity) - reference.velocity,
        z_1: zero,
        z_2: zero,
        feedback: zero,
        filtered: zero,
        intermediate: zero,
        acceleration_command: zero,
        desired_attitude: quaternion(&commanded.desired),
        desired_angular_velocity: single(commanded.desired_rate),
        desired_angular_acceleration: zero,
        attitude_error: quaternion(&error),
        mrp: single(error.imag() / (1.0 + error.w)),
        lift_sign: 1.0,
        angular_velocity_error: single(rival_state.rate - rate),
        attitude_feedback: zero,
        rate_feedback: zero,
    }
}
