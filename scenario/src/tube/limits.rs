//! The limits of the law that the loops do not know: within the bounds none may be reached. Section 7 of
//! `docs/recovery.md`. SI units.

use super::bounds::Peaks;
use super::deviation::Plane;
use controller_core::extended::budget::TORQUE_THRUST_SHARE;
use controller_core::extended::direction_limiter::{END_SOFTNESS_PER_S, PUSH_ACROSS_MAX_M_PER_S2};
use core::cmp::Ordering;

/// A limit of the law that the bounds reach: beyond it the loops say nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    /// What it limits, in words.
    pub what: &'static str,
    /// The numbers' unit.
    pub unit: &'static str,
    /// What the signals may need.
    pub needed: f64,
    /// What there is.
    pub available: f64,
}

impl Plane<'_> {
    /// The first of them that is reached.
    pub fn reached(&self, across: &Peaks, vertical: &Peaks) -> Option<Reached> {
        let p = &self.law.parameters;
        let g = self.gravity();
        let mass = f64::from(self.configuration.vehicle().mass);
        let max = self.acceleration_max(across);
        let [y, z_rate, z_acceleration] = self.vertical_filters(vertical);
        let [c, rate, acceleration] = across.desired;
        let least = g - y;
        let tangent = c / least;
        let [turning, bending] = [
            (rate + z_rate * tangent) / least,
            (acceleration
                + z_acceleration * tangent
                + 2.0 * (rate * tangent + z_rate) * (rate + z_rate * tangent) / least)
                / least,
        ];
        let radius = 0.999 * self.budget.radius(1.0);
        let [k_tilt, damping] = [p.k_tilt, p.k_omega_t].map(f64::from);
        // What a tick spends before it turns the frame, and in all.
        let [angle, rate_error] = across.projected;
        let spent = across.bias * self.inertia + 1.01 * 0.25 * k_tilt * angle + damping * rate_error;
        let inertia_max = self.reserve() / f64::from(p.turn_reserve);
        let whole = spent + inertia_max * bending;
        let [bottom, margin] = [self.budget.ends[0], self.budget.margin];
        let floor = bottom + margin + self.budget.reach[0] * whole;
        let lean = (p.tilt_max as f64).tan();
        let [level_across, level_vertical] = self.levels(across, vertical);
        let limit = |what, unit, needed, available| Reached { what, unit, needed, available };
        let share = 1.0 - TORQUE_THRUST_SHARE;
        let sine = tangent / 1.0f64.hypot(tangent);
        let cosine_left = 1.0 / 1.0f64.hypot(tangent) - 1.0 / 1.0f64.hypot(lean);
        let alpha = radius / inertia_max;
        // The ends of c_z and |u|.
        let k = f64::from(END_SOFTNESS_PER_S).min(0.5 / self.ages.period);
        let n = (g + y) * 1.0f64.hypot(tangent);
        // What moves c along the vertical moves nothing while c points up: the thrust takes y.
        let tilts = f64::from(u8::from(c > 0.0));
        let growing = rate * sine + z_rate;
        let swelling = acceleration * sine + z_acceleration + n * turning * turning;
        [
            limit("feedback's level across", "m/s^2", 0.3, level_across),
            limit("feedback's level along the vertical", "m/s^2", 0.3, level_vertical),
            limit("the estimate of a force across", "m/s^2", across.force, p.force_across.into()),
            limit("the estimate of a force up and down", "m/s^2", vertical.force, p.force_up.min(p.force_down).into()),
            limit("the force that thrust holds", "m/s^2", across.force.hypot(g + vertical.force), 0.99 * max),
            limit("the torque bias", "N m", across.bias * self.inertia, p.torque_tilt.into()),
            limit("the tilt's error", "rad", across.error[0], 0.3),
            limit("the desired tilt's tangent", "", tangent, lean),
            limit(
                "the desired tilt's cone",
                "rad/s",
                sine * (turning + self.ages.period * bending),
                (0.5 * alpha).sqrt() * cosine_left,
            ),
            limit("the turning rate", "rad/s", turning + self.ages.period * bending, p.turn_rate.into()),
            limit("the turning acceleration", "rad/s^2", bending, alpha),
            limit("the tilt's feedback beside the reserve", "N m", spent + self.reserve(), radius),
            limit("the torque about the tilt's axes", "N m", whole, radius),
            limit("the thrust's floor", "N", floor, share * mass * least),
            limit("the thrust", "m/s^2", n + self.budget.reach[0] * whole / mass, max),
            limit("what thrust pushes across", "m/s^2", 2.0 * y * tangent, PUSH_ACROSS_MAX_M_PER_S2.into()),
            limit(
                "the fall's end",
                "m/s^4",
                tilts * (z_acceleration + 2.0 * k * z_rate),
                k * k * (f64::from(p.a_down) - y),
            ),
            limit("the thrust's end", "m/s^4", tilts * (swelling + 2.0 * k * growing), k * k * (max - n)),
        ]
        .into_iter()
        .find(|limit| limit.needed.partial_cmp(&limit.available) != Some(Ordering::Less))
    }
}
