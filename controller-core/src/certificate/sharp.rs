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
use crate::math;
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
pub struct DesiredRates {
    /// U_omega: greatest |omega_d|, rad/s.
    pub angular_velocity: f64,
    /// U_omega': greatest |omega_d'|, rad/s^2.
    pub angular_acceleration: f64,
    /// Greatest J_ii |omega_d'| + |J_jj - J_kk| |omega_d|^2 / 2 about each body axis, N m.
    pub feedforward_torque: Vector3<f64>,
}

impl DesiredRates {
    /// The componentwise lesser of two bounds.
    #[must_use]
    pub fn min(&self, other: &Self) -> Self {
        Self {
            angular_velocity: self.angular_velocity.min(other.angular_velocity),
            angular_acceleration: self.angular_acceleration.min(other.angular_acceleration),
            feedforward_torque: self.feedforward_torque.inf(&other.feedforward_torque),
        }
    }

    /// Whether any of these bounds is greater than the other's.
    fn exceed(&self, other: &Self) -> bool {
        let torque = self.feedforward_torque.iter().zip(other.feedforward_torque.as_slice());
        self.angular_velocity > other.angular_velocity
            || self.angular_acceleration > other.angular_acceleration
            || torque.into_iter().any(|(ours, theirs)| ours > theirs)
    }

    /// These bounds raised to hold for another cell too.
    fn with(&self, inertia: &Vector3<f64>, velocity: f64, acceleration: f64) -> Self {
        Self {
            angular_velocity: math::greater_f64(self.angular_velocity, velocity),
            angular_acceleration: math::greater_f64(self.angular_acceleration, acceleration),
            feedforward_torque: self.feedforward_torque.sup(&feedforward_torque(inertia, velocity, acceleration)),
        }
    }
}

/// J_ii a + |J_jj - J_kk| v^2 / 2 for each axis: the bound under |omega_d'| <= a and |omega_d| <= v in any body frame.
#[must_use]
pub fn feedforward_torque(inertia: &Vector3<f64>, velocity: f64, acceleration: f64) -> Vector3<f64> {
    let differences = Vector3::new(inertia.y - inertia.z, inertia.z - inertia.x, inertia.x - inertia.y).abs();
    inertia * acceleration + differences * (0.5 * velocity * velocity)
}

/// A part of omega_d or omega_d': what tilts rho (axes 1 and 2) and what turns about it (axis 3), as magnitudes.
#[derive(Clone, Copy)]
struct Parts {
    tilting: f64,
    yawing: f64,
}

impl Parts {
    /// The greatest of each part.
    fn worst(all: &[Self]) -> Self {
        let nothing = Self { tilting: 0.0, yawing: 0.0 };
        all.iter().fold(nothing, |worst, parts| Self {
            tilting: math::greater_f64(worst.tilting, parts.tilting),
            yawing: math::greater_f64(worst.yawing, parts.yawing),
        })
    }

    /// |self + other|^2 at most.
    fn square_of_sum(&self, other: &Self) -> f64 {
        let (tilting, yawing) = (self.tilting + other.tilting, self.yawing + other.yawing);
        tilting * tilting + yawing * yawing
    }
}

/// A vector's part orthogonal to rho, divided by n: its length |v| and what it can turn the yaw by, \[v\].
#[derive(Clone, Copy)]
struct Tangential {
    length: f64,
    mixed: f64,
}

/// One cell of how u' splits into p, orthogonal to rho, and r along it; every part at its greatest, over n.
#[derive(Clone, Copy)]
struct Shares {
    /// r / n.
    stretch: f64,
    /// p / n.
    length: f64,
    /// p r / n^2.
    product: f64,
    /// \[p\] / n.
    mixed: f64,
}

impl Shares {
    /// The greatest of each part.
    fn worst(all: &[Self]) -> Self {
        let nothing = Self { stretch: 0.0, length: 0.0, product: 0.0, mixed: 0.0 };
        all.iter().fold(nothing, |worst, shares| Self {
            stretch: math::greater_f64(worst.stretch, shares.stretch),
            length: math::greater_f64(worst.length, shares.length),
            product: math::greater_f64(worst.product, shares.product),
            mixed: math::greater_f64(worst.mixed, shares.mixed),
        })
    }
}

