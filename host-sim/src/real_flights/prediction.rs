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
//! What is left of the start's own errors is in all three. The times of poses, their tilt and the gyro's bias are those
//! of the whole flight: they say how it was measured, not how it flew.

use super::flown::{Flown, PERIOD_S, Sample};
use super::forces::lagged;
use super::model::{FoundVehicle, Motion, advanced};
use controller_core::allocation::Rotors;
use nalgebra::Vector3;

/// How far ahead, s.
pub const HORIZONS_S: [f64; 3] = [0.1, 0.5, 1.0];
/// Between two starts, samples.
const START_SPACING_SAMPLES: usize = 10;

/// What foretells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// Thrust and turning by the model.
    Commands,
    /// Thrust by the model, turning as measured.
    Gyro,
    /// The weight carried, turning going on.
    Hover,
}

impl Way {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Commands, Self::Gyro, Self::Hover];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Commands => "commands",
            Self::Gyro => "gyro",
            Self::Hover => "hover",
        }
    }
}

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
    for start in (first..samples.len().saturating_sub(farthest)).step_by(START_SPACING_SAMPLES) {
        starts += 1;
        for (way, squares) in Way::ALL.into_iter().zip(&mut squares) {
            let mut motion = Motion::of_sample(&samples[start]);
            for step in 1..=farthest {
                let until = start + step - 1..=start + step;
                motion = moved(way, &motion, &samples[until.clone()], &acting[until], vehicle, rotors);
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
    way: Way,
    motion: &Motion,
    samples: &[Sample],
    acting: &[Vec<f64>],
    vehicle: &FoundVehicle,
    rotors: &Rotors,
) -> Motion {
    let thrusts: Vec<f64> = acting[0].iter().zip(&acting[1]).map(|(a, b)| (a + b) * 0.5).collect();
    let by_model = || vehicle.force(&thrusts, &motion.attitude.inverse_transform_vector(&motion.velocity));
    let (force, turned) = match way {
        Way::Commands => (by_model(), vehicle.turned(&thrusts, rotors, &motion.rates)),
        Way::Gyro => (by_model(), (samples[1].rates - motion.rates) / PERIOD_S),
        Way::Hover => (Vector3::z() * vehicle.gravity, Vector3::zeros()),
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
