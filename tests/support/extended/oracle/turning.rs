//! Section 3: how fast and how soon the thrust direction may turn, in world axes.

use super::{Law, double};
use nalgebra::Vector3;

/// k, 1/s, and the part of alpha that q may take.
const SOFTNESS: f64 = 10.0;
pub const TURNED: f64 = 0.6;

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
    /// Section 3, in world axes: what is added to u''.
    pub fn limited(
        &self,
        turn: &Turn,
        yaw_rate: f64,
        alpha: f64,
        greatest: f64,
        [c, c_rate, c_second]: &[f64; 3],
        nudge: &Vector3<f64>,
    ) -> (Vector3<f64>, [bool; 6]) {
        let (parameters, h) = (&self.p, self.period);
        let Turn { rho, n, r, p, q: wanted, along: radial } = turn;
        let [rate, reserve] = [parameters.turn_rate, parameters.turn_reserve].map(double);
        let most = alpha.max(reserve);
        let (own, shorter) = shortened(*wanted, TURNED * most);
        let mut q = if shorter { own + nudge } else { *wanted };

        // e3 without its part along rho.
        let z = Vector3::z() - rho * rho.z;
        let rising = (p + q * h).dot(&z);
        let least = -(reserve / rate) * (rho.z - double(parameters.tilt_max).cos());
        let carried = p.cross(rho) * yaw_rate;
        let tilted = rising < least;
        if tilted {
            let inwards = z * ((least - rising) / (z.norm_squared().max(1e-6) * h));
            q += shortened(inwards, most).0 + nudge;
        }
        let (next, faster) = shortened(p + q * h, rate);
        if faster {
            q = (next - p) / h + nudge;
        }
        let (whole, sooner) = shortened(q + carried, most);
        if sooner {
            q = whole - carried + nudge;
        }

        let tangential = (q - wanted) * *n;
        let k = SOFTNESS.min(0.5 / h);
        let mut along = 0.0;
        let falling = c_second + tangential.z;
        let climbing = -2.0 * k * c_rate - k * k * (c + double(parameters.a_down));
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
        (tangential + rho * along, [faster, shorter, sooner, tilted, swells, falls])
    }
}
