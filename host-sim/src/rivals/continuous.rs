//! A continuous attitude law: the error's quaternion follows its own path, whichever of the two it becomes.
//!
//! The law of [`quaternion_feedback`](super::quaternion_feedback) with q chosen next to the q of the tick before. It is
//! continuous along every motion, and so what S. P. Bhat, D. S. Bernstein: *A topological obstruction to continuous
//! global stabilization of rotational motion and the unwinding phenomenon*, Systems & Control Letters 39, 2000, say of
//! such laws holds: q and -q are one attitude, but only q = +1 is its goal. Past half a turn it goes on for the whole
//! of it, or back all the way it came.
//!
//! Home: errors that never pass half a turn.

use super::quaternion_feedback::QuaternionFeedback;
use super::rival::{Commanded, Rival, RivalReference, RivalState};
use nalgebra::Quaternion;

pub use super::quaternion_feedback::{GAIN_PACES, NAMES, START_GAINS};

/// The law and the quaternion it was at.
#[derive(Debug, Clone)]
pub struct Continuous {
    law: QuaternionFeedback,
    before: Option<Quaternion<f64>>,
}

impl Continuous {
    /// On the side of q_0 >= 0 at first.
    #[must_use]
    pub fn new(law: QuaternionFeedback) -> Self {
        Self { law, before: None }
    }

    /// After one whole turn: the same attitude, on the side of q_0 < 0.
    #[must_use]
    pub fn after_a_turn(law: QuaternionFeedback) -> Self {
        Self { law, before: Some(-Quaternion::identity()) }
    }
}

impl Rival for Continuous {
    fn step(&mut self, state: &RivalState, target: &RivalReference) -> Commanded {
        let before = self.before.unwrap_or_else(Quaternion::identity);
        let mut chosen = before;
        let commanded = self.law.step(state, target, |error| {
            chosen = if error.dot(&before) < 0.0 { -error } else { error };
            chosen
        });
        self.before = Some(chosen);
        commanded
    }

    fn boxed(&self) -> Box<dyn Rival> {
        Box::new(self.clone())
    }
}
