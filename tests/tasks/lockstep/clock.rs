//! The simulated clock, which `host-sim sitl` flies on as well.

pub use host_sim::sessions::sitl::clock::SimClock;
