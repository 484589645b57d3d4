//! The search itself: random restarts, each climbed by a pattern search with shrinking steps.

use super::{COORDINATE_COUNT, Code, Domain, Situation};
use crate::support::random::ChaCha8Rng;
use controller_core::certificate::sharp::feedforward_torque;
use controller_core::configuration::Configuration;
use nalgebra::Vector3;
use rand::RngExt;

/// What the adversary drives up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Objective {
    /// |omega_d|, rad/s.
    AngularVelocity,
    /// |omega_d'|, rad/s^2.
    AngularAcceleration,
    /// J_ii |omega_d'| + |J_jj - J_kk| |omega_d|^2 / 2 about one body axis, N m.
    Feedforward(usize),
    /// |tau| about one body axis as the law commands it, N m.
    Torque(usize),
}

impl Objective {
    /// The coordinates that matter to it: the attitude and rate errors do for the commanded torque only.
    fn coordinates(self) -> usize {
        if matches!(self, Self::Torque(_)) { COORDINATE_COUNT } else { 24 }
    }

    /// Its value in a situation.
    pub fn value(self, configuration: &Configuration, situation: &Situation) -> f64 {
        if let Self::Torque(axis) = self {
            return f64::from(situation.torque(configuration)[axis].abs());
        }
        let desired = situation.desired();
        let velocity = desired.angular_velocity.cast::<f64>().norm();
        let acceleration = desired.angular_acceleration.cast::<f64>().norm();
        match self {
            Self::AngularVelocity => velocity,
            Self::AngularAcceleration => acceleration,
            Self::Feedforward(axis) | Self::Torque(axis) => {
                let inertia: Vector3<f64> = configuration.vehicle().inertia.cast();
                feedforward_torque(&inertia, velocity, acceleration)[axis]
            }
        }
    }
}

/// The worst the adversary found.
#[derive(Debug, Clone, Copy)]
pub struct Worst {
    /// The objective's value there.
    pub value: f64,
    /// Where it is.
    pub situation: Situation,
}

/// The pattern search stops at this step.
const FINEST_STEP: f64 = 1e-3;
/// Random moves of the whole code per sweep, for ridges that no single coordinate climbs.
const OBLIQUE_MOVES: usize = 8;

/// The greatest value of `objective` over `restarts` climbs from random codes.
pub fn worst(
    configuration: &Configuration,
    domain: Domain,
    objective: Objective,
    restarts: usize,
    rng: &mut ChaCha8Rng,
) -> Worst {
    let value = |code: &Code| objective.value(configuration, &Situation::decode(configuration, domain, code));
    let mut best = (f64::NEG_INFINITY, [0.0; COORDINATE_COUNT]);
    for _ in 0..restarts {
        let start = [(); COORDINATE_COUNT].map(|()| (1.6 * rng.random_range(-1.0..1.0_f64)).clamp(-1.0, 1.0));
        let found = climb(&value, objective.coordinates(), start, rng);
        if found.0 > best.0 {
            best = found;
        }
    }
    Worst { value: best.0, situation: Situation::decode(configuration, domain, &best.1) }
}

fn climb(value: &impl Fn(&Code) -> f64, used: usize, start: Code, rng: &mut ChaCha8Rng) -> (f64, Code) {
    let mut best = (value(&start), start);
    let mut step = 0.5;
    while step > FINEST_STEP {
        let before = best.0;
        let mut attempt = |code: Code| {
            let found = value(&code);
            let better = found > best.0;
            if better {
                best = (found, code);
            }
            (better, best.1)
        };
        let mut here = attempt(start).1;
        for coordinate in 0..used {
            for change in [step, -step] {
                let mut code = here;
                code[coordinate] = (code[coordinate] + change).clamp(-1.0, 1.0);
                let (better, now) = attempt(code);
                here = now;
                if better {
                    break;
                }
            }
        }
        for _ in 0..OBLIQUE_MOVES {
            let code = here.map(|c| (c + step * rng.random_range(-1.0..1.0_f64)).clamp(-1.0, 1.0));
            here = attempt(code).1;
        }
        if best.0 <= before * (1.0 + 1e-5) {
            step *= 0.5;
        }
    }
    best
}
