//! Section 1: the position loop, and the filters behind it.

use super::fallback::Gains;
use super::tick::Tick;
use super::{Law, double, saturate};
use nalgebra::{Vector2, Vector3};

/// The least level of a feedback, m/s^2, and how much of tilt and thrust it uses across.
const LEVEL_LEAST: f64 = 0.3;
const SHARE_ACROSS: f64 = 0.95;

/// The part of U that a force may use up together with the reference (section 2).
const HELD_SHARE: f64 = 0.99;

fn saturate_across(x: Vector2<f64>, level: f64) -> Vector2<f64> {
    x * (level / level.hypot(x.norm()))
}

/// The speed of approach, m/s, at a distance z, m: the v with z = v t + v^2 / (2 a), saturated at v_c.
fn approach(z: f64, t: f64, a: f64, v_c: f64) -> f64 {
    saturate(a * ((t * t + 2.0 * z / a).sqrt() - t), v_c)
}

impl Law {
    /// d: the average cut to its levels, then to what the rotors hold beside the reference's u, the vertical first. And
    /// whether that was less.
    pub fn believed(&self, average: &Vector3<f64>, rest: &Vector3<f64>, greatest: f64) -> (Vector3<f64>, bool) {
        let p = &self.p;
        let z = average.z.clamp(-double(p.force_down), double(p.force_up));
        let radial = |level: f64| (level.max(0.0) / average.xy().norm()).min(1.0);
        let most = HELD_SHARE * greatest;
        let lift = (rest.z - z).min(most);
        let left = (most * most - lift * lift).max(0.0).sqrt() - rest.xy().norm();
        let across = average.xy() * radial(left.min(double(p.force_across)));
        let cut = lift < rest.z - z || left < average.xy().norm().min(double(p.force_across));
        (Vector3::new(across.x, across.y, rest.z - lift), cut)
    }

    /// Section 1: ubar, for d and U.
    pub fn feedback(&self, t: &Tick, gains: &Gains, d: &Vector3<f64>, greatest: f64) -> Vector3<f64> {
        let p = &self.p;
        let [f, s, of_y] = gains.filters.map(|bandwidth| 1.0 / bandwidth);
        let [c, x, y] = t.filters.map(|filter| filter + d);
        let of_z = Vector3::new(f + s + of_y, f + s + of_y, of_y);
        let lagging = Vector3::new(1.0, 1.0, 0.0);
        let late = (c * (f * (s + of_y)) + x * (s * of_y)).component_mul(&lagging);
        let z_1 = t.position_error + t.velocity_error.component_mul(&of_z) + late;
        let z_2 = t.velocity_error + (c * f + x * s).component_mul(&lagging) + y * of_y + t.nudge.z_2;

        let ([k_p, k_p_z], [k_v, k_v_z], [v, v_up, v_down]) = (gains.k_p, gains.k_v, gains.speeds);
        let up = (greatest - self.gravity + d.z).max(LEVEL_LEAST).min(gains.most);
        let down = (double(p.a_down) - d.z).max(LEVEL_LEAST).min(gains.most);
        let (speed, brakes) = if z_1.z > 0.0 { (v_down, up) } else { (v_up, down) };
        let closing = approach(z_1.z.abs(), k_v_z / k_p_z, double(p.braking_vertical) * brakes, speed);
        let wanted = k_v_z * (closing * z_1.z.signum() + z_2.z);
        let vertical = -saturate(wanted, if wanted > 0.0 { down } else { up }) - d.z;

        let lift = self.gravity + vertical + t.nudge.lift;
        let left = (greatest.powi(2) - lift.powi(2)).max(0.0).sqrt();
        let reach = double(p.a_across).min(SHARE_ACROSS * left).min(SHARE_ACROSS * lift * double(p.tilt_max).tan());
        let level = (reach - d.xy().norm()).max(LEVEL_LEAST).min(gains.most);
        let distance = z_1.xy().norm();
        let closing = approach(distance, k_v / k_p, double(p.braking_across) * level, v);
        let towards = if distance > 0.0 { z_1.xy() / distance } else { Vector2::zeros() };
        let wanted = k_v * (towards * closing + z_2.xy());
        let across = -saturate_across(wanted, level) - d.xy();
        Vector3::new(across.x, across.y, vertical)
    }

    /// c and x a period later, with the drive held, and y at `smoothed`.
    pub fn filtered(
        &self,
        [mut c, mut x]: [Vector3<f64>; 2],
        drive: Vector3<f64>,
        smoothed: Vector3<f64>,
        k_f: f64,
    ) -> [Vector3<f64>; 3] {
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