/// One cell of the tilt, with each function of it at both ends or at its worst one.
struct Tilt {
    /// Greatest tangent and sine, at the tilted end.
    tan: f64,
    sin: f64,
    /// Least sine and greatest cosine, at the upright end.
    sin_least: f64,
    cos_greatest: f64,
    /// Greatest 1 / cos, at the tilted end.
    secant: f64,
    /// Least n.
    magnitude: f64,
}

impl Tilt {
    fn between(upright_end: f64, tilted_end: f64, vertical_least: f64) -> Self {
        let secant = math::hypot(1.0, tilted_end);
        let secant_least = math::hypot(1.0, upright_end);
        Self {
            tan: tilted_end,
            sin: tilted_end / secant,
            sin_least: upright_end / secant_least,
            cos_greatest: 1.0 / secant_least,
            secant,
            magnitude: vertical_least * secant_least,
        }
    }

    /// The tangential part of a vector whose horizontal part is at most `horizontal` long and points within `direction`
    /// of the slope, and whose vertical part is at most `vertical`.
    ///
    /// With a its angle to the slope, |v|^2 = (cos gamma h cos a + sin gamma z)^2 + (h sin a)^2, here multiplied out.
    fn tangential(&self, horizontal: f64, vertical: f64, direction: &Direction) -> Tangential {
        let climbing = self.sin * vertical;
        let flattened = self.sin_least * horizontal * direction.cos_least;
        let square = horizontal * horizontal + climbing * climbing - flattened * flattened
            + 2.0 * self.cos_greatest * horizontal * direction.cos_greatest * climbing;
        let length = math::sqrt_of_rounded(square) / self.magnitude;
        Tangential { length, mixed: 0.5 * (length + horizontal * direction.sin_greatest / self.magnitude) }
    }

    /// L u'' for a direction of u''.
    fn linear_part(&self, reach: &Reachable, direction: &Direction) -> Parts {
        let Tangential { length, mixed } = self.tangential(reach.horizontal_snap, reach.vertical_snap, direction);
        Parts { tilting: length, yawing: self.tan * mixed }
    }

    /// omega_d for u' and |psi'| = `yaw_rate`.
    fn velocity(&self, jerk: &Tangential, yaw_rate: f64) -> Parts {
        let Tangential { length, mixed } = *jerk;
        Parts { tilting: length, yawing: yaw_rate * self.secant + self.tan * mixed }
    }

    /// The shares of u' in the cell `split`, for p at most `longest`.
    fn shares(&self, reach: &Reachable, longest: f64, split: usize) -> Shares {
        let [least, most] = [split, split + 1].map(|end| longest * end as f64 / SPLIT_CELLS as f64);
        let total = reach.jerk * reach.jerk;
        let length = most / self.magnitude;
        Shares {
            stretch: math::sqrt_f64(total - least * least) / self.magnitude,
            length,
            product: greatest_product(total, least * least, most * most) / (self.magnitude * self.magnitude),
            mixed: 0.5 * (length + math::lesser_f64(most, reach.horizontal_jerk) / self.magnitude),
        }
    }

    /// N for |psi'| and |psi''| at most those of `heading` and u' shared out as `shares`. Grows with each of their
    /// parts.
    fn quadratic_part(&self, heading: &HeadingCell, shares: &Shares) -> Parts {
        let HeadingCell { rate, acceleration } = *heading;
        let Shares { stretch, length, product, mixed } = *shares;
        let yaw = rate * self.secant + self.tan * mixed;
        let yawing = acceleration * self.secant
            + 2.0 * self.tan * stretch * mixed
            + rate * rate * self.tan * self.tan
            + 2.0 * rate * length * self.sin * self.secant * self.secant
            + 0.5 * length * length * (1.0 + 2.0 * self.tan * self.tan);
        let (twice, turned) = (2.0 * product, length * yaw);
        Parts { tilting: math::sqrt_f64(twice * twice + turned * turned), yawing }
    }
}

