//! The reference r(t) of the paper's Section III, and its bounds Omega_r.
//!
//! The law needs the position to its fourth derivative (snap) and the heading to its second; Assumption 1 needs bounds
//! on all of them. Each kind of reference states its own bounds, rigorously:
//!
//! - [`hover`]: a point and a heading, at rest;
//! - [`harmonic`]: a cosine on each axis, and a heading that turns and swings (the paper's experiment);
//! - [`waypoints`]: polynomials through given points, smooth to snap;
//! - [`path`]: the same of any length, through knots that say how they are passed.
//!
//! Time is integer microseconds; see [`phase`] for why a month of uptime costs a periodic reference no precision.

mod bernstein;
pub mod harmonic;
pub mod hover;
pub mod inside;
pub mod knot;
pub mod path;
pub mod phase;
pub mod segment;
pub mod spline;
pub mod waypoints;

use crate::constants::{Range, constants};
use crate::error::{InputError, ParameterError};
use crate::heading::Heading;
use crate::math;
use crate::state::{STATE_RANGE, State, check_vectors, sum_of_squares};
use nalgebra::Vector3;

/// The greatest magnitude of a reference derivative's component, in its SI unit.
pub const DERIVATIVE_RANGE: f32 = 1e6;

/// A reference at one instant. World frame, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference {
    /// p_d, m.
    pub position: Vector3<f32>,
    /// p_d', m/s.
    pub velocity: Vector3<f32>,
    /// p_d'', m/s^2.
    pub acceleration: Vector3<f32>,
    /// p_d''', m/s^3.
    pub jerk: Vector3<f32>,
    /// p_d'''', m/s^4.
    pub snap: Vector3<f32>,
    /// nu_d with its derivatives.
    pub heading: Heading,
}

impl Reference {
    /// At rest.
    pub const fn resting(position: Vector3<f32>, heading: Heading) -> Self {
        let zero = Vector3::new(0.0, 0.0, 0.0);
        Self { position, velocity: zero, acceleration: zero, jerk: zero, snap: zero, heading }
    }

    /// The sum of the squares of all vectors and of the heading's rates.
    #[inline(always)]
    pub(crate) fn squares(&self) -> f32 {
        let turning = Vector3::new(self.heading.rate(), self.heading.acceleration(), 0.0);
        sum_of_squares(&[&self.position, &self.velocity, &self.acceleration, &self.jerk, &self.snap, &turning])
    }

    /// Checks that every field is finite and in range.
    pub(crate) fn check(&self) -> Result<(), InputError> {
        let turning = Vector3::new(self.heading.rate(), self.heading.acceleration(), 0.0);
        check_vectors(&[
            (&self.position, STATE_RANGE, "reference.position"),
            (&self.velocity, STATE_RANGE, "reference.velocity"),
            (&self.acceleration, DERIVATIVE_RANGE, "reference.acceleration"),
            (&self.jerk, DERIVATIVE_RANGE, "reference.jerk"),
            (&self.snap, DERIVATIVE_RANGE, "reference.snap"),
            (&turning, DERIVATIVE_RANGE, "reference.heading"),
        ])
    }
}

/// Refuses a tick's inputs for which no law is defined; the reference's vertical acceleration stays above
/// `steepest_fall`, m/s^2. Nearly every input passes at a glance.
#[inline(always)]
pub(crate) fn admit(state: &State, reference: &Reference, steepest_fall: f32) -> Result<(), InputError> {
    if passes_at_a_glance(state, reference, steepest_fall) { Ok(()) } else { examine(state, reference, steepest_fall) }
}

/// Whether nothing can be wrong: where the squares of all components add up to little, each is finite and in range.
#[inline(always)]
pub(crate) fn passes_at_a_glance(state: &State, reference: &Reference, steepest_fall: f32) -> bool {
    let small = state.squares() + reference.squares() <= DERIVATIVE_RANGE * DERIVATIVE_RANGE;
    let climbs = reference.acceleration.z > steepest_fall;
    small & climbs & state.has_unit_attitude()
}

