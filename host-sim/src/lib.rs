//! The desktop side: a vehicle to fly, scenarios to fly it through, and reports of what was flown.

pub mod sampled_loop;
