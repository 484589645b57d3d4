//! Sampling, delay and rotor lag: where the loop is stable, and by how much.

mod rotor_lag;
mod sampled_loop;
