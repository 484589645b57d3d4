//! From any state in motion to a steady one: the acceleration, jerk and snap a reference starts with are faded out.
//!
//! The smoother can start from any steady velocity, and from nothing else. A [`Bridge`] leads there:
//!
//! a(t) = a_0 phi_0(t/T_0) + j_0 T_1 phi_1(t/T_1) + s_0 T_2^2 phi_2(t/T_2)
//!
//! where phi_i is the quintic with its i-th derivative one at 0 and all else (value, first, second derivative; both ends)
//! zero. So a, j, s start as given, end at zero, and snap is continuous. Short T_i cost snap, long ones acceleration and
//! jerk: all combinations of a fixed geometric series of durations are tried, the shortest that stays inside the bounds
//! at every tick is taken. Its velocity at the end is whatever it is; the pursuit then deals with it.
//!
//! What it cannot do: a state may lie inside the bounds and yet have no way on inside them (an acceleration at its bound
//! with jerk outwards), or only one outside this family. Such a state is refused. Circles and oscillations are all left,
//! even where they touch their bounds. [`Bridge::search`] takes far longer than a tick when it has to try
//! everything: it belongs to changes of mode.

use super::smoother::Knot;
use crate::math;
use crate::reference::ReferenceBounds;
use nalgebra::Vector3;

/// Durations tried, as shares of the smoother's first window (the time a full reversal of acceleration takes).
const DURATIONS: [f32; 11] = [0.06, 0.1, 0.16, 0.25, 0.4, 0.6, 0.85, 1.2, 1.7, 2.4, 3.5];

/// Points looked at within each duration before a candidate is checked tick by tick.
const GLANCES: u32 = 8;

/// Room left for the rounding of norms in single precision; what is checked is what will be emitted, to the bit.
const ROOM: f32 = 1e-6;

/// Coefficients, from degree 0 to 7, of the second integrals of phi_0, phi_1, phi_2 on [0, 1].
const FADES: [[f32; 8]; 3] = [
    [0.0, 0.0, 0.5, 0.0, 0.0, -0.5, 0.5, -1.0 / 7.0],
    [0.0, 0.0, 0.0, 1.0 / 6.0, 0.0, -0.3, 4.0 / 15.0, -1.0 / 14.0],
    [0.0, 0.0, 0.0, 0.0, 1.0 / 24.0, -0.075, 0.05, -1.0 / 84.0],
];

/// A fade-out under way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bridge {
    start: Knot,
    durations: [u32; 3],
    period: f32,
}

impl Bridge {
    /// The shortest fade-out of `start` inside `bounds`, with durations in proportion to `window` ticks; `None` if there is
    /// none in the family.
    #[inline]
    pub fn search(start: &Knot, bounds: &ReferenceBounds, period: f32, window: usize) -> Option<Self> {
        let durations = DURATIONS.map(|share| (share * window as f32) as u32 + 1);
        let mut best: Option<Self> = None;
        let fading = [start.acceleration, start.jerk, start.snap].map(|vector| vector != Vector3::zeros());
        // What is zero already needs no choice of duration.
        let choices = fading.map(|fades| durations.iter().take(if fades { durations.len() } else { 1 }));
        let [accelerations, jerks, snaps] = choices;
        for &acceleration in accelerations {
            for &jerk in jerks.clone() {
                for &snap in snaps.clone() {
                    let candidate = Self { start: *start, durations: [acceleration, jerk, snap], period };
                    let shorter = best.as_ref().is_none_or(|best| candidate.duration() < best.duration());
                    if shorter && candidate.is_inside(bounds) {
                        best = Some(candidate);
                    }
                }
            }
        }
        best
    }

    /// Ticks until the motion is steady.
    #[inline]
    pub fn duration(&self) -> u32 {
        self.durations.iter().copied().max().unwrap_or(0)
    }

    /// Whether every tick after the start is inside: a glance first, since most candidates are far outside.
    #[inline]
    fn is_inside(&self, bounds: &ReferenceBounds) -> bool {
        let glances = self
            .durations
            .iter()
            .flat_map(|&duration| (1..=GLANCES).map(move |glance| duration as f32 * glance as f32 / GLANCES as f32));
        glances.chain((1..=self.duration()).map(|tick| tick as f32)).all(|ticks| {
            let knot = self.knot(ticks);
            let room = 1.0 - ROOM;
            knot.acceleration.xy().norm_squared() <= square(bounds.horizontal_acceleration * room)
                && knot.acceleration.z.abs() <= bounds.vertical_acceleration * room
                && knot.jerk.norm_squared() <= square(bounds.jerk * room)
                && knot.snap.norm_squared() <= square(bounds.snap * room)
        })
    }

