//! A flight's samples for the figures: thinned where a flight is long, yaw without jumps.

use crate::flight::Tick;
use nalgebra::{Quaternion, Vector3};
use std::f64::consts::TAU;

/// More samples than a figure can show.
const MOST_SAMPLES: u64 = 20_000;

/// One instant of a flight. Units as in log.csv, but yaw in degrees.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// s.
    pub time: f64,
    /// p, m.
    pub position: Vector3<f64>,
    /// p_d, m.
    pub desired_position: Vector3<f64>,
    /// q, body to world.
    pub attitude: Quaternion<f64>,
    /// psi, degrees, unwrapped.
    pub yaw: f64,
    /// psi_d, degrees, unwrapped.
    pub desired_yaw: f64,
    /// |p - p_d|, m.
    pub position_error: f64,
    /// |theta~|.
    pub mrp_error: f64,
    /// T, N.
    pub thrust: f64,
    /// tau, N m.
    pub torque: Vector3<f64>,
    /// |ubar_p|, |u_f|, |u_s|, m/s^2.
    pub filter_norms: Vector3<f64>,
    /// |s_theta|, |s_omega|, N m.
    pub feedback_norms: (f64, f64),
}

/// A flight's samples, in order of time.
#[derive(Debug, Clone)]
pub struct Record {
    stride: u64,
    seen: u64,
    last_yaw: f64,
    last_desired_yaw: f64,
    samples: Vec<Sample>,
}

impl Record {
    /// Room for a flight of so many ticks: all of them, or every n-th of a long flight.
    #[must_use]
    pub fn new(ticks: u64) -> Self {
        let stride = ticks.div_ceil(MOST_SAMPLES).max(1);
        Self { stride, seen: 0, last_yaw: 0.0, last_desired_yaw: 0.0, samples: Vec::new() }
    }

    /// Takes one tick.
    pub fn observe(&mut self, tick: &Tick) {
        let (state, diagnostics) = (&tick.state, &tick.diagnostics);
        let heading = tick.reference.heading.direction();
        let desired_yaw = f64::from(heading.y).atan2(f64::from(heading.x));
        // Every tick is unwrapped, also the ones that are not kept: a turn between two kept ones must not be lost.
        self.last_desired_yaw = nearest_turn(desired_yaw, self.last_desired_yaw);
        let before = if self.seen == 0 { self.last_desired_yaw } else { self.last_yaw };
        self.last_yaw = nearest_turn(state.yaw(), before);
        self.seen += 1;
        if !(self.seen - 1).is_multiple_of(self.stride) {
            return;
        }
        let desired_position = tick.reference.position.map(f64::from);
        let norm = |vector: &Vector3<f32>| f64::from(vector.norm());
        self.samples.push(Sample {
            time: tick.time_us as f64 / 1e6,
            position: state.position,
            desired_position,
            attitude: state.attitude,
            yaw: self.last_yaw.to_degrees(),
            desired_yaw: self.last_desired_yaw.to_degrees(),
            position_error: (state.position - desired_position).norm(),
            mrp_error: norm(&diagnostics.mrp),
            thrust: f64::from(tick.wrench.thrust),
            torque: tick.wrench.torque.map(f64::from),
            filter_norms: Vector3::new(
                norm(&diagnostics.feedback),
                norm(&diagnostics.filtered),
                norm(&diagnostics.intermediate),
            ),
            feedback_norms: (norm(&diagnostics.attitude_feedback), norm(&diagnostics.rate_feedback)),
        });
    }

    /// The samples, with the yaw shifted by whole turns so that it ends beside the desired one.
    #[must_use]
    pub fn samples(&self) -> Vec<Sample> {
        let turns = self.samples.last().map_or(0.0, |last| ((last.yaw - last.desired_yaw) / 360.0).round());
        self.samples.iter().map(|sample| Sample { yaw: sample.yaw - 360.0 * turns, ..*sample }).collect()
    }
}

/// `angle` plus the whole turns that bring it closest to `before`, rad.
pub(crate) fn nearest_turn(angle: f64, before: f64) -> f64 {
    angle + TAU * ((before - angle) / TAU).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::Flight;
    use scenario::Scenario;

    #[test]
    fn yaw_has_no_jumps_of_a_turn_and_ends_beside_the_desired_one() {
        let scenario = Scenario::paper().unwrap();
        let mut flight = Flight::new(&scenario).unwrap();
        let mut record = Record::new(scenario.timing.ticks);
        for _ in 0..scenario.timing.ticks {
            record.observe(&flight.tick().unwrap());
        }
        let samples = record.samples();
        assert_eq!(samples.len(), 4000);
        for pair in samples.windows(2) {
            assert!((pair[1].desired_yaw - pair[0].desired_yaw).abs() < 5.0);
            assert!((pair[1].yaw - pair[0].yaw).abs() < 180.0);
        }
        let last = samples.last().unwrap();
        assert!((last.yaw - last.desired_yaw).abs() < 0.1);
    }
}
