//! A bound on omega_d and omega_d' sharper than Lemma 1's. `docs/sharp-bound.md` derives it step by step.
//!
//! Let n = |u|, gamma the tilt of rho = u / n from the vertical, chi the angle in the plane orthogonal to rho from body x to the
//! uphill direction, so that the roll of R_d has tan phi = tan gamma sin chi. Write w and p for the parts of u'' and u'
//! orthogonal to rho, r for the part of u' along it, w_perp and p_perp for the horizontal ones among the orthogonal, and
//! `[v]` = (|v| + |v_perp|) / 2, which is the greatest sin chi (x . v) over chi. Then, exactly, omega_d' = L u'' + N, with
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
//! What is gained over the lemma: the yaw acceleration feels w only through tan gamma, and the tilt is bounded; p and r share
//! one budget, p^2 + r^2 <= |u'|^2; the horizontal parts of w share another; the tilting and the yawing part of omega_d' are
//! orthogonal; tall n goes with tilt, n >= u_z,min / cos gamma.
//!
//! The supremum over (gamma; direction of w; split of u'; psi') is taken over cells that cover the whole range, each
//! quantity at the end of the cell where it is worst, so that the result is a bound and not a sample. All counts are constants.

use super::reachable::Reachable;
use crate::math;
use crate::reference::ReferenceBounds;
use nalgebra::Vector3;

/// Cells of tan gamma between upright and the greatest tilt.
const TILT_CELLS: u32 = 48;
/// Cells of a quarter turn, for the direction of a horizontal vector.
const ANGLE_CELLS: u32 = 24;
/// Cells of p between zero and its greatest value, for the split of u'.
const SPLIT_CELLS: u32 = 24;
/// Cells of |psi'|.
const HEADING_CELLS: u32 = 80;

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
}

/// J_ii a + |J_jj - J_kk| v^2 / 2 for each axis: what |omega_d'| <= a and |omega_d| <= v can ask for in any body frame.
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
    /// |self + other|^2 at most.
    fn square_of_sum(&self, other: &Self) -> f64 {
        let (tilting, yawing) = (self.tilting + other.tilting, self.yawing + other.yawing);
        tilting * tilting + yawing * yawing
    }

    /// The greater of each part.
    fn max(self, other: &Self) -> Self {
        Self { tilting: self.tilting.max(other.tilting), yawing: self.yawing.max(other.yawing) }
    }
}

/// A vector's part orthogonal to rho, divided by n: its length |v| and what it can turn the yaw by, \[v\].
#[derive(Clone, Copy)]
struct Tangential {
    length: f64,
    mixed: f64,
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

    /// The tangential part of a vector whose horizontal part is at most `horizontal` long and points within `direction` of
    /// the slope, and whose vertical part is at most `vertical`.
    ///
    /// With a its angle to the slope, |v|^2 = (cos gamma h cos a + sin gamma z)^2 + (h sin a)^2, here multiplied out.
    fn tangential(&self, horizontal: f64, vertical: f64, direction: &Direction) -> Tangential {
        let climbing = self.sin * vertical;
        let flattened = self.sin_least * horizontal * direction.cos_least;
        let square = horizontal * horizontal + climbing * climbing - flattened * flattened
            + 2.0 * self.cos_greatest * horizontal * direction.cos_greatest * climbing;
        let length = math::sqrt_f64(square.max(0.0)) / self.magnitude;
        Tangential { length, mixed: 0.5 * (length + horizontal * direction.sin_greatest / self.magnitude) }
    }

    /// L u'' for a direction of u''.
    fn linear_part(&self, reach: &Reachable, direction: &Direction) -> Parts {
        let Tangential { length, mixed } = self.tangential(reach.horizontal_snap, reach.vertical_snap, direction);
        Parts { tilting: length, yawing: self.tan * mixed }
    }

    /// omega_d for a direction of u' and |psi'| = `yaw_rate`.
    fn velocity(&self, reach: &Reachable, direction: &Direction, yaw_rate: f64) -> Parts {
        let Tangential { length, mixed } = self.tangential(reach.horizontal_jerk, reach.vertical_jerk, direction);
        Parts { tilting: length, yawing: yaw_rate * self.secant + self.tan * mixed }
    }

    /// The splits of u' with p at most `longest`.
    fn splits(&self, reach: &Reachable, longest: f64) -> [Split; SPLIT_CELLS as usize] {
        core::array::from_fn(|split| {
            let [least, most] = [split, split + 1].map(|end| longest * end as f64 / f64::from(SPLIT_CELLS));
            let length = most / self.magnitude;
            let product = greatest_product(reach.jerk * reach.jerk, least * least, most * most);
            Split {
                stretch: math::sqrt_f64(reach.jerk * reach.jerk - least * least) / self.magnitude,
                length,
                product: product / (self.magnitude * self.magnitude),
                mixed: 0.5 * (length + most.min(reach.horizontal_jerk) / self.magnitude),
            }
        })
    }

    /// N for |psi'| and |psi''| at most those of `heading` and a split of u'.
    fn quadratic_part(&self, heading: &HeadingCell, split: &Split) -> Parts {
        let Split { stretch, length, product, mixed } = *split;
        let HeadingCell { rate, acceleration } = *heading;
        let yaw = rate * self.secant + self.tan * mixed;
        let yawing = acceleration * self.secant
            + 2.0 * self.tan * stretch * mixed
            + rate * rate * self.tan * self.tan
            + 2.0 * rate * length * self.sin * self.secant * self.secant
            + 0.5 * length * length * (1.0 + 2.0 * self.tan * self.tan);
        Parts { tilting: math::hypot(2.0 * product, length * yaw), yawing }
    }
}

