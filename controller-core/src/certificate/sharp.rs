//! A bound on omega_d and omega_d' sharper than Lemma 1's. `docs/sharp-bound.md` derives it step by step.
//!
//! Let n = |u|, gamma the tilt of rho = u / n from the vertical, chi the angle in the plane orthogonal to rho from body
//! x to the uphill direction, so that the roll of R_d has tan phi = tan gamma sin chi. Write w and p for the parts of
//! u'' and u' orthogonal to rho, r for the part of u' along it, w_perp and p_perp for the horizontal ones among the
//! orthogonal, and `[v]` = (|v| + |v_perp|) / 2, which is the greatest sin chi (x . v) over chi. Then, exactly,
//! omega_d' = L u'' + N, with
//!
//! ```text
//! |L_12 u''| = |w| / n,  |L_3 u''| = |tan phi (x . w)| / n <= tan gamma [w] / n,
//!
//! |N_12| = (p / n) sqrt(4 r^2 / n^2 + omega_3^2),  |omega_3| <= |psi'| / cos gamma + tan gamma [p] / n,
//!
//! |N_3| <= |psi''| / cos gamma + 2 tan gamma r [p] / n^2 + psi'^2 tan^2 gamma + 2 |psi'| (p / n) sin gamma / cos^2 gamma
//!       + (p / n)^2 (1 + 2 tan^2 gamma) / 2,
//!
//! |omega_d'|^2 <= (|L_12 u''| + |N_12|)^2 + (|L_3 u''| + |N_3|)^2.
//! ```
//!
//! What is gained over the lemma: the yaw acceleration feels w only through tan gamma, and the tilt is bounded; p and r
//! share one budget, p^2 + r^2 <= |u'|^2; the horizontal parts of w share another; the tilting and the yawing part of
//! omega_d' are orthogonal; tall n goes with tilt, n >= u_z,min / cos gamma.
//!
//! The supremum over (gamma; direction of w; split of u'; psi') is taken over cells that cover the whole range, each
//! quantity at the end of the cell where it is worst, so that the result is a bound and not a sample. The number of
//! cells is constant. Cells whose bound, every part at its worst at once, does not exceed what was found already are
//! not looked into: rounding is monotone, so the result is the same to the last bit.

mod cells;

use super::reachable::Reachable;
use crate::math::real::Real;
use crate::reference::ReferenceBounds;
pub use cells::{ANGLE_CELLS, HEADING_CELLS, SPLIT_CELLS, TILT_CELLS};
use cells::{Direction, HeadingCell, Parts, Shares, Tilt};
use nalgebra::Vector3;

/// Bounds on the desired attitude's motion, and on the torque it takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesiredRates<R = f64> {
    /// U_omega: greatest |omega_d|, rad/s.
    pub angular_velocity: R,
    /// U_omega': greatest |omega_d'|, rad/s^2.
    pub angular_acceleration: R,
    /// Greatest J_ii |omega_d'| + |J_jj - J_kk| |omega_d|^2 / 2 about each body axis, N m.
    pub feedforward_torque: Vector3<R>,
}

impl<R: Real> DesiredRates<R> {
    /// The componentwise lesser of two bounds.
    pub fn min(&self, other: &Self) -> Self {
        Self {
            angular_velocity: self.angular_velocity.lesser(other.angular_velocity),
            angular_acceleration: self.angular_acceleration.lesser(other.angular_acceleration),
            feedforward_torque: self.feedforward_torque.zip_map(&other.feedforward_torque, R::lesser),
        }
    }

    /// Whether any of these bounds may be greater than the other's.
    fn exceed(&self, other: &Self) -> bool {
        // What is undefined exceeds everything.
        let exceeds = |ours: R, theirs: R| ours.upper() > theirs.upper() || ours.upper().is_nan();
        let torque = self.feedforward_torque.iter().zip(other.feedforward_torque.as_slice());
        exceeds(self.angular_velocity, other.angular_velocity)
            || exceeds(self.angular_acceleration, other.angular_acceleration)
            || torque.into_iter().any(|(ours, theirs)| exceeds(*ours, *theirs))
    }

    /// These bounds raised to hold for another cell too.
    #[inline(never)] // twice in a board's image is once too often
    fn with(&self, inertia: &Vector3<R>, velocity: R, acceleration: R) -> Self {
        Self {
            angular_velocity: self.angular_velocity.greater(velocity),
            angular_acceleration: self.angular_acceleration.greater(acceleration),
            feedforward_torque: self
                .feedforward_torque
                .zip_map(&feedforward_torque(inertia, velocity, acceleration), R::greater),
        }
    }
}

/// J_ii a + |J_jj - J_kk| v^2 / 2 for each axis: the bound under |omega_d'| <= a and |omega_d| <= v in any body frame.
pub fn feedforward_torque<R: Real>(inertia: &Vector3<R>, velocity: R, acceleration: R) -> Vector3<R> {
    let differences = Vector3::new(inertia.y - inertia.z, inertia.z - inertia.x, inertia.x - inertia.y).map(R::abs);
    inertia * acceleration + differences * (velocity * 0.5 * velocity)
}

