//! The cells that the supremum of the sharp bound is taken over, with each function of a cell at its worst end.
//! `docs/sharp-bound.md`, step 6.

use crate::certificate::reachable::Reachable;
use crate::math::real::Real;
use crate::reference::ReferenceBounds;

/// Cells of tan gamma between upright and the greatest tilt.
pub const TILT_CELLS: usize = 48;
/// Cells of a quarter turn, for the direction of a horizontal vector.
pub const ANGLE_CELLS: usize = 24;
/// Cosine and sine of one such cell, pi/48.
const CELL_COS: f64 = 0.997_858_923_238_603_5;
const CELL_SIN: f64 = 0.065_403_129_230_143_07;
/// More than 24 turns by one cell are off by.
pub const CELL_ROUNDING: f64 = 1e-14;
/// Cells of p between zero and its greatest value, for the split of u'.
pub const SPLIT_CELLS: usize = 24;
/// Cells of |psi'|.
pub const HEADING_CELLS: usize = 80;

/// A part of omega_d or omega_d': what tilts rho (axes 1 and 2) and what turns about it (axis 3), as magnitudes.
#[derive(Clone, Copy)]
pub struct Parts<R> {
    pub tilting: R,
    pub yawing: R,
}

impl<R: Real> Parts<R> {
    /// The greatest of each part.
    pub fn worst(all: &[Self]) -> Self {
        let nothing = Self { tilting: R::from(0.0), yawing: R::from(0.0) };
        all.iter().fold(nothing, |worst, parts| Self {
            tilting: worst.tilting.greater(parts.tilting),
            yawing: worst.yawing.greater(parts.yawing),
        })
    }

    /// |self + other|^2 at most.
    pub fn square_of_sum(&self, other: &Self) -> R {
        let (tilting, yawing) = (self.tilting + other.tilting, self.yawing + other.yawing);
        tilting * tilting + yawing * yawing
    }
}

/// A vector's part orthogonal to rho, divided by n: its length |v| and what it can turn the yaw by, \[v\].
#[derive(Clone, Copy)]
pub struct Tangential<R> {
    pub length: R,
    pub mixed: R,
}

/// One cell of how u' splits into p, orthogonal to rho, and r along it; every part at its greatest, over n.
#[derive(Clone, Copy)]
pub struct Shares<R> {
    /// r / n.
    pub stretch: R,
    /// p / n.
    pub length: R,
    /// p r / n^2.
    pub product: R,
    /// \[p\] / n.
    pub mixed: R,
}

