//! The budget for turning the desired frame: the thrust and torque available in a tick. Section 4 of
//! `docs/extended-law.md`.
//!
//! Tilt and yaw torques fit the rotors, and the limits, if for each of at most four rows
//!
//! ```text
//! t |tau_tilt| + y |tau_yaw| <= R
//! ```
//!
//! | row | t | y | R |
//! |---|---|---|---|
//! | two rotors k, i at their ends at once | max \|b_12,k/b_T,k - b_12,i/b_T,i\| | the same of b_3 | min (s_lo f_max,k/b_T,k - s_hi f_min,i/b_T,i) - 2 margin |
//! | the thrust floor N and T_max | max \|b_12,i\|/b_T,i | the same of b_3 | T_max - max s_hi f_min,i/b_T,i - 2 margin |
//! | limits of roll and pitch | 1 | 0 | the lesser of the two |
//! | limit of yaw | 0 | 1 | the limit |
//!
//! The parts that do not change from tick to tick are subtracted beforehand: the bias estimate at its level, yaw's
//! feedback, J_33 A, and the gyroscopic torque at Omega and W_max. The remaining parts are the tilt feedback's |P +
//! lambda D| of this tick and J R~^T omega_d', which tilts by at most J_max |omega'| and leaks J_33 |omega'| sin theta
//! into yaw, with theta the angle from b to rho. So the frame may turn with
//!
//! ```text
//! |omega'_12| <= alpha = min( alpha_max, ((1 - mu) m n - N_0) / L, min over rows (R - t |tau_fb|) / (t J_max + y J_33 sin theta) )
//! ```
//!
//! and with at least alpha_0, for which the certificate's rows reserve torque. The second term keeps the thrust floor
//! below the thrust near the target.

use super::parameters::ExtendedParameters;
use crate::allocation::geometry::ROTORS_MAX;
use crate::allocation::{Rotors, collected};
use crate::math;
use crate::math::real::Real;
use crate::vehicle::{Limits, Vehicle};
use heapless::Vec;
use nalgebra::{Vector3, Vector4};

/// mu: the part of a thrust that the budget leaves.
pub const THRUST_LEFT: f64 = 0.05;

/// The part of a row's room that a tick leaves unused, for the change between two ticks.
pub const ROOM_LEFT: f64 = 0.01;

/// t, y and the rest of R.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row<R = f64> {
    /// t.
    pub tilt: R,
    /// y.
    pub yaw: R,
    /// R without the fixed parts.
    pub room: R,
}

impl Row {
    /// Whether `other` holds wherever this row does: it costs no more of its room.
    fn covers(&self, other: &Self) -> bool {
        other.tilt * self.room <= self.tilt * other.room && other.yaw * self.room <= self.yaw * other.room
    }
}

/// How far beyond Omega a tick may take the thrust direction: alpha is cut after Omega.
pub const RATE_BEYOND: f64 = 1.15;

/// The greatest number of rows.
pub const ROWS: usize = 4;

/// Everything about the budget that does not change from tick to tick.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueBudget<R = f64> {
    /// The rows.
    pub rows: Vec<Row<R>, ROWS>,
    /// The greatest moment of inertia of the tilt, and J_33, kg m^2.
    pub inertia: [R; 2],
    /// Tilt and yaw torque beside the feedback and the frame's turning, N m.
    pub fixed: [R; 2],
    /// N_0, N.
    pub floor: R,
    /// L, N per rad/s^2.
    pub floor_per_acceleration: R,
    /// The thrust of all rotors for each unit of s, infinite without rotors, and the thrust that bias and yaw use up,
    /// N.
    pub ceiling: [R; 2],
}

/// Rows of B+ over b_T with the rotor's range.
struct Share<R> {
    least: R,
    greatest: R,
    torque: Vector3<R>,
}

/// The greatest of some directions of torque: across, about z, and across with both biases at their levels.
struct Reach<R> {
    tilt: R,
    yaw: R,
    corner: R,
}

impl<R: Real> Reach<R> {
    fn of(directions: impl Iterator<Item = Vector3<R>>) -> Self {
        let zero = R::from(0.0);
        directions.fold(Self { tilt: zero, yaw: zero, corner: zero }, |reach, b| Self {
            tilt: reach.tilt.greater(b.x.hypot(b.y)),
            yaw: reach.yaw.greater(b.z.abs()),
            corner: reach.corner.greater(b.x.abs() + b.y.abs()),
        })
    }