/// The greatest |L u'' + N|^2 of one cell of the tilt: every direction, heading and share, with those left out of which
/// an upper bound shows that they change nothing.
fn acceleration_square<R: Real>(
    tilt: &Tilt<R>,
    linear: &[Parts<R>; ANGLE_CELLS],
    headings: &[HeadingCell<R>; HEADING_CELLS],
    shares: &[Shares<R>; SPLIT_CELLS],
) -> R {
    let (worst_linear, worst_shares) = (Parts::worst(linear), Shares::worst(shares));
    let mut max = R::from(0.0);
    for heading in headings {
        if worst_linear.square_of_sum(&tilt.quadratic_part(heading, &worst_shares)).upper() <= max.upper() {
            continue;
        }
        for shares in shares {
            let quadratic = tilt.quadratic_part(heading, shares);
            let is_covered = worst_linear.square_of_sum(&quadratic).upper() <= max.upper();
            if !is_covered {
                for linear in linear {
                    max = max.greater(linear.square_of_sum(&quadratic));
                }
            }
        }
    }
    max
}

/// Bounds on how the desired frame turns about its third axis: |omega_d3|, rad/s, and |omega'_d3|, rad/s^2, for
/// everything in `reach` and any heading within `bounds`; `reach.vertical_least` must be positive.
#[inline(never)] // a board's stack is not to hold it beside the other bounds
pub fn turning_rates<R: Real>(reach: &Reachable<R>, bounds: &ReferenceBounds) -> [R; 2] {
    let steepest = reach.horizontal / reach.vertical_min;
    let directions = Direction::quarter_turn();
    let headings = HeadingCell::all(bounds);
    let worst_heading = HeadingCell { rate: headings[0].rate, acceleration: headings[HEADING_CELLS - 1].acceleration };
    let (mut rate, mut acceleration) = (R::from(0.0), R::from(0.0));
    // The steepest first: they are the likeliest to matter.
    for cell in (0..TILT_CELLS).rev() {
        let ends = [cell, cell + 1].map(|end| steepest * end as f64 / TILT_CELLS as f64);
        let tilt = Tilt::between(ends[0], ends[1], reach.vertical_min);
        let tangential = directions.map(|d| tilt.tangential(reach.horizontal_jerk, reach.vertical_jerk, &d));
        for tangential in &tangential {
            rate = rate.greater(tilt.velocity(tangential, worst_heading.rate).yawing);
        }
        let longest = tangential.iter().map(|t| t.length * tilt.magnitude).fold(R::from(0.0), R::greater);
        let longest = longest.lesser(reach.jerk);
        let linear = Parts::worst(&directions.map(|direction| tilt.linear_part(reach, &direction)));
        let shares: [_; SPLIT_CELLS] = core::array::from_fn(|split| tilt.shares(reach, longest, split));
        let worst_shares = Shares::worst(&shares);
        let at_most =
            |heading: &HeadingCell<R>, shares: &Shares<R>| linear.yawing + tilt.quadratic_part(heading, shares).yawing;
        if at_most(&worst_heading, &worst_shares).upper() <= acceleration.upper() {
            continue;
        }
        for heading in &headings {
            if at_most(heading, &worst_shares).upper() <= acceleration.upper() {
                continue;
            }
            let all = shares.iter().map(|shares| at_most(heading, shares));
            acceleration = all.fold(acceleration, R::greater);
        }
    }
    [rate, acceleration]
}

/// The sharp bound for everything in `reach` and any heading within `bounds`; `reach.vertical_least` must be positive.
pub fn desired_rates<R: Real>(reach: &Reachable<R>, bounds: &ReferenceBounds, inertia: &Vector3<R>) -> DesiredRates<R> {
    let steepest = reach.horizontal / reach.vertical_min;
    let directions = Direction::quarter_turn();
    let headings = HeadingCell::all(bounds);
    // |psi'| is greatest in the first cell, |psi''| in the last, where nothing is left to |psi'|.
    let worst_heading = HeadingCell { rate: headings[0].rate, acceleration: headings[HEADING_CELLS - 1].acceleration };
    let zero = R::from(0.0);
    let nothing = Parts { tilting: zero, yawing: zero };
    let mut max =
        DesiredRates { angular_velocity: zero, angular_acceleration: zero, feedforward_torque: Vector3::repeat(zero) };
    // The steepest first: they are the likeliest to matter.
    for cell in (0..TILT_CELLS).rev() {
        let ends = [cell, cell + 1].map(|end| steepest * end as f64 / TILT_CELLS as f64);
        let tilt = Tilt::between(ends[0], ends[1], reach.vertical_min);

        let (mut velocity_square, mut longest) = (zero, zero);
        for direction in &directions {
            let tangential = tilt.tangential(reach.horizontal_jerk, reach.vertical_jerk, direction);
            let velocity = tilt.velocity(&tangential, worst_heading.rate);
            velocity_square = velocity_square.greater(velocity.square_of_sum(&nothing));
            longest = longest.greater(tangential.length * tilt.magnitude);
        }
        let velocity = velocity_square.sqrt_of_rounded();
        let longest = longest.lesser(reach.jerk);
        let linear = directions.map(|direction| tilt.linear_part(reach, &direction));
        let shares = core::array::from_fn(|split| tilt.shares(reach, longest, split));

        let quadratic = tilt.quadratic_part(&worst_heading, &Shares::worst(&shares));
        let at_most = max.with(inertia, velocity, Parts::worst(&linear).square_of_sum(&quadratic).sqrt_of_rounded());
        if at_most.exceed(&max) {
            let square = acceleration_square(&tilt, &linear, &headings, &shares);
            max = max.with(inertia, velocity, square.sqrt_of_rounded());
        }
    }
    max
}

#[cfg(test)]
mod tests;
