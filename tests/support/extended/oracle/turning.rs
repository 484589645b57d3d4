//! Section 3: how fast and how soon the thrust direction may turn, in world axes.

use super::{Law, double};
use nalgebra::Vector3;

/// k.
const SOFTNESS_PER_S: f64 = 10.0;

/// How u moves, and what bounds it.
pub struct Turn {
    pub rho: Vector3<f64>,
    pub n: f64,
    /// rho . u'.
    pub r: f64,
    /// rho', and rho'' as wanted without its radial part.
    pub p: Vector3<f64>,
    pub q: Vector3<f64>,
    /// rho . u''.
    pub along: f64,
}

/// `v`, at most `length` long, and whether it was shortened.
fn shortened(v: Vector3<f64>, length: f64) -> (Vector3<f64>, bool) {
    let long = v.norm() > length;
    (if long { v * (length / v.norm()) } else { v }, long)
}

impl Law {
    /// q, in world axes, before its share is known; whether rate, acceleration and cone had a say.
    pub fn turned(&self, turn: &Turn, nudge: &Vector3<f64>) -> (Vector3<f64>, [bool; 3]) {
        let (parameters, h) = (&self.p, self.period);
        let Turn { rho, p, q, .. } = turn;
        let rate = double(parameters.turn_rate);
        let alpha = self.alpha();
        let (mut q, sooner) = shortened(*q, alpha);
        // e3 without its part along rho.
        let z = Vector3::z() - rho * rho.z;
        let least = -(0.5 * alpha).sqrt() * (rho.z - double(parameters.tilt_max).cos());
        let tilted = (p + q * h).dot(&z) < least;
        if tilted {
            // As much along z as it takes, and of the rest what is left of alpha.
            let z = z / z.norm().max(1e-3);
            let along = ((least / z.dot(&Vector3::z()).max(1e-3) - p.dot(&z)) / h).clamp(-alpha, alpha);
            let across = q - z * q.dot(&z);
            q = shortened(across, (alpha * alpha - along * along).max(0.0).sqrt()).0 + z * along;
        }
        let (next, faster) = shortened(p + q * h, rate);
        if faster {
            q = shortened((next - p) / h, alpha).0;
        }
        let changed = [faster, sooner, tilted];
        (if changed.contains(&true) { q + nudge } else { q }, changed)
    }

    /// What is added to u'' where rho turns with `q`, and whether |u| and c_z had a say.
    pub fn change(
        &self,
        turn: &Turn,
        q: &Vector3<f64>,
        greatest: f64,
        [c, c_rate, c_second]: &[f64; 3],
    ) -> (Vector3<f64>, [bool; 2]) {
        let Turn { rho, n, r, p, q: wanted, along: radial } = turn;
        let tangential = (q - wanted) * *n;
        let k = SOFTNESS_PER_S.min(0.5 / self.period);
        let mut along = 0.0;
        let falling = c_second + tangential.z;
        let climbing = -2.0 * k * c_rate - k * k * (c + double(self.p.a_down));
        let falls = falling < climbing;
        if falls {
            along = (climbing - falling) / rho.z;
        }
        let swelling = radial + along + n * p.norm_squared();
        let shrinking = -2.0 * k * r - k * k * (n - greatest);
        let swells = swelling > shrinking;
        if swells {
            along += shrinking - swelling;
        }
        (tangential + rho * along, [swells, falls])
    }
}
