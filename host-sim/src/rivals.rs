//! Other laws, to compare ours with: in the same simulator, through the same allocation, limits, sensors, estimator and
//! clock.
//!
//! They are references for comparison, written from their papers in double precision. They are not proven, and not
//! meant to fly. Each module says what its paper leaves open, and what it lacks that ours has (feed-forward, separate
//! gains for tilt and yaw). Their gains are found by the cost that ours are tuned by
//! ([`crate::studies::tune::rivals`]).
//!
//! | module | law |
//! |---|---|
//! | `lee` | geometric tracking on SE(3): Lee, Leok, McClamroch, 2010 |
//! | `cascade` | P and PID loops around a quaternion law: PX4; Brescianini, Hehn, D'Andrea, 2013 |
//! | `mellinger` | Mellinger, Kumar, 2011 |
//! | `indi` | incremental inversion, with accelerometer and rotor speeds: Smeur, 2016; Tal, Karaman, 2021 |
//! | [`nested`] | nested saturations around a saturated hybrid attitude law: Martins, 2024 |
//! | [`continuous`] | continuous quaternion feedback, which unwinds: Wie, 1989; Bhat, Bernstein, 2000 |
//! | [`memoryless`] | discontinuous without memory, which chatters: Fjellstad, Fossen, 1994 |
//! | [`rival`], [`pilot`] | a rival's inputs and outputs; its place in a flight |
//! | [`jet`], `frame`, `low_pass`, [`quaternion_feedback`] | parts that several of them share |
//! | [`kind`], [`gains`] | the list of them; their gains, from a file |
//! | [`start`] | where the search for them starts ([`crate::studies::tune::rivals`]) |
//! | [`choice`] | which law flies, ours or one of these |
//! | [`rate`] | a scenario under a law of another rate |

pub(crate) mod cascade;
pub mod choice;
pub mod continuous;
pub(crate) mod frame;
pub mod gains;
pub(crate) mod indi;
pub mod jet;
pub mod kind;
pub(crate) mod lee;
pub(crate) mod low_pass;
pub(crate) mod mellinger;
pub mod memoryless;
pub mod nested;
pub mod pilot;
pub mod quaternion_feedback;
pub mod rate;
pub mod rival;
pub mod start;

#[cfg(test)]
mod tests;
