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

use super::reachable::Reachable;
use crate::math::real::Real;
use crate::reference::ReferenceBounds;
use nalgebra::Vector3;

/// Cells of tan gamma between upright and the greatest tilt.
pub const TILT_CELLS: usize = 48;
/// Cells of a quarter turn, for the direction of a horizontal vector.
pub const ANGLE_CELLS: usize = 24;
/// Cosine and sine of one such cell, pi/48.
const CELL_COS: f64 = 0.997_858_923_238_603_5;
const CELL_SIN: f64 = 0.065_403_129_230_143_07;
/// More than 24 turns by one cell are off by.
const OUTWARDS: f64 = 1e-14;
/// Cells of p between zero and its greatest value, for the split of u'.
pub const SPLIT_CELLS: usize = 24;
/// Cells of |psi'|.
pub const HEADING_CELLS: usize = 80;

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
    #[must_use]
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
#[must_use]
pub fn feedforward_torque<R: Real>(inertia: &Vector3<R>, velocity: R, acceleration: R) -> Vector3<R> {
    let differences = Vector3::new(inertia.y - inertia.z, inertia.z - inertia.x, inertia.x - inertia.y).map(R::abs);
    inertia * acceleration + differences * (velocity * 0.5 * velocity)
}

/// A part of omega_d or omega_d': what tilts rho (axes 1 and 2) and what turns about it (axis 3), as magnitudes.
#[derive(Clone, Copy)]
struct Parts<R> {
    tilting: R,
    yawing: R,
}

impl<R: Real> Parts<R> {
    /// The greatest of each part.
    fn worst(all: &[Self]) -> Self {
        let nothing = Self { tilting: R::from(0.0), yawing: R::from(0.0) };
        all.iter().fold(nothing, |worst, parts| Self {
            tilting: worst.tilting.greater(parts.tilting),
            yawing: worst.yawing.greater(parts.yawing),
        })
    }

    /// |self + other|^2 at most.
    fn square_of_sum(&self, other: &Self) -> R {
        let (tilting, yawing) = (self.tilting + other.tilting, self.yawing + other.yawing);
        tilting * tilting + yawing * yawing
    }
}

/// A vector's part orthogonal to rho, divided by n: its length |v| and what it can turn the yaw by, \[v\].
#[derive(Clone, Copy)]
struct Tangential<R> {
    length: R,
    mixed: R,
}

/// One cell of how u' splits into p, orthogonal to rho, and r along it; every part at its greatest, over n.
#[derive(Clone, Copy)]
struct Shares<R> {
    /// r / n.
    stretch: R,
    /// p / n.
    length: R,
    /// p r / n^2.
    product: R,
    /// \[p\] / n.
    mixed: R,
}

impl<R: Real> Shares<R> {
    /// The greatest of each part.
    fn worst(all: &[Self]) -> Self {
        let zero = R::from(0.0);
        let nothing = Self { stretch: zero, length: zero, product: zero, mixed: zero };
        all.iter().fold(nothing, |worst, shares| Self {
            stretch: worst.stretch.greater(shares.stretch),
            length: worst.length.greater(shares.length),
            product: worst.product.greater(shares.product),
            mixed: worst.mixed.greater(shares.mixed),
        })
    }
}

/// One cell of the tilt, with each function of it at both ends or at its worst one.
struct Tilt<R> {
    /// Greatest tangent and sine, at the tilted end.
    tan: R,
    sin: R,
    /// Least sine and greatest cosine, at the upright end.
    sin_least: R,
    cos_greatest: R,
    /// Greatest 1 / cos, at the tilted end.
    secant: R,
    /// Least n.
    magnitude: R,
}

impl<R: Real> Tilt<R> {
    fn between(upright_end: R, tilted_end: R, vertical_least: R) -> Self {
        let one = R::from(1.0);
        let [secant, secant_least] = [tilted_end, upright_end].map(|tangent| one.hypot(tangent));
        Self {
            tan: tilted_end,
            sin: tilted_end / secant,
            sin_least: upright_end / secant_least,
            cos_greatest: one / secant_least,
            secant,
            magnitude: vertical_least * secant_least,
        }
    }

