//! What rotors and torque limits leave: for the torque about the tilt's axes, section 4; for thrust and yaw, section 8.

use super::tick::PART_COUNT;
use super::{Law, double};
use nalgebra::{Vector2, Vector3, Vector4};

/// mu (section 8), and the part of a row's room that a tick leaves.
pub const THRUST_LEFT: f64 = 0.05;
const ROOM_LEFT: f64 = 1e-3;

/// A row of the table: |w . tau| <= s scaled - fixed.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    w: Vector2<f64>,
    scaled: f64,
    fixed: f64,
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
    pub fn beta(&self) -> Vector3<f64> {
        Vector3::new(self.row[1], self.row[2], self.row[3]) / self.row[0]
    }
}

/// The greatest share in [0, 1] for which `holds`, which it does from zero up to that share.
fn share(holds: impl Fn(f64) -> bool) -> f64 {
    if holds(1.0) {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if holds(middle) { low = middle } else { high = middle }
    }
    if low < 1e-15 { 0.0 } else { low }
}

/// The torque of a tick.
pub struct Spending<'a> {
    law: &'a Law,
    scale: f64,
    /// What the rooms are changed by, relative, for each part to come.
    nudges: Vec<f64>,
    pub spent: Vector2<f64>,
}

impl Spending<'_> {
    /// As much of `part` as every row has room for with `kept` to spare; the share.
    pub fn spend(&mut self, part: &Vector2<f64>, kept: f64) -> f64 {
        let nudge = 1.0 + self.nudges.pop().unwrap_or_default();
        let share = share(|share| {
            self.law.rows.iter().all(|row| {
                let ahead = row.w.dot(part).signum();
                // A row forbids going on, never coming back.
                ahead * row.w.dot(&(self.spent + part * share)) <= self.room(row) * nudge - kept
            })
        });
        self.spent += part * share;
        share
    }

    fn room(&self, row: &Row) -> f64 {
        self.law.room(row, self.scale) * (1.0 - ROOM_LEFT)
    }

    /// The least room.
    pub fn radius(&self) -> f64 {
        self.law.rows.iter().map(|row| self.room(row)).fold(f64::INFINITY, f64::min)
    }
}

impl Law {
    /// The rows of section 4.
    pub fn rows(&self, torque_max: &Vector3<f64>) -> Vec<Row> {
        let margin = double(self.p.floor_margin);
        let [bottom, top] = self.ends();
        let limit = |w, limit: f64| Row { w, scaled: 0.0, fixed: -limit };
        let mut rows = vec![limit(Vector2::x(), torque_max.x), limit(Vector2::y(), torque_max.y)];
        for i in &self.rotors {
            let floor = Row { w: i.beta().xy(), scaled: -bottom, fixed: 2.0 * margin - self.thrust_max };
            let with = |k: &Rotor| Row { w: (k.beta() - i.beta()).xy(), scaled: top - bottom, fixed: 2.0 * margin };
            rows.extend(self.rotors.iter().map(with).chain([floor]));
        }
        rows.retain(|row| row.w.norm() > 0.0);
        let unit = |Row { w, scaled, fixed }| {
            let length = w.norm();
            Row { w: w / length, scaled: scaled / length, fixed: fixed / length }
        };
        rows.into_iter().map(unit).collect()
    }

    fn room(&self, row: &Row, scale: f64) -> f64 {
        row.scaled * scale - row.fixed
    }

    /// max f_min / b_T and min f_max / b_T.
    fn ends(&self) -> [f64; 2] {
        let of = |end: fn(&Rotor) -> f64| self.rotors.iter().map(move |rotor| end(rotor) / rotor.row[0]);
        [of(|rotor| rotor.least).fold(0.0, f64::max), of(|rotor| rotor.greatest).fold(f64::INFINITY, f64::min)]
    }

    pub fn spending(&self, scale: f64, nudges: [f64; PART_COUNT]) -> Spending<'_> {
        let nudges = nudges.into_iter().rev().collect();
        Spending { law: self, scale, nudges, spent: Vector2::zeros() }
    }

    /// alpha: the greatest torque over J_max, rad/s^2.
    pub fn alpha(&self) -> f64 {
        let least = self.rows.iter().map(|row| self.room(row, 1.0)).fold(f64::INFINITY, f64::min);
        least / self.moments().xy().max()
    }

    /// U, section 8.
    pub fn greatest(&self, scale: f64, bias: &Vector3<f64>) -> f64 {
        let most = |of: fn(Vector3<f64>) -> f64| self.rotors.iter().map(|r| of(r.beta())).fold(0.0, f64::max);
        let taken = double(self.p.floor_margin)
            + most(|beta| beta.xy().norm()) * bias.xy().norm()
            + most(|beta| beta.z.abs()) * bias.z.abs();
        (scale * self.ends()[1] - taken).min(self.thrust_max) / self.mass
    }

    /// N and C, section 8.
    pub fn thrusts(&self, torque: &Vector3<f64>, scale: f64) -> [f64; 2] {
        let margin = double(self.p.floor_margin);
        let each = |end: fn(&Rotor) -> f64| {
            self.rotors.iter().map(move |rotor| scale * end(rotor) / rotor.row[0] - rotor.beta().dot(torque))
        };
        let least = each(|rotor| rotor.least).fold(0.0, f64::max) + margin;
        [least, each(|rotor| rotor.greatest).map(|most| most - margin).fold(self.thrust_max, f64::min)]
    }

    /// The share of a further torque about the tilt's axes with which N stays below `thrust` or where it was.
    pub fn share_above_the_floor(&self, spent: &Vector2<f64>, part: &Vector2<f64>, thrust: f64, scale: f64) -> f64 {
        let floor = |share: f64| self.thrusts(&(spent + part * share).push(0.0), scale)[0];
        let most = thrust.max(floor(0.0));
        share(|share| floor(share) <= most)
    }

    /// The torques about z with which every rotor is within its range at this thrust: [least, greatest].
    pub fn yaw(&self, thrust: f64, tilt: &Vector2<f64>, scale: f64) -> [f64; 2] {
        let margin = double(self.p.floor_margin);
        let mut ends = [-self.yaw_max, self.yaw_max];
        for rotor in &self.rotors {
            let (beta, alone) = (rotor.beta(), thrust + rotor.beta().dot(&tilt.push(0.0)));
            let [low, high] =
                [scale * rotor.least / rotor.row[0] + margin, scale * rotor.greatest / rotor.row[0] - margin];
            let [a, b] = [(low - alone) / beta.z, (high - alone) / beta.z];
            ends = [ends[0].max(a.min(b)), ends[1].min(a.max(b))];
        }
        [ends[0].min(0.0), ends[1].max(0.0)]
    }
}
