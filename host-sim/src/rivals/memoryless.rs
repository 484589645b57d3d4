//! A memoryless discontinuous attitude law: of the error's two quaternions always the nearer one.
//!
//! The law of [`quaternion_feedback`](super::quaternion_feedback) with the q of q_0 >= 0: tau = -k sgn(q_0) q_v - …, as
//! in O.-E. Fjellstad, T. I. Fossen: *Position and attitude tracking of AUV's: a quaternion feedback approach*, IEEE
//! Journal of Oceanic Engineering 19, 1994. It never unwinds. At half a turn it jumps without memory: C. G. Mayhew, R.
//! G. Sanfelice, A. R. Teel: *Quaternion-based hybrid control for robust global attitude tracking*, IEEE Transactions
//! on Automatic Control 56, 2011, show that arbitrarily small noise can hold it there for ever.
//!
//! Home: errors that stay away from half a turn.

use super::quaternion_feedback::QuaternionFeedback;
use super::rival::{Commanded, Rival, RivalReference, RivalState};

pub use super::quaternion_feedback::{GAIN_PACES, NAMES, START_GAINS};

/// The law; it remembers nothing.
#[derive(Debug, Clone)]
pub struct Memoryless(pub QuaternionFeedback);

impl Rival for Memoryless {
    fn step(&mut self, state: &RivalState, target: &RivalReference) -> Commanded {
        self.0.step(state, target, |error| if error.w < 0.0 { -error } else { error })
    }

    fn boxed(&self) -> Box<dyn Rival> {
        Box::new(self.clone())
    }
}
