//! A vehicle of one's own: its numbers, from the log of a flight and from a bench, each with its uncertainty.
//!
//! | module | what it holds |
//! |---|---|
//! | [`flight_log`], [`ulog`] | what the vehicle knew in flight, from log.csv or from the firmware's recorder |
//! | [`low_passes`] | what its body rates went through before, and the gyro's noise with them |
//! | [`impulses`] | what the model's rotors gave between ticks, with a lag and a delay |
//! | [`model`] | the rigid body that the log is held against |
//! | [`hubs`] | what the air does at the rotors |
//! | [`noise`] | what is left, made white |
//! | [`fit`] | the most likely numbers and their covariance |
//! | [`mod@bench`] | weighing, swings, thrust stand |
//! | [`quantities`] | flight and bench together |
//! | [`agreement`] | whether the two can be of one vehicle |
//! | [`telling`] | what a log cannot tell, and what to fly for it |
//! | [`output`], [`margins`] | the scenario with these numbers; what the uncertainty eats of its certificate |
//! | [`command`] | all of it, from files to a report |

pub mod agreement;
pub mod bench;
pub mod command;
pub mod fit;
pub mod flight_log;
pub mod hubs;
pub mod impulses;
pub mod low_passes;
pub mod margins;
pub mod model;
pub mod noise;
pub mod output;
pub mod quantities;
pub mod telling;
pub mod ulog;

use bench::Bench;
use flight_log::{FlightLog, Source};
use model::Model;
use quantities::Quantities;
use scenario::Scenario;
use scenario::reality::estimator::IMU_RATE;

/// What `log` and `bench` say of the vehicle whose model is `scenario`'s.
///
/// # Errors
/// If the log is of no flight of it.
pub fn identify(log: &FlightLog, scenario: &Scenario, bench: &Bench) -> Result<Quantities, String> {
    let configuration = &scenario.configuration;
    let asked_for = log.asked_for();
    let (flown, asked) = (Model::new(log, configuration)?, Model::new(&asked_for, configuration)?);
    let fit = fit::fit(&flown, &asked, log.period)?;
    Quantities::combined(&fit, bench, configuration.vehicle(), late(log, scenario))
}

/// By how much the body rates of a log are late that the sampled loops count, s: with an estimator by a sample of the
/// IMU, besides the [`low_passes`].
fn late(log: &FlightLog, scenario: &Scenario) -> f64 {
    match log.source {
        Source::Estimator => 1.0 / IMU_RATE,
        Source::Sensors => scenario.input_delay(),
        Source::Truth => 0.0,
    }
}

#[cfg(test)]
mod tests;