    /// The reference `ticks` after the start.
    #[inline]
    pub fn knot(&self, ticks: f32) -> Knot {
        let time = ticks * self.period;
        let mut knot = Knot {
            position: self.start.position + self.start.velocity * time,
            velocity: self.start.velocity,
            acceleration: Vector3::zeros(),
            jerk: Vector3::zeros(),
            snap: Vector3::zeros(),
        };
        let [duration_0, duration_1, duration_2] = self.durations.map(|duration| duration as f32 * self.period);
        let [fade_0, fade_1, fade_2] = FADES;
        for (fade, amplitude, duration) in [
            (fade_0, self.start.acceleration, duration_0),
            (fade_1, self.start.jerk * duration_1, duration_1),
            (fade_2, self.start.snap * (duration_2 * duration_2), duration_2),
        ] {
            let phase = time / duration;
            let [position, velocity, acceleration, jerk, snap] = derivatives(&fade, phase.min(1.0));
            // Past its end a fade has left a constant velocity behind.
            let position = position + velocity * (phase - 1.0).max(0.0);
            knot.position += amplitude * (position * duration * duration);
            knot.velocity += amplitude * (velocity * duration);
            if phase < 1.0 {
                knot.acceleration += amplitude * acceleration;
                knot.jerk += amplitude * (jerk / duration);
                knot.snap += amplitude * (snap / (duration * duration));
            }
        }
        knot
    }
}

/// A polynomial (lowest coefficient first) and its first four derivatives at `x`, by Horner's rule.
#[inline]
fn derivatives(coefficients: &[f32; 8], x: f32) -> [f32; 5] {
    let [mut value, mut first, mut second, mut third, mut fourth] = [0.0; 5];
    for coefficient in coefficients.iter().rev() {
        fourth = fourth * x + 4.0 * third;
        third = third * x + 3.0 * second;
        second = second * x + 2.0 * first;
        first = first * x + value;
        value = value * x + coefficient;
    }
    [value, first, second, third, fourth]
}

#[inline]
fn square(x: f32) -> f32 {
    x * x
}

/// Whether a state has nothing to fade out.
#[inline]
pub(super) fn is_steady(knot: &Knot) -> bool {
    [knot.acceleration, knot.jerk, knot.snap].iter().all(|vector| *vector == Vector3::zeros())
}

/// |psi'| and psi'' for headings: psi'' falls to zero linearly, so it is continuous.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TurnBridge {
    /// psi', rad/s, and psi'', rad/s^2, at the start.
    pub rate: f32,
    pub acceleration: f32,
    /// Ticks until the rate is steady.
    pub duration: u32,
    pub period: f32,
}

impl TurnBridge {
    /// The slowest fade-out of at most `longest` ticks whose heading stays inside `bounds`.
    #[inline]
    pub fn search(rate: f32, acceleration: f32, bounds: &ReferenceBounds, period: f32, longest: u32) -> Option<Self> {
        (1..=longest)
            .rev()
            .map(|duration| Self { rate, acceleration, duration, period })
            .find(|bridge| (1..=bridge.duration).all(|tick| bridge.is_inside(tick, bounds)))
    }

    #[inline]
    fn is_inside(&self, tick: u32, bounds: &ReferenceBounds) -> bool {
        let (_, rate, acceleration) = self.at(tick);
        let second = math::sqrt(acceleration * acceleration + square(rate * rate));
        rate.abs() <= bounds.heading_rate * (1.0 - ROOM) && second <= bounds.heading_second_derivative * (1.0 - ROOM)
    }

    /// The angle turned since the start (rad), psi' and psi'' at `tick`.
    #[inline]
    pub fn at(&self, tick: u32) -> (f32, f32, f32) {
        let duration = self.duration as f32 * self.period;
        let (time, left) = (tick as f32 * self.period, 1.0 - tick as f32 / self.duration as f32);
        let rate = self.rate + self.acceleration * time * (1.0 - 0.5 * time / duration);
        let angle = self.rate * time + self.acceleration * time * time * (0.5 - time / (6.0 * duration));
        (angle, rate, self.acceleration * left)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Random, TYPICAL};
    use super::*;

