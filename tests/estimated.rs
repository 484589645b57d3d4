//! The estimator, and flights on its estimates.

mod estimated_flights;
mod estimator;
