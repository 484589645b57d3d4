//! The desktop side: a vehicle to fly, scenarios to fly it through, and reports of what was flown.

pub mod claims;
pub mod flight;
pub mod law;
pub mod log;
pub mod plant;
pub mod scenario;
