//! The wrenches that rotors within their ranges can deliver, as half-spaces worked out once.
//!
//! The image of a box under B is a zonotope Z = { sum_i b_i f_i : low_i <= f_i <= high_i }. Between its two faces with
//! normal a it is as wide as the support function says:
//!
//! ```text
//! sum_i min(a.b_i low_i, a.b_i high_i) <= a.w <= sum_i max(a.b_i low_i, a.b_i high_i)
//! ```
//!
//! and every face of a zonotope in four dimensions holds three independent columns b_i, b_j, b_k. So the normals to all
//! triples of columns describe Z completely: at most 56 slabs for eight rotors. Z with one wrench component left open
//! (a prism) has the normals to all pairs of columns and that component's axis.
//!
//! The mixer moves a wrench along a line and needs to know how far it may go. With a slab's normal scaled to a.d = 1,
//!
//! ```text
//! w - s d in Z   =>   a.w - high <= s <= a.w - low,
//! ```
//!
//! two multiply-adds per slab and no division: [`Slabs::range`]. The image of Z in the roll-pitch plane is a polygon
//! with two edges per rotor; [`Polygon::nearest`] projects onto it.
//!
//! Normals are worked out in f64 with the wrench scaled as in [`Rotors`]; a tick works in f32. Where d nearly runs
//! along a face, a.d is small, and the rounding of a.w becomes a large error in s. Three rules keep that from
//! mattering:
//!
//! - a *steep* slab (|a.d| < [`STEEP_FACE_COSINE`] |a||d|) is widened by that rounding, so that it never cuts off what
//!   is attainable;
//! - slabs narrow the range in the order of their steepness, and none moves it out of what the gentler ones left;
//! - a slab with |a.d| below [`PARALLEL_FACE_COSINE`] is left out.
//!
//! So a range errs by rounding across every face, whatever the face's slope; the mixer's last clip takes that back.

use super::collected;
use super::geometry::{ROTORS_MAX, Rotors, normal};
use crate::error::ParameterError;
use crate::math;
use crate::vehicle::{LimitParameters, Limits, Vehicle};
use core::cell::Cell;
use heapless::Vec;
use nalgebra::{Vector2, Vector3, Vector4};

/// Pairs of eight rotors.
pub(super) const ROTOR_PAIRS_MAX: usize = 28;

/// What evaluating a.w in f32 may lose, relative to |a|.|w|: four products, four sums, and the rounding of a, w and the
/// bounds, half an [`f32::EPSILON`] each at most.
const EVALUATION_ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// The cosine between a and d below which a face is steep: rounding is magnified more than its inverse, 30 times.
const STEEP_FACE_COSINE: f64 = 1.0 / 30.0;

/// The cosine below which a face does not bound movement along d: its widening hides the polytope.
const PARALLEL_FACE_COSINE: f64 = 1e-6;

/// A column of B with its rotor's range, the wrench scaled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Generator {
    column: Vector4<f64>,
    low: f64,
    high: f64,
}

/// The generators of some of the rotors, in the order given.
pub(super) fn generators<'a>(rotors: &Rotors, chosen: impl Iterator<Item = &'a usize>) -> Vec<Generator, ROTORS_MAX> {
    let one = |index: &usize| {
        let rotor = rotors.get(*index)?;
        let column = rotors.effectiveness().get(*index)?.component_mul(&rotors.scale());
        Some(Generator { column, low: f64::from(rotor.thrust_min), high: f64::from(rotor.thrust_max) })
    };
    collected(chosen.filter_map(one))
}

/// low <= normal . w <= high, with normal . d = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Slab {
    normal: Vector4<f32>,
    low: f32,
    high: f32,
}

