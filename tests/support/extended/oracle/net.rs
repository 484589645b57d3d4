//! Section 13: the net, for a vehicle whose drives are changed without end.

use super::{Law, double};
use nalgebra::Vector3;

/// When the net catches, s, what it forgives of a silent time, and how near the target is, m and m/s.
pub const PATIENCE: f64 = 60.0;
const FORGIVEN: f64 = 0.05;
const NEAR: f64 = 0.05;

/// The net: for how long drives were changed, and whether its level is in force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Net {
    pub acted: f64,
    pub caught: bool,
}

impl Net {
    /// Itself, or as it catches: its level is in force from this tick on. And whether it does.
    pub fn catching(self) -> (Self, bool) {
        let catches = self.acted > PATIENCE && !self.caught;
        (if catches { Self { acted: 0.0, caught: true } } else { self }, catches)
    }

    /// After a tick of `period` s with the errors z_1 and z_2, in which drives were `changed` or not.
    pub fn after(self, [z_1, z_2]: &[Vector3<f64>; 2], changed: bool, period: f64) -> Self {
        if z_1.norm() < NEAR && z_2.norm() < NEAR {
            Self { acted: 0.0, caught: false }
        } else if changed {
            Self { acted: self.acted + period, ..self }
        } else {
            Self { acted: (self.acted - FORGIVEN * period).max(0.0), ..self }
        }
    }
}

impl Law {
    /// The net's level, section 13: c' and c'' take half of Omega and three tenths of alpha_0 at the least |u|.
    pub fn net_level(&self) -> f64 {
        let p = &self.p;
        let [k_f, k_s] = [p.k_f, p.k_s].map(double);
        let least = self.gravity - double(p.a_down);
        let by_rate = 0.5 * double(p.turn_rate) * least / (2.0 * k_f);
        by_rate.min(0.3 * double(p.turn_reserve) * least / (2.0 * k_f * (k_s + k_f)))
    }
}
