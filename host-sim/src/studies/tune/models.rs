//! The vehicles that a search flies: the file's, and others that it might really be.

use std::fmt;

/// A vehicle as it may really be, relative to the file's model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    /// Factor on the mass.
    pub mass: f64,
    /// The thrust scale.
    pub thrust: f64,
    /// Centre of mass, m, body; on small vehicles nearer, by `CENTRE_OFFSET_MAX_SHARE`.
    pub centre_of_mass: [f64; 2],
    /// Factor on the rotors' lag.
    pub lag: f64,
    /// Further delay, s, rounded to plant steps.
    pub delay: f64,
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mass, thrust, centre_of_mass: [x, y], lag, delay } = self;
        write!(f, "mass times {mass}, thrust times {thrust}, centre of mass at [{x}, {y}] m, ")?;
        write!(f, "lag times {lag}, {delay} s of further delay")
    }
}

/// The models a cost is averaged over: as the file says; and mass and thrust 10 % off, the centre of mass 5 mm, half as
/// much lag again, 5 ms of delay, in combinations.
pub const COST_MODELS: [Model; 4] = [
    Model { mass: 1.0, thrust: 1.0, centre_of_mass: [0.0, 0.0], lag: 1.0, delay: 0.0 },
    Model { mass: 1.1, thrust: 0.9, centre_of_mass: [0.004, 0.003], lag: 1.5, delay: 0.0 },
    Model { mass: 0.9, thrust: 1.1, centre_of_mass: [-0.003, 0.004], lag: 1.0, delay: 0.005 },
    Model { mass: 1.0, thrust: 1.0, centre_of_mass: [0.0, 0.0], lag: 1.5, delay: 0.005 },
];
