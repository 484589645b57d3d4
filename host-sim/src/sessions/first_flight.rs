//! A first flight's bench checks, walked through with a person at the vehicle and a link to it; no debug probe.
//!
//! ```text
//! person <- instructions, questions | answers -> walk <- telemetry, words | commands -> vehicle
//!                                                 '-> record of what passed -> page to sign
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`mod@line`], [`vehicle`] | bytes to and from the vehicle; what it says and answers |
//! | [`person`] | questions and answers, at a terminal or out of a file |
//! | [`judge`] | what measured values mean |
//! | [`walk`] | vehicle and person together: what checks are made with |
//! | [`checks`] | the checks, in their order |
//! | [`course`] | one check after the other |
//! | [`outcome`], [`record`], [`page`] | what passed, kept over walks; the page to sign |
//!
//! A check that fails ends the walk: the next ones rest on it. It is safe to break off at any question: the vehicle is
//! disarmed in all of them but the last checks, and a vehicle without heartbeats disarms.

pub mod checks;
pub mod course;
pub mod judge;
pub mod line;
pub mod outcome;
pub mod page;
pub mod person;
pub mod record;
pub mod vehicle;
pub mod walk;

#[cfg(test)]
mod tests;
