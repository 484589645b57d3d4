//! From the tick on in which a rotor is found to fail.

use super::Controller;
use crate::allocation::remaining::LostRotor;
use crate::controller::Diagnostics;
use crate::extended::measured::Measured;
use crate::extended::memory::{LastTick, Memory};
use crate::extended::rotor_loss::detector::Interval;
use crate::extended::rotor_loss::spinning::{RotorLossLaw, RotorLossStep};
use crate::reference::Reference;
use crate::state::{State, Wrench};
use nalgebra::{Quaternion, Vector3, Vector4};

impl Controller {
    /// Whether a rotor is lost, now or before. `acted` is the mean wrench since the last tick, as commanded.
    #[inline(always)] // into the law's step
    pub(super) fn has_lost(
        &mut self,
        state: &State,
        axis: &Vector3<f32>,
        measured: &Measured,
        acted: &Vector4<f32>,
    ) -> bool {
        let memory = &self.memory;
        let last = memory.last.as_ref().filter(|_| memory.held == 0);
        let known = last.map(|last| self.learning.force.mean_acceleration([&last.velocity, &state.velocity]));
        let known = known.filter(|_| memory.without_velocity == 0);
        let (Some(last), Some(acceleration)) = (last, measured.usable_acceleration().copied().or(known)) else {
            self.memory.suspicion.forget();
            return self.spinning.is_some();
        };
        let start = last.angular_velocity;
        let mut interval = Interval {
            acceleration,
            angular_velocities: [&start, &state.angular_velocity],
            axis: (last.thrust_axis + axis) * 0.5,
            acted: *acted,
        };
        if let Some(law) = &mut self.spinning {
            // What acted is what was to be delivered.
            let [thrust, missing] = self.detector.missing(law.lost().rotor, &interval);
            law.refine_loss(thrust, missing, self.period);
            return true;
        }
        interval.acted *= self.memory.averages.scale.scale;
        let found = self.detector.observe(&mut self.memory.suspicion, &interval);
        let agrees = |lost: &LostRotor| self.detector.agrees(&self.memory.suspicion, &interval, lost);
        let Some(lost) = found.or(measured.lost.filter(agrees)) else { return false };
        self.lose(&lost);
        self.spinning.is_some()
    }

    /// From now on without this rotor.
    #[cold]
    #[inline(never)]
    fn lose(&mut self, lost: &LostRotor) {
        let (estimates, times) = (self.estimates(), [self.late, self.period]);
        let law = |rotors| RotorLossLaw::new(&self.vehicle, &self.limits, rotors, lost, times, &estimates);
        self.spinning = self.rotors.as_ref().filter(|rotors| lost.rotor < rotors.len()).map(law);
    }

    /// A tick without a rotor: the wrench of the commands, as all rotors would deliver it.
    #[cold]
    #[inline(never)]
    pub(super) fn spin(
        &mut self,
        state: &State,
        reference: &Reference,
        axis: &Vector3<f32>,
        pending: &Vector4<f32>,
    ) -> (Wrench, Diagnostics) {
        let (Some(law), Some(rotors)) = (&mut self.spinning, &self.rotors) else {
            return (Wrench { thrust: 0.0, torque: Vector3::zeros() }, Diagnostics::NONE);
        };
        let RotorLossStep { command, mrp } = law.step(state, reference, pending, self.period);
        let Wrench { thrust, torque } = *law.delivered();
        let asked: Vector4<f32> =
            rotors.effectiveness().iter().zip(law.commands()).map(|(column, f)| column.map(|x| x as f32) * *f).sum();
        let asked = asked * self.thrust_scale();
        let Memory { actuators, acted, last, .. } = &mut self.memory;
        actuators.command(Vector4::new(thrust, torque.x, torque.y, torque.z));
        *acted = self.actuators.advance(actuators);
        *last = Some(LastTick {
            velocity: state.velocity,
            thrust_axis: *axis,
            angular_velocity: state.angular_velocity,
            forward: Vector3::zeros(),
        });
        let square = mrp.norm_squared();
        let error = Quaternion::from_parts(1.0 - square, mrp * 2.0) * (1.0 / (1.0 + square));
        let diagnostics = Diagnostics {
            position_error: state.position - reference.position,
            velocity_error: state.velocity - reference.velocity,
            acceleration_command: command,
            desired_attitude: state.attitude * error.conjugate(),
            attitude_error: error,
            mrp,
            ..Diagnostics::NONE
        };
        (Wrench { thrust: asked.x, torque: Vector3::new(asked.y, asked.z, asked.w) }, diagnostics)
    }
}
