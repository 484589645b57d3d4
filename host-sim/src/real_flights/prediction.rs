//! One half of a flight foretold by the other.
//!
//! A vehicle is found from the first half alone. From many states of the second half it is then moved on by the
//! commands that were logged, for 0.1, 0.5 and 1 s, and compared with where the vehicle was. Three ways:
//!
//! | | thrust | turning |
//! |---|---|---|
//! | commands | by the model | by the model |
//! | gyro | by the model | as the gyro measured it: what is left is thrust's and drag's |
//! | hover | the weight's, no drag | goes on as it is, without torque |
//!
//! What is left of the start's own errors is in all three.

use super::flown::{Flown, PERIOD_S, Sample};
use super::forces::lagged;
use super::model::{FoundVehicle, Motion, advanced};
use controller_core::allocation::Rotors;
use nalgebra::Vector3;

/// How far ahead, s.
pub const HORIZONS_S: [f64; 3] = [0.1, 0.5, 1.0];
/// Between two starts, samples.
const EVERY: usize = 10;

/// The ways, by name.
pub const WAYS: [&str; 3] = ["commands", "gyro", "hover"];

/// RMS errors.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// m.
    pub position: f64,
    /// m/s.
    pub velocity: f64,
    /// rad.
    pub attitude: f64,
    /// rad/s.
    pub rates: f64,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Foretold {
    /// Way by way, each at every horizon.
    pub errors: [[Errors; 3]; 3],
    /// How many there were.
    pub starts: usize,
}

/// Foretells `flown` from sample `first` on, by `vehicle`.
pub fn foretold(flown: &Flown, first: usize, vehicle: &FoundVehicle, rotors: &Rotors) -> Foretold {
    let samples = &flown.samples;
    let acting = lagged(samples, vehicle.lags);
    let steps = HORIZONS_S.map(|seconds| (seconds / PERIOD_S).round() as usize);
    let farthest = steps.iter().copied().max().unwrap_or(0);
    let mut squares = [[[0.0; 4]; 3]; 3];
    let mut starts = 0;
    for start in (first..samples.len().saturating_sub(farthest)).step_by(EVERY) {
        starts += 1;
        for (way, squares) in squares.iter_mut().enumerate() {
            let mut motion = Motion::of_sample(&samples[start]);
            for step in 1..=farthest {
                motion = moved(
                    way,
                    &motion,
                    &samples[start + step - 1..=start + step],
                    &acting[start + step - 1..=start + step],
                    vehicle,
                    rotors,
                );
                if let Some(horizon) = steps.iter().position(|horizon| *horizon == step) {
                    let apart = apart(&motion, &samples[start + step]);
                    squares[horizon].iter_mut().zip(apart).for_each(|(sum, apart)| *sum += apart * apart);
                }
            }
        }
    }
    let rms = |squares: [f64; 4]| {
        let [position, velocity, attitude, rates] =
            squares.map(|square| (square / f64::from(starts.max(1) as u32)).sqrt());
        Errors { position, velocity, attitude, rates }
    };
    Foretold { errors: squares.map(|way| way.map(rms)), starts }
}

/// One sample on.
fn moved(
    way: usize,
    motion: &Motion,
    samples: &[Sample],
    acting: &[Vec<f64>],
    vehicle: &FoundVehicle,
    rotors: &Rotors,
) -> Motion {
    if way == 2 {
        return advanced(motion, &(Vector3::z() * vehicle.gravity), &Vector3::zeros(), vehicle.gravity);
    }
    let thrusts: Vec<f64> = acting[0].iter().zip(&acting[1]).map(|(a, b)| (a + b) * 0.5).collect();
    let force = vehicle.force(&thrusts, &motion.attitude.inverse_transform_vector(&motion.velocity));
    let turned = if way == 1 {
        (samples[1].rates - motion.rates) / PERIOD_S
    } else {
        vehicle.turned(&thrusts, rotors, &motion.rates)
    };
    advanced(motion, &force, &turned, vehicle.gravity)
}

fn apart(motion: &Motion, sample: &Sample) -> [f64; 4] {
    [
        (motion.position - sample.position).norm(),
        (motion.velocity - sample.velocity).norm(),
        motion.attitude.angle_to(&sample.attitude),
        (motion.rates - sample.rates).norm(),
    ]
}
