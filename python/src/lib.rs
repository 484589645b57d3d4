//! What `host-sim` does, for Python: `saturated_hybrid._core`, which `source/saturated_hybrid` shows to its users.
//!
//! | module | what it holds |
//! |---|---|
//! | [`scenarios`] | scenarios from files, text and the built-in ones; edited copies; their references |
//! | [`imports`] | vehicles from the files and dictionaries of other programs |
//! | [`laws`] | the control law, one vehicle or rows of them |
//! | [`shields`] | the law behind which a policy flies, one vehicle or rows of them |
//! | [`networks`] | a small network as a policy |
//! | [`certificates`] | the certificate and the sampled loops, in numbers and words |
//! | [`governors`], [`allocations`] | setpoints to references, wrenches to rotors |
//! | [`flights`], [`campaigns`], [`tuning`] | whole flights, thousands of them, the search for gains |
//! | [`vehicles`] | rows of simulated vehicles, for environments |
//! | [`rotor_vehicles`] | one simulated vehicle under its rotors' thrusts |
//! | [`replays`] | pictures and replays of flights that something else flew |
//! | [`rows`] | numpy arrays as states, references and wrenches, and back |
//! | [`whole_number`] | whole numbers as arguments |
//! | [`errors`], [`interruptible`], [`threads`] | errors; long work that lets other threads run and Ctrl-C through; on which threads |
//!
//! Arrays that come in may have any numeric type and are rounded once, where the law's single precision begins; those
//! that go out have the precision of what they hold. What documents the items here is their docstring in Python, which
//! `source/saturated_hybrid/_core.pyi` repeats with types; a test compares the two.

mod allocations;
mod campaigns;
mod certificates;
mod errors;
mod flights;
mod governors;
mod imports;
mod interruptible;
mod laws;
mod networks;
mod replays;
mod rotor_vehicles;
mod rows;
mod scenarios;
mod shield_arguments;
mod shield_row;
mod shields;
mod threads;
mod tuning;
mod vehicles;
mod whole_number;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    #[pymodule_export]
    use super::allocations::Allocation;
    #[pymodule_export]
    use super::campaigns::{Campaign, campaign, merge};
    #[pymodule_export]
    use super::certificates::{Certificate, Inequality, Loop, certify};
    #[pymodule_export]
    use super::flights::{Claim, Flight, fly};
    #[pymodule_export]
    use super::governors::Governor;
    #[pymodule_export]
    use super::imports::Vehicle;
    #[pymodule_export]
    use super::laws::{Law, LawRows};
    #[pymodule_export]
    use super::networks::Network;
    #[pymodule_export]
    use super::replays::{picture, replay};
    #[pymodule_export]
    use super::rotor_vehicles::RotorVehicle;
    #[pymodule_export]
    use super::rows::{reference, state};
    #[pymodule_export]
    use super::scenarios::Scenario;
    #[pymodule_export]
    use super::shields::{Shield, ShieldRows};
    #[pymodule_export]
    use super::tuning::{Tuned, tune};
    #[pymodule_export]
    use super::vehicles::VehicleRows;
}