impl<R: Real> Shares<R> {
    /// The greatest of each part.
    pub fn worst(all: &[Self]) -> Self {
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
pub struct Tilt<R> {
    /// Greatest tangent and sine, at the tilted end.
    pub tan: R,
    pub sin: R,
    /// Least sine and greatest cosine, at the upright end.
    pub sin_min: R,
    pub cos_max: R,
    /// Greatest 1 / cos, at the tilted end.
    pub secant: R,
    /// Least n.
    pub magnitude: R,
}

impl<R: Real> Tilt<R> {
    pub fn between(upright_end: R, tilted_end: R, vertical_least: R) -> Self {
        let one = R::from(1.0);
        let [secant, secant_least] = [tilted_end, upright_end].map(|tangent| one.hypot(tangent));
        Self {
            tan: tilted_end,
            sin: tilted_end / secant,
            sin_min: upright_end / secant_least,
            cos_max: one / secant_least,
            secant,
            magnitude: vertical_least * secant_least,
        }
    }

    /// The tangential part of a vector whose horizontal part is at most `horizontal` long and points within `direction`
    /// of the slope, and whose vertical part is at most `vertical`.
    ///
    /// With a its angle to the slope, |v|^2 = (cos gamma h cos a + sin gamma z)^2 + (h sin a)^2, here multiplied out.
    pub fn tangential(&self, horizontal: R, vertical: R, direction: &Direction<R>) -> Tangential<R> {
        let climbing = self.sin * vertical;
        let flattened = self.sin_min * horizontal * direction.cos_min;
        let square = horizontal * horizontal + climbing * climbing - flattened * flattened
            + self.cos_max * 2.0 * horizontal * direction.cos_max * climbing;
        let length = square.sqrt_of_rounded() / self.magnitude;
        Tangential { length, mixed: (length + horizontal * direction.sin_max / self.magnitude) * 0.5 }
    }

    /// L u'' for a direction of u''.
    pub fn linear_part(&self, reach: &Reachable<R>, direction: &Direction<R>) -> Parts<R> {
        let Tangential { length, mixed } = self.tangential(reach.horizontal_snap, reach.vertical_snap, direction);
        Parts { tilting: length, yawing: self.tan * mixed }
    }

    /// omega_d for u' and |psi'| = `yaw_rate`.
    pub fn velocity(&self, jerk: &Tangential<R>, yaw_rate: R) -> Parts<R> {
        let Tangential { length, mixed } = *jerk;
        Parts { tilting: length, yawing: yaw_rate * self.secant + self.tan * mixed }
    }

    /// The shares of u' in the cell `split`, for p at most `longest`.
    pub fn shares(&self, reach: &Reachable<R>, longest: R, split: usize) -> Shares<R> {
        let [min, max] = [split, split + 1].map(|end| longest * end as f64 / SPLIT_CELLS as f64);
        let total = reach.jerk * reach.jerk;
        let length = max / self.magnitude;
        Shares {
            stretch: (total - min * min).sqrt_of_rounded() / self.magnitude,
            length,
            product: max_product(total, min * min, max * max) / (self.magnitude * self.magnitude),
            mixed: (length + max.lesser(reach.horizontal_jerk) / self.magnitude) * 0.5,
        }
    }

    /// N for |psi'| and |psi''| at most those of `heading` and u' shared out as `shares`. Grows with each of their
    /// parts.
    pub fn quadratic_part(&self, heading: &HeadingCell<R>, shares: &Shares<R>) -> Parts<R> {
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

/// The greatest sqrt(x (total - x)) for x between `min` and `most`: p r, where p^2 + r^2 = `total`.
fn max_product<R: Real>(total: R, min: R, max: R) -> R {
    let x = (total * 0.5).greater(min).lesser(max);
    (x * (total - x)).sqrt_of_rounded()
}

/// One cell of a horizontal vector's angle to the slope.
#[derive(Clone, Copy)]
pub struct Direction<R> {
    pub cos_max: R,
    pub cos_min: R,
    pub sin_max: R,
}

impl<R: Real> Direction<R> {
    /// The cells of [0, pi/2]; the other quadrants mirror it. From end to end the angle is turned on by one cell; what
    /// rounding does to that is far below [`CELL_ROUNDING`], by which every value is moved to its safe side.
    pub fn quarter_turn() -> [Self; ANGLE_CELLS] {
        let (mut cos, mut sin) = (R::from(1.0), R::from(0.0));
        core::array::from_fn(|_| {
            let cos_greatest = cos + CELL_ROUNDING;
            (cos, sin) = (cos * CELL_COS - sin * CELL_SIN, sin * CELL_COS + cos * CELL_SIN);
            // A cosine below zero must not come out: it is squared.
            Self {
                cos_max: cos_greatest,
                cos_min: (cos - CELL_ROUNDING).greater(R::from(0.0)),
                sin_max: sin + CELL_ROUNDING,
            }
        })
    }
}

/// One cell of |psi'|, with |psi''| as large as it leaves it.
#[derive(Clone, Copy)]
pub struct HeadingCell<R> {
    pub rate: R,
    pub acceleration: R,
}

impl<R: Real> HeadingCell<R> {
    /// The cells of |psi'| <= K_nu' with psi''^2 + psi'^4 <= K_nu''^2: psi' at the far end, psi'' as at the near end.
    /// The fastest first: they are the likeliest to matter.
    pub fn all(bounds: &ReferenceBounds) -> [Self; HEADING_CELLS] {
        let [rate_bound, second_bound] = [bounds.heading_rate, bounds.heading_second_derivative].map(R::from);
        // No heading turns faster than K_nu'' allows.
        let fastest = rate_bound.lesser(second_bound.sqrt());
        core::array::from_fn(|place| Self::new(HEADING_CELLS - 1 - place, fastest, second_bound))
    }

    /// The cell of this number from the slowest, of headings no faster than `fastest`.
    #[inline(never)] // unrolled, it would take more of a board's stack than anything around it
    pub fn new(cell: usize, fastest: R, second_bound: R) -> Self {
        let [near, far] = [cell, cell + 1].map(|end| fastest * end as f64 / HEADING_CELLS as f64);
        let room = second_bound * second_bound - near * near * near * near;
        Self { rate: far, acceleration: room.sqrt_of_rounded() }
    }
}
