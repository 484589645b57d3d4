//! Section 1: the position loop, and the filters behind it.

use super::tick::Tick;
use super::{Law, double, saturate};
use nalgebra::{Vector2, Vector3};

/// The least level of a feedback, m/s^2, and how much of tilt and thrust it uses across.
const LEVEL_LEAST: f64 = 0.3;
const SHARE_ACROSS: f64 = 0.95;

/// d, U and whether the level is the net's.
pub struct Envelope {
    pub d: Vector3<f64>,
    pub greatest: f64,
    pub most: f64,
}

fn saturate_across(x: Vector2<f64>, level: f64) -> Vector2<f64> {
    x * (level / level.hypot(x.norm()))
}

impl Law {
    /// Section 1: z_1, z_2 and ubar.
    pub fn feedback(&self, t: &Tick, filters: &[Vector3<f64>; 3], e: &Envelope) -> ([Vector3<f64>; 2], Vector3<f64>) {
        let p = &self.p;
        let [f, s, d] = [p.k_f, p.k_s, p.k_d].map(|bandwidth| 1.0 / double(bandwidth));
        let [c, x, y] = filters.map(|filter| filter + e.d);
        let z_1 = t.position_error + t.velocity_error * (f + s + d) + c * (f * (s + d)) + x * (s * d);
        let z_2 = t.velocity_error + c * f + x * s + y * d;

        let (k_p, k_v) = (double(p.k_p_vertical), double(p.k_v_vertical));
        let speed = double(if z_1.z > 0.0 { p.v_down } else { p.v_up });
        let wanted = saturate(k_p * z_1.z, k_v * speed) + k_v * z_2.z;
        let level = if wanted > 0.0 { double(p.a_down) - e.d.z } else { e.greatest - self.gravity + e.d.z };
        let vertical = -saturate(wanted, level.max(LEVEL_LEAST).min(e.most)) - e.d.z;

        let lift = self.gravity + vertical;
        let left = (e.greatest.powi(2) - lift.powi(2)).max(0.0).sqrt();
        let reach = double(p.a_across).min(SHARE_ACROSS * left).min(SHARE_ACROSS * lift * double(p.tilt_max).tan());
        let level = (reach - e.d.xy().norm()).max(LEVEL_LEAST).min(e.most);
        let (k_p, k_v) = (double(p.k_p_across), double(p.k_v_across));
        let wanted = saturate_across(k_p * z_1.xy(), k_v * double(p.v_across)) + k_v * z_2.xy();
        let across = -saturate_across(wanted, level) - e.d.xy();
        ([z_1, z_2], Vector3::new(across.x, across.y, vertical))
    }

    /// c and x a period later, with the drive held, and y at `smoothed`.
    pub fn filtered(
        &self,
        [mut c, mut x]: [Vector3<f64>; 2],
        drive: Vector3<f64>,
        smoothed: Vector3<f64>,
    ) -> [Vector3<f64>; 3] {
        let k_f = double(self.p.k_f);
        let flow = |c: Vector3<f64>, x: Vector3<f64>| k_f * (x - c);
        let steps = 60;
        let h = self.period / f64::from(steps);
        for _ in 0..steps {
            let (middle, end) = (x + drive * (h / 2.0), x + drive * h);
            let k_1 = flow(c, x);
            let k_2 = flow(c + k_1 * (h / 2.0), middle);
            let k_3 = flow(c + k_2 * (h / 2.0), middle);
            let k_4 = flow(c + k_3 * h, end);
            c += (k_1 + 2.0 * k_2 + 2.0 * k_3 + k_4) * (h / 6.0);
            x = end;
        }
        let lowest = -double(self.p.a_down);
        if c.z < lowest {
            (c.z, x.z) = (lowest, x.z.max(lowest));
        }
        [c, x, smoothed]
    }
}
