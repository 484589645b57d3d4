//! The core from outside: references, rotors and allocation.

mod allocation;
mod harmonic;
mod proofs;
mod rotor_demand;
mod support;
mod waypoints;
