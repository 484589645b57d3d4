//! The estimator as a whole, on synthesised flights: noise-free here, so that every figure is the method's own. Flights
//! with noise, by the hundred, are in `tests/estimated/estimator.rs`.

mod felt;
mod lies;
mod motion;
mod poses;
mod shocks;
mod starting;