    /// The tangential part of a vector whose horizontal part is at most `horizontal` long and points within `direction`
    /// of the slope, and whose vertical part is at most `vertical`.
    ///
    /// With a its angle to the slope, |v|^2 = (cos gamma h cos a + sin gamma z)^2 + (h sin a)^2, here multiplied out.
    fn tangential(&self, horizontal: R, vertical: R, direction: &Direction<R>) -> Tangential<R> {
        let climbing = self.sin * vertical;
        let flattened = self.sin_least * horizontal * direction.cos_least;
        let square = horizontal * horizontal + climbing * climbing - flattened * flattened
            + self.cos_greatest * 2.0 * horizontal * direction.cos_greatest * climbing;
        let length = square.sqrt_of_rounded() / self.magnitude;
        Tangential { length, mixed: (length + horizontal * direction.sin_greatest / self.magnitude) * 0.5 }
    }

    /// L u'' for a direction of u''.
    fn linear_part(&self, reach: &Reachable<R>, direction: &Direction<R>) -> Parts<R> {
        let Tangential { length, mixed } = self.tangential(reach.horizontal_snap, reach.vertical_snap, direction);
        Parts { tilting: length, yawing: self.tan * mixed }
    }

    /// omega_d for u' and |psi'| = `yaw_rate`.
    fn velocity(&self, jerk: &Tangential<R>, yaw_rate: R) -> Parts<R> {
        let Tangential { length, mixed } = *jerk;
        Parts { tilting: length, yawing: yaw_rate * self.secant + self.tan * mixed }
    }

    /// The shares of u' in the cell `split`, for p at most `longest`.
    fn shares(&self, reach: &Reachable<R>, longest: R, split: usize) -> Shares<R> {
        let [least, most] = [split, split + 1].map(|end| longest * end as f64 / SPLIT_CELLS as f64);
        let total = reach.jerk * reach.jerk;
        let length = most / self.magnitude;
        Shares {
            stretch: (total - least * least).sqrt_of_rounded() / self.magnitude,
            length,
            product: greatest_product(total, least * least, most * most) / (self.magnitude * self.magnitude),
            mixed: (length + most.lesser(reach.horizontal_jerk) / self.magnitude) * 0.5,
        }
    }

    /// N for |psi'| and |psi''| at most those of `heading` and u' shared out as `shares`. Grows with each of their
    /// parts.
    fn quadratic_part(&self, heading: &HeadingCell<R>, shares: &Shares<R>) -> Parts<R> {
        let HeadingCell { rate, acceleration } = *heading;
        let Shares { stretch, length, product, mixed } = *shares;
        let yaw = rate * self.secant + self.tan * mixed;
        let yawing = acceleration * self.secant
            + self.tan * 2.0 * stretch * mixed
            + rate * rate * self.tan * self.tan
            + rate * 2.0 * length * self.sin * self.secant * self.secant
            + length * 0.5 * length * (self.tan * 2.0 * self.tan + 1.0);
        let (twice, turned) = (product * 2.0, length * yaw);
        Parts { tilting: (twice * twice + turned * turned).sqrt_of_rounded(), yawing }
    }
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
    let mut greatest = R::from(0.0);
    for heading in headings {
        if worst_linear.square_of_sum(&tilt.quadratic_part(heading, &worst_shares)).upper() <= greatest.upper() {
            continue;
        }
        for shares in shares {
            let quadratic = tilt.quadratic_part(heading, shares);
            let is_covered = worst_linear.square_of_sum(&quadratic).upper() <= greatest.upper();
            if !is_covered {
                for linear in linear {
                    greatest = greatest.greater(linear.square_of_sum(&quadratic));
                }
            }
        }
    }
    greatest
}

/// The greatest sqrt(x (total - x)) for x between `least` and `most`: p r, where p^2 + r^2 = `total`.
fn greatest_product<R: Real>(total: R, least: R, most: R) -> R {
    let x = (total * 0.5).greater(least).lesser(most);
    (x * (total - x)).sqrt_of_rounded()
}

/// One cell of a horizontal vector's angle to the slope.
#[derive(Clone, Copy)]
struct Direction<R> {
    cos_greatest: R,
    cos_least: R,
    sin_greatest: R,
}

impl<R: Real> Direction<R> {
    /// The cells of [0, pi/2]; the other quadrants mirror it. From end to end the angle is turned on by one cell; what
    /// rounding does to that is far below [`OUTWARDS`], by which every value is moved to its safe side.
    fn quarter_turn() -> [Self; ANGLE_CELLS] {
        let (mut cos, mut sin) = (R::from(1.0), R::from(0.0));
        core::array::from_fn(|_| {
            let cos_greatest = cos + OUTWARDS;
            (cos, sin) = (cos * CELL_COS - sin * CELL_SIN, sin * CELL_COS + cos * CELL_SIN);
            // A cosine below zero must not come out: it is squared.
            Self { cos_greatest, cos_least: (cos - OUTWARDS).greater(R::from(0.0)), sin_greatest: sin + OUTWARDS }
        })
    }
}

