//! A motion along legs: how each of its knots is passed, and how long the pieces between them take.

use super::hull::stays;
use super::merge::Leg;
use super::piece::{KNOT_ORDERS, Motion, Place, powers};
use controller_core::reference::knot::Knot;
use nalgebra::{Vector3, Vector4};

/// Control points of a piece.
const CONTROL_POINTS: usize = 10;

/// From rest to rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// The knots; one more than pieces.
    pub knots: Vec<Motion>,
    /// The leg and the duration, s, of each piece.
    pub pieces: Vec<(usize, f64)>,
    /// The legs, each of one piece or more.
    pub legs: Vec<Leg>,
}

/// At rest.
fn resting(place: Vector4<f64>) -> Motion {
    let zero = Vector4::zeros();
    [place, zero, zero, zero, zero]
}

impl Way {
    /// At rest for good.
    pub fn resting(place: Vector4<f64>) -> Self {
        Self { knots: vec![resting(place)], pieces: Vec::new(), legs: Vec::new() }
    }

    /// From rest at the start of each leg to rest at its end, which takes the durations that `lasting` says, s.
    pub fn stopping(legs: Vec<Leg>, lasting: impl Fn(&Self) -> f64) -> Self {
        let alone = |leg: &Leg| {
            let knots = vec![resting(leg.from), resting(leg.to)];
            lasting(&Self { knots, pieces: vec![(0, 1.0)], legs: vec![*leg] })
        };
        let pieces = legs.iter().enumerate().map(|(number, leg)| (number, alone(leg))).collect();
        let starts = legs.iter().map(|leg| resting(leg.from));
        let knots = starts.chain(legs.last().map(|leg| resting(leg.to))).collect();
        Self { knots, pieces, legs }
    }

    /// s.
    pub fn duration(&self) -> f64 {
        self.pieces.iter().map(|(_, duration)| duration).sum()
    }

    /// Whether a leg begins or ends at the knot.
    pub fn is_point(&self, knot: usize) -> bool {
        match (knot.checked_sub(1).and_then(|before| self.pieces.get(before)), self.pieces.get(knot)) {
            (Some((before, _)), Some((after, _))) => before != after,
            _ => true,
        }
    }

    /// The motion at a place of a piece.
    pub fn motion(&self, piece: usize, place: &Place) -> Motion {
        let powers = powers(self.pieces[piece].1);
        std::array::from_fn(|order| {
            let weights = place.weights(order, &powers);
            let ends = [&self.knots[piece], &self.knots[piece + 1]];
            let mut sum = Vector4::zeros();
            for (end, weights) in ends.into_iter().zip(&weights) {
                for (derivative, weight) in end.iter().zip(weights) {
                    sum += derivative * *weight;
                }
            }
            sum
        })
    }

    /// The same line, `k` times as slowly.
    pub fn stretched(mut self, k: f64) -> Self {
        self.pieces.iter_mut().for_each(|(_, duration)| *duration *= k);
        for knot in &mut self.knots {
            for (order, derivative) in knot.iter_mut().enumerate() {
                *derivative /= k.powi(order as i32);
            }
        }
        self
    }

    /// The same motion with each piece in so many equal parts as `parts` says of its duration.
    pub fn split(&self, parts: impl Fn(f64) -> usize) -> Self {
        let (mut knots, mut pieces) = (Vec::new(), Vec::new());
        for (number, (leg, duration)) in self.pieces.iter().enumerate() {
            let parts = parts(*duration);
            for part in 0..parts {
                let place = Place::new(part as f64 / parts as f64);
                knots.push(if part == 0 { self.knots[number] } else { self.motion(number, &place) });
                pieces.push((*leg, duration / parts as f64));
            }
        }
        knots.extend(self.knots.last());
        Self { knots, pieces, legs: self.legs.clone() }
    }

    /// Whether at no instant it leaves a leg's corridor, or exceeds its speed.
    pub fn keeps_to_its_legs(&self) -> bool {
        self.pieces.iter().zip(self.knots.windows(2)).all(|((leg, duration), ends)| {
            let leg = &self.legs[*leg];
            let place = controls(&ends[0], &ends[1], *duration);
            let rate = (CONTROL_POINTS - 1) as f64 / duration;
            let velocity: [_; CONTROL_POINTS - 1] = std::array::from_fn(|i| (place[i + 1] - place[i]) * rate);
            stays(&place, |place| leg.off(place).norm() > leg.corridor)
                && stays(&velocity, |velocity| velocity.norm() > leg.speed)
        })
    }

    /// The knots at whole microseconds.
    pub fn knots(&self) -> Vec<Knot> {
        let mut time = 0.0;
        let mut knots = Vec::with_capacity(self.knots.len());
        for (number, [place, derivatives @ ..]) in self.knots.iter().enumerate() {
            let time_us = (time * 1e6_f64).round() as u64;
            knots.push(Knot { time_us, position: place.xyz(), heading: place.w, derivatives: *derivatives });
            time += self.pieces.get(number).map_or(0.0, |(_, duration)| *duration);
        }
        knots
    }
}

/// A piece's position in Bernstein form, m.
fn controls(start: &Motion, end: &Motion, duration: f64) -> [Vector3<f64>; CONTROL_POINTS] {
    // Differences of order l of the control points at an end: p^(l) T^l (9 - l)! / 9!.
    let differences = |end: &Motion, sign: f64| -> [Vector3<f64>; KNOT_ORDERS] {
        let mut factor = 1.0;
        std::array::from_fn(|l| {
            let difference = end[l].xyz() * factor;
            factor *= sign * duration / (9 - l) as f64;
            difference
        })
    };
    let choose = [
        [1.0, 0.0, 0.0, 0.0, 0.0],
        [1.0, 1.0, 0.0, 0.0, 0.0],
        [1.0, 2.0, 1.0, 0.0, 0.0],
        [1.0, 3.0, 3.0, 1.0, 0.0],
        [1.0, 4.0, 6.0, 4.0, 1.0],
    ];
    let point = |differences: &[Vector3<f64>; KNOT_ORDERS], number: usize| -> Vector3<f64> {
        differences.iter().zip(choose[number]).map(|(difference, count)| difference * count).sum()
    };
    let (from, to) = (differences(start, 1.0), differences(end, -1.0));
    std::array::from_fn(|i| if i < KNOT_ORDERS { point(&from, i) } else { point(&to, CONTROL_POINTS - 1 - i) })
}
