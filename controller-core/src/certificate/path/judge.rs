//! What a motion takes of what the extended law's limits leave at an instant. Section 11 of `docs/extended-law.md`.
//!
//! With w = g e3 + p_d'' + kappa p_d' and its derivatives w', w'' (kappa acts across), the law commands
//!
//! ```text
//! u = w - d + e,  |d| <= D,  |e| <= sqrt(2) M_s,  |e'| and |e''| those of the slowed law
//! ```
//!
//! near the target: d the force that is kept free, in any direction, and e the feedback of [`Slowed`]. So u is in a
//! ball about w and its derivatives are in balls about w', w''; where the motion is known to within a [`Spread`] only,
//! the balls are as much larger. With n, p, q, r as in [`crate::extended::direction_limiter`], at their worst in these
//! balls, and tau = J_max |q| + the gyroscopic torque + a share of rho(s) that is kept for torque bias and feedback:
//!
//! | row | taken < left |
//! |---|---|
//! | fall | A_- < g + p_d,z'' |
//! | thrust | m n + \|beta_12\| tau + \|beta_3\| J_33 y < s_lo min f_max / b_T - margin; m n < T_max |
//! | thrust | n + (rho . (u'' + 2 k u') + n \|p\|^2) / k^2 < U: it does not swell faster than the limiter allows |
//! | turning rate | \|p\| < Omega |
//! | torque | tau < rho(s) |
//! | floor | s_hi max f_min / b_T + margin + \|beta_12\| tau < (1 - mu) m n |
//! | cone | -rho_z' < sqrt(alpha / 2) (rho_z - cos gamma), alpha = rho(1) / J_max |
//!
//! A row is given as the share that is taken of what is left: where all are below one, nothing is limited, whatever d
//! and e do. The heading is not among them: yaw gets what is left, and the tilt does not depend on it. Where the frame
//! turns about u faster than yaw follows, the body is taken to turn no faster than the frame: y is what yaw then
//! [brakes](crate::extended::heading) with before thrust.

use super::{PathMotion, PathRow, RowShares, Spread, TORQUE_KEPT_SHARE};
use crate::certificate::form::ARITHMETIC_ALLOWANCE;
use crate::configuration::{Configuration, ExtendedLaw};
use crate::extended::budget::{TORQUE_THRUST_SHARE, TorqueBudget};
use crate::extended::direction_limiter::{self, END_SOFTNESS_PER_S};
use crate::extended::estimates::HELD_SHARE;
use crate::extended::fallback::Slowed;
use crate::math;
use crate::math::real::Real;

/// What limits and rotors leave to the motions of a configuration of the extended law.
#[derive(Debug, Clone, PartialEq)]
pub struct PathJudge<R = f64> {
    gravity: R,
    mass: R,
    /// kappa, 1/s.
    drag: R,
    /// A_-, m/s^2.
    a_down: R,
    /// D, m/s^2.
    force: R,
    /// The greatest e, e' and e'', m/s^2, m/s^3 and m/s^4.
    feedback: [R; 3],
    /// The part of e in the swelling, m/s^2.
    swelling: R,
    /// k of the limiter, 1/s.
    softness: R,
    /// Omega, rad/s.
    turn_rate: R,
    /// sqrt(alpha / 2), 1/s.
    closing: R,
    /// cos gamma.
    cosine: R,
    /// J_max and J_33 + |J_11 - J_22|, kg m^2.
    inertia: [R; 2],
    /// What is kept of the torque about the tilt's axes, and rho(s), N m.
    torque: [R; 2],
    /// |beta_12|, 1/m.
    reach: R,
    /// |beta_3| J_33 A, N, and W_max, rad/s.
    spin: [R; 2],
    /// s_lo min f_max / b_T - margin, and T_max, N.
    ceiling: [R; 2],
    /// s_hi max f_min / b_T + margin, N.
    floor: R,
    /// U beside the torque that is kept, m/s^2.
    max: R,
}

