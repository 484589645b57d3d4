//! Recorded setpoints as a path that our law can fly.
//!
//! Setpoints of others jump: to a path's first point, and home from its last. The longest part without a jump is kept,
//! a second at each end left out. A radio's times make what is left jitter; so it is flown as a trajectory's rows are,
//! on the smoothest path near them, from rest and to rest: as near as the vehicle certifies.

use super::flown::{PERIOD_S, Sample};
use controller_core::reference::Reference;
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::reference::ReferenceKind;
use scenario::trajectory::RouteWay;
use scenario::verdict::Verdict;
use std::fmt::Write;

/// Setpoints that move further than this within `JUMP_SAMPLES`, m, over three times the usual way, jump.
const JUMP_MIN_M: f64 = 0.15;
const JUMP_SAMPLES: usize = 10;
/// What is left out beside a jump, s.
const BESIDE_JUMP_S: f64 = 1.0;
/// The shortest part that is worth a flight, s.
const PART_MIN_S: f64 = 5.0;
/// Between two rows, samples.
const ROW_SAMPLES: usize = 20;
/// How near the path is to the rows, m: the first with which it certifies.
const WITHIN_M: [f64; 4] = [0.03, 0.06, 0.1, 0.15];
/// Samples to either side of a setpoint that a parabola is fitted to.
const PARABOLA_SAMPLES: usize = 40;

/// A path, ready to be flown.
pub struct SetpointPath {
    /// The samples that it covers.
    pub samples: std::ops::Range<usize>,
    /// The vehicle, with the path as its reference.
    pub scenario: Scenario,
    /// The verdict on both.
    pub verdict: Verdict,
    /// Samples from the start to the first setpoint.
    pub lead_in: usize,
    /// How near it is to every setpoint, m.
    pub within: f64,
    /// Setpoints without their jitter, m.
    pub smoothed: Vec<Vector3<f64>>,
}

impl SetpointPath {
    /// The path of a flight, for the vehicle of `text`.
    ///
    /// # Errors
    /// If there are no setpoints, or no path near them.
    pub fn new(samples: &[Sample], text: &str, file: &str) -> Result<Self, String> {
        let places: Vec<Vector3<f64>> = samples
            .iter()
            .map(|sample| sample.setpoint.map(|setpoint| setpoint.0))
            .collect::<Option<_>>()
            .ok_or("setpoint: is missing; the law needs to know what was wanted")?;
        let part = without_jumps(&places);
        if (part.len() as f64) * PERIOD_S < PART_MIN_S {
            return Err(format!("setpoint: has no part of {PART_MIN_S} s without a jump"));
        }
        let rows = rows(samples.get(part.clone()).unwrap_or_default());
        let mut last = Err("has no setpoints".to_owned());
        for within in WITHIN_M {
            let text =
                format!("{text}\n[reference]\nkind = \"trajectory\"\nwithin = {within}\ndata = \"\"\"\n{rows}\"\"\"\n");
            last = Self::near(&text, file, part.clone());
            if last.as_ref().is_ok_and(|path| path.verdict.refusal().is_none()) {
                break;
            }
        }
        let mut path = last?;
        path.smoothed = smoothed(places.get(part).unwrap_or_default());
        Ok(path)
    }

    /// The reference so many samples after the start.
    pub fn reference(&self, sample: usize) -> Reference {
        self.scenario.trajectory.at((sample as f64 * PERIOD_S * 1e6).round() as u64)
    }

    fn near(text: &str, file: &str, samples: std::ops::Range<usize>) -> Result<Self, String> {
        let scenario = Scenario::parse(text, file).map_err(|error| error.to_string())?;
        let verdict = Verdict::judge(&scenario).map_err(|error| error.to_string())?;
        let ReferenceKind::Route(route) = &scenario.reference else { return Err("reference: is no path".to_owned()) };
        let RouteWay::Near { farthest: (within, _), lead_in } = route.way else {
            return Err("reference: is no path near rows".to_owned());
        };
        let lead_in = (lead_in / PERIOD_S).round() as usize;
        Ok(Self { samples, lead_in, within, verdict, scenario, smoothed: Vec::new() })
    }
}

/// The longest part in which no setpoint jumps.
fn without_jumps(places: &[Vector3<f64>]) -> std::ops::Range<usize> {
    let ways: Vec<f64> = places.windows(JUMP_SAMPLES + 1).map(|pair| (pair[JUMP_SAMPLES] - pair[0]).norm()).collect();
    let mut sorted = ways.clone();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let (mut longest, mut start) = (0..0, 0);
    for (index, way) in ways.iter().chain([&f64::INFINITY]).enumerate() {
        if *way > JUMP_MIN_M + 3.0 * usual {
            if index.saturating_sub(start) > longest.len() {
                longest = start..index;
            }
            start = index + JUMP_SAMPLES;
        }
    }
    let beside = (BESIDE_JUMP_S / PERIOD_S) as usize;
    let begin = if longest.start == 0 { 0 } else { longest.start + beside };
    let end = if longest.end + JUMP_SAMPLES >= places.len() { longest.end } else { longest.end.saturating_sub(beside) };
    begin..end.max(begin)
}

/// Rows of time and place, as a trajectory's file has them.
fn rows(samples: &[Sample]) -> String {
    let mut text = "t,x,y,z,yaw_deg\n".to_owned();
    for (row, sample) in samples.iter().step_by(ROW_SAMPLES).enumerate() {
        let Some((place, yaw)) = sample.setpoint else { continue };
        let time = (row * ROW_SAMPLES) as f64 * PERIOD_S;
        let yaw = yaw.unwrap_or(0.0).to_degrees();
        // A String takes whatever is written.
        let _ = writeln!(text, "{time:.2},{:.5},{:.5},{:.5},{yaw:.3}", place.x, place.y, place.z);
    }
    text
}

/// Each by the parabola that fits best to either side.
fn smoothed(places: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let smooth = |index: usize| {
        let reach = PARABOLA_SAMPLES.min(index).min(places.len() - 1 - index) as i64;
        let around = |i: i64| places[(index as i64 + i) as usize];
        let powers = |power: i32| (-reach..=reach).map(|i| (i as f64).powi(power)).sum::<f64>();
        let moments = |power: i32| (-reach..=reach).map(|i| around(i) * (i as f64).powi(power)).sum::<Vector3<f64>>();
        if reach < 2 {
            return places[index];
        }
        (moments(0) * powers(4) - moments(2) * powers(2)) / (powers(0) * powers(4) - powers(2).powi(2))
    };
    (0..places.len()).map(smooth).collect()
}
