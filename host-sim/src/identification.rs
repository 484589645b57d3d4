//! A vehicle's numbers, from what people have.
//!
//! | module | what it holds |
//! |---|---|
//! | [`identify`] | from the log of a flight and from a bench, each number with its uncertainty |
//! | [`import`] | from files of other programs: URDF, SDF, MJCF, Betaflight, PX4 and others |
//! | [`ulog`] | ULog, read and written |

#[cfg(feature = "desk")]
pub mod identify;
pub mod import;
#[cfg(feature = "desk")]
pub mod ulog;