/// The greatest |L u'' + N|^2 of one cell of the tilt: every direction, heading and share, with those left out of which
/// an upper bound shows that they change nothing.
fn acceleration_square(
    tilt: &Tilt,
    linear: &[Parts; ANGLE_CELLS],
    headings: &[HeadingCell; HEADING_CELLS],
    shares: &[Shares; SPLIT_CELLS],
) -> f64 {
    let (worst_linear, worst_shares) = (Parts::worst(linear), Shares::worst(shares));
    let mut greatest: f64 = 0.0;
    for heading in headings {
        if worst_linear.square_of_sum(&tilt.quadratic_part(heading, &worst_shares)) <= greatest {
            continue;
        }
        for shares in shares {
            let quadratic = tilt.quadratic_part(heading, shares);
            let is_covered = worst_linear.square_of_sum(&quadratic) <= greatest;
            if !is_covered {
                for linear in linear {
                    greatest = math::greater_f64(greatest, linear.square_of_sum(&quadratic));
                }
            }
        }
    }
    greatest
}

/// The greatest sqrt(x (total - x)) for x between `least` and `most`: p r, where p^2 + r^2 = `total`.
fn greatest_product(total: f64, least: f64, most: f64) -> f64 {
    let x = math::lesser_f64(math::greater_f64(0.5 * total, least), most);
    math::sqrt_of_rounded(x * (total - x))
}

/// One cell of a horizontal vector's angle to the slope.
#[derive(Clone, Copy)]
struct Direction {
    cos_greatest: f64,
    cos_least: f64,
    sin_greatest: f64,
}

impl Direction {
    /// The cells of [0, pi/2]; the other quadrants mirror it. From end to end the angle is turned on by one cell; what
    /// rounding does to that is far below [`OUTWARDS`], by which every value is moved to its safe side.
    fn quarter_turn() -> [Self; ANGLE_CELLS] {
        let (mut cos, mut sin) = (1.0, 0.0);
        core::array::from_fn(|_| {
            let cos_greatest = cos + OUTWARDS;
            (cos, sin) = (cos * CELL_COS - sin * CELL_SIN, sin * CELL_COS + cos * CELL_SIN);
            // A cosine below zero must not come out: it is squared.
            Self { cos_greatest, cos_least: math::greater_f64(cos - OUTWARDS, 0.0), sin_greatest: sin + OUTWARDS }
        })
    }
}

/// One cell of |psi'|, with |psi''| as large as it leaves it.
#[derive(Clone, Copy)]
struct HeadingCell {
    rate: f64,
    acceleration: f64,
}

impl HeadingCell {
    /// The cells of |psi'| <= K_nu' with psi''^2 + psi'^4 <= K_nu''^2: psi' at the far end, psi'' as at the near end.
    /// The fastest first: they are the likeliest to matter.
    fn all(bounds: &ReferenceBounds) -> [Self; HEADING_CELLS] {
        let (rate_bound, second_bound) = (f64::from(bounds.heading_rate), f64::from(bounds.heading_second_derivative));
        // No heading turns faster than K_nu'' allows.
        let fastest = math::lesser_f64(rate_bound, math::sqrt_f64(second_bound));
        core::array::from_fn(|place| Self::new(HEADING_CELLS - 1 - place, fastest, second_bound))
    }

    /// The cell of this number from the slowest, of headings no faster than `fastest`.
    #[inline(never)] // unrolled, it would take more of a board's stack than anything around it
    fn new(cell: usize, fastest: f64, second_bound: f64) -> Self {
        let [near, far] = [cell, cell + 1].map(|end| fastest * end as f64 / HEADING_CELLS as f64);
        let room = second_bound * second_bound - near * near * near * near;
        Self { rate: far, acceleration: math::sqrt_of_rounded(room) }
    }
}

