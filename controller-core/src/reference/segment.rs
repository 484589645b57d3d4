//! One polynomial piece of a waypoint reference, degree 9, in Bernstein form.
//!
//! With s = (t - start) / T in [0, 1], every derivative from position to snap is kept as control points of its own,
//! computed in double precision and rounded once: differences of rounded positions would leave nothing of the snap.
//! Positions are relative to the segment's first point and headings to its first phase, so that neither kilometres nor
//! turns cost precision. s and 1 - s are both ratios of integers, so s resolves 2^-24 of a segment's length at its
//! middle and better towards its ends.
//!
//! The four axes are x, y, z (m, world) and the heading psi (rad).

use super::Reference;
use super::bernstein::{DEGREE_ZERO, Supremum, combine, raise};
use super::knot::{Anchor, Derivatives, Knot};
use super::phase;
use crate::heading::Heading;
use crate::math;
use nalgebra::{Vector2, Vector3, Vector4};

/// A polynomial piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    start_us: u64,
    end_us: u64,
    origin: Anchor,
    offset: [Vector4<f32>; 10],
    velocity: [Vector4<f32>; 9],
    acceleration: [Vector4<f32>; 8],
    jerk: [Vector3<f32>; 7],
    snap: [Vector3<f32>; 6],
}

/// Control points of a curve's derivative with exact ends: `M` is `N` - 1, `rate` the degree over the duration.
fn derivative<const N: usize, const M: usize>(
    points: &[Vector4<f64>; N],
    rate: f64,
    start: Vector4<f64>,
    end: Vector4<f64>,
) -> [Vector4<f64>; M] {
    let mut derivative = [Vector4::zeros(); M];
    for (d, (a, b)) in derivative.iter_mut().zip(points.iter().zip(points.iter().skip(1))) {
        *d = (b - a) * rate;
    }
    // Both neighbours of a joint round the same numbers: what the differences lost does not show as a step.
    if let [first, .., last] = derivative.as_mut_slice() {
        *first = start;
        *last = end;
    }
    derivative
}

impl Segment {
    /// From one knot to the next, passing both as they say.
    pub fn between(knot: &Knot, next: &Knot) -> Self {
        let (start_us, end_us, origin) = (knot.time_us, next.time_us, knot.anchor());
        let (difference, start, end) = (knot.difference_to(next), &knot.derivatives, &next.derivatives);
        let t = knot.duration_to(next);
        // Forward differences of the first control points, backward differences of the last: p^(k) T^k (9 - k)! / 9!.
        let scaled = |derivatives: &Derivatives| {
            let [v, a, j, s] = derivatives;
            [v * (t / 9.0), a * (t * t / 72.0), j * (t * t * t / 504.0), s * (t * t * t * t / 3024.0)]
        };
        let [v0, a0, j0, s0] = scaled(start);
        let [v1, a1, j1, s1] = scaled(end);
        let offset = [
            Vector4::zeros(),
            v0,
            v0 * 2.0 + a0,
            v0 * 3.0 + a0 * 3.0 + j0,
            v0 * 4.0 + a0 * 6.0 + j0 * 4.0 + s0,
            difference - v1 * 4.0 + a1 * 6.0 - j1 * 4.0 + s1,
            difference - v1 * 3.0 + a1 * 3.0 - j1,
            difference - v1 * 2.0 + a1,
            difference - v1,
            difference,
        ];
        let ([v0, a0, j0, s0], [v1, a1, j1, s1]) = (*start, *end);
        let velocity: [_; 9] = derivative(&offset, 9.0 / t, v0, v1);
        let acceleration: [_; 8] = derivative(&velocity, 8.0 / t, a0, a1);
        let jerk: [_; 7] = derivative(&acceleration, 7.0 / t, j0, j1);
        let snap: [_; 6] = derivative(&jerk, 6.0 / t, s0, s1);
        Self {
            start_us,
            end_us,
            origin,
            offset: offset.map(|point| point.map(|x| x as f32)),
            velocity: velocity.map(|point| point.map(|x| x as f32)),
            acceleration: acceleration.map(|point| point.map(|x| x as f32)),
            jerk: jerk.map(|point| point.xyz().map(|x| x as f32)),
            snap: snap.map(|point| point.xyz().map(|x| x as f32)),
        }
    }

    /// When it takes over, microseconds.
    pub(super) fn start_us(&self) -> u64 {
        self.start_us
    }

    /// When the next segment takes over, microseconds.
    pub(super) fn end_us(&self) -> u64 {
        self.end_us
    }

    /// The largest coordinate that can occur, m; infinite or NaN if any control point is.
    pub(super) fn reach(&self) -> f32 {
        let finite = self.offset.iter().chain(&self.velocity).chain(&self.acceleration).all(is_finite)
            && self.jerk.iter().chain(&self.snap).all(is_finite);
        let largest = self.offset.iter().map(Vector4::amax).fold(0.0, f32::max);
        if finite { self.origin.position.amax() + largest } else { f32::INFINITY }
    }