/// One cell of the split of u' into p and r, each at its greatest, over n.
#[derive(Clone, Copy)]
struct Split {
    /// r / n.
    stretch: f64,
    /// p / n.
    length: f64,
    /// p r / n^2.
    product: f64,
    /// `[p]` / n.
    mixed: f64,
}

/// The greatest sqrt(x (total - x)) for x between `least` and `most`: p r, where p^2 + r^2 = `total`.
fn greatest_product(total: f64, least: f64, most: f64) -> f64 {
    let x = (0.5 * total).max(least).min(most);
    math::sqrt_f64(x * (total - x).max(0.0))
}

/// One cell of a horizontal vector's angle to the slope.
#[derive(Clone, Copy)]
struct Direction {
    cos_greatest: f64,
    cos_least: f64,
    sin_greatest: f64,
}

impl Direction {
    /// The cells of [0, pi/2]; the other quadrants mirror it.
    fn quarter_turn() -> [Self; ANGLE_CELLS as usize] {
        let cell = core::f64::consts::FRAC_PI_2 / f64::from(ANGLE_CELLS);
        core::array::from_fn(|i| {
            let (least, most) = (cell * i as f64, cell * (i + 1) as f64);
            // The last cell's cosine must not come out below zero by rounding: it is squared.
            let cos_least = math::cos_f64(most).max(0.0);
            Self { cos_greatest: math::cos_f64(least), cos_least, sin_greatest: math::sin_f64(most) }
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
    fn all(bounds: &ReferenceBounds) -> impl DoubleEndedIterator<Item = Self> {
        let (rate_bound, second_bound) = (f64::from(bounds.heading_rate), f64::from(bounds.heading_second_derivative));
        // No heading turns faster than K_nu'' allows.
        let fastest = rate_bound.min(math::sqrt_f64(second_bound));
        (0..HEADING_CELLS).map(move |cell| {
            let [near, far] = [cell, cell + 1].map(|end| fastest * f64::from(end) / f64::from(HEADING_CELLS));
            let room = second_bound * second_bound - near * near * near * near;
            Self { rate: far, acceleration: math::sqrt_f64(room.max(0.0)) }
        })
    }

    /// The greatest |psi'| of all.
    fn fastest(bounds: &ReferenceBounds) -> f64 {
        Self::all(bounds).map(|cell| cell.rate).fold(0.0, f64::max)
    }
}

/// The sharp bound for everything in `reach` and any heading within `bounds`; `reach.vertical_least` must be positive.
#[must_use]
pub fn desired_rates(reach: &Reachable, bounds: &ReferenceBounds, inertia: &Vector3<f64>) -> DesiredRates {
    let steepest = reach.horizontal / reach.vertical_least;
    let directions = Direction::quarter_turn();
    let yaw_rate = HeadingCell::fastest(bounds);
    let nothing = Parts { tilting: 0.0, yawing: 0.0 };
    let mut greatest =
        DesiredRates { angular_velocity: 0.0, angular_acceleration: 0.0, feedforward_torque: Vector3::zeros() };
    for cell in 0..TILT_CELLS {
        let ends = [cell, cell + 1].map(|end| steepest * f64::from(end) / f64::from(TILT_CELLS));
        let tilt = Tilt::between(ends[0], ends[1], reach.vertical_least);

        let mut velocity_square: f64 = 0.0;
        let mut longest: f64 = 0.0;
        for direction in &directions {
            velocity_square = velocity_square.max(tilt.velocity(reach, direction, yaw_rate).square_of_sum(&nothing));
            let tangential = tilt.tangential(reach.horizontal_jerk, reach.vertical_jerk, direction);
            longest = longest.max(tangential.length * tilt.magnitude);
        }
        let longest = longest.min(reach.jerk);
        let linear = directions.map(|direction| tilt.linear_part(reach, &direction));
        let splits = tilt.splits(reach, longest);
        // No part is negative and rounding is monotonic, so no direction does better than this. Beginning with the fastest
        // headings, it tells of nearly all others that they need not be tried one by one.
        let outermost = linear.iter().fold(nothing, |a, b| a.max(b));
        let mut acceleration_square: f64 = 0.0;
        for heading in HeadingCell::all(bounds).rev() {
            for split in &splits {
                let quadratic = tilt.quadratic_part(&heading, split);
                if outermost.square_of_sum(&quadratic) > acceleration_square {
                    for linear in &linear {
                        acceleration_square = acceleration_square.max(linear.square_of_sum(&quadratic));
                    }
                }
            }
        }

        let (velocity, acceleration) = (math::sqrt_f64(velocity_square), math::sqrt_f64(acceleration_square));
        let torque = feedforward_torque(inertia, velocity, acceleration);
        greatest.angular_velocity = greatest.angular_velocity.max(velocity);
        greatest.angular_acceleration = greatest.angular_acceleration.max(acceleration);
        greatest.feedforward_torque = greatest.feedforward_torque.sup(&torque);
    }
    greatest
}
