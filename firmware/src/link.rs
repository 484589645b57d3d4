//! The MAVLink link: poses, setpoints, requests and parameters in; telemetry, answers and events out.

pub mod frame;
mod reply;

pub use reply::Reply;
