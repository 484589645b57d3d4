//! Rotors in motion: speeds that follow their commands with a first-order lag.
//!
//! speed' = (command - speed) / lag is solved exactly over each plant step; the body feels the thrusts of the step's middle,
//! so the error against a continuous solution is of second order in step / lag. There is no air flow through the rotors,
//! and a motor that starts from standstill follows like any other.

use super::RotorSetup;
use controller_core::allocation::{Rotor, Rotors};
use nalgebra::{Vector3, Vector4};

/// A vehicle's rotors and how fast they turn.
#[derive(Debug, Clone)]
pub struct SpinningRotors {
    rotors: Rotors,
    /// What is left of a speed error after half a plant step, and after a whole one.
    decay: (f64, f64),
    /// Per rotor: speed now and speed commanded, rad/s.
    speeds: Vec<(f64, f64)>,
}

impl SpinningRotors {
    /// Rotors that together give the thrust `hover`, N, without torque. `step` is the plant's, s.
    #[must_use]
    pub fn hovering(setup: &RotorSetup, hover: f32, step: f64) -> Self {
        let hovering = |(rotor, row): (&Rotor, &Vector4<f64>)| {
            let thrust = (row.x as f32 * hover).clamp(rotor.thrust_min, rotor.thrust_max);
            f64::from(rotor.speed_at(thrust))
        };
        Self::at(setup, step, setup.rotors.iter().zip(setup.rotors.pseudo_inverse()).map(hovering))
    }

    /// Rotors that stand still.
    #[must_use]
    pub fn stopped(setup: &RotorSetup, step: f64) -> Self {
        Self::at(setup, step, setup.rotors.iter().map(|_| 0.0))
    }

    fn at(setup: &RotorSetup, step: f64, speeds: impl Iterator<Item = f64>) -> Self {
        let left = |time: f64| if setup.lag > 0.0 { (-time / setup.lag).exp() } else { 0.0 };
        Self {
            rotors: setup.rotors.clone(),
            decay: (left(0.5 * step), left(step)),
            speeds: speeds.map(|speed| (speed, speed)).collect(),
        }
    }

    /// Asks each rotor for a thrust, N.
    pub fn command(&mut self, thrusts: &[f32]) {
        for ((speed, rotor), thrust) in self.speeds.iter_mut().zip(self.rotors.iter()).zip(thrusts) {
            speed.1 = f64::from(rotor.speed_at(*thrust));
        }
    }

    /// Per rotor: speed now and speed commanded, rad/s.
    pub fn speeds(&self) -> impl Iterator<Item = &(f64, f64)> {
        self.speeds.iter()
    }

    /// Advances the speeds by one plant step and returns thrust, N, and torque, N m, at its middle.
    pub fn advance(&mut self) -> (f64, Vector3<f64>) {
        let (half, whole) = self.decay;
        let mut thrust = 0.0;
        let mut torque = Vector3::zeros();
        let columns = self.rotors.effectiveness();
        for (((speed, command), rotor), column) in self.speeds.iter_mut().zip(self.rotors.iter()).zip(columns) {
            let middle = *command + (*speed - *command) * half;
            *speed = *command + (*speed - *command) * whole;
            let force = f64::from(rotor.thrust_coefficient) * middle * middle;
            thrust += force * column.x;
            torque += Vector3::new(column.y, column.z, column.w) * force;
        }
        (thrust, torque)
    }
}
