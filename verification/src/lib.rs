//! What only tests, examples and benches fly. No product depends on it.
//!
//! | module | what it holds |
//! |---|---|
//! | [`piloted`] | the whole pilot in closed loop: supervisor, estimator, conditioner, governor, law |
//! | [`mod@hours`] | hours of missions with faults, on one pilot |
//! | [`campaign`] | flights in circumstances that differ, on all cores |
//! | [`half_turn`] | attitude laws at half a turn, with noise: unwinding and chattering |
//! | [`identify_trials`] | flights of vehicles that are not what their file says, to see how often `identify` is right |
//!
//! The tests that use it are the whole-system tests in `tests/`, the programs are `host-sim/examples`: both belong to
//! `host-sim`, which has this crate as a dev-dependency.

pub mod campaign;
pub mod half_turn;
pub mod hours;
pub mod identify_trials;
pub mod piloted;
