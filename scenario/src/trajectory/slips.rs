//! What a file's numbers are probably not meant to say: times in ms read as s, degrees as radians and the reverse.
//!
//! A number whose unit the file names is believed. One without is judged by what it would mean.

use super::row::Row;
use std::f64::consts::TAU;

/// A path that is nowhere as fast is flown by nobody, m/s.
const FLOWN_SPEED_MIN_M_PER_S: f64 = 0.02;
/// What is shorter may stand still, m.
const MOVING_DISTANCE_MIN_M: f64 = 0.1;
/// The least speed at which such a path makes sense, m/s.
const PLAUSIBLE_SPEED_MIN_M_PER_S: f64 = 0.05;
/// A heading that swings by less may be in degrees, degrees.
const HEADING_SWING_MIN_DEG: f64 = 1.5;
/// What rounding may add to a turn, rad.
const HALF_ROTATION_TOLERANCE_RAD: f64 = 0.01;

/// In what times are counted, if they are so great that they count from 1970, and that in s.
pub fn since_1970(first: f64) -> Option<(&'static str, f64)> {
    // 3 to 300 years in each of them.
    [("ns", 1e-9), ("us", 1e-6), ("ms", 1e-3)].into_iter().find(|(_, factor)| (1e8..1e10).contains(&(first * factor)))
}

/// Rows that are flown more slowly than anybody flies.
#[derive(Debug, Clone, PartialEq)]
pub struct TooSlow {
    /// How slowly.
    pub what: String,
    /// What their times are probably counted in.
    pub unit: &'static str,
}

impl TooSlow {
    /// What is wrong with rows that, `stretch` times as slowly, are slower than that.
    pub fn find(rows: &[Row], stretch: f64) -> Option<Self> {
        let (mut fastest, mut way) = (0.0_f64, 0.0);
        for pair in rows.windows(2) {
            let distance = (pair[1].position - pair[0].position).norm();
            fastest = fastest.max(distance / (stretch * (pair[1].time? - pair[0].time?)));
            way += distance;
        }
        if way < MOVING_DISTANCE_MIN_M || fastest >= FLOWN_SPEED_MIN_M_PER_S {
            return None;
        }
        let duration = stretch * (rows.last()?.time? - rows.first()?.time?);
        let units = [("ms", 1e3), ("us", 1e6), ("ns", 1e9)];
        let (unit, _) = units.into_iter().find(|(_, factor)| fastest * factor >= PLAUSIBLE_SPEED_MIN_M_PER_S)?;
        let what = format!("takes {duration:.0} s for {way:.1} m, {:.3} mm/s at most", 1e3 * fastest);
        Some(Self { what, unit })
    }
}

/// The greatest of headings in rad, if it is so great that they are probably degrees.
pub fn degrees_as_radians(headings: impl Iterator<Item = f64>) -> Option<f64> {
    let most = headings.map(f64::abs).fold(0.0, f64::max);
    (most > TAU + HALF_ROTATION_TOLERANCE_RAD).then_some(most)
}

/// What may be wrong with headings that are read as degrees.
pub fn radians_as_degrees(headings: impl Iterator<Item = f64>) -> Option<String> {
    let range = headings.map(|heading| (heading, heading)).reduce(|(low, high), (h, _)| (low.min(h), high.max(h)));
    let (low, high) = range?;
    let is_suspect = high - low > HEADING_SWING_MIN_DEG && high.max(-low) < TAU + HALF_ROTATION_TOLERANCE_RAD;
    is_suspect.then(|| format!("stays between {low} and {high} degrees: name it yaw if these are radians"))
}
