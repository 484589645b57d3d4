//! A serial line in memory, which `host-sim sitl` has as well.

pub use host_sim::sessions::sitl::line::Line;
