//! Where a flight begins, and in what its vehicle and air are not as the law believes.
//!
//! | drawn | how |
//! |---|---|
//! | attitude | uniform: four normal numbers, made a unit quaternion |
//! | body rates, velocity | evenly in a ball |
//! | lag, each moment of inertia | evenly on both sides; moments that no body has are drawn again |
//! | force | steps ([`super::gust`]) |

use super::gust::Gust;
use crate::studies::campaign::draw::Drawn;
use controller_core::vehicle::{Vehicle, VehicleParameters};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use std::fmt;

/// How long every flight is.
pub const FLIGHT_DURATION_S: f64 = 20.0;

/// What a recovery has to bear, beside any attitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sets {
    /// Greatest |omega|, rad/s.
    pub spin: f64,
    /// Greatest |v|, m/s.
    pub speed: f64,
    /// Greatest force per mass along an axis of the world, m/s^2.
    pub gust: f64,
    /// By how much the rotors' lag may be off, as a share.
    pub lag: f64,
    /// By how much each moment of inertia may be off, as a share.
    pub inertia: f64,
}

impl Default for Sets {
    fn default() -> Self {
        Self { spin: 5.0, speed: 3.0, gust: 0.1, lag: 0.3, inertia: 0.1 }
    }
}

/// A start within [`Sets`].
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// Body to world, unit, scalar first.
    pub attitude: Quaternion<f64>,
    /// omega, rad/s, body frame.
    pub rates: Vector3<f64>,
    /// v, m/s, world frame.
    pub velocity: Vector3<f64>,
    /// The true lag over the file's.
    pub lag: f64,
    /// The true moments of inertia over the file's, body axes.
    pub inertia: Vector3<f64>,
    /// In shares of the greatest force.
    pub gust: Gust,
}

impl Start {
    /// At rest, upright, the vehicle as the file has it, in no wind.
    #[must_use]
    pub fn at_rest() -> Self {
        Self {
            attitude: Quaternion::identity(),
            rates: Vector3::zeros(),
            velocity: Vector3::zeros(),
            lag: 1.0,
            inertia: Vector3::repeat(1.0),
            gust: Gust::NONE,
        }
    }

    /// The start of a flight of `vehicle`, from seed and number alone.
    #[must_use]
    pub fn drawn(sets: &Sets, vehicle: &Vehicle, seed: u64, number: u64) -> Self {
        let drawn = &mut Drawn::new(seed, number);
        let (attitude, rates, velocity) = (drawn.attitude(), drawn.ball() * sets.spin, drawn.ball() * sets.speed);
        let lag = 1.0 + sets.lag * drawn.side();
        let inertia = loop {
            let factors = Vector3::from_fn(|_, _| 1.0 + sets.inertia * drawn.side());
            if is_a_bodys(vehicle, &factors) {
                break factors;
            }
        };
        Self { attitude, rates, velocity, lag, inertia, gust: Gust::drawn(drawn, FLIGHT_DURATION_S) }
    }

    /// The same start, turning and moving as fast as the sets have it, and with the slowest rotors.
    #[must_use]
    pub fn at_the_ends(self, sets: &Sets) -> Self {
        let long = |v: &Vector3<f64>, length: f64| v.try_normalize(0.0).map_or(*v, |v| v * length);
        let (rates, velocity) = (long(&self.rates, sets.spin), long(&self.velocity, sets.speed));
        Self { rates, velocity, lag: 1.0 + sets.lag, ..self }
    }

    /// Another start near this one, changed in some of its parts; `scale` is 1 for changes as large as the
    /// sets.
    pub(crate) fn mutated(&self, sets: &Sets, vehicle: &Vehicle, drawn: &mut Drawn, scale: f64) -> Self {
        let mut start = self.clone();
        let forced = drawn.index(6);
        let changes = |index: usize, drawn: &mut Drawn| index == forced || drawn.part() < CHANGE_PROBABILITY;
        if changes(0, drawn) {
            let turn = UnitQuaternion::from_scaled_axis(drawn.ball() * (std::f64::consts::PI * scale));
            start.attitude = (UnitQuaternion::from_quaternion(self.attitude) * turn).into_inner();
        }
        if changes(1, drawn) {
            start.rates = (self.rates + drawn.ball() * (2.0 * scale * sets.spin)).cap_magnitude(sets.spin);
        }
        if changes(2, drawn) {
            start.velocity = (self.velocity + drawn.ball() * (2.0 * scale * sets.speed)).cap_magnitude(sets.speed);
        }
        let near =
            |factor: f64, share: f64, side: f64| (factor + 2.0 * scale * share * side).clamp(1.0 - share, 1.0 + share);
        if changes(3, drawn) {
            start.lag = near(self.lag, sets.lag, drawn.side());
        }
        if changes(4, drawn) {
            let factors = self.inertia.map(|factor| near(factor, sets.inertia, drawn.side()));
            start.inertia = if is_a_bodys(vehicle, &factors) { factors } else { self.inertia };
        }
        if changes(5, drawn) {
            start.gust = self.gust.mutated(drawn, scale, FLIGHT_DURATION_S);
        }
        start
    }

    /// As numbers, with the gust up to a time, s.
    pub fn in_words(&self, sets: &Sets, until: f64) -> impl fmt::Display {
        let Self { attitude: q, rates, velocity, lag, inertia, gust } = self;
        let three = |v: &Vector3<f64>| format!("({:.4}, {:.4}, {:.4})", v.x, v.y, v.z);
        format!(
            "attitude ({:.5}, {:.5}, {:.5}, {:.5}), rates {} rad/s, velocity {} m/s, lag {lag:.4} times and moments of \
             inertia {} times the file's, force in shares of {} m/s^2 along {}",
            q.w,
            q.i,
            q.j,
            q.k,
            three(rates),
            three(velocity),
            three(inertia),
            sets.gust,
            gust.until(until)
        )
    }
}

/// With it each part of a start changes in a mutation, beside the one that does in any case.
const CHANGE_PROBABILITY: f64 = 0.25;

/// Whether a body can have a vehicle's moments times these factors, as exactly as files are held to it.
fn is_a_bodys(vehicle: &Vehicle, factors: &Vector3<f64>) -> bool {
    let inertia = vehicle.inertia.component_mul(&factors.map(|factor| factor as f32));
    Vehicle::new(VehicleParameters { inertia, mass: vehicle.mass, gravity: vehicle.gravity }).is_ok()
}

impl fmt::Display for Sets {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { spin, speed, gust, lag, inertia } = self;
        write!(
            f,
            "any attitude, |omega| <= {spin} rad/s and |v| <= {speed} m/s at the place where it is to hover, the law \
             freshly reset; rotors' lag within {} % of the file's and each moment of inertia within {} %, while \
             the law believes the file's; a force per mass of at most {gust} m/s^2 along x, y or z, which changes at \
             any time; no air, and the true state in the law",
            100.0 * lag,
            100.0 * inertia
        )
    }
}
