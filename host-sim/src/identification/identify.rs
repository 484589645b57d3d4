//! Identification: a vehicle's numbers from the log of a flight and from a bench, each with its uncertainty.
//!
//! | module | what it holds |
//! |---|---|
//! | [`flight_log`], [`ulog`], [`px4`] | the states and commands of a flight, from log.csv, from the firmware's logs, from PX4's |
//! | [`foreign`] | logs of other kinds, and what to do with them |
//! | [`low_passes`] | the low-passes of its body rates, and of the gyro's noise |
//! | [`impulses`] | impulses of the model's rotors between ticks, with a lag and a delay |
//! | [`model`] | the rigid body that is fitted to the log |
//! | [`hubs`] | the air's forces at the rotors' hubs |
//! | [`noise`] | the residuals, whitened |
//! | [`fit`] | the most likely numbers and their covariance |
//! | [`mod@bench`] | weighing, swings, thrust stand |
//! | [`quantities`] | flight and bench together |
//! | [`student_t`] | how wide intervals are, by the length of the flight |
//! | [`agreement`] | whether the two can be of one vehicle |
//! | [`observability`] | what is not observable in a log, and what to fly for it |
//! | [`output`], [`margins`] | the scenario with these numbers; its margins within their uncertainty |
//! | [`command`] | all of it, from files to a report |

pub mod agreement;
pub mod bench;
pub mod command;
pub mod fit;
pub mod flight_log;
pub mod foreign;
pub mod hubs;
pub mod impulses;
pub mod low_passes;
pub mod margins;
pub mod model;
pub mod noise;
pub mod observability;
pub mod output;
pub mod px4;
pub mod quantities;
pub mod student_t;
pub mod ulog;

use bench::Bench;
use flight_log::{FlightLog, Source};
use model::IdentifiedModel;
use quantities::Quantities;
use scenario::Scenario;
use scenario::reality::estimator::IMU_RATE_HZ;

/// The vehicle's numbers from `log` and `bench`; `scenario` is its model.
///
/// # Errors
/// If the log does not fit the model.
pub fn identify(log: &FlightLog, scenario: &Scenario, bench: &Bench) -> Result<Quantities, String> {
    let configuration = &scenario.configuration;
    let reference = log.of_reference();
    let (flown, reference) =
        (IdentifiedModel::new(log, configuration)?, IdentifiedModel::new(&reference, configuration)?);
    let fit = fit::fit(&flown, &reference, log.period)?;
    Quantities::combined(&fit, bench, configuration.vehicle(), late(log, scenario))
}

/// By how much the body rates of a log are late that the sampled loops count, s: with an estimator by a sample of the
/// IMU, besides the [`low_passes`].
fn late(log: &FlightLog, scenario: &Scenario) -> f64 {
    match log.source {
        Source::Estimator => 1.0 / IMU_RATE_HZ,
        Source::Sensors => scenario.input_delay(),
        // PX4's are brought to the time at which they were true.
        Source::Truth | Source::Px4 => 0.0,
    }
}

#[cfg(test)]
mod tests;
