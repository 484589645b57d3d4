//! The desktop side: a vehicle to fly, and reports of its flights. Scenario files and the verdict on them are a
//! crate of their own, [`scenario`], which the firmware's build uses too.
//!
//! [`map`] says which equation of the paper is where in all crates, and which test checks it.
//!
//! Each room imports only from those above it; the program itself, `program/`, from all of them.
//!
//! | room | what it holds |
//! |---|---|
//! | [`output`] | files that appear whole, tables, progress, an end at a signal |
//! | [`vehicle`] | the simulated vehicle: body, rotors, air, ground, sensors |
//! | [`rivals`] | other laws, to compare ours with |
//! | [`flight`] | vehicle, reference and law in closed loop; a flight's figures and claims |
//! | [`reports`] | log.csv, figures, report.html, flight.mcap |
//! | [`identification`] | a vehicle's numbers from flights, benches and other programs' files |
//! | [`real_flights`] | flights of real vehicles, which others recorded |
//! | [`sessions`] | the firmware in closed loop with the vehicle: `sitl`, `hil` |
//! | [`studies`] | many flights: `tune`, `campaign`, `compare` |
//! | [`commands`] | `fly`, `certify`, `law` |
//!
//! Without the feature `desk` there is what also runs in a browser: what needs neither files nor threads nor sockets.

#[cfg(doc)]
#[allow(unused_imports)] // what the page's links name
pub mod map {
    #![doc = include_str!("../../docs/map.md")]
    use controller_core::*;
    use estimation::{estimator, imu, measurement};
    use flight;
}

pub mod commands;
pub mod flight;
pub mod identification;
pub mod output;
#[cfg(feature = "desk")]
pub mod real_flights;
#[cfg(feature = "desk")]
pub mod reports;
pub mod rivals;
#[cfg(feature = "desk")]
pub mod sessions;
#[cfg(feature = "desk")]
pub mod studies;
pub mod vehicle;
