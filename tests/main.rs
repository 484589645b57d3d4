//! Whole-system tests: everything here runs the crates as they are put together, none of them from the inside. One
//! binary, because linking it once is quicker than linking each suite; `cargo test -p host-sim hysteresis` runs one
//! suite.
//!
//! | what is tested | suites |
//! |---|---|
//! | the law | [`independent_law`], [`extended_independent`], [`kinematics`], [`lyapunov`], [`extended_flows`], [`attitude_sign`], [`bad_inputs`], [`bounds`] |
//! | the laws beside it, at half a turn | [`half_turn`] |
//! | a vehicle's numbers from a flight and a bench; from other programs' files | [`identify`], [`identify_px4`]; [`vehicle_import`], [`vehicle_models`] |
//! | the estimated state | [`estimator`], [`estimated_flights`] |
//! | its proof | [`adversary`], [`extended_adversary`], [`sharp_derivation`], [`certified_flights`], [`vehicles`], [`published`] |
//! | its flights | [`paper`], [`recovery`], [`hysteresis`], [`tuned`], [`reality`], [`beyond_the_model`], [`vibration`], [`touchdown`], [`pilots_table`], [`steady_circle`], [`progress`]; along files: [`trajectory_files`] |
//! | sampling, delay and rotor lag | [`sampled_loop`], [`rotor_lag`] |
//! | references from setpoints | [`governor_campaign`] |
//! | other people's controllers within the limits | [`shield`] |
//! | the supervisor, whatever fails or lies; how it brakes; hours of it | [`fault_campaign`], [`lying_poses`], [`braking`], [`endurance`] |
//! | the firmware's tasks | [`lockstep`], [`emulated_bits`] |
//! | the program and the pages | [`cli`], [`cli_campaign`], [`cli_campaign_directory`], [`cli_certify`], [`cli_compare`], [`cli_identify`], |
//! |  | [`cli_output`], [`cli_overwriting`], [`cli_verdicts`], [`documentation`], [`documented_defaults`] |

mod adversary;
mod attitude_sign;
mod bad_inputs;
mod beyond_the_model;
mod bounds;
mod braking;
mod certified_flights;
mod cli;
mod cli_campaign;
mod cli_campaign_directory;
mod cli_certify;
mod cli_compare;
mod cli_identify;
mod cli_output;
mod cli_overwriting;
mod cli_verdicts;
mod documentation;
mod documented_defaults;
mod emulated_bits;
mod endurance;
mod estimated_flights;
mod estimator;
mod extended_adversary;
mod extended_flows;
mod extended_independent;
mod fault_campaign;
mod governor_campaign;
mod half_turn;
mod hysteresis;
mod identify;
mod identify_px4;
mod independent_law;
mod kinematics;
mod lockstep;
mod lyapunov;
mod lying_poses;
mod paper;
mod pilots_table;
mod progress;
mod published;
mod reality;
mod recovery;
mod rotor_lag;
mod rotor_loss;
mod sampled_loop;
mod sharp_derivation;
mod shield;
mod steady_circle;
mod support;
mod touchdown;
mod trajectory_files;
mod tuned;
mod vehicle_import;
mod vehicle_models;
mod vehicles;
mod vibration;
