//! The desktop side: a vehicle to fly, and reports of its flights. Scenario files and the verdict on them are a
//! crate of their own, [`scenario`], which the firmware's build uses too.
//!
//! [`map`] says which equation of the paper is where in all crates, and which test checks it.
//!
//! | module | what it holds |
//! |---|---|
//! | [`plant`] | the paper's rigid body, eq. (2) |
//! | [`actuators`] | delay, allocation and rotors that lag |
//! | [`reality`] | the vehicle as it really is: drag, wind, wrong mass, sagging battery, failing rotor |
//! | [`vehicle`] | the one or the other, as the scenario says |
//! | [`sensors`] | the measured state |
//! | [`instruments`], [`estimation`] | an IMU at 1 kHz and late poses; the core's estimator on them |
//! | [`ground`] | level ground, for flights that start and end there |
//! | [`controller`], [`rivals`], [`flier`] | our law; other laws to compare it with; the choice |
//! | [`flight`] | plant, reference and controller in closed loop, one tick at a time |
//! | [`course`], [`campaign`] | a flight's figures; many flights at once, on all cores |
//! | [`flown`], [`claims`] | a flight's extremes; its claims and verdicts |
//! | [`log`], [`recording`], [`plots`] | log.csv, flight.mcap and the figures |
//! | [`identify`] | a vehicle's numbers from the log of a flight and from a bench |
//! | [`import`] | a vehicle's numbers from files of other programs |
//! | [`report`] | report.html: a page of tables, plots, replays and distributions |
//! | [`fly`], [`law`], [`certify`], [`tune`], [`compare`], [`hil`], [`sitl`] | the commands |

#[cfg(doc)]
#[allow(unused_imports)] // what the page's links name
pub mod map {
    #![doc = include_str!("../../docs/map.md")]
    use controller_core::*;
    use estimation::{estimator, imu, measurement};
    use flight;
}

pub mod actuators;
pub mod campaign;
pub mod certify;
pub mod claims;
pub mod compare;
pub mod controller;
pub mod course;
pub mod directory_lock;
pub mod estimation;
pub mod flier;
pub mod flight;
pub mod flown;
pub mod fly;
pub mod ground;
pub mod hil;
pub mod identify;
pub mod import;
pub mod instruments;
pub mod interrupt;
pub mod law;
pub mod log;
pub mod plant;
pub mod plots;
pub mod progress;
pub mod reality;
pub mod recording;
pub mod reference_rows;
pub mod report;
pub mod rivals;
pub mod sensed;
pub mod sensors;
pub mod sitl;
pub mod table;
pub mod tune;
pub mod ulog;
pub mod vehicle;
pub mod whole_file;
