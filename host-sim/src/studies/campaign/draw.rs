//! The circumstances of a campaign's flights: where each starts, how the air moves, what is measured, what the vehicle
//! really is.
//!
//! Everything is drawn from (seed, number) alone: the number is the key of a ChaCha8 generator, the seed its stream.
//! Each quantity is drawn whatever its range, in the order of this table, and scaled after that: a range that changes
//! leaves the other draws as they are.
//!
//! | drawn | how |
//! |---|---|
//! | offset from the reference's first point, velocity | evenly in a ball |
//! | body rates | evenly in a ball, whose axis along body z is as long as `yaw_rate` says |
//! | steady wind | evenly in a ball, of which the level part is taken: what holds against wind is for the level |
//! | attitude | uniform: four normal numbers, made a unit quaternion |
//! | gust | evenly in a ball, of which the level part is taken; a step, evenly within the first half of the flight |
//! | turbulence, noises, delay | evenly from zero up |
//! | errors of the model | evenly on both sides; the centre of mass in a ball |
//! | a rotor's failure | in a share of the flights; each rotor alike, evenly within the first half, the thrust left evenly |
//!
//! A wind needs air: a vehicle whose file has no `[drag]` is given one of 0.5 1/s. Where the file has `[sensors]` or
//! `[estimator]`, that stands, and only its seed is drawn. Of the file's own `[initial]` the attitude stands if none is
//! drawn, of its `[wind]` nothing.

use controller_core::allocation::geometry::ROTORS_MAX;
use controller_core::reference::hover::Hover;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use scenario::Scenario;
use scenario::body::BodyState;
use scenario::campaign::{FailureRanges, ModelRanges, NoiseRanges, Ranges, Task};
use scenario::reality::drag::Drag;
use scenario::reality::failure::Failure;
use scenario::reality::sensors::{Sensors, VelocitySource};
use scenario::reality::truth::Truth;
use scenario::reality::wind::{Gust, Shape, Turbulence, Wind};
use scenario::reference::ReferenceKind;
use scenario::timing::Timing;
use std::sync::Arc;

/// The drag over mass of a vehicle without `[drag]`.
pub const DRAG_PER_MASS_PER_S: f64 = 0.5;
const TURBULENCE_ALTITUDE_M: f64 = 10.0;
/// The least airspeed that turbulence drifts past with.
const AIRSPEED_MIN_M_PER_S: f64 = 1.0;
/// How velocity is made of noisy poses: bandwidth, rad/s, and the accelerometer's noise, m/s^2, as for the trials of a
/// search.
const VELOCITY_SOURCE: VelocitySource =
    VelocitySource::Observer { bandwidth: 8.0, noise: 0.05, bias: Vector3::new(0.0, 0.0, 0.0) };
/// Durations are decimal fractions: how far their quotient by the period may be below a whole number, relative.
const WHOLE_TOLERANCE: f64 = 1e-9;

/// `scenario` in the circumstances of flight `number` of the campaign with this `seed`. Its configuration stays as it
/// is: what is certified for the scenario is certified for all of its flights.
pub fn circumstances(scenario: &Scenario, ranges: &Ranges, seed: u64, number: u64) -> Scenario {
    let mut drawn = Drawn::new(seed, number);
    let mut thrown = scenario.clone();
    let hovers = match ranges.reference {
        Task::File => false,
        Task::Hover => true,
        Task::InTurn => number.is_multiple_of(2),
    };
    if hovers {
        thrown.reference = ReferenceKind::Hover { position: Vector3::zeros(), heading: 0.0 };
        thrown.trajectory = Arc::new(Hover::ORIGIN);
    }
    thrown.timing = timing(scenario, ranges);

    let (offset, velocity, rates, wind) = (drawn.ball(), drawn.ball(), drawn.ball(), drawn.ball());
    let attitude = drawn.attitude();
    thrown.initial = BodyState {
        position: thrown.trajectory.at(0).position.map(f64::from) + offset * ranges.offset,
        velocity: velocity * ranges.velocity,
        attitude: if ranges.attitude { attitude } else { scenario.initial.attitude },
        angular_velocity: rates.component_mul(&Vector3::new(ranges.rate, ranges.rate, ranges.yaw_rate)),
    };
    blow(&mut thrown, ranges, wind * ranges.wind, &mut drawn);
    measure(&mut thrown, &ranges.noise, &mut drawn);
    err(&mut thrown, &ranges.model, &mut drawn);
    fail(&mut thrown, &ranges.failure, 0.5 * ranges.duration, &mut drawn);
    thrown
}

/// For how long every flight is flown, in whole control periods.
pub fn timing(scenario: &Scenario, ranges: &Ranges) -> Timing {
    let period = scenario.timing.period();
    Timing { ticks: (ranges.duration / period * (1.0 + WHOLE_TOLERANCE)) as u64, ..scenario.timing }
}

/// How the air moves, with this steady wind before it is laid level, m/s.
fn blow(scenario: &mut Scenario, ranges: &Ranges, steady: Vector3<f64>, drawn: &mut Drawn) {
    let (gust, start) = (drawn.ball() * ranges.gust, drawn.part() * 0.5 * ranges.duration);
    let (strength, seed) = (drawn.part() * ranges.turbulence, drawn.seed());
    scenario.reality.wind = None;
    if ranges.wind.max(ranges.gust).max(ranges.turbulence) <= 0.0 {
        return;
    }
    let mass = f64::from(scenario.configuration.vehicle().mass);
    let drag = Drag { linear: Vector3::repeat(DRAG_PER_MASS_PER_S * mass), ..Drag::default() };
    scenario.reality.drag.get_or_insert(drag);
    let level = |wind: Vector3<f64>| Vector3::new(wind.x, wind.y, 0.0);
    let steady = level(steady);
    let turbulence = Turbulence {
        wind_at_20_feet: strength,
        altitude: TURBULENCE_ALTITUDE_M,
        airspeed: steady.norm().max(AIRSPEED_MIN_M_PER_S),
        seed,
    };
    scenario.reality.wind = Some(Wind {
        steady,
        gust: (ranges.gust > 0.0).then(|| Gust { shape: Shape::Step, start, velocity: level(gust) }),
        turbulence: (ranges.turbulence > 0.0).then_some(turbulence),
    });
}

