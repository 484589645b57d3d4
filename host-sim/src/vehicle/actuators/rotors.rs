//! Rotors in motion: speeds that follow their commands with a first-order lag.
//!
//! speed' = (command - speed) / lag is solved exactly over each plant step; the body feels the thrusts of the step's
//! middle, so the error against a continuous solution is of second order in step / lag. There is no air flow through
//! the rotors, and a motor that starts from standstill follows like any other.

use controller_core::allocation::{Rotor, Rotors};
use nalgebra::{Vector3, Vector4};

/// A vehicle's rotors and how fast they turn.
#[derive(Debug, Clone)]
pub struct SpinningRotors {
    rotors: Rotors,
    /// The share of a speed error that remains after half a plant step, and after a whole one.
    decay: (f64, f64),
    /// Per rotor: speed now and speed commanded, rad/s.
    speeds: Vec<(f64, f64)>,
}

impl SpinningRotors {
    /// Rotors that together give the thrust `hover`, N, without torque. `lag` and the plant's `step` in s.
    pub fn hovering(rotors: &Rotors, lag: f64, hover: f32, step: f64) -> Self {
        let hovering = |(rotor, row): (&Rotor, &Vector4<f64>)| {
            let thrust = (row.x as f32 * hover).clamp(rotor.thrust_min, rotor.thrust_max);
            f64::from(rotor.speed_at(thrust))
        };
        Self::at(rotors, lag, step, rotors.iter().zip(rotors.pseudo_inverse()).map(hovering))
    }

    /// Rotors that stand still. `lag` and the plant's `step` in s.
    pub fn stopped(rotors: &Rotors, lag: f64, step: f64) -> Self {
        Self::at(rotors, lag, step, rotors.iter().map(|_| 0.0))
    }

    fn at(rotors: &Rotors, lag: f64, step: f64, speeds: impl Iterator<Item = f64>) -> Self {
        let left = |time: f64| if lag > 0.0 { (-time / lag).exp() } else { 0.0 };
        Self {
            rotors: rotors.clone(),
            decay: (left(0.5 * step), left(step)),
            speeds: speeds.map(|speed| (speed, speed)).collect(),
        }
    }

    /// Thrusts at the speeds of this moment, N.
    pub fn thrusts(&self) -> Vec<f64> {
        let thrust = |((speed, _), rotor): (&(f64, f64), &Rotor)| f64::from(rotor.thrust_coefficient) * speed * speed;
        self.speeds.iter().zip(self.rotors.iter()).map(thrust).collect()
    }

    /// The speeds of this moment, rad/s.
    pub fn speeds(&self) -> impl Iterator<Item = f64> {
        self.speeds.iter().map(|(speed, _)| *speed)
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
    use scenario::Scenario;

    #[test]
    fn rotor_speeds_follow_the_closed_form_exactly() {
        let study = Scenario::parse(include_str!("../../../../vehicles/study.toml"), "study").unwrap();
        let (lag, step) = (study.rotor_lag, study.timing.step());
        let vehicle = study.configuration.vehicle();
        let hover = vehicle.mass * vehicle.gravity;
        let mut rotors = SpinningRotors::hovering(study.configuration.rotors().unwrap(), lag, hover, step);
        let start: Vec<f64> = rotors.speeds.iter().map(|(speed, _)| *speed).collect();
        rotors.command(&[2.2, 1.9, 2.0, 1.8]);
        for k in 1..=200_u32 {
            rotors.advance();
            let left = (-f64::from(k) * step / lag).exp();
            for ((speed, command), start) in rotors.speeds.iter().zip(&start) {
                let exact = command + (start - command) * left;
                // Two hundred products, each rounded.
                assert!((speed - exact).abs() < 1e-13 * 200.0 * exact, "step {k}: {speed} {exact}");
            }
        }
    }
}
