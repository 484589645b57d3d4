//! A bound on omega_d and omega_d' sharper than Lemma 1's. `docs/sharp-bound.md` derives it step by step.
//!
//! Let n = |u|, gamma the tilt of rho = u / n from the vertical, chi the angle in the plane orthogonal to rho from body x to the
//! uphill direction, so that the roll of R_d has tan phi = tan gamma sin chi. Write w for the part of u'' orthogonal to
//! rho, p and r for the parts of u' orthogonal to and along rho. Then, exactly,
//!
//! omega_d' = L u'' + N, with
//!
//! |L u''|^2 = (|w|^2 + tan^2 phi (x . w)^2) / n^2 <= (|w|^2 + tan^2 gamma (|w| + |w_perp|)^2 / 4) / n^2,
//!
//! |N_12| = (p / n) sqrt(4 r^2 / n^2 + omega_3^2),
//!
//! |N_3| <= |psi''| / cos gamma + 2 tan gamma r p / n^2 + psi'^2 tan^2 gamma + 2 |psi'| (p / n) sin gamma / cos^2 gamma
//!       + (p / n)^2 (1 + 2 tan^2 gamma) / 2,
//!
//! |omega_3| <= |psi'| / cos gamma + tan gamma p / n.
//!
//! What is gained over the lemma: the yaw acceleration feels w only through tan gamma, and the tilt is bounded; p and r share
//! one budget, p^2 + r^2 <= |u'|^2; the horizontal parts of w share another; tall n goes with tilt, n >= u_z,min / cos gamma.
//!
//! The supremum over (gamma; direction of w; split of u'; psi') is taken over cells that cover the whole range, each
//! quantity at the end of the cell where it is worst, so that the result is a bound and not a sample. All counts are constants.

use super::reachable::Reachable;
use crate::math;
use crate::reference::ReferenceBounds;
use nalgebra::Vector3;

/// Cells of tan gamma between upright and the greatest tilt.
const TILT_CELLS: u32 = 96;
/// Cells of a quarter turn, for directions and splits.
const ANGLE_CELLS: u32 = 32;
/// Cells of |psi'|.
const HEADING_CELLS: u32 = 6;

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

/// One cell of the tilt, with each function of it at its worst end.
struct Tilt {
    tan: f64,
    sin: f64,
    /// Greatest cosine, at the upright end.
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
            cos_greatest: 1.0 / secant_least,
            secant,
            magnitude: vertical_least * secant_least,
        }
    }

    /// Greatest |L u''| over all directions of u''.
    fn linear_part(&self, reach: &Reachable) -> f64 {
        let mut greatest: f64 = 0.0;
        for (least, most) in quarter_turn() {
            // u''_h = (along, across) with along = |u''_h| cos, across = |u''_h| sin: cos worst at `least`, sin at `most`.
            let across = reach.horizontal_snap * math::sin_f64(most);
            let along = reach.horizontal_snap * math::cos_f64(least);
            let uphill = self.cos_greatest * along + self.sin * reach.vertical_snap;
            let w = math::hypot(uphill, across);
            let mixed = 0.5 * self.tan * (w + across);
            greatest = greatest.max(math::hypot(w, mixed));
        }
        greatest / self.magnitude
    }

    /// |omega_3| for |rho'| = `direction_rate` and |psi'| = `yaw_rate`.
    fn yaw_part(&self, direction_rate: f64, yaw_rate: f64) -> f64 {
        yaw_rate * self.secant + self.tan * direction_rate
    }

    /// Greatest |N| over the splits of u' and of the heading's budget.
    fn quadratic_part(&self, reach: &Reachable, bounds: &ReferenceBounds) -> f64 {
        let (rate_bound, second_bound) = (f64::from(bounds.heading_rate), f64::from(bounds.heading_second_derivative));
        let mut greatest: f64 = 0.0;
        for cell in 0..HEADING_CELLS {
            // psi''^2 + psi'^4 <= K_nu''^2: psi' at the far end of its cell, psi'' at the near end.
            let cells = f64::from(HEADING_CELLS);
            let (near, yaw_rate) = (rate_bound * f64::from(cell) / cells, rate_bound * f64::from(cell + 1) / cells);
            let room = second_bound * second_bound - near * near * near * near;
            if room < 0.0 {
                break; // no heading turns this fast within K_nu''
            }
            let yaw_acceleration = math::sqrt_f64(room);
            for (least, most) in quarter_turn() {
                let direction_rate = reach.jerk * math::cos_f64(least) / self.magnitude;
                let stretch = reach.jerk * math::sin_f64(most) / self.magnitude;
                let tilting = direction_rate * math::hypot(2.0 * stretch, self.yaw_part(direction_rate, yaw_rate));
                let yawing = yaw_acceleration * self.secant
                    + 2.0 * self.tan * stretch * direction_rate
                    + yaw_rate * yaw_rate * self.tan * self.tan
                    + 2.0 * yaw_rate * direction_rate * self.sin * self.secant * self.secant
                    + 0.5 * direction_rate * direction_rate * (1.0 + 2.0 * self.tan * self.tan);
                greatest = greatest.max(math::hypot(tilting, yawing));
            }
        }
        greatest
    }
}

/// The cells of [0, pi/2], each as (least, most).
fn quarter_turn() -> impl Iterator<Item = (f64, f64)> {
    let cell = core::f64::consts::FRAC_PI_2 / f64::from(ANGLE_CELLS);
    (0..ANGLE_CELLS).map(move |i| (cell * f64::from(i), cell * f64::from(i + 1)))
}

/// The sharp bound for everything in `reach` and any heading within `bounds`; `reach.vertical_least` must be positive.
#[must_use]
pub fn desired_rates(reach: &Reachable, bounds: &ReferenceBounds, inertia: &Vector3<f64>) -> DesiredRates {
    let steepest = reach.horizontal / reach.vertical_least;
    let mut greatest =
        DesiredRates { angular_velocity: 0.0, angular_acceleration: 0.0, feedforward_torque: Vector3::zeros() };
    for cell in 0..TILT_CELLS {
        let ends = [cell, cell + 1].map(|end| steepest * f64::from(end) / f64::from(TILT_CELLS));
        let tilt = Tilt::between(ends[0], ends[1], reach.vertical_least);
        let direction_rate = reach.jerk / tilt.magnitude;
        let velocity = math::hypot(direction_rate, tilt.yaw_part(direction_rate, f64::from(bounds.heading_rate)));
        let acceleration = tilt.linear_part(reach) + tilt.quadratic_part(reach, bounds);
        let torque = feedforward_torque(inertia, velocity, acceleration);
        greatest.angular_velocity = greatest.angular_velocity.max(velocity);
        greatest.angular_acceleration = greatest.angular_acceleration.max(acceleration);
        greatest.feedforward_torque = greatest.feedforward_torque.sup(&torque);
    }
    greatest
}