impl<R: Real> PathJudge<R> {
    /// For `law`, the one of `configuration`, with a force of `force_kept` kept free, m/s^2.
    pub fn new(configuration: &Configuration, law: &ExtendedLaw, force_kept: f32) -> Self {
        let (vehicle, limits, p) = (configuration.vehicle(), configuration.limits(), &law.parameters);
        let budget = TorqueBudget::<R>::new(p.floor_margin, limits, configuration.rotors());
        let [scale_least, scale_greatest] = [p.scale_least, p.scale_greatest].map(R::from);
        let [j_1, j_2, j_3] = [vehicle.inertia.x, vehicle.inertia.y, vehicle.inertia.z].map(R::from);
        let ([tilt_reach, yaw_reach], [bottom, top]) = (budget.reach, budget.ends);
        let (one, mass) = (R::from(1.0), R::from(vehicle.mass));

        let slowed = Slowed::<R>::new(p, vehicle.gravity);
        let [jerk, snap] = slowed.derivatives(p);
        let level = slowed.level * R::from(2.0).sqrt();
        let softness = R::from(END_SOFTNESS_PER_S);
        // (1 + s / k) behind a filter overshoots where the filter is quicker.
        let overshoot = |bandwidth: f32| (R::from(bandwidth) * slowed.factor * 2.0 / softness - one).greater(one);
        let radius = budget.radius(scale_least).lesser(budget.radius(scale_greatest));
        let kept = radius * TORQUE_KEPT_SHARE;
        let most = scale_least * top - budget.margin;
        let thrust_max = R::from(limits.thrust_max);
        Self {
            gravity: R::from(vehicle.gravity),
            mass,
            drag: R::from(p.drag_across),
            a_down: R::from(p.a_down),
            force: R::from(force_kept),
            feedback: [level, jerk, snap],
            swelling: level * overshoot(p.k_f) * overshoot(p.k_d),
            softness,
            turn_rate: R::from(p.turn_rate),
            closing: direction_limiter::closing(budget.radius(one) / j_1.greater(j_2)),
            cosine: R::from(1.0 / math::hypot(1.0, math::tan(f64::from(p.tilt_max)))),
            inertia: [j_1.greater(j_2), j_3 + (j_1 - j_2).abs()],
            torque: [kept, radius],
            reach: tilt_reach,
            spin: [yaw_reach * j_3 * R::from(p.yaw_acceleration), R::from(p.yaw_rate)],
            ceiling: [most, thrust_max],
            floor: scale_greatest * bottom + budget.margin,
            max: (most - tilt_reach * kept).lesser(thrust_max) / mass,
        }
    }

    /// What a motion takes at an instant.
    pub fn shares(&self, motion: &PathMotion<R>) -> RowShares<R> {
        self.shares_within(motion, &Spread::none())
    }