    /// The row of `range` without the `fixed` torques and the biases' levels.
    fn row(&self, range: R, fixed: [R; 2], [bias_tilt, bias_yaw]: [R; 2]) -> Row<R> {
        let Self { tilt, yaw, corner } = *self;
        let room = range - corner * bias_tilt - yaw * (fixed[1] + bias_yaw) - tilt * fixed[0];
        Row { tilt, yaw, room }
    }
}

impl<R: Real> TorqueBudget<R> {
    /// For a vehicle, its limits, its rotors if it has any, and the law's constants.
    #[must_use]
    pub fn new(parameters: &ExtendedParameters, vehicle: &Vehicle, limits: &Limits, rotors: Option<&Rotors>) -> Self {
        let p = parameters;
        let (zero, one) = (R::from(0.0), R::from(1.0));
        let j = vehicle.inertia.map(R::from);
        let inertia = [j.x.greater(j.y), j.z];
        let [acceleration, rate, turn_rate] = [p.yaw_acceleration, p.yaw_rate, p.turn_rate].map(R::from);
        let turn_rate = turn_rate * RATE_BEYOND;
        let [bias_tilt, bias_yaw] = [p.torque_tilt, p.torque_yaw].map(R::from);
        // Half of |omega_d|^2: the greatest product of two orthogonal components.
        let product = (turn_rate * turn_rate + rate * rate) * 0.5;
        let across = (j.z - j.x).abs().greater((j.z - j.y).abs());
        let yaw_feedback = R::from(p.w) * 0.5 * R::from(p.eta) + R::from(p.m_omega_z);
        let fixed = [
            inertia[0] * acceleration + across * product,
            j.z * acceleration + (j.x - j.y).abs() * product + yaw_feedback,
        ];

        let torque_max = limits.torque_max.map(R::from);
        let mut rows = Vec::new();
        // There are at most that many: they fit.
        let mut push = |row: Row<R>| {
            let _ = rows.push(row);
        };
        push(Row { tilt: one, yaw: zero, room: torque_max.x.lesser(torque_max.y) - fixed[0] - bias_tilt });
        push(Row { tilt: zero, yaw: one, room: torque_max.z - fixed[1] - bias_yaw });
        let shares = shares(rotors);
        let scales = [p.scale_least, p.scale_greatest].map(R::from);
        let margin = R::from(p.floor_margin);
        if let Some(room) = least_range(&shares, scales, margin) {
            let spread = Reach::of(shares.iter().flat_map(|a| shares.iter().map(move |b| a.torque - b.torque)));
            push(spread.row(room, fixed, [bias_tilt, bias_yaw]));
            let least = shares.iter().map(|share| scales[1] * share.least).fold(zero, R::greater);
            let below = R::from(limits.thrust_max) - least - margin * 2.0;
            push(Reach::of(shares.iter().map(|share| share.torque)).row(below, fixed, [bias_tilt, bias_yaw]));
        }

        let beside = |torque: &Vector3<R>| {
            (torque.x.abs() + torque.y.abs()) * bias_tilt + torque.z.abs() * (bias_yaw + j.z * acceleration)
        };
        let (mut floor, mut per_acceleration) = (zero, zero);
        let mut ceiling = [R::from(f64::INFINITY), zero];
        for share in &shares {
            floor = floor.greater(scales[1] * share.least + beside(&share.torque));
            per_acceleration = per_acceleration.greater((j.x * share.torque.x).hypot(j.y * share.torque.y));
            ceiling[0] = ceiling[0].lesser(share.greatest);
            ceiling[1] = ceiling[1].greater(beside(&share.torque) + margin);
        }
        Self { rows, inertia, fixed, floor: floor + margin, floor_per_acceleration: per_acceleration, ceiling }
    }

    /// The needed and the available torque of each row with a tilt feedback of `feedback`, N m, and the frame turning
    /// with `acceleration`, rad/s^2, at the worst angle.
    pub fn reserves(&self, feedback: R, acceleration: R) -> impl Iterator<Item = [R; 2]> + '_ {
        let [tilt, yaw] = self.inertia;
        self.rows
            .iter()
            .map(move |row| [row.tilt * (feedback + tilt * acceleration) + row.yaw * yaw * acceleration, row.room])
    }
}

