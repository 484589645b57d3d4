//! Sections 2, 7 and 9: the averages of force, torque bias and thrust scale.

use super::tick::Tick;
use super::{Law, axes, double};
use crate::support::oracle::skew;
use nalgebra::Vector3;

/// c_0, m/s^2, and the bandwidth of the slow averages, 1/s (section 9).
const LEAST_VARIATION: f64 = 2.0;
const SLOW_BANDWIDTH_PER_S: f64 = 0.7;

/// What is averaged: zeta, the torque bias, ybar and fbar (none before the first interval); and the scale.
#[derive(Debug, Clone, Copy)]
pub struct Averages {
    pub force: Vector3<f64>,
    pub bias: Vector3<f64>,
    pub slow: Option<[Vector3<f64>; 2]>,
    pub scale: f64,
    /// B: how the accelerometer differs for long.
    pub offset: Vector3<f64>,
}

impl Law {
    /// Sections 2, 7 and 9: the averages with what happened since the last tick.
    pub fn learnt(&self, t: &Tick, axis: &Vector3<f64>) -> Averages {
        let before = t.averages;
        let Some(last) = t.last.filter(|_| !t.held) else { return before };
        let (p, h) = (&self.p, self.period);
        let weight = |bandwidth: f64| 1.0 - (-bandwidth * h).exp();
        let drag = double(p.drag_across) * (t.velocity + last.velocity) / 2.0;
        let made = (t.velocity - last.velocity) / h + Vector3::new(drag.x, drag.y, self.gravity);
        // The state has jumped: nothing is learnt.
        if made.norm() >= 1e3 || (t.omega - last.omega).norm() >= 1e3 {
            return before;
        }
        // An accelerometer knows better what is quick, within the range of one.
        let mut offset = before.offset;
        let made = match t.felt.filter(|felt| felt.norm() < 500.0) {
            Some(felt) => {
                let acceleration = felt - before.offset;
                offset += (acceleration - (t.velocity - last.velocity) / h) * weight(1.0);
                acceleration + Vector3::new(drag.x, drag.y, self.gravity)
            }
            None => made,
        };
        let commanded = (last.axis + axis) / 2.0 * (t.acted[0] / self.mass);

        // They begin with the first interval.
        let [slow_made, slow_commanded] = before.slow.unwrap_or([made, commanded]);
        let slow = [(slow_made, made), (slow_commanded, commanded)]
            .map(|(slow, new)| slow + (new - slow) * weight(SLOW_BANDWIDTH_PER_S));
        let (y, f) = (made - slow[0], commanded - slow[1]);
        let step = double(p.scale_rate) * h * (y - before.scale * f).dot(&f)
            / (f.norm_squared() + LEAST_VARIATION * LEAST_VARIATION);
        let scale = (before.scale + step).clamp(double(p.scale_least), double(p.scale_greatest));

        let averaging = axes(p.force_bandwidth_across, p.force_bandwidth_vertical).map(weight);
        let force = before.force + averaging.component_mul(&(made - commanded * scale - before.force));
        let omega = (last.omega + t.omega) / 2.0;
        let torque = Vector3::new(t.acted[1], t.acted[2], t.acted[3]) * scale;
        let observed = self.inertia * (t.omega - last.omega) / h + skew(omega) * self.inertia * omega - torque;
        let bandwidth = double(p.torque_bandwidth);
        let averaging = Vector3::new(bandwidth, bandwidth, bandwidth / 2.0).map(weight);
        let bias = before.bias + averaging.component_mul(&(observed - before.bias));
        Averages { force, bias, slow: Some(slow), scale, offset }
    }
}
