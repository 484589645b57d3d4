//! Section 6: the attitude loop.

use super::tick::Tick;
use super::{Law, double, saturate};
use crate::support::oracle::skew;
use nalgebra::{Matrix3, Vector3, Vector4};

impl Law {
    /// Section 6: the errors as they will be once what is under way has arrived.
    pub fn projected(
        &self,
        t: &Tick,
        error: &Matrix3<f64>,
        behind: &Vector3<f64>,
        scale: f64,
        bias: &Vector3<f64>,
    ) -> (Matrix3<f64>, Vector3<f64>) {
        // Cayley's transform of v is the rotation of the quaternion (1, v).
        let v = skew(behind * (0.5 * self.late));
        let turned = (Matrix3::identity() - v).try_inverse().unwrap() * (Matrix3::identity() + v);
        let impulse = Vector3::new(t.pending[1], t.pending[2], t.pending[3]) * scale + bias * self.late;
        let wanted = t.last.map_or_else(Vector3::zeros, |last| last.wanted);
        (error * turned, behind + impulse.component_div(&self.moments()) - wanted * self.late)
    }

    /// Section 6: P.
    pub fn potential(&self, q: &Vector4<f64>) -> Vector3<f64> {
        let p = &self.p;
        let [w, eta, k_t, m_t, eta_t] = [p.w, p.eta, p.k_t, p.m_t, p.eta_t].map(double);
        let r = q[1].hypot(q[2]);
        let h = (q[0] + eta).hypot(q[3]);
        let g = m_t * k_t / (m_t.hypot(k_t * r) * ((1.0 - r * r).max(0.0) + eta_t * eta_t).sqrt());
        // The gradients of h and of r^2 along the body's rates.
        let of_h = Vector3::new((q[0] + eta) * q[1] + q[2] * q[3], (q[0] + eta) * q[2] - q[1] * q[3], eta * q[3]);
        let of_r = Vector3::new(q[0] * q[1] + q[2] * q[3], q[0] * q[2] - q[1] * q[3], 0.0);
        of_h * (w / (2.0 * h)) + of_r * g
    }

    /// Section 6: the damping, and whether it has less than it asks for.
    pub fn damping(&self, q: &Vector4<f64>, potential: &Vector3<f64>, behind: &Vector3<f64>) -> (Vector3<f64>, bool) {
        let p = &self.p;
        let r = q[1].hypot(q[2]);
        let d = behind.xy() * (double(p.k_omega_t) / (1.0 + (r / double(p.r_0)).powi(2)).powf(0.25));
        let (pull, most) = (potential.xy(), double(p.m_all));
        let room = (most.powi(2) - pull.norm_squared()).max(0.0);
        let (along, square) = (pull.dot(&d), d.norm_squared());
        let eased = (pull + d).norm() > most;
        // The positive root of |P + lambda D| = M_all.
        let lambda = if !eased {
            1.0
        } else if along > 0.0 {
            room / ((along * along + square * room).sqrt() + along)
        } else {
            ((along * along + square * room).sqrt() - along) / square
        };
        let yaw = saturate(double(p.k_omega_z) * behind.z, double(p.m_omega_z));
        (Vector3::new(lambda * d.x, lambda * d.y, yaw), eased)
    }
}
