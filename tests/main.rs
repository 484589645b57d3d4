//! Whole-system tests: everything here runs the crates as they are put together, none of them from the inside. One
//! binary, because linking it once is quicker than linking each suite; `cargo test -p host-sim hysteresis` runs one
//! suite.
//!
//! | room | what belongs there |
//! |---|---|
//! | [`law`] | the laws by themselves: against independent ones, against the paper's theorems, on impossible inputs |
//! | [`proof`] | the certificate: its derivation, adversaries against its bounds, flights and vehicles that it must cover |
//! | [`flights`] | whole flights of the true or measured state, and what they must reach |
//! | [`numbers`] | a vehicle's numbers from flights, benches and other programs' files |
//! | [`sampling`] | sampling, delay and rotor lag: where the loop is stable, and by how much |
//! | [`estimated`] | the estimator, and flights on its estimates |
//! | [`setpoints`] | references from setpoints; other people's controllers within the limits |
//! | [`supervisor`] | the supervisor, whatever fails or lies; how it brakes; hours of it |
//! | [`tasks`] | the firmware's tasks on this desktop; the bits that emulated boards must find again |
//! | [`program`] | the program: its commands, messages and files, and the pages about it |
//! | [`support`] | what several suites share |

mod estimated;
mod flights;
mod law;
mod numbers;
mod program;
mod proof;
mod sampling;
mod setpoints;
mod supervisor;
mod support;
mod tasks;
