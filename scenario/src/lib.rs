//! Scenario files: everything a flight needs, from TOML to validated types, and whether it may fly.
//!
//! | section | left out |
//! |---|---|
//! | `name`, `[vehicle]` | an error |
//! | `[gains]`, or keys of it | the extended law's follow from the vehicle's numbers; the paper's law needs all |
//! | `duration` | 20 s |
//! | `gravity` of `[vehicle]` | 9.81 m/s^2 |
//! | `[limits]`, or a key of it | what `[rotors]` can give ([`mod@vehicle`]); without them an error |
//! | `[control]` | `rate` 100 Hz; `law` the paper's beside its gains, else the extended one; no `thrust_floor` |
//! | `[estimates]`, or keys of it | as `[gains]` |
//! | `[plant]` | the longest step of at most 1 ms that divides the control period |
//! | `[rotors]` | thrust and torque act directly, clipped to `[limits]` |
//! | `[sampling]` | no delay |
//! | `[reference]` | hover where the flight starts, facing world x; 1 m above the origin if `[initial]` has no position |
//! | `[reference_bounds]` | under the extended law what the vehicle can fly, else the bounds of `[reference]` ([`bounds`]) |
//! | `[truth]`, `[drag]`, `[wind]`, `[disturbance]`, `[battery]`, `[failure]`, `[ground]`, `[sensors]` ([`reality`]) | as the model has it |
//! | `[campaign]` | the circumstances of [`campaign`] |
//! | `[initial]`, or fields of it | on the reference's first point, at rest, level, facing world x |
//!
//! [`mod@file`] reads the whole file; each section has a module, which declares its keys ([`key`]) and reads them.
//! [`schema`] prints the declarations as a JSON schema. Numbers are read in double precision and rounded once, where
//! the law's types take them.
//!
//! [`verdict`] says whether a scenario may fly: from the certificate, which is about commands, from [`stability`],
//! which is about the small motions of the [`sampled_loop`], from the [`large_motions`] of a [`model`], and from what
//! the reference takes [along itself](along); [`board`], whether the firmware can; [`rotor_loss`], what to expect of it
//! without one of its rotors.
//!
//! [`plausibility`] refuses numbers that no vehicle has, as those in other units; [`resolution`] says how far from the
//! origin single precision goes.
//!
//! [`policy`] reads the files of policies, [`cells`] those of numbers.

pub mod actuation;
pub mod along;
pub mod board;
pub mod body;
pub mod bounds;
pub mod campaign;
pub mod cells;
pub mod constants;
pub mod excess;
pub mod extended;
pub mod field_error;
pub mod file;
pub mod inertia;
pub mod initial;
pub mod judge;
pub mod key;
pub mod large_motions;
pub mod model;
pub mod number;
pub mod path;
pub mod plausibility;
pub mod policy;
pub mod reality;
pub mod reference;
pub mod remarks;
pub mod resolution;
pub mod rotor_loss;
pub mod sampled_loop;
pub mod schema;
pub mod section;
pub mod self_contained;
pub mod stability;
pub mod text;
pub mod timing;
pub mod trajectory;
pub mod tube;
pub mod vehicle;
pub mod verdict;

pub use file::{PAPER, STUDY, Scenario, ScenarioError, check_name};
