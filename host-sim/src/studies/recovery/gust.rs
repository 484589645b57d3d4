//! A force per mass that changes with time: steps along one axis of the world, as the proof of r has it.
//!
//! A flight's gust is drawn from a shortest and a longest time between steps; half of its steps go to a limit, the
//! others evenly between both. It is held over a tick of the law.

use crate::studies::campaign::draw::Drawn;
use nalgebra::Vector3;
use std::fmt;

/// The mean time between two steps of a flight's gust is drawn between these, each octave alike.
const MEAN_TIME_MIN_S: f64 = 0.1;
const MEAN_TIME_MAX_S: f64 = 3.0;

/// From a time on, s, a share of the greatest force, -1 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// s, from the flight's start.
    pub from: f64,
    /// Of the greatest force.
    pub share: f64,
}

/// Steps along an axis of the world, in the order of time, the first at zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Gust {
    /// 0 to 2: x, y or z.
    pub axis: usize,
    /// None is no force.
    pub steps: Vec<Step>,
}

impl Gust {
    /// No force.
    pub const NONE: Self = Self { axis: 0, steps: Vec::new() };

    /// A share for each tick of `period`, s.
    #[must_use]
    pub fn of_ticks(axis: usize, shares: &[f64], period: f64) -> Self {
        let mut steps: Vec<Step> = Vec::new();
        for (tick, share) in shares.iter().enumerate() {
            if steps.last().is_none_or(|last| last.share != *share) {
                // Half a tick before, so that no rounding puts it into the next one.
                steps.push(Step { from: ((tick as f64 - 0.5) * period).max(0.0), share: *share });
            }
        }
        Self { axis, steps }
    }

    /// Of a flight of this duration, s.
    pub(crate) fn drawn(drawn: &mut Drawn, duration: f64) -> Self {
        Self { axis: drawn.index(3), steps: steps(drawn, duration) }
    }

    /// The share of the greatest force along each axis at a time, s, from which on steps count.
    #[must_use]
    pub fn at(&self, time: f64) -> Vector3<f64> {
        let passed = self.steps.partition_point(|step| step.from <= time);
        let share = passed.checked_sub(1).and_then(|last| self.steps.get(last)).map_or(0.0, |step| step.share);
        Vector3::ith(self.axis, share)
    }

    /// Changed a little, or, with a large `scale`, much: a step moved, turned round or set to a limit, one more or one
    /// less, or all along another axis.
    pub(crate) fn mutated(&self, drawn: &mut Drawn, scale: f64, duration: f64) -> Self {
        let mut gust = self.clone();
        let steps = &mut gust.steps;
        let place = drawn.index(steps.len());
        match drawn.index(6) {
            0 => steps[place].share = -steps[place].share,
            1 => steps[place].share = drawn.side().signum(),
            2 if place > 0 => steps[place].from = (steps[place].from + scale * drawn.side()).clamp(0.0, duration),
            3 if place > 0 => drop(steps.remove(place)),
            4 => gust.axis = drawn.index(3),
            _ => steps.push(Step { from: drawn.part() * drawn.part() * duration, share: drawn.side().signum() }),
        }
        gust.steps.sort_by(|one, other| one.from.total_cmp(&other.from));
        gust
    }

    /// As words, up to a time, s.
    pub fn until(&self, end: f64) -> impl fmt::Display {
        let shown = self.steps.iter().filter(|step| step.from <= end);
        let shown: Vec<String> = shown.map(|Step { from, share }| format!("{share:.3} at {from:.3} s")).collect();
        format!("{} {}", ["x", "y", "z"][self.axis], shown.join(", "))
    }
}

fn steps(drawn: &mut Drawn, duration: f64) -> Vec<Step> {
    let mean = MEAN_TIME_MIN_S * (MEAN_TIME_MAX_S / MEAN_TIME_MIN_S).powf(drawn.part());
    let mut steps = Vec::new();
    let mut from = 0.0;
    while from < duration {
        steps.push(Step { from, share: (2.0 * drawn.side()).clamp(-1.0, 1.0) });
        from -= mean * (1.0 - drawn.part()).ln();
    }
    steps
}