/// The sensors' circumstances.
fn measure(scenario: &mut Scenario, ranges: &NoiseRanges, drawn: &mut Drawn) {
    let (gyro, position, attitude, delay) = (drawn.part(), drawn.part(), drawn.part(), drawn.part());
    let seed = drawn.seed();
    match &mut scenario.reality {
        reality if reality.estimator.is_some() => {
            reality.estimator =
                reality.estimator.map(|estimator| scenario::reality::estimator::Estimator { seed, ..estimator });
        }
        reality if reality.sensors.is_some() => {
            reality.sensors = reality.sensors.map(|sensors| Sensors { seed, ..sensors });
        }
        reality if *ranges != NoiseRanges::default() => {
            reality.sensors = Some(Sensors {
                gyro_noise: gyro * ranges.gyro,
                gyro_bias: Vector3::zeros(),
                position_noise: position * ranges.position,
                attitude_noise: attitude * ranges.attitude,
                velocity: VELOCITY_SOURCE,
                pose_every: 1,
                dropout: 0.0,
                delay_ticks: (delay * ranges.delay / scenario.timing.period()).round() as u64,
                pose_delay_ticks: 0,
                imu_delay: 0.0,
                seed,
            });
        }
        _ => {}
    }
}

/// The true vehicle, where it differs from the model.
fn err(scenario: &mut Scenario, ranges: &ModelRanges, drawn: &mut Drawn) {
    let mut factor = |range: f64| 1.0 + range * drawn.side();
    let (mass, inertia, thrust) = (factor(ranges.mass), factor(ranges.inertia), factor(ranges.thrust_scale));
    let scales: [f64; ROTORS_MAX] = std::array::from_fn(|_| factor(ranges.rotor_scales));
    let centre_of_mass = drawn.ball() * ranges.centre_of_mass;
    if *ranges == ModelRanges::default() {
        return;
    }
    let truth = scenario.reality.truth.clone();
    let truth = truth.unwrap_or_else(|| Truth::model(scenario.configuration.vehicle()));
    let rotors = scenario.configuration.rotors().map_or(0, |rotors| rotors.len());
    let own = |rotor: usize| truth.rotor_scales.get(rotor).copied().unwrap_or(1.0);
    let rotor_scales = scales.iter().take(rotors).enumerate().map(|(rotor, scale)| own(rotor) * scale).collect();
    scenario.reality.truth = Some(Truth {
        mass: truth.mass * mass,
        inertia: truth.inertia * inertia,
        centre_of_mass: truth.centre_of_mass + centre_of_mass,
        thrust_scale: truth.thrust_scale * thrust,
        rotor_scales,
        ..truth
    });
}

/// A rotor that fails, at the `latest` at this time, s: so what follows can be seen.
fn fail(scenario: &mut Scenario, ranges: &FailureRanges, latest: f64, drawn: &mut Drawn) {
    let (fails, rotor, time, left) = (drawn.part() < ranges.flights, drawn.part(), drawn.part(), drawn.part());
    let rotors = scenario.configuration.rotors().map_or(0, |rotors| rotors.len());
    if fails {
        let [least, greatest] = ranges.thrust_left;
        let rotor = (rotor * rotors as f64) as usize;
        let failure = Failure { rotor, time: time * latest, thrust_left: least + (greatest - least) * left };
        scenario.reality.failure = Some(failure);
    }
}

/// A flight's own random numbers.
pub(crate) struct Drawn(ChaCha8Rng);

impl Drawn {
    /// Those of flight `number` of this `seed`.
    pub(crate) fn new(seed: u64, number: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(number);
        random.set_stream(seed);
        Self(random)
    }

    /// Evenly from -1 to 1.
    pub(crate) fn side(&mut self) -> f64 {
        self.0.random_range(-1.0..1.0)
    }

    /// Evenly from 0 to 1.
    pub(crate) fn part(&mut self) -> f64 {
        self.0.random_range(0.0..1.0)
    }

    /// Evenly from 0 to below `count`; 0 for a count of 0.
    pub(crate) fn index(&mut self, count: usize) -> usize {
        self.0.random_range(0..count.max(1))
    }

    /// Evenly within the unit ball.
    pub(crate) fn ball(&mut self) -> Vector3<f64> {
        loop {
            let v = Vector3::from_fn(|_, _| self.side());
            if v.norm() <= 1.0 {
                return v;
            }
        }
    }

    /// Of all attitudes alike.
    pub(crate) fn attitude(&mut self) -> Quaternion<f64> {
        let mut normal = || StandardNormal.sample(&mut self.0);
        let four = Quaternion::new(normal(), normal(), normal(), normal());
        UnitQuaternion::from_quaternion(four).into_inner()
    }

    /// A seed that a scenario file could hold.
    fn seed(&mut self) -> u64 {
        self.0.random::<u64>() >> 11
    }
}

#[cfg(test)]
mod tests;
