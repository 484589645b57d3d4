//! What rotors and torque limits leave: for turning, section 4, and for the thrust, sections 4 and 8.

use super::{Law, double};
use nalgebra::{Vector3, Vector4};

/// mu, and the part of a room that a tick leaves (section 4).
const THRUST_LEFT: f64 = 0.05;
const ROOM_LEFT: f64 = 0.01;

/// How far beyond Omega a tick may take the thrust direction (section 4).
const RATE_BEYOND: f64 = 1.15;

/// A row of the budget: t, y, R.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    tilt: f64,
    yaw: f64,
    room: f64,
}

/// A rotor: its range and its row of B+.
#[derive(Debug, Clone, Copy)]
pub struct Rotor {
    pub least: f64,
    pub greatest: f64,
    pub row: Vector4<f64>,
}

impl Rotor {
    /// b_tau / b_T.
    fn per_thrust(&self) -> Vector3<f64> {
        Vector3::new(self.row[1], self.row[2], self.row[3]) / self.row[0]
    }
}

impl Law {
    /// The budget's fixed part, section 4.
    pub fn spend(&mut self, torque_max: &Vector3<f64>) {
        let (p, j) = (&self.p, self.moments());
        let [yaw_acceleration, yaw_rate, margin] = [p.yaw_acceleration, p.yaw_rate, p.floor_margin].map(double);
        let turn_rate = RATE_BEYOND * double(p.turn_rate);
        let [bias_tilt, bias_yaw] = [p.torque_tilt, p.torque_yaw].map(double);
        let [s_lo, s_hi] = [p.scale_least, p.scale_greatest].map(double);
        // Two components of omega_d across each other, at Omega and W_max: their product is at most half the square.
        let product = (turn_rate.powi(2) + yaw_rate.powi(2)) / 2.0;
        let tilt = j.x.max(j.y) * yaw_acceleration + (j.z - j.x).abs().max((j.z - j.y).abs()) * product;
        let feedback = double(p.w) * double(p.eta) / 2.0 + double(p.m_omega_z);
        let yaw = j.z * yaw_acceleration + (j.x - j.y).abs() * product + feedback;
        self.rows = vec![
            Row { tilt: 1.0, yaw: 0.0, room: torque_max.x.min(torque_max.y) - tilt - bias_tilt },
            Row { tilt: 0.0, yaw: 1.0, room: torque_max.z - yaw - bias_yaw },
        ];
        let beside =
            |b: &Vector3<f64>| (b.x.abs() + b.y.abs()) * bias_tilt + b.z.abs() * (bias_yaw + j.z * yaw_acceleration);
        self.floor = [margin, 0.0];
        if !self.rotors.is_empty() {
            let pairs = || self.rotors.iter().flat_map(|k| self.rotors.iter().map(move |i| (k, i)));
            let most = |of: fn(Vector3<f64>) -> f64| {
                pairs().map(|(k, i)| of(k.per_thrust() - i.per_thrust())).fold(0.0, f64::max)
            };
            let range = pairs()
                .map(|(k, i)| s_lo * k.greatest / k.row[0] - s_hi * i.least / i.row[0])
                .fold(f64::INFINITY, f64::min);
            let (t, y) = (most(|b| b.x.hypot(b.y)), most(|b| b.z.abs()));
            let bias = most(|b| b.x.abs() + b.y.abs()) * bias_tilt + y * bias_yaw;
            self.rows.push(Row { tilt: t, yaw: y, room: range - 2.0 * margin - bias - t * tilt - y * yaw });
            let greatest = |of: &dyn Fn(&Rotor) -> f64| self.rotors.iter().map(of).fold(0.0, f64::max);
            let (t, y) = (greatest(&|r| r.per_thrust().xy().norm()), greatest(&|r| r.per_thrust().z.abs()));
            let below = self.thrust_max - greatest(&|r| s_hi * r.least / r.row[0]) - 2.0 * margin;
            let bias = greatest(&|r| r.per_thrust().x.abs() + r.per_thrust().y.abs()) * bias_tilt + y * bias_yaw;
            self.rows.push(Row { tilt: t, yaw: y, room: below - bias - t * tilt - y * yaw });
            let raised = greatest(&|rotor| s_hi * rotor.least / rotor.row[0] + beside(&rotor.per_thrust()));
            let slope = greatest(&|rotor| {
                let b = rotor.per_thrust();
                (j.x * b.x).hypot(j.y * b.y)
            });
            self.taken = greatest(&|rotor| beside(&rotor.per_thrust())) + margin;
            self.floor = [raised + margin, slope];
        }
    }

    /// U, section 4: what the thrust near the target leaves.
    pub fn greatest(&self, scale: f64) -> f64 {
        let each = self.rotors.iter().map(|rotor| rotor.greatest / rotor.row[0]).fold(f64::INFINITY, f64::min);
        (1.0 - THRUST_LEFT) * (scale * each - self.taken).min(self.thrust_max) / self.mass
    }

    /// alpha, section 4, and what was added up to it.
    pub fn budget(&self, n: f64, feedback: f64, sine: f64) -> (f64, f64) {
        let j = self.moments();
        let most = double(self.p.turn_acceleration);
        let [floor, slope] = self.floor;
        let (mut alpha, mut size) = (most, most);
        if slope > 0.0 {
            alpha = alpha.min(((1.0 - THRUST_LEFT) * self.mass * n - floor) / slope);
            size += (self.mass * n + floor) / slope;
        }
        for Row { tilt, yaw, room } in &self.rows {
            let cost = tilt * j.x.max(j.y) + yaw * j.z * sine;
            if cost > 0.0 {
                alpha = alpha.min((room * (1.0 - ROOM_LEFT) - tilt * feedback) / cost);
                size += if *tilt > 0.0 { room.min(1e3) / cost } else { 0.0 };
            }
        }
        (alpha, size)
    }

    /// What was added up to alpha, rad/s^2.
    pub fn budget_size(&self, n: f64) -> f64 {
        self.budget(n, 0.0, 0.0).1
    }

    /// Section 8: N and C.
    pub fn thrusts(&self, torque: &Vector3<f64>, scale: f64) -> [f64; 2] {
        let margin = double(self.p.floor_margin);
        let each = |end: fn(&Rotor) -> f64| {
            self.rotors.iter().map(move |rotor| scale * end(rotor) / rotor.row[0] - rotor.per_thrust().dot(torque))
        };
        let least = each(|rotor| rotor.least).fold(0.0, f64::max) + margin;
        [least, each(|rotor| rotor.greatest).map(|most| most - margin).fold(self.thrust_max, f64::min)]
    }
}
