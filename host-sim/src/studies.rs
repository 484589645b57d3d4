//! Many flights: to find constants, to count what goes wrong, to compare laws.
//!
//! | module | what it holds |
//! |---|---|
//! | [`tune`] | the constants that certify and make the most of a vehicle; a rival's gains by the same cost |
//! | [`campaign`] | flights in circumstances that differ, on all cores |
//! | [`recovery`] | how much height a recovery costs, and how long it takes: flights from anywhere, and the worst |
//! | [`compare`] | our law and its rivals on one set of scenes |

pub mod campaign;
pub mod compare;
pub mod recovery;
pub mod tune;
