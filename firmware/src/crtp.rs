//! CRTP, which the tools of the Crazyflie speak: cflib, cfclient, Crazyswarm2. Beside MAVLink, by the same rules.
//!
//! | module | what it holds |
//! |---|---|
//! | [`packet`], [`ports`], `fields` | packets, what they are about, numbers in them |
//! | [`task`], [`session`] | packets in and out; each to what it is about |
//! | [`contents`] | tables of contents, which clients keep by their checksum |
//! | [`log`], [`parameters`], [`memories`] | what is logged, set and uploaded |
//! | [`setpoint`], [`high_level`] | what a client has flown: streams, and commands of a place and a time |
//! | [`flying`], [`path`], [`polynomial`], [`pieces`], [`limits`] | how that is led, and how fast |
//! | [`localisation`] | poses from outside |
//! | [`supervisor`], [`platform`] | arming and the emergency stop; what the vehicle is |
//! | [`quaternion`], [`errors`] | attitudes in 32 bits; errors in answers |
//!
//! Whoever arms by CRTP is no station of MAVLink's: any of those may disarm. A vehicle that such a station armed takes
//! no emergency stop from here while that station is heard. A client that sends is a ground station's heartbeat. Poses
//! are taken from one protocol at a time, setpoints from one sender. No answer waits for the vehicle but that to arming.

pub mod contents;
pub mod errors;
mod fields;
pub mod flying;
pub mod high_level;
pub mod limits;
pub mod localisation;
pub mod log;
pub mod memories;
pub mod packet;
pub mod parameters;
pub mod path;
pub mod pieces;
pub mod platform;
pub mod polynomial;
pub mod ports;
pub mod quaternion;
pub mod session;
pub mod setpoint;
pub mod supervisor;
pub mod task;
