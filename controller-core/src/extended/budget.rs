//! The budget of a tick: the torque about the tilt's axes that limits and rotors leave, spent part by part. Section 4
//! of `docs/extended-law.md`.
//!
//! With (b_T, b_tau) a rotor's row of the inverse allocation and beta = b_tau / b_T, a torque tau about the tilt's axes
//! fits at the thrust scale s if for every row
//!
//! ```text
//! |w . tau| <= R(s)
//! ```
//!
//! | row | w | R(s) |
//! |---|---|---|
//! | limit of roll, limit of pitch | e_1, e_2 | the limit |
//! | two rotors k, i at their ends at once | beta_12,k - beta_12,i | s (min f_max / b_T - max f_min / b_T) - 2 margin |
//! | the thrust floor and T_max | beta_12,i | T_max - s max f_min / b_T - 2 margin |
//!
//! Here w has length one: both sides are divided by its length, so that R is a torque. With the rows every rotor has a
//! thrust within its range ([`super::thrust_range`]). A tick adds the parts of its torque up in their order, each as
//! much of it as the rows allow ([`Spending`]): nothing is subtracted beforehand, and no part is taken at its worst.

use crate::allocation::geometry::ROTORS_MAX;
use crate::allocation::{Rotors, collected};
use crate::math;
use crate::math::real::Real;
use crate::vehicle::{Limits, Vehicle};
use core::hint::cold_path;
use heapless::Vec;
use nalgebra::{Vector2, Vector3, Vector4};

/// mu: the part of a thrust that torques may use near the target.
pub const TORQUE_THRUST_SHARE: f64 = 0.05;

/// The part of a row that a tick leaves unused: more than the rounding of what it adds up.
const UNUSED_ROW_SHARE: f64 = 1e-3;

/// The greatest number of rows: pairs of rotors, rotors, two limits.
const ROWS_MAX: usize = ROTORS_MAX * (ROTORS_MAX - 1) / 2 + ROTORS_MAX + 2;

/// The source of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowSource {
    /// The limit of roll or pitch.
    Limit,
    /// Two rotors at their ends at once.
    Rotors,
    /// The thrust floor and T_max.
    Floor,
}

/// |w . tau| <= R(s) = per_scale s - fixed, w of length one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BudgetRow<R = f64> {
    /// Its source.
    pub bound: RowSource,
    /// w.
    pub direction: [R; 2],
    /// The part of R that is proportional to the thrust scale, N m.
    pub per_scale: R,
    /// The part that is subtracted, N m.
    pub fixed: R,
}

impl<R: Real> BudgetRow<R> {
    /// R(s), N m.
    pub fn capacity(&self, scale: R) -> R {
        self.per_scale * scale - self.fixed
    }
}

/// The rows, and what follows from the rotors besides.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueBudget<R = f64> {
    /// The rows.
    pub rows: Vec<BudgetRow<R>, ROWS_MAX>,
    /// |beta_12| and |beta_3|, the greatest of all rotors, 1/m; none without rotors.
    pub reach: [R; 2],
    /// max f_min / b_T and min f_max / b_T, N; without rotors none and infinitely much.
    pub ends: [R; 2],
    /// N.
    pub margin: R,
}

/// Row of B+ over b_T with the rotor's range.
struct Share<R> {
    min: R,
    max: R,
    torque: Vector3<R>,
}