/// Bounds on how the desired frame turns about its third axis: |omega_d3|, rad/s, and |omega'_d3|, rad/s^2, for
/// everything in `reach` and any heading within `bounds`; `reach.vertical_least` must be positive.
#[must_use]
#[inline(never)] // a board's stack is not to hold it beside the other bounds
pub fn turning_rates(reach: &Reachable, bounds: &ReferenceBounds) -> [f64; 2] {
    let steepest = reach.horizontal / reach.vertical_least;
    let directions = Direction::quarter_turn();
    let headings = HeadingCell::all(bounds);
    let worst_heading = HeadingCell { rate: headings[0].rate, acceleration: headings[HEADING_CELLS - 1].acceleration };
    let (mut rate, mut acceleration) = (0.0_f64, 0.0_f64);
    // The steepest first: they are the likeliest to matter.
    for cell in (0..TILT_CELLS).rev() {
        let ends = [cell, cell + 1].map(|end| steepest * end as f64 / TILT_CELLS as f64);
        let tilt = Tilt::between(ends[0], ends[1], reach.vertical_least);
        let tangential = directions.map(|d| tilt.tangential(reach.horizontal_jerk, reach.vertical_jerk, &d));
        for tangential in &tangential {
            rate = math::greater_f64(rate, tilt.velocity(tangential, worst_heading.rate).yawing);
        }
        let longest = tangential.iter().map(|t| t.length * tilt.magnitude).fold(0.0, math::greater_f64);
        let longest = math::lesser_f64(longest, reach.jerk);
        let linear = Parts::worst(&directions.map(|direction| tilt.linear_part(reach, &direction)));
        let shares: [_; SPLIT_CELLS] = core::array::from_fn(|split| tilt.shares(reach, longest, split));
        let worst_shares = Shares::worst(&shares);
        let at_most = |heading, shares| linear.yawing + tilt.quadratic_part(heading, shares).yawing;
        if at_most(&worst_heading, &worst_shares) <= acceleration {
            continue;
        }
        for heading in &headings {
            if at_most(heading, &worst_shares) <= acceleration {
                continue;
            }
            let all = shares.iter().map(|shares| at_most(heading, shares));
            acceleration = all.fold(acceleration, math::greater_f64);
        }
    }
    [rate, acceleration]
}

/// The sharp bound for everything in `reach` and any heading within `bounds`; `reach.vertical_least` must be positive.
#[must_use]
pub fn desired_rates(reach: &Reachable, bounds: &ReferenceBounds, inertia: &Vector3<f64>) -> DesiredRates {
    let steepest = reach.horizontal / reach.vertical_least;
    let directions = Direction::quarter_turn();
    let headings = HeadingCell::all(bounds);
    // |psi'| is greatest in the first cell, |psi''| in the last, where nothing is left to |psi'|.
    let worst_heading = HeadingCell { rate: headings[0].rate, acceleration: headings[HEADING_CELLS - 1].acceleration };
    let nothing = Parts { tilting: 0.0, yawing: 0.0 };
    let mut greatest =
        DesiredRates { angular_velocity: 0.0, angular_acceleration: 0.0, feedforward_torque: Vector3::zeros() };
    // The steepest first: they are the likeliest to matter.
    for cell in (0..TILT_CELLS).rev() {
        let ends = [cell, cell + 1].map(|end| steepest * end as f64 / TILT_CELLS as f64);
        let tilt = Tilt::between(ends[0], ends[1], reach.vertical_least);

        let mut velocity_square: f64 = 0.0;
        let mut longest: f64 = 0.0;
        for direction in &directions {
            let tangential = tilt.tangential(reach.horizontal_jerk, reach.vertical_jerk, direction);
            let velocity = tilt.velocity(&tangential, worst_heading.rate);
            velocity_square = math::greater_f64(velocity_square, velocity.square_of_sum(&nothing));
            longest = math::greater_f64(longest, tangential.length * tilt.magnitude);
        }
        let velocity = math::sqrt_f64(velocity_square);
        let longest = math::lesser_f64(longest, reach.jerk);
        let linear = directions.map(|direction| tilt.linear_part(reach, &direction));
        let shares = core::array::from_fn(|split| tilt.shares(reach, longest, split));

        let quadratic = tilt.quadratic_part(&worst_heading, &Shares::worst(&shares));
        let at_most = greatest.with(inertia, velocity, math::sqrt_f64(Parts::worst(&linear).square_of_sum(&quadratic)));
        if at_most.exceed(&greatest) {
            let square = acceleration_square(&tilt, &linear, &headings, &shares);
            greatest = greatest.with(inertia, velocity, math::sqrt_f64(square));
        }
    }
    greatest
}

#[cfg(test)]
mod tests;
