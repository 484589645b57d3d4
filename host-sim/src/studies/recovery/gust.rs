//! A force per mass that changes with time: along each axis steps, at times of its own.
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

/// The steps along world x, y and z, each axis' in the order of time, the first at zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Gust {
    /// One list an axis.
    pub axes: [Vec<Step>; 3],
}

impl Gust {
    /// Of a flight of this duration, s.
    pub(crate) fn drawn(drawn: &mut Drawn, duration: f64) -> Self {
        Self { axes: [(); 3].map(|()| steps(drawn, duration)) }
    }

    /// The share of the greatest force along each axis at a time, s, from which on steps count.
    #[must_use]
    pub fn at(&self, time: f64) -> Vector3<f64> {
        let share = |steps: &Vec<Step>| {
            let passed = steps.partition_point(|step| step.from <= time);
            passed.checked_sub(1).and_then(|last| steps.get(last)).map_or(0.0, |step| step.share)
        };
        Vector3::new(share(&self.axes[0]), share(&self.axes[1]), share(&self.axes[2]))
    }

    /// Changed a little, or, with a large `scale`, much: a step moved, turned round or set to a limit, one more or one
    /// less.
    pub(crate) fn mutated(&self, drawn: &mut Drawn, scale: f64, duration: f64) -> Self {
        let mut gust = self.clone();
        let steps = &mut gust.axes[drawn.index(3)];
        let place = drawn.index(steps.len());
        match drawn.index(5) {
            0 => steps[place].share = -steps[place].share,
            1 => steps[place].share = drawn.side().signum(),
            2 if place > 0 => steps[place].from = (steps[place].from + scale * drawn.side()).clamp(0.0, duration),
            3 if place > 0 => drop(steps.remove(place)),
            _ => steps.push(Step { from: drawn.part() * drawn.part() * duration, share: drawn.side().signum() }),
        }
        steps.sort_by(|one, other| one.from.total_cmp(&other.from));
        gust
    }

    /// As words, up to a time, s.
    pub fn until(&self, end: f64) -> impl fmt::Display {
        let axis = |(name, steps): (&str, &Vec<Step>)| {
            let shown = steps.iter().filter(|step| step.from <= end);
            let shown: Vec<String> = shown.map(|Step { from, share }| format!("{share:.3} at {from:.3} s")).collect();
            format!("{name} {}", shown.join(", "))
        };
        ["x", "y", "z"].into_iter().zip(&self.axes).map(axis).collect::<Vec<_>>().join("; ")
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
