//! The supervisor, whatever fails or lies; how it brakes; hours of it.

mod braking;
mod endurance;
mod fault_campaign;
mod lying_poses;
mod rotor_loss;
