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

#[cfg(test)]
mod tests {
    use super::*;
    use controller_core::allocation::QuadX;

    const STEP: f64 = 1e-3;
    const HOVER: f32 = 0.5 * 9.81;
    const LAG: f64 = 0.03;

    fn setup() -> RotorSetup {
        let (thrust_coefficient, drag_coefficient) = (5.57e-6, 1.36e-7);
        let quad = QuadX { arm: 0.17, thrust_coefficient, drag_coefficient, speed_min: 0.0, speed_max: 1500.0 };
        RotorSetup { rotors: Rotors::quad_x(quad).unwrap(), lag: LAG }
    }

    #[test]
    fn rotor_speeds_follow_the_closed_form_exactly() {
        let mut rotors = SpinningRotors::hovering(&setup(), HOVER, STEP);
        let start: Vec<f64> = rotors.speeds.iter().map(|(speed, _)| *speed).collect();
        rotors.command(&[2.2, 1.9, 2.0, 1.8]);
        for step in 1..=200_u32 {
            rotors.advance();
            let left = (-f64::from(step) * STEP / LAG).exp();
            for ((speed, command), start) in rotors.speeds.iter().zip(&start) {
                let exact = command + (start - command) * left;
                // Two hundred products, each rounded.
                assert!((speed - exact).abs() < 1e-13 * 200.0 * exact, "step {step}: {speed} {exact}");
            }
        }
    }
}
