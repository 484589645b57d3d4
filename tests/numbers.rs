//! A vehicle's numbers from flights, benches and other programs' files.

mod identify;
mod identify_px4;
mod real_flights;
mod vehicle_import;
mod vehicle_models;
