//! Bounds on what goes through an axis' loop, and on what comes to it from outside.

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
    /// What the actuator is told, and that less what it delivers.
    pub command: f64,
    pub behind: f64,
}

/// What differs, bounds: entries as [`crate::sampled_loop::disturbed::Input`]. SI units: forces in m/s^2; the actuator,
/// the command and the bend of a tilt in rad/s^2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation {
    pub force: f64,
    pub actuator: f64,
    pub feedback: f64,
    pub command: f64,
    pub estimate: f64,
    pub unseen: f64,
    pub shaken: f64,
    pub bend: f64,
    pub late: f64,
    pub stray: f64,
    pub uneven: f64,
}

impl Deviation {
    /// All, in the order of their declaration.
    pub fn list(&self) -> [f64; 11] {
        let Self { force, actuator, feedback, command, estimate, unseen, shaken, bend, late, stray, uneven } = *self;
        [force, actuator, feedback, command, estimate, unseen, shaken, bend, late, stray, uneven]
    }

    /// Whether each is at most that of `other`.
    pub fn is_within(&self, other: &Self) -> bool {
        self.list().iter().zip(other.list()).all(|(own, others)| *own <= others)
    }

    /// So many times each.
    pub fn times(&self, factor: f64) -> Self {
        let [force, actuator, feedback, command, estimate, unseen, shaken, bend, late, stray, uneven] =
            self.list().map(|part| factor * part);
        Self { force, actuator, feedback, command, estimate, unseen, shaken, bend, late, stray, uneven }
    }
}
