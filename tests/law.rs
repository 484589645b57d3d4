//! The laws by themselves: against independent ones, against the paper's theorems, on impossible inputs.

mod bad_inputs;
mod bounds;
mod extended_flows;
mod extended_independent;
mod half_turn;
mod independent_law;
mod kinematics;
mod lyapunov;
