//! Bounds on what goes through an axis' loop, and on what comes to it from outside.

use crate::sampled_loop::disturbed::Input;

/// Bounds on an axis' signals, SI units: m, m/s, m/s^2, rad; what turns is in rad/s and rad/s^2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Peaks {
    pub position: f64,
    pub velocity: f64,
    pub z_1: f64,
    pub z_2: f64,
    /// |k_p z_1 + k_v z_2|.
    pub wanted: f64,
    /// |d|.
    pub force: f64,
    /// |c|, |c'| and |c''|; along the vertical the first is |y|.
    pub desired: [f64; 3],
    /// How far c'' jumps at a tick.
    pub jump: f64,
    /// |e| and |e'| between ticks as well, and the projected errors.
    pub error: [f64; 2],
    pub projected: [f64; 2],
    /// How fast at most the tilt's turn changes.
    pub turned: f64,
    /// The torque bias over the moment of inertia.
    pub bias: f64,
    /// The actuator's command, and that less what it delivers.
    pub command: f64,
    pub behind: f64,
}

/// What differs: a bound for each [`Input`], zero where nothing is said. SI units: forces in m/s^2; the actuator, the
/// command and the bend of a tilt in rad/s^2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation([f64; Input::ALL.len()]);

impl Deviation {
    /// With these bounds.
    pub fn of<const N: usize>(bounds: [(Input, f64); N]) -> Self {
        bounds.into_iter().fold(Self::default(), |deviation, (input, bound)| deviation.with(input, bound))
    }

    /// With another bound.
    pub fn with(mut self, input: Input, bound: f64) -> Self {
        self.0[input as usize] = bound;
        self
    }

    /// One of them.
    pub fn at(&self, input: Input) -> f64 {
        self.0[input as usize]
    }

    /// Whether each is at most that of `other`.
    pub fn is_within(&self, other: &Self) -> bool {
        Input::ALL.iter().all(|input| self.at(*input) <= other.at(*input))
    }

    /// So many times each.
    pub fn times(&self, factor: f64) -> Self {
        Self(self.0.map(|bound| factor * bound))
    }
}