impl<R: Real> TorqueBudget<R> {
    /// For the margin of the law's thrust range, N, limits, and rotors if there are any.
    pub fn new(margin: f32, limits: &Limits, rotors: Option<&Rotors>) -> Self {
        let (zero, one) = (R::from(0.0), R::from(1.0));
        let margin = R::from(margin);
        let mut rows = Vec::new();
        // There are at most that many: they fit.
        let mut push = |bound, [x, y]: [R; 2], per_scale: R, fixed: R| {
            let length = x.hypot(y);
            if length.lower() > 0.0 {
                let row = BudgetRow {
                    bound,
                    direction: [x / length, y / length],
                    per_scale: per_scale / length,
                    fixed: fixed / length,
                };
                let _ = rows.push(row);
            }
        };
        let torque_max = limits.torque_max.map(R::from);
        push(RowSource::Limit, [one, zero], zero, -torque_max.x);
        push(RowSource::Limit, [zero, one], zero, -torque_max.y);

        let shares = shares::<R>(rotors);
        let top = shares.iter().map(|share| share.max).fold(R::from(f64::INFINITY), R::lesser);
        let bottom = shares.iter().map(|share| share.min).fold(zero, R::greater);
        for (place, share) in shares.iter().enumerate() {
            for other in shares.iter().skip(place + 1) {
                let difference = share.torque - other.torque;
                push(RowSource::Rotors, [difference.x, difference.y], top - bottom, margin * 2.0);
            }
            let fixed = margin * 2.0 - R::from(limits.thrust_max);
            push(RowSource::Floor, [share.torque.x, share.torque.y], -bottom, fixed);
        }
        let reach = shares.iter().fold([zero; 2], |[tilt, yaw], share| {
            [tilt.greater(share.torque.x.hypot(share.torque.y)), yaw.greater(share.torque.z.abs())]
        });
        Self { rows, reach, ends: [bottom, top], margin }
    }

    /// (1 - mu) U for a thrust scale and no bias, m/s^2.
    pub fn held_acceleration(&self, vehicle: &Vehicle, limits: &Limits, scale: R) -> R {
        let max = (scale * self.ends[1] - self.margin).lesser(R::from(limits.thrust_max));
        max * (1.0 - TORQUE_THRUST_SHARE) / R::from(vehicle.mass)
    }

    /// The greatest torque about the tilt's axes that fits in every direction at a thrust scale, N m.
    pub fn radius(&self, scale: R) -> R {
        self.rows.iter().map(|row| row.capacity(scale)).fold(R::from(f64::INFINITY), R::lesser)
    }
}

impl TorqueBudget {
    /// U as a tick works it out.
    pub fn ceiling(&self, vehicle: &Vehicle, limits: &Limits) -> Ceiling {
        let mass = f64::from(vehicle.mass);
        Ceiling {
            per_scale: (self.ends[1] / mass) as f32,
            fixed: (self.margin / mass) as f32,
            per_bias: self.reach.map(|reach| (reach / mass) as f32),
            max: (f64::from(limits.thrust_max) / mass) as f32,
        }
    }
}

/// U = min(s min f_max / b_T - margin - |beta_12| |tau_b,12| - |beta_3| |tau_b,3|, T_max) / m: the acceleration that
/// the rotors hold near the target beside the torque bias tau_b.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ceiling {
    per_scale: f32,
    fixed: f32,
    per_bias: [f32; 2],
    max: f32,
}

impl Ceiling {
    /// U, m/s^2, for a thrust scale and a bias in N m.
    #[inline(always)] // into the law's step
    pub fn at(&self, scale: f32, bias: &Vector3<f32>) -> f32 {
        let [lean, twist] = self.per_bias;
        let taken = self.fixed + lean * math::sqrt(bias.xy().norm_squared()) + twist * bias.z.abs();
        math::min(scale * self.per_scale - taken, self.max)
    }
}

/// The rows are in double precision, as the mixer is made of them: they are exact here.
fn shares<R: Real>(rotors: Option<&Rotors>) -> Vec<Share<R>, ROTORS_MAX> {
    collected(rotors.into_iter().flat_map(|rotors| rotors.iter().zip(rotors.pseudo_inverse())).map(|(rotor, row)| {
        let row: &Vector4<f64> = row;
        let torque = Vector3::new(row.y, row.z, row.w).map(|part| R::from(part) / row.x);
        let [min, max] = [rotor.thrust_min, rotor.thrust_max].map(|thrust| R::from(thrust) / row.x);
        Share { min, max, torque }
    }))
}

/// The rows as a tick reads them.
#[derive(Debug, Clone, PartialEq)]
pub struct TickBudget {
    /// w, and R's two parts.
    rows: Vec<[f32; 4], ROWS_MAX>,
}

