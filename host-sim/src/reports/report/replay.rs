//! Vehicles that move in space: body and rotors, thrust, and their references.
//!
//! A body's track has the columns of log.csv: `px … pz`, `qw … qz` (body to world), `thrust`; `pdx … pdz` and `yaw_d`
//! (degrees) for the reference; `rotor_1 …` where there are rotors. World z up, body x forward, y left, z up; metres,
//! newtons.

use super::plot::Color;
use serde_json::{Value, json};

/// A vehicle of a replay.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Body {
    /// Which of the page's tracks moves it.
    pub track: usize,
    /// Its name, where there are several.
    pub label: String,
    /// The colour of its path.
    pub color: Color,
}

/// A replay.
#[derive(Debug, Clone, PartialEq)]
pub struct Replay {
    /// Who flies. The first one's reference is shown.
    pub bodies: Vec<Body>,
    /// Hub of each rotor, m, body frame; empty for a vehicle without, which is drawn with four.
    pub rotors: Vec<[f64; 3]>,
    /// Thrust that carries the weight, N: how long a vector of that length is drawn is the program's choice.
    pub hover_thrust: f64,
}

impl Replay {
    /// Its data for the page's program.
    pub fn json(&self) -> Value {
        let bodies = self
            .bodies
            .iter()
            .map(|body| json!({ "track": body.track, "label": body.label, "color": body.color.name() }));
        json!({ "bodies": bodies.collect::<Vec<_>>(), "rotors": self.rotors, "hoverThrust": self.hover_thrust })
    }
}