impl TorqueBudget {
    /// The greatest feedback about the tilt's axes with which every row has room for `acceleration`, N m.
    #[must_use]
    pub fn feedback(&self, acceleration: f64) -> f64 {
        let [tilt, yaw] = self.inertia;
        let of = |row: &Row| (row.room - row.yaw * yaw * acceleration) / row.tilt - tilt * acceleration;
        self.rows.iter().filter(|row| row.tilt > 0.0).map(of).fold(f64::INFINITY, math::lesser_f64)
    }
}

/// The rows are in double precision, as the mixer is made of them: they are exact here.
fn shares<R: Real>(rotors: Option<&Rotors>) -> Vec<Share<R>, ROTORS_MAX> {
    let mut shares = Vec::new();
    for (rotor, row) in rotors.into_iter().flat_map(|rotors| rotors.iter().zip(rotors.pseudo_inverse())) {
        let row: &Vector4<f64> = row;
        let torque = Vector3::new(row.y, row.z, row.w).map(|part| R::from(part) / row.x);
        let [least, greatest] = [rotor.thrust_min, rotor.thrust_max].map(|thrust| R::from(thrust) / row.x);
        // As many as there are rotors: it fits.
        let _ = shares.push(Share { least, greatest, torque });
    }
    shares
}

/// The least of s_lo f_max,k / b_T,k - s_hi f_min,i / b_T,i, less both margins; none without rotors.
fn least_range<R: Real>(shares: &[Share<R>], [least_scale, greatest_scale]: [R; 2], margin: R) -> Option<R> {
    let greatest = shares.iter().map(|share| share.greatest).reduce(R::lesser)?;
    let least = shares.iter().map(|share| share.least).reduce(R::greater)?;
    Some(least_scale * greatest - greatest_scale * least - margin * 2.0)
}

/// The budget as a tick spends it.
#[derive(Debug, Clone, PartialEq)]
pub struct TurningBudget {
    /// t, y and R of each row that can bind.
    rows: Vec<[f32; 3], ROWS>,
    inertia: [f32; 2],
    /// (1 - mu) m / L, per s^2/m, and N_0 / L, rad/s^2.
    thrust: f32,
    floor: f32,
    most: f32,
}

impl TurningBudget {
    /// Of `budget` for a vehicle of `mass`, kg, and at most `most`, rad/s^2.
    #[must_use]
    pub fn new(budget: &TorqueBudget, mass: f32, most: f32) -> Self {
        let rotors = budget.rows.get(2);
        let binding = budget.rows.iter().enumerate().filter(|(place, row)| {
            let covered = rotors.is_some_and(|rotors| rotors.covers(row));
            *place == 2 || !covered
        });
        let rounded = |row: &Row| [row.tilt, row.yaw, row.room * (1.0 - ROOM_LEFT)].map(|x| x as f32);
        let per_acceleration = math::greater_f64(budget.floor_per_acceleration, 1e-12);
        Self {
            rows: collected(binding.map(|(_, row)| rounded(row))),
            inertia: budget.inertia.map(|x| x as f32),
            thrust: ((1.0 - THRUST_LEFT) * f64::from(mass) / per_acceleration) as f32,
            floor: (budget.floor / per_acceleration) as f32,
            most,
        }
    }

    /// alpha, rad/s^2, at |u| = `magnitude`, m/s^2, with `feedback` N m about the tilt's axes and the sine of the angle
    /// from b to rho (one beyond a right angle). It may be negative: the caller adds the reserve.
    #[must_use]
    pub fn acceleration(&self, magnitude: f32, feedback: f32, sine: f32) -> f32 {
        let [tilt, yaw] = self.inertia;
        let leak = yaw * sine;
        let mut alpha = math::lesser(self.most, self.thrust * magnitude - self.floor);
        for [t, y, room] in &self.rows {
            let left = room - t * feedback;
            let cost = t * tilt + y * leak;
            // Without a division where the row does not bind.
            if left < alpha * cost {
                alpha = left / cost;
            }
        }
        alpha
    }
}
