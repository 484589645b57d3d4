//! Points that move as vehicles are asked to: round circles, along eights, to and fro, up and down; inside a case's
//! bounds, or not.

use super::case::{Case, Random};
use controller_core::governor::Motion;
use controller_core::prelude::Vector3;
use core::f64::consts::TAU;

/// A sum of two turns of each axis about a centre: amplitudes, phases, and how many turns the second makes to the
/// first's one.
#[derive(Clone, Copy)]
pub struct Path {
    centre: Vector3<f64>,
    rate: f64,
    amplitude: [Vector3<f64>; 2],
    phase: [Vector3<f64>; 2],
}

impl Path {
    /// About `here`, at 0.3 to 1.3 times what the case's bounds leave.
    pub fn draw(random: &mut Random, case: &Case, here: &Vector3<f32>) -> Self {
        let b = &case.bounds;
        let rate = random.sized(0.2, 3.0);
        let quarter = Vector3::new(0.0, -TAU / 4.0, 0.0);
        let fits = |bound: f32, rate: f32| (bound / rate.powi(2)).min(b.jerk / rate.powi(3)).min(b.snap / rate.powi(4));
        let share = random.between(0.3, 1.3);
        let size = f64::from(share * fits(b.horizontal_acceleration, rate));
        let height = f64::from(random.between(0.0, 0.3) * fits(b.vertical_acceleration, rate));
        let double = f64::from(share * fits(b.horizontal_acceleration, 2.0 * rate));
        let [x, y] = [Vector3::x(), Vector3::y()];
        let tilted = Vector3::new(0.8, -0.6, 0.0);
        let amplitude = match random.below(4) {
            // A circle; an eight, along and across; to and fro; a circle in waves.
            0 => [(x + y) * size, Vector3::zeros()],
            1 => [x * double * 0.7, y * double * 0.7],
            2 => [tilted * size, Vector3::zeros()],
            _ => [(x + y) * (0.8 * size) + Vector3::z() * height, Vector3::zeros()],
        };
        let centre = here.map(f64::from) + random.vector(2.0).map(f64::from);
        let turned = Vector3::repeat(f64::from(random.between(0.0, 6.0)));
        Self { centre, rate: f64::from(rate), amplitude, phase: [turned + quarter, turned * 2.0 + quarter] }
    }

    /// Where its point is at `time`, s, and how it moves: as single precision has it.
    pub fn at(&self, time: f64) -> [Vector3<f32>; 3] {
        let mut sum = [self.centre, Vector3::zeros(), Vector3::zeros()];
        for (turns, (amplitude, phase)) in (1..).zip(self.amplitude.iter().zip(&self.phase)) {
            let rate = self.rate * f64::from(turns);
            let angle = phase.map(|phase| rate * time + phase);
            sum[0] += amplitude.component_mul(&angle.map(f64::cos));
            sum[1] -= amplitude.component_mul(&angle.map(f64::sin)) * rate;
            sum[2] -= amplitude.component_mul(&angle.map(f64::cos)) * (rate * rate);
        }
        sum.map(|vector| vector.map(|component| component as f32))
    }

    /// As a setpoint has it.
    pub fn motion(&self, time: f64) -> Motion {
        let [position, velocity, acceleration] = self.at(time);
        Motion::PositionVelocityAcceleration { position, velocity, acceleration }
    }

    /// Half its width, m.
    pub fn size(&self) -> f64 {
        (self.amplitude[0] + self.amplitude[1]).norm()
    }
}
