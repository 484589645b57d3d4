//! An attitude law near the half turn: whether it goes the long way round, and whether small noise can hold it there.
//!
//! The paper's vehicle, exact and without rotors, hovers with Table I; the law's torque about body x is watched, and
//! the roll counted on past half a turn.
//!
//! - [`Trial::unwinding`]: at rest, 30 degrees of roll. How far does it turn?
//! - [`Trial::held`]: at rest at half a turn. The measured roll is off by a constant angle, always to the side that
//!   makes the law push back to half a turn: the worst noise of that size.
//! - [`Trial::noisy`]: the same, but the error is drawn anew each tick, normal.

use controller_core::heading::Heading;
use controller_core::law::Command;
use controller_core::reference::Trajectory;
use controller_core::reference::hover::Hover;
use host_sim::flight::controller::Controller;
use host_sim::vehicle::SimulatedVehicle;
use host_sim::vehicle::actuators::ActuatorDemand;
use host_sim::vehicle::sensed::Sensed;
use nalgebra::{Quaternion, Vector3};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use scenario::Scenario;
use std::f64::consts::PI;

/// How the measured roll differs from the true one.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Noise {
    None,
    /// Always towards the other side of half a turn, rad.
    Worst(f64),
    /// Normal with this deviation, rad, drawn with this seed.
    Drawn(f64, u64),
}

/// A start, a noise, a duration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// rad.
    roll: f64,
    noise: Noise,
    /// s.
    duration: f64,
}

/// The course of one trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// (s, rad): the roll, counted on past half a turn.
    pub roll: Vec<(f64, f64)>,
    /// (s, N m): the commanded torque about body x.
    pub torque: Vec<(f64, f64)>,
    /// How far it turned about body x in all, there and back, rad.
    pub turned: f64,
    /// When it was last within a tenth of a radian of half a turn, s.
    pub left_after: f64,
    /// How often the torque changed its sign before that.
    pub reversals: u64,
}

impl Trial {
    /// 30 degrees of roll, no noise, 4 s.
    #[must_use]
    pub fn unwinding() -> Self {
        Self { roll: PI / 6.0, noise: Noise::None, duration: 4.0 }
    }

    /// Half a turn, the worst noise of `size`, rad, 5 s.
    #[must_use]
    pub fn held(size: f64) -> Self {
        Self { roll: PI, noise: Noise::Worst(size), duration: 5.0 }
    }

    /// Half a turn, noise of this deviation, rad, 5 s.
    #[must_use]
    pub fn noisy(deviation: f64, seed: u64) -> Self {
        Self { roll: PI, noise: Noise::Drawn(deviation, seed), duration: 5.0 }
    }

    /// Flies it; `None` if the law refuses a state or the motion diverges.
    #[must_use]
    pub fn fly(&self, scenario: &Scenario, mut controller: Controller) -> Option<Course> {
        let mut start = scenario.clone();
        start.initial.attitude = about_x(self.roll);
        (start.initial.velocity, start.initial.angular_velocity) = (Vector3::zeros(), Vector3::zeros());
        let mut vehicle = SimulatedVehicle::new(&start, &start.configuration);
        let hover = Hover::new(start.initial.position.map(|x| x as f32), Heading::FORWARD).ok()?;
        let mut random = ChaCha8Rng::seed_from_u64(if let Noise::Drawn(_, seed) = self.noise { seed } else { 0 });
        let (period, mut roll, mut before) = (start.timing.period(), self.roll, 0.0);
        let sensed = Sensed::hovering(start.configuration.vehicle());
        let mut course = Course { roll: Vec::new(), torque: Vec::new(), turned: 0.0, left_after: 0.0, reversals: 0 };
        for tick in 0..(self.duration / period) as u64 {
            let (state, time) = (*vehicle.state(), tick as f64 * period);
            let error = match self.noise {
                Noise::None => 0.0,
                Noise::Worst(size) => size * if roll >= PI { -1.0 } else { 1.0 },
                Noise::Drawn(deviation, _) => {
                    let normal: f64 = StandardNormal.sample(&mut random);
                    deviation * normal
                }
            };
            let mut measured = state;
            measured.attitude = state.attitude * about_x(error);
            let (Command { wrench, .. }, _) =
                controller.step(&measured.measured(), &sensed, &hover.at(tick * start.timing.period_us)).ok()?;
            let torque = f64::from(wrench.torque.x);
            if (roll - PI).abs() < 0.1 {
                course.left_after = time + period;
                course.reversals += u64::from(torque * before < 0.0);
            }
            before = torque;
            course.roll.push((time, roll));
            course.torque.push((time, torque));
            vehicle.hold(&ActuatorDemand::Wrench(wrench), start.timing.steps_per_tick).ok()?;
            // Less than half a turn in a tick, so the nearer way is the way it went.
            let turn = (state.attitude.conjugate() * vehicle.state().attitude).normalize();
            let angle = 2.0 * turn.i.atan2(turn.w);
            let angle = angle.sin().atan2(angle.cos());
            roll += angle;
            course.turned += angle.abs();
        }
        Some(course)
    }
}

fn about_x(angle: f64) -> Quaternion<f64> {
    let (sin, cos) = (0.5 * angle).sin_cos();
    Quaternion::new(cos, sin, 0.0, 0.0)
}

/// Gains of [quaternion feedback](host_sim::rivals::quaternion_feedback) that push as hard at half a turn as Table I,
/// and damp as well.
pub const GAINS_LIKE_TABLE_1: [f64; 7] = [9.0, 6.0, 2.0, 23.0, 12.0, 10.0, 8.0];
