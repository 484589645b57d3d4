//! How the air moves: a steady wind, a gust, turbulence, added up. World frame, z up, m/s, the same at every place.
//!
//! ```text
//! step        v = 0 before t_0, V from then on
//! one-cosine  v = V/2 (1 - cos(pi (t - t_0) / d)) for t_0 <= t <= t_0 + d, V after it
//! pulse       v = V/2 (1 - cos(2 pi (t - t_0) / d)) for t_0 <= t <= t_0 + d, 0 after it
//! ```
//!
//! Sources: MIL-F-8785C, section 3.7.1.3 (the discrete gust, here by time instead of by distance); CS-25.341(a) (the
//! pulse); turbulence, `super::dryden`.

use super::dryden::Turbulence;
use nalgebra::Vector3;
use scenario::reality::wind::{Gust, Shape, Wind};
use std::f64::consts::PI;

/// Air that moves.
#[derive(Debug, Clone)]
pub struct MovingAir {
    steady: Vector3<f64>,
    /// With the plant step at which it begins.
    gust: Option<(Gust, u64)>,
    turbulence: Option<Turbulence>,
    /// Plant step, s.
    step: f64,
}

impl MovingAir {
    /// The scenario's wind; turbulence advances in plant steps of `step` s.
    pub fn new(wind: &Wind, step: f64) -> Self {
        let turbulence = wind.turbulence.map(|turbulence| Turbulence::new(&turbulence, &wind.steady, step));
        let gust = wind.gust.map(|gust| (gust, first_step(gust.start, step)));
        Self { steady: wind.steady, gust, turbulence, step }
    }

    /// Its velocity, m/s, in the plant step `now`, a `part` of which is over.
    pub fn velocity(&self, now: u64, part: f64) -> Vector3<f64> {
        let begun = |(gust, first): &&(Gust, u64)| gust.shape != Shape::Step || now >= *first;
        let gust = self.gust.as_ref().filter(begun).map_or_else(Vector3::zeros, |(gust, _)| {
            gust.velocity * share(gust, (now as f64 + part) * self.step - gust.start)
        });
        let turbulence = self.turbulence.as_ref().map_or_else(Vector3::zeros, Turbulence::velocity);
        self.steady + gust + turbulence
    }

    /// Goes on to the next plant step.
    pub fn advance(&mut self) {
        if let Some(turbulence) = &mut self.turbulence {
            turbulence.advance();
        }
    }
}

/// The first plant step of `step` s that does not begin before `time`, s, but for rounding.
pub fn first_step(time: f64, step: f64) -> u64 {
    (time / step - 1e-6).ceil() as u64
}

/// The share of a gust `since` s after its beginning; a step that has begun.
fn share(gust: &Gust, since: f64) -> f64 {
    let risen = |duration: f64| 0.5 * (1.0 - (PI * since / duration).cos());
    match gust.shape {
        Shape::Step => 1.0,
        _ if since < 0.0 => 0.0,
        Shape::OneCosine(duration) if since < duration => risen(duration),
        Shape::OneCosine(_) => 1.0,
        Shape::Pulse(duration) if since < duration => risen(0.5 * duration),
        Shape::Pulse(_) => 0.0,
    }
}

#[cfg(test)]
mod tests;
