//! Flights of real vehicles, which others recorded: what they say of a vehicle, of our estimator and of our law.
//!
//! ```text
//! files of numbers + columns.toml -> streams -> one clock, checked -> identified vehicle -> predictions
//!                                                                  -> our estimator on the same sensors
//!                                                                  -> our law in the same air
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`columns`] | which column is what, in which unit and frame |
//! | `numbers` | the files' numbers, by the names of columns |
//! | [`recording`] | streams in SI units and our frames, each on its own times |
//! | `series` | a stream: repeated rows left out, gaps kept |
//! | [`alignment`] | how late poses are on the vehicle's clock, moment by moment |
//! | `slopes` | slopes of what is noisy |
//! | [`flown`] | the flight, sample by sample, on the vehicle's clock |
//! | [`suspicions`] | wrong units, axes, motors and times, each by its name |
//! | `regression` | least squares with parts left out |
//! | [`forces`] | thrust, rotor lag and drag, by accelerometer |
//! | [`torques`] | inertia, or why the log cannot show it |
//! | [`model`] | the vehicle that was found, and how it moves on |
//! | [`prediction`] | one half of a flight foretold by the other |
//! | [`estimation`] | our estimator on the recorded sensors |
//! | [`setpoint_path`] | recorded setpoints as a path for our law |
//! | [`law`] | our law's commands beside those that flew, and its flight in the same air |
//! | [`picture`] | a picture of both
//! | [`command`] | the commands, from files to reports |

pub mod alignment;
pub mod columns;
pub mod command;
pub mod estimation;
pub mod flown;
pub mod forces;
pub mod law;
pub mod model;
pub(crate) mod numbers;
pub mod picture;
pub mod prediction;
pub mod recording;
pub(crate) mod regression;
pub(crate) mod series;
pub mod setpoint_path;
pub(crate) mod slopes;
pub mod suspicions;
pub mod torques;
