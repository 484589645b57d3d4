//! The state a quadrotor flies on, from its inertial sensor and from poses that may be late, wrong or missing.
//!
//! - [`imu`]: samples integrated for the estimator, low-passed for the law, watched for faults, calibrated;
//! - [`measurement`]: a pose, a sample, and the time at which they were true;
//! - [`estimator`]: an error-state Kalman filter that accepts or refuses every pose, with the reason.
//!
//! Frames and units are [`controller_core`]'s. `no_std`, no allocation, no panics, single precision.
//!
//! # Features
//!
//! - `defmt`: errors can be written to defmt logs. Such a build links only for targets with a defmt logger.

#![no_std]
#![deny(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable)
)]

#[macro_use]
mod listed;

pub mod estimator;
pub mod imu;
pub mod measurement;
