//! Section 6: the tilt, by the angle between two axes, and the projection of the errors.

use super::tick::Tick;
use super::{Law, double};
use crate::support::oracle::skew;
use nalgebra::{Matrix3, Vector2, Vector3};

/// The tilt's error.
pub struct Tilt {
    /// vartheta, axes of the body.
    pub mrp: Vector2<f64>,
    /// sin(theta / 2).
    pub sine: f64,
    /// Along m, axes of the desired frame.
    pub side: Vector2<f64>,
    /// How far it is from the region of the side, and from its switch.
    pub edge: f64,
    /// Whether it is held, or was and the other way round is taken.
    pub held: bool,
    pub round: bool,
}

/// qbar.
pub fn switching(delta: f64) -> f64 {
    let square = (1.0 + delta).powi(2);
    (square - 1.0) / (square + 1.0)
}

impl Law {
    /// The errors as they will be once what is under way has arrived: R~ and the rate error, as far as the frame's
    /// motion `behind` and the part of it about the tilt's axes and z that `rate` counts.
    pub fn projected(
        &self,
        t: &Tick,
        error: &Matrix3<f64>,
        [behind, rate]: [&Vector3<f64>; 2],
        scale: f64,
        bias: &Vector3<f64>,
    ) -> (Matrix3<f64>, Vector3<f64>) {
        // Cayley's transform of v is the rotation of the quaternion (1, v).
        let v = skew(behind * (0.5 * self.late));
        let turned = (Matrix3::identity() - v).try_inverse().unwrap() * (Matrix3::identity() + v);
        let impulse = Vector3::new(t.pending[1], t.pending[2], t.pending[3]) * scale + bias * self.late;
        let forward = t.last.map_or_else(Vector3::zeros, |last| last.forward);
        (error * turned, rate + impulse.component_div(&self.moments()) - forward * self.late)
    }

    /// theta and e, and what becomes of the side.
    pub fn tilt(&self, error: &Matrix3<f64>, side: Option<Vector2<f64>>) -> Tilt {
        let switch = switching(double(self.p.delta));
        let b: Vector3<f64> = error.column(2).into();
        let across = b.xy();
        let theta = across.norm().atan2(b.z);
        let sine = (theta / 2.0).sin();
        let into_body = |e: Vector3<f64>| (error.transpose() * e).xy();
        let edge = ((theta / 2.0).cos() - 2.0 * switch).abs();
        let plain = || {
            let e = Vector3::new(-b.y, b.x, 0.0) / across.norm().max(1e-300);
            let mrp = into_body(e) * (theta / 4.0).tan();
            Tilt { mrp, sine, side: across, edge, held: false, round: false }
        };
        if (theta / 2.0).cos() >= 2.0 * switch {
            return plain();
        }
        let m = side.filter(|side| side.norm() > 0.0).unwrap_or(across).normalize();
        let beyond = std::f64::consts::PI - m.dot(&across).asin();
        let edge = edge.min(((beyond / 2.0).cos() + switch).abs());
        if (beyond / 4.0).tan() >= 1.0 + double(self.p.delta) {
            return Tilt { edge, round: true, ..plain() };
        }
        let e = -b.cross(&m.push(0.0)).normalize();
        Tilt { mrp: into_body(e) * (beyond / 4.0).tan(), sine, side: m, edge, held: true, round: false }
    }

    /// P.
    pub fn pull(&self, tilt: &Tilt, level: f64) -> Vector2<f64> {
        let scaled = tilt.mrp * double(self.p.k_tilt);
        scaled * (level / level.hypot(scaled.norm()))
    }

    /// D.
    pub fn damping(&self, tilt: &Tilt, rate: &Vector2<f64>) -> Vector2<f64> {
        let eased = (1.0 + (tilt.sine / double(self.p.r_0)).powi(2)).powf(0.25);
        rate * (double(self.p.k_omega_t) / eased)
    }

    /// g: what leaves of Euler's equations for J omega~_12' a turn of omega~_12 by kappa. And the size of its terms.
    pub fn gyroscopic(&self, r: &Vector3<f64>, omega: &Vector3<f64>) -> (Vector2<f64>, f64) {
        let j = self.moments();
        let error = omega.xy() - r.xy();
        let kappa = 0.5 * (j.x + j.y) * (omega.z + r.z) - j.z * omega.z;
        // omega' = J^-1 (tau - omega x J omega), r' = -omega x r.
        let [spun, turned] = [omega.cross(&j.component_mul(omega)), j.component_mul(&omega.cross(r))];
        let kept = Vector2::new(error.y, -error.x) * kappa;
        let spin = omega.z.abs() + r.z.abs();
        let size = spin * (2.0 * j.max() * r.xy().norm() + 0.5 * (j.x - j.y).abs() * error.norm());
        (spun.xy() - turned.xy() + kept, size)
    }

    /// h: what the spin's part of Euler's equations takes of omega~_12.
    pub fn precession(&self, r: &Vector3<f64>, omega: &Vector3<f64>) -> Vector2<f64> {
        let spin = Vector3::new(0.0, 0.0, self.moments().z * omega.z);
        -spin.cross(&(omega - r).xy().push(0.0)).xy()
    }
}