    fn state(acceleration: [f32; 3], jerk: [f32; 3], snap: [f32; 3]) -> Knot {
        Knot {
            position: Vector3::new(1.0, 2.0, 3.0),
            velocity: Vector3::new(4.0, 0.0, -1.0),
            acceleration: acceleration.into(),
            jerk: jerk.into(),
            snap: snap.into(),
        }
    }

    #[test]
    fn a_bridge_starts_from_the_state_and_ends_steady() {
        let start = state([1.0, -0.5, 0.2], [0.5, 1.0, -0.3], [-2.0, 0.0, 1.0]);
        let bridge = Bridge::search(&start, &TYPICAL, 0.01, 128).unwrap();
        let first = bridge.knot(0.0);
        assert_eq!((first.position, first.velocity), (start.position, start.velocity));
        assert!((first.acceleration - start.acceleration).norm() < 1e-6);
        assert!((first.jerk - start.jerk).norm() < 1e-6 && (first.snap - start.snap).norm() < 1e-5);
        assert!(is_steady(&bridge.knot(bridge.duration() as f32)));
    }

    #[test]
    fn each_derivative_of_a_bridge_is_that_of_the_one_below() {
        let start = state([1.0, -0.5, 0.2], [0.5, 1.0, -0.3], [-2.0, 0.0, 1.0]);
        let bridge = Bridge { start, durations: [110, 75, 50], period: 0.01 };
        for tick in 1..120 {
            let (before, here, after) =
                (bridge.knot(tick as f32 - 0.5), bridge.knot(tick as f32), bridge.knot(tick as f32 + 0.5));
            let close = |up: Vector3<f32>, down: Vector3<f32>, is: Vector3<f32>, tolerance: f32| {
                assert!(((up - down) / 0.01 - is).norm() < tolerance, "tick {tick}: {} {is}", (up - down) / 0.01);
            };
            // Rounding of the values over the step, and h^2/24 times the third derivative.
            close(after.position, before.position, here.velocity, 3e-4);
            close(after.velocity, before.velocity, here.acceleration, 3e-4);
            close(after.acceleration, before.acceleration, here.jerk, 5e-4);
            // Snap has corners where a fade ends; a difference over a step sees h/8 of a change of its slope.
            let corner = [50, 75, 110].contains(&tick);
            close(after.jerk, before.jerk, here.snap, if corner { 0.08 } else { 3e-3 });
        }
    }

    #[test]
    fn states_without_a_way_on_are_refused() {
        let outward = state([2.5, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0; 3]);
        assert!(Bridge::search(&outward, &TYPICAL, 0.01, 128).is_none());
        let growing = state([0.0; 3], [0.0, 4.0, 0.0], [0.0, 1.0, 0.0]);
        assert!(Bridge::search(&growing, &TYPICAL, 0.01, 128).is_none());
    }

    #[test]
    fn circles_are_left_smoothly_even_where_they_touch_their_bounds() {
        // Radius and rate such that acceleration, jerk and snap all are at the same share of their bounds or below.
        let mut random = Random::new(3);
        for share in [0.5, 0.7, 0.8, 0.85, 0.9, 0.95, 1.0] {
            let mut left = 0;
            for _ in 0..100 {
                let rate: f32 = 0.3 + 2.7 * random.unit();
                let radius = share * (2.49 / rate.powi(2)).min(3.99 / rate.powi(3)).min(9.99 / rate.powi(4));
                let (sin, cos) = (core::f32::consts::TAU * random.unit()).sin_cos();
                let a = Vector3::new(cos, sin, 0.0) * (-radius * rate * rate);
                let j = Vector3::new(sin, -cos, 0.0) * (radius * rate.powi(3));
                let start =
                    Knot { acceleration: a, jerk: j, snap: -a * (rate * rate), ..state([0.0; 3], [0.0; 3], [0.0; 3]) };
                left += usize::from(Bridge::search(&start, &TYPICAL, 0.01, 128).is_some());
            }
            assert_eq!(left, 100, "at a share of {share}");
        }
    }
}