/// What is wrong with an input, if anything.
#[cold]
#[inline(never)]
pub(crate) fn examine(state: &State, reference: &Reference, steepest_fall: f32) -> Result<(), InputError> {
    state.check()?;
    reference.check()?;
    if reference.acceleration.z > steepest_fall { Ok(()) } else { Err(InputError::FallsTooFast) }
}

constants! {
    /// Omega_r of Assumption 1: the bounds of a reference's derivatives.
    pub struct ReferenceBounds {
        /// K_v12, m/s: horizontal speed, Euclidean. Only a law that feeds drag forward depends on it.
        reference_bounds.horizontal_speed: Range::BOUND, FIXED;
        /// K_a12, m/s^2: horizontal acceleration, Euclidean.
        reference_bounds.horizontal_acceleration: Range::BOUND, FIXED;
        /// K_a3, m/s^2: |vertical acceleration|.
        reference_bounds.vertical_acceleration: Range::BOUND, FIXED;
        /// K_j, m/s^3: jerk, Euclidean.
        reference_bounds.jerk: Range::BOUND, FIXED;
        /// K_s, m/s^4: snap, Euclidean.
        reference_bounds.snap: Range::BOUND, FIXED;
        /// K_nu', rad/s: |nu_d'| = |psi'|.
        reference_bounds.heading_rate: Range::BOUND, FIXED;
        /// K_nu'', 1/s^2: |nu_d''| = sqrt(psi''^2 + psi'^4).
        reference_bounds.heading_second_derivative: Range::BOUND, FIXED;
    }
}

impl ReferenceBounds {
    /// The bounds of a reference at rest.
    pub const REST: Self = Self {
        horizontal_speed: 0.0,
        horizontal_acceleration: 0.0,
        vertical_acceleration: 0.0,
        jerk: 0.0,
        snap: 0.0,
        heading_rate: 0.0,
        heading_second_derivative: 0.0,
    };

    /// The greater of each bound.
    pub fn covering(&self, other: &Self) -> Self {
        let (mut values, others) = (self.values(), other.values());
        for (value, other) in values.iter_mut().zip(others) {
            *value = value.max(other);
        }
        Self::from_values(values)
    }

    /// Checks that every bound is finite and not negative.
    ///
    /// # Errors
    /// Names the first field that is not.
    pub fn validated(self) -> Result<Self, ParameterError> {
        self.check()?;
        Ok(self)
    }

    /// Whether `reference` lies inside, with a relative allowance for single-precision rounding.
    pub fn contain(&self, reference: &Reference, allowance: f32) -> bool {
        let Reference { velocity: v, acceleration: a, jerk, snap, heading, .. } = reference;
        [
            (v.xy().norm_squared(), self.horizontal_speed),
            (a.xy().norm_squared(), self.horizontal_acceleration),
            (a.z * a.z, self.vertical_acceleration),
            (jerk.norm_squared(), self.jerk),
            (snap.norm_squared(), self.snap),
            (heading.rate() * heading.rate(), self.heading_rate),
            (heading.second_derivative().norm_squared(), self.heading_second_derivative),
        ]
        .iter()
        .all(|(square, bound)| math::sqrt(*square) <= bound * (1.0 + allowance) + allowance)
    }
}

/// A trajectory: a reference at every instant, and bounds it never leaves.
pub trait Trajectory {
    /// The reference at `time_us` microseconds after the start.
    fn at(&self, time_us: u64) -> Reference;

    /// Bounds that hold at every instant, rounded outwards.
    fn bounds(&self) -> ReferenceBounds;

    /// A bound of the position's fifth derivative between two instants, microseconds after the start, m/s^5, Euclidean:
    /// how fast the snap changes.
    fn fifth_derivative(&self, from_us: u64, to_us: u64) -> f64;
}

/// The least single-precision number not below `bound`, which is not negative.
fn outwards(bound: f64) -> f32 {
    let rounded = bound as f32;
    if f64::from(rounded) < bound { rounded.next_up() } else { rounded }
}