/// One cell of |psi'|, with |psi''| as large as it leaves it.
#[derive(Clone, Copy)]
struct HeadingCell<R> {
    rate: R,
    acceleration: R,
}

impl<R: Real> HeadingCell<R> {
    /// The cells of |psi'| <= K_nu' with psi''^2 + psi'^4 <= K_nu''^2: psi' at the far end, psi'' as at the near end.
    /// The fastest first: they are the likeliest to matter.
    fn all(bounds: &ReferenceBounds) -> [Self; HEADING_CELLS] {
        let [rate_bound, second_bound] = [bounds.heading_rate, bounds.heading_second_derivative].map(R::from);
        // No heading turns faster than K_nu'' allows.
        let fastest = rate_bound.lesser(second_bound.sqrt());
        core::array::from_fn(|place| Self::new(HEADING_CELLS - 1 - place, fastest, second_bound))
    }

    /// The cell of this number from the slowest, of headings no faster than `fastest`.
    #[inline(never)] // unrolled, it would take more of a board's stack than anything around it
    fn new(cell: usize, fastest: R, second_bound: R) -> Self {
        let [near, far] = [cell, cell + 1].map(|end| fastest * end as f64 / HEADING_CELLS as f64);
        let room = second_bound * second_bound - near * near * near * near;
        Self { rate: far, acceleration: room.sqrt_of_rounded() }
    }
}

/// Bounds on how the desired frame turns about its third axis: |omega_d3|, rad/s, and |omega'_d3|, rad/s^2, for
/// everything in `reach` and any heading within `bounds`; `reach.vertical_least` must be positive.
#[must_use]
#[inline(never)] // a board's stack is not to hold it beside the other bounds
pub fn turning_rates<R: Real>(reach: &Reachable<R>, bounds: &ReferenceBounds) -> [R; 2] {
    let steepest = reach.horizontal / reach.vertical_least;
    let directions = Direction::quarter_turn();
    let headings = HeadingCell::all(bounds);
    let worst_heading = HeadingCell { rate: headings[0].rate, acceleration: headings[HEADING_CELLS - 1].acceleration };
    let (mut rate, mut acceleration) = (R::from(0.0), R::from(0.0));
    // The steepest first: they are the likeliest to matter.
    for cell in (0..TILT_CELLS).rev() {
        let ends = [cell, cell + 1].map(|end| steepest * end as f64 / TILT_CELLS as f64);
        let tilt = Tilt::between(ends[0], ends[1], reach.vertical_least);
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
#[must_use]
pub fn desired_rates<R: Real>(reach: &Reachable<R>, bounds: &ReferenceBounds, inertia: &Vector3<R>) -> DesiredRates<R> {
    let steepest = reach.horizontal / reach.vertical_least;
    let directions = Direction::quarter_turn();
    let headings = HeadingCell::all(bounds);
    // |psi'| is greatest in the first cell, |psi''| in the last, where nothing is left to |psi'|.
    let worst_heading = HeadingCell { rate: headings[0].rate, acceleration: headings[HEADING_CELLS - 1].acceleration };
    let zero = R::from(0.0);
    let nothing = Parts { tilting: zero, yawing: zero };
    let mut greatest =
        DesiredRates { angular_velocity: zero, angular_acceleration: zero, feedforward_torque: Vector3::repeat(zero) };
    // The steepest first: they are the likeliest to matter.
    for cell in (0..TILT_CELLS).rev() {
        let ends = [cell, cell + 1].map(|end| steepest * end as f64 / TILT_CELLS as f64);
        let tilt = Tilt::between(ends[0], ends[1], reach.vertical_least);

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
        let at_most =
            greatest.with(inertia, velocity, Parts::worst(&linear).square_of_sum(&quadratic).sqrt_of_rounded());
        if at_most.exceed(&greatest) {
            let square = acceleration_square(&tilt, &linear, &headings, &shares);
            greatest = greatest.with(inertia, velocity, square.sqrt_of_rounded());
        }
    }
    greatest
}

#[cfg(test)]
mod tests;