impl Slab {
    /// The slab between the faces with `normal`, and the cosine between normal and direction; none where they are
    /// parallel.
    fn new(
        rotors: &Rotors,
        generators: &[Generator],
        direction: &Vector4<f64>,
        normal: &Vector4<f64>,
    ) -> Option<(f64, Self)> {
        let along = normal.dot(direction);
        let cosine = along.abs() / math::sqrt_f64(normal.dot(normal) * direction.dot(direction));
        // Dependent triples have no normal (0 / 0 compares false): the faces they lie in come from other triples.
        if cosine > PARALLEL_FACE_COSINE {
            let normal = normal / along;
            let (low, high) = extent(generators, &normal);
            let slack =
                if cosine < STEEP_FACE_COSINE { EVALUATION_ROUNDING * magnitude(generators, &normal) } else { 0.0 };
            let normal = normal.component_mul(&rotors.scale()).map(|x| x as f32);
            Some((cosine, Self { normal, low: (low - slack) as f32, high: (high + slack) as f32 }))
        } else {
            None
        }
    }
}

/// How far a wrench may move along one direction d without leaving a zonotope of at most N slabs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Slabs<const N: usize>(Vec<Slab, N>);

impl<const N: usize> Slabs<N> {
    /// Of no zonotope.
    pub(super) const NONE: Self = Self(Vec::new());

    /// The zonotope of `generators`, open along `open` if given; `direction` is d, in the wrench's own units.
    #[inline(never)] // as the polygon's
    pub(super) fn new(
        rotors: &Rotors,
        generators: &[Generator],
        open: Option<Vector4<f64>>,
        direction: Vector4<f64>,
    ) -> Self {
        let direction = direction.component_mul(&rotors.scale());
        let mut slabs: Vec<(f64, Slab), N> = Vec::new();
        for (i, a) in generators.iter().enumerate() {
            for (j, b) in generators.iter().enumerate().skip(i + 1) {
                let others = generators.iter().skip(j + 1).map(|generator| &generator.column);
                let third = open.iter().chain(others.take(if open.is_some() { 0 } else { ROTORS_MAX }));
                for c in third {
                    let slab = Slab::new(rotors, generators, &direction, &normal(&a.column, &b.column, c));
                    // N counts every triple there is.
                    let _ = slab.map(|slab| slabs.push(slab));
                }
            }
        }
        // Gentlest first.
        for _ in 0..N {
            for pair in Cell::from_mut(slabs.as_mut_slice()).as_slice_of_cells().windows(2) {
                if let [one, next] = pair
                    && one.get().0 < next.get().0
                {
                    one.swap(next);
                }
            }
        }
        Self(collected(slabs.iter().map(|(_, slab)| *slab)))
    }

    /// The least and greatest s with `wrench` - s d in the zonotope; if it misses the zonotope, nearly so.
    pub(super) fn range(&self, wrench: &Vector4<f32>) -> (f32, f32) {
        self.0.iter().fold((f32::NEG_INFINITY, f32::INFINITY), |(min, max), slab| {
            let at = slab.normal.dot(wrench);
            let into = |s: f32| s.max(min).min(max);
            (into(at - slab.high), into(at - slab.low))
        })
    }
}

/// sum_i |normal| . |b_i| high_i: the size of what rounding is relative to.
fn magnitude(generators: &[Generator], normal: &Vector4<f64>) -> f64 {
    generators.iter().map(|generator| normal.abs().dot(&generator.column.abs()) * generator.high).sum()
}

/// The zonotope's least and greatest component along `normal`.
fn extent(generators: &[Generator], normal: &Vector4<f64>) -> (f64, f64) {
    generators.iter().fold((0.0, 0.0), |(low, high), generator| {
        let at = normal.dot(&generator.column);
        let (one, other) = (at * generator.low, at * generator.high);
        (low + one.min(other), high + one.max(other))
    })
}

/// The greatest torque about each body axis, N m, that `rotors` deliver to either side with none about the other two,
/// at whatever thrust suits it best. Not above zero for some axis where they cannot push without turning the vehicle.
pub fn max_torques(rotors: &Rotors) -> Vector3<f32> {
    let order: Vec<usize, ROTORS_MAX> = collected(0..rotors.len());
    let all = generators(rotors, order.iter());
    let about = |axis: Vector4<f64>| {
        let along = Slabs::<ROTOR_PAIRS_MAX>::new(rotors, &all, Some(Vector4::x()), -axis);
        let (min, max) = along.range(&Vector4::zeros());
        max.min(-min)
    };
    Vector3::new(about(Vector4::y()), about(Vector4::z()), about(Vector4::w()))
}

