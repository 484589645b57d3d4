//! Section 5: what yaw asks for.

use super::{Law, double};
use nalgebra::Vector3;

/// The part of the torque at hand that brakes.
const BRAKED_SHARE: f64 = 0.7;

impl Law {
    /// The first two terms of a, for the frame's rate f and its acceleration, both seen from the body.
    pub fn forward(&self, omega: &Vector3<f64>, f: &Vector3<f64>, acceleration: &Vector3<f64>) -> f64 {
        acceleration.z - omega.cross(f).z
    }

    /// The torque about z beside the bias, for psi, omega_3 - f_3 and the torque that was left in the last tick.
    pub fn yaw_torque(&self, [psi, rate]: [f64; 2], forward: f64, omega: &Vector3<f64>, room: f64) -> f64 {
        let (p, j) = (&self.p, self.moments());
        let [c_1, c_2, fastest] = [p.c_1, p.c_2, p.yaw_rate].map(double);
        let k = c_1 / c_2;
        // A is always there; what was left more brakes as well.
        let braking = (BRAKED_SHARE * room / j.z).max(double(p.yaw_acceleration));
        let speed = k * psi / (1.0 + psi.abs() * k * k / (2.0 * braking) + (k * psi / fastest).powi(2)).sqrt();
        j.z * (forward - c_2 * (rate + speed)) - (j.x - j.y) * omega.x * omega.y
    }

    /// The part of a torque about z that comes before thrust: what brakes omega_3 - f_3, up to J_3 A, where it is twice
    /// W_max and more; nothing where it is at most W_max.
    pub fn braking(&self, torque: f64, rate: f64) -> f64 {
        let spin = (rate.abs() / double(self.p.yaw_rate)).clamp(1.0, 2.0) - 1.0;
        let most = spin * self.moments().z * double(self.p.yaw_acceleration);
        if torque.signum() == rate.signum() { 0.0 } else { torque.clamp(-most, most) }
    }
}
