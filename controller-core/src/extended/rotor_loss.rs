//! A rotor that fails: found from the motion, and flown without.
//!
//! | module | what it holds |
//! |---|---|
//! | [`detector`] | which rotor, and what it has left |
//! | [`spinning`] | the law with the rotors that are left: it turns, and holds its place |
//! | [`crate::allocation::remaining`] | their thrusts, each within its range |
//!
//! The law's own proof is of a vehicle with all its rotors. Without one of them only this holds by construction: every
//! rotor's command is within its range, whatever happens. What the vehicle then does is measured: docs/rotor-loss.md.

pub mod detector;
pub mod spinning;