impl Rotors {
    /// The limits that the rotors themselves are: all their greatest thrusts together, and [`max_torques`].
    ///
    /// # Errors
    /// If `vehicle` cannot hover by that, or the rotors cannot push without turning it.
    pub fn limits(&self, vehicle: &Vehicle) -> Result<Limits, ParameterError> {
        Limits::new(LimitParameters { thrust_max: self.thrust_together().1, torque_max: max_torques(self) }, vehicle)
    }
}

/// An edge of a convex polygon.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Edge {
    start: Vector2<f32>,
    along: Vector2<f32>,
    /// `along` over its squared length.
    per_length: Vector2<f32>,
    /// Unit normal, away from the polygon.
    outward: Vector2<f32>,
}

impl Edge {
    fn nearest(&self, point: &Vector2<f32>) -> Vector2<f32> {
        let part = (point - self.start).dot(&self.per_length).clamp(0.0, 1.0);
        self.start + self.along * part
    }
}

/// The roll and pitch torques that can be had, N m, whatever the thrust and yaw.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Polygon(Vec<Edge, { 2 * ROTORS_MAX }>);

impl Polygon {
    /// Of no rotors.
    pub(super) const NONE: Self = Self(Vec::new());

    #[inline(never)] // its temporaries are not to add up with those of the slabs
    pub(super) fn new(rotors: &Rotors) -> Self {
        let arms = || rotors.effectiveness().iter().map(|column| Vector2::new(column.y, column.z));
        let mut edges = Vec::new();
        for arm in arms() {
            let length = math::sqrt_f64(arm.norm_squared());
            if length > 0.0 {
                let normal = Vector2::new(arm.y, -arm.x) / length;
                for outward in [normal, -normal] {
                    // Counter-clockwise, the polygon on the left.
                    let forward = Vector2::new(-outward.y, outward.x);
                    let mut start = Vector2::zeros();
                    let mut along = Vector2::zeros();
                    for (rotor, other) in rotors.iter().zip(arms()) {
                        let (low, high) = (f64::from(rotor.thrust_min), f64::from(rotor.thrust_max));
                        let side = outward.dot(&other);
                        // Rotors on one line with the centre share an edge; the rounding of their places does not
                        // count.
                        let parallel = side.abs() <= 1e-12 * length;
                        let rises = if parallel { forward.dot(&other) < 0.0 } else { side > 0.0 };
                        start += other * if rises { high } else { low };
                        if parallel {
                            along += forward * (forward.dot(&other).abs() * (high - low));
                        }
                    }
                    let single = |v: Vector2<f64>| v.map(|x| x as f32);
                    // Two edges for each rotor is what there is room for.
                    let _ = edges.push(Edge {
                        start: single(start),
                        along: single(along),
                        per_length: single(along / along.norm_squared()),
                        outward: single(outward),
                    });
                }
            }
        }
        Self(edges)
    }

    /// The point itself if it lies in the polygon, else the nearest one of the polygon's edges.
    pub(super) fn nearest(&self, point: &Vector2<f32>) -> Vector2<f32> {
        if self.0.iter().all(|edge| edge.outward.dot(&(point - edge.start)) <= 0.0) {
            return *point;
        }
        // |c - p|^2 < |b - p|^2 written as (b - c).(2 p - b - c) < 0: right for near and for far points in f32.
        let closer = |best: Vector2<f32>, candidate: Vector2<f32>| {
            let nearer = (best - candidate).dot(&(2.0 * point - best - candidate)) < 0.0;
            if nearer { candidate } else { best }
        };
        self.0.iter().map(|edge| edge.nearest(point)).reduce(closer).unwrap_or_default()
    }
}