    /// What motions take that are no farther than `spread` from `motion`, each at most.
    pub fn shares_within(&self, motion: &PathMotion<R>, spread: &Spread<R>) -> RowShares<R> {
        let one = R::from(1.0);
        // w, w', w'', and how far u and its derivatives are from them.
        let mut w = self.with_drag(&motion.acceleration, &motion.velocity);
        w[2] += self.gravity;
        let w_1 = self.with_drag(&motion.jerk, &motion.acceleration);
        let w_2 = self.with_drag(&motion.snap, &motion.jerk);
        let moved = [
            spread.acceleration + self.drag * spread.velocity,
            spread.jerk + self.drag * spread.acceleration,
            spread.snap + self.drag * spread.jerk,
        ];
        let [level, e_1, e_2] = self.feedback;
        let forced = moved[0] + self.force;
        let (around, around_1, around_2) = (forced + level, moved[1] + e_1, moved[2] + e_2);

        let length = norm(&w);
        let (min, max) = (length - around, length + around);
        if min.lower() <= 0.0 {
            return RowShares { each: [R::from(f64::INFINITY); PathRow::ALL.len()] };
        }
        let direction = w.map(|x| x / length);
        // Of the greatest angle between w and u.
        let sine = around / length;
        let cosine = (one - sine * sine).sqrt_of_rounded();
        let (parts_1, parts_2) = (parts(&w_1, &direction), parts(&w_2, &direction));
        // The greatest part across u of a vector whose parts along and across w are given.
        let across = |[along, across]: [R; 2]| (across + along.abs() * sine).lesser(across.hypot(along));
        let u_1 = across(parts_1) + around_1;
        let u_2 = across(parts_2) + around_2;
        let r = parts_1[0].abs() + parts_1[1] * sine + around_1;
        let rate = u_1 / min;
        let acceleration = (u_2 + r * rate * 2.0) / min;

        let leaning = (one - direction[2] * direction[2]).sqrt_of_rounded();
        let up = direction[2] * cosine - leaning * sine;
        // The frame turns about u with |w_3| <= |psi'| / rho_z + tan(tilt) |p|.
        let tangent = (one - up * up).sqrt_of_rounded();
        let turning = share(motion.heading_rate.abs() + spread.heading_rate + tangent * rate, up);
        let [kept, radius] = self.torque;
        let torque = self.inertia[0] * acceleration + self.inertia[1] * turning * rate + kept;

        let k = self.softness;
        let [swell, swell_across] = parts(&sum(&w_2, &w_1.map(|x| x * k * 2.0)), &direction);
        let swell = swell.greater(swell * cosine) + swell_across * sine + moved[2] + moved[1] * k * 2.0;
        let swollen = length + forced + self.swelling + (swell + u_1 * u_1 / min) / (k * k);

        // The body turns one way while the frame turns the other.
        let [braking, fastest] = self.spin;
        let braking = braking * (turning * 2.0 / fastest - 1.0).greater(R::from(0.0)).lesser(one);
        let [ceiling, thrust_max] = self.ceiling;
        let thrust = [
            share(self.mass * max + self.reach * torque + braking, ceiling),
            share(self.mass * max, thrust_max),
            share(swollen, self.max),
            share(length + forced, self.max * f64::from(HELD_SHARE)),
        ];
        // -n rho_z' = (rho . u') rho_z - u_z'.
        let highest = (direction[2] + leaning * sine).lesser(one);
        let drawn = parts_1[0].greater(parts_1[0] * cosine) + parts_1[1] * sine + moved[1];
        let sinking = (drawn * highest).greater(drawn * up) - w_1[2] + moved[1] + e_1;
        let each = [
            share(self.a_down, self.gravity + motion.acceleration[2] - spread.acceleration),
            thrust.into_iter().fold(R::from(0.0), R::greater),
            share(rate, self.turn_rate),
            share(torque, radius),
            share(self.floor + self.reach * torque, self.mass * min * (1.0 - TORQUE_THRUST_SHARE)),
            share(self.cosine * self.closing + sinking / min, up * self.closing),
        ];
        RowShares { each: each.map(|share| share * (1.0 + ARITHMETIC_ALLOWANCE)) }
    }

    /// A derivative of the reference with the drag of the one below.
    fn with_drag(&self, derivative: &[R; 3], below: &[R; 3]) -> [R; 3] {
        let [x, y, z] = *derivative;
        [x + self.drag * below[0], y + self.drag * below[1], z]
    }
}

/// `taken` of what is `left`; infinite where nothing is, or where either is unknown.
fn share<R: Real>(taken: R, left: R) -> R {
    let share = taken / left;
    if left.lower() > 0.0 && !share.upper().is_nan() { share } else { R::from(f64::INFINITY) }
}

/// |v|.
fn norm<R: Real>(v: &[R; 3]) -> R {
    v[0].hypot(v[1]).hypot(v[2])
}

/// The parts of `v` along a `direction` of length one, and across it.
fn parts<R: Real>(v: &[R; 3], direction: &[R; 3]) -> [R; 2] {
    let along = v[0] * direction[0] + v[1] * direction[1] + v[2] * direction[2];
    [along, norm(&sum(v, &direction.map(|x| x * -along)))]
}

/// The sum of two vectors.
fn sum<R: Real>([x, y, z]: &[R; 3], [a, b, c]: &[R; 3]) -> [R; 3] {
    [*x + *a, *y + *b, *z + *c]
}

#[cfg(test)]
mod tests;