    /// A bound of the position's fifth derivative, m/s^5: of its control points, which are those of the snap less their
    /// neighbours.
    pub(super) fn fifth_derivative(&self) -> f64 {
        let rate = 5.0 / (self.end_us.saturating_sub(self.start_us) as f64 * 1e-6);
        let pairs = self.snap.iter().zip(self.snap.iter().skip(1));
        let squares = pairs.map(|(a, b)| (b - a).map(f64::from).norm_squared());
        rate * math::sqrt_f64(squares.fold(0.0, f64::max))
    }

    /// The reference at `time_us`, from the segment's start to its end.
    pub fn at(&self, time_us: u64) -> Reference {
        let duration = self.end_us.saturating_sub(self.start_us) as f32;
        let done = time_us.saturating_sub(self.start_us) as f32 / duration;
        let rest = self.end_us.saturating_sub(time_us) as f32 / duration;
        let mut weights = DEGREE_ZERO;
        for _ in 0..5 {
            raise(&mut weights, rest, done);
        }
        let snap = combine(&weights, &self.snap);
        raise(&mut weights, rest, done);
        let jerk = combine(&weights, &self.jerk);
        raise(&mut weights, rest, done);
        let acceleration = combine(&weights, &self.acceleration);
        raise(&mut weights, rest, done);
        let velocity = combine(&weights, &self.velocity);
        raise(&mut weights, rest, done);
        let offset = combine(&weights, &self.offset);
        let psi = self.origin.phase.wrapping_add(phase::swing(offset.w));
        Reference {
            position: self.origin.position + offset.xyz(),
            velocity: velocity.xyz(),
            acceleration: acceleration.xyz(),
            jerk,
            snap,
            heading: Heading::from_phase(psi, velocity.w, acceleration.w),
        }
    }
}

fn is_finite<const N: usize>(vector: &nalgebra::SVector<f32, N>) -> bool {
    vector.iter().all(|x| x.is_finite())
}

/// The suprema of a reference's bounds over the segments taken in; the measures are squares.
pub(super) struct Suprema {
    pub horizontal_speed: Supremum<fn(&Vector2<f64>) -> f64>,
    pub horizontal_acceleration: Supremum<fn(&Vector2<f64>) -> f64>,
    pub vertical_acceleration: Supremum<fn(&f64) -> f64>,
    pub jerk: Supremum<fn(&Vector3<f64>) -> f64>,
    pub snap: Supremum<fn(&Vector3<f64>) -> f64>,
    pub heading_rate: Supremum<fn(&f64) -> f64>,
    /// psi''^2 + psi'^4 of the curve (psi', psi''), of which it is a convex function.
    pub heading_second_derivative: Supremum<fn(&Vector2<f64>) -> f64>,
}

impl Suprema {
    /// Of no segment yet.
    pub(super) fn new() -> Self {
        Self {
            horizontal_speed: Supremum::new(Vector2::norm_squared),
            horizontal_acceleration: Supremum::new(Vector2::norm_squared),
            vertical_acceleration: Supremum::new(|x| x * x),
            jerk: Supremum::new(Vector3::norm_squared),
            snap: Supremum::new(Vector3::norm_squared),
            heading_rate: Supremum::new(|x| x * x),
            heading_second_derivative: Supremum::new(|point| {
                let rate2 = point.x * point.x;
                point.y * point.y + rate2 * rate2
            }),
        }
    }

    /// Takes in the control points as they are flown: what is bounded is the rounded polynomial.
    pub(super) fn include(&mut self, segment: &Segment) {
        let velocity = segment.velocity.map(|point| point.map(f64::from));
        self.horizontal_speed.include(&velocity.map(|point| point.xy()));
        let acceleration = segment.acceleration.map(|point| point.map(f64::from));
        self.horizontal_acceleration.include(&acceleration.map(|point| point.xy()));
        self.vertical_acceleration.include(&acceleration.map(|point| point.z));
        self.jerk.include(&segment.jerk.map(|point| point.map(f64::from)));
        self.snap.include(&segment.snap.map(|point| point.map(f64::from)));
        let rate = velocity.map(|point| point.w);
        self.heading_rate.include(&rate);
        let mut turning = rate.map(|rate| Vector2::new(rate, 0.0));
        for (point, acceleration) in turning.iter_mut().zip(elevate(&acceleration.map(|point| point.w))) {
            point.y = acceleration;
        }
        self.heading_second_derivative.include(&turning);
    }
}

/// The same curve of degree 7 as one of degree 8: b_i = (i / 8) a_(i-1) + (1 - i / 8) a_i.
fn elevate(points: &[f64; 8]) -> [f64; 9] {
    let mut elevated = [0.0; 9];
    let mut before = 0.0;
    let padded = points.iter().copied().chain(core::iter::once(0.0));
    for (i, (to, point)) in elevated.iter_mut().zip(padded).enumerate() {
        let share = i as f64 / 8.0;
        *to = share * before + (1.0 - share) * point;
        before = point;
    }
    elevated
}
