//! The desktop side: a vehicle to fly, scenarios to fly it through, and reports of what was flown.
//!
//! | module | what it holds |
//! |---|---|
//! | [`plant`] | the paper's rigid body, eq. (2) |
//! | [`scenario`] | files to validated types |
//! | [`flight`] | plant, reference and controller in closed loop, one tick at a time |
//! | [`claims`] | what was claimed against what was flown |
//! | [`log`], [`plots`] | log.csv and the figures |
//! | [`fly`], [`law`] | the two commands |

pub mod claims;
pub mod flight;
pub mod fly;
pub mod law;
pub mod log;
pub mod plant;
pub mod plots;
pub mod progress;
pub mod scenario;
