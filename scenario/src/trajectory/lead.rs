//! From rest onto a path that begins in motion, and to rest from one that ends so.
//!
//! Of all motions of duration T from rest to velocity v, acceleration a, jerk j and snap s, the one with the least
//! squared fifth derivative begins
//!
//! v T/2 - 3/28 a T^2 + j T^3/84 - s T^4/1680
//!
//! before its end, and likewise backwards. T is the shortest of a few for which this takes no more acceleration, jerk
//! and snap than the path itself or the vehicle's own bounds, or else the one for which it takes least.

use super::stretch::{stretch, taken};
use controller_core::error::ParameterError;
use controller_core::reference::ReferenceBounds;
use controller_core::reference::knot::{Knot, REST};
use nalgebra::Vector4;

/// The first duration tried, s, by how much it grows, and how often: to 10 s.
const DURATION_MIN_S: f64 = 0.2;
const DURATION_GROWTH: f64 = 1.1;
const DURATIONS_TRIED: i32 = 41;

/// Adds a beginning and an end at rest to `knots`, where they do not begin or end so, inside their own bounds and
/// those `allowed`; how long the beginning is, us.
///
/// # Errors
/// If a derivative leaves the range of the law.
pub fn lead(knots: &mut Vec<Knot>, allowed: &ReferenceBounds) -> Result<u64, ParameterError> {
    let allowed = taken(knots)?.covering(allowed);
    let mut led_in = 0;
    if let Some(first) = knots.first().filter(|first| first.derivatives != REST).copied() {
        let [before, after] = shortest(&allowed, |duration| rest_before(&first, duration))?;
        led_in = after.time_us - before.time_us;
        knots.iter_mut().for_each(|knot| knot.time_us += led_in);
        knots.insert(0, before);
    }
    if let Some(last) = knots.last().filter(|last| last.derivatives != REST).copied() {
        let [_, after] = shortest(&allowed, |duration| rest_after(&last, duration))?;
        knots.push(after);
    }
    Ok(led_in)
}

/// The pair whose way takes no more than `allowed`.
fn shortest(allowed: &ReferenceBounds, pair: impl Fn(f64) -> [Knot; 2]) -> Result<[Knot; 2], ParameterError> {
    let mut best = (f64::INFINITY, pair(DURATION_MIN_S));
    for number in 0..DURATIONS_TRIED {
        let tried = pair(DURATION_MIN_S * DURATION_GROWTH.powi(number));
        let more = stretch(&taken(&tried)?, allowed);
        if more < best.0 {
            best = (more, tried);
        }
        if more <= 1.0 {
            break;
        }
    }
    Ok(best.1)
}

/// From rest to a knot that is reached (`side` -1), or from one that is left (1) to rest.
fn way(knot: &Knot, duration: f64, side: f64) -> Vector4<f64> {
    let (t, [v, a, j, s]) = (duration, knot.derivatives);
    v * (t / 2.0) + a * (side * t.powi(2) * 3.0 / 28.0) + j * (t.powi(3) / 84.0) + s * (side * t.powi(4) / 1680.0)
}

fn rest_before(knot: &Knot, duration: f64) -> [Knot; 2] {
    let way = way(knot, duration, -1.0);
    let after = Knot { time_us: knot.time_us + (duration * 1e6) as u64, ..*knot };
    [Knot { position: knot.position - way.xyz(), heading: knot.heading - way.w, derivatives: REST, ..*knot }, after]
}

fn rest_after(knot: &Knot, duration: f64) -> [Knot; 2] {
    let way = way(knot, duration, 1.0);
    let time_us = knot.time_us + (duration * 1e6) as u64;
    let position = knot.position + way.xyz();
    [*knot, Knot { time_us, position, heading: knot.heading + way.w, derivatives: REST }]
}