impl TickBudget {
    /// Of `budget`, without the rows that others imply for every thrust scale from `scales[0]` to `scales[1]`.
    pub fn new(budget: &TorqueBudget, scales: [f32; 2]) -> Self {
        let mut binding: Vec<BudgetRow, ROWS_MAX> = Vec::new();
        for (place, row) in budget.rows.iter().enumerate() {
            let others = || binding.iter().chain(budget.rows.iter().skip(place + 1));
            if !implied(row, others, scales.map(f64::from)) {
                // At most as many as there are.
                let _ = binding.push(*row);
            }
        }
        let single = |row: &BudgetRow| {
            let left = 1.0 - UNUSED_ROW_SHARE;
            [row.direction[0], row.direction[1], left * row.per_scale, left * row.fixed].map(|x| x as f32)
        };
        Self { rows: collected(binding.iter().map(single)) }
    }

    /// The greatest torque that fits in every direction at a thrust scale, N m.
    #[inline(always)] // into the law's step
    pub fn radius(&self, scale: f32) -> f32 {
        self.rows.iter().map(|[_, _, per_scale, fixed]| per_scale * scale - fixed).fold(f32::MAX, math::min)
    }

    /// A tick's spending at a thrust scale, nothing spent.
    #[inline(always)]
    pub fn spending(&self, scale: f32) -> Spending<'_> {
        Spending { rows: &self.rows, scale, radius: self.radius(scale), spent: Vector2::zeros() }
    }
}

/// Whether two of the `others` imply `row` between the two scales: w is a sum of theirs with weights that are not
/// negative, and R is at least the sum of theirs with these weights.
fn implied<'a, I: Iterator<Item = &'a BudgetRow>>(row: &BudgetRow, others: impl Fn() -> I, scales: [f64; 2]) -> bool {
    let [x, y] = row.direction;
    others().any(|a| {
        others().any(|b| {
            let determinant = a.direction[0] * b.direction[1] - a.direction[1] * b.direction[0];
            // Of a parallel one, itself.
            let weights = if determinant.abs() < 1e-9 {
                let along = a.direction[0] * x + a.direction[1] * y;
                if along.abs() < 1.0 - 1e-12 {
                    return false;
                }
                [1.0, 0.0]
            } else {
                let of_a = (x * b.direction[1] - y * b.direction[0]) / determinant;
                let of_b = (a.direction[0] * y - a.direction[1] * x) / determinant;
                [of_a.abs(), of_b.abs()]
            };
            scales.iter().all(|s| weights[0] * a.capacity(*s) + weights[1] * b.capacity(*s) <= row.capacity(*s))
        })
    })
}

/// What a tick has spent of its torque about the tilt's axes.
#[derive(Debug, Clone, Copy)]
pub struct Spending<'a> {
    rows: &'a [[f32; 4]],
    scale: f32,
    radius: f32,
    /// N m.
    pub spent: Vector2<f32>,
}

impl Spending<'_> {
    /// The greatest torque that fits in every direction if nothing is spent, N m.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// Spends as much of `wanted`, N m, as leaves `kept`, N m, in every direction; returns the share.
    #[inline(always)]
    pub fn spend(&mut self, wanted: &Vector2<f32>, kept: f32) -> f32 {
        let whole = self.spent + wanted;
        let round = self.radius - kept;
        if round > 0.0 && whole.norm_squared() <= round * round {
            self.spent = whole;
            return 1.0;
        }
        cold_path();
        let share = self.share(wanted, kept);
        let part = wanted * share;
        // Inputs in range can overflow together: of a torque that is not a number nothing is spent.
        if !(part.x.is_finite() & part.y.is_finite()) {
            return 0.0;
        }
        self.spent += part;
        share
    }

    /// The greatest share of `wanted`, at most one, for which every row holds with `kept` to spare.
    #[inline(never)]
    fn share(&self, wanted: &Vector2<f32>, kept: f32) -> f32 {
        let mut share = 1.0;
        for [x, y, per_scale, fixed] in self.rows {
            let room = per_scale * self.scale - fixed - kept;
            let (spent, more) = (x * self.spent.x + y * self.spent.y, x * wanted.x + y * wanted.y);
            if (spent + more).abs() > room {
                let left = if more > 0.0 { room - spent } else { room + spent };
                share = math::min(share, math::max(left, 0.0) / more.abs());
            }
        }
        share
    }
}
