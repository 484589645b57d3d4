//! How a vehicle would come to rest if its reference were at rest: for the prospect that a monitor judges.
//! `docs/shield.md` derives it.

use super::{FeedbackLimits, Filters, LEVEL_MIN_M_PER_S2, PositionLaw, unit_factor};
use crate::math;
use crate::state::State;
use nalgebra::Vector3;

impl PositionLaw {
    /// The levels that a force d leaves for stopping at z_2, where the reference is at rest at z_1, m/s^2: across, up
    /// and down. Across: the least on the way, for the vertical goes from its command of now to -d_z, and the reach
    /// between two lifts is nowhere below the lesser of theirs.
    pub fn stopping_levels(
        &self,
        z_2: &Vector3<f32>,
        force: &Vector3<f32>,
        max: f32,
        most: &FeedbackLimits,
    ) -> FeedbackLimits {
        let up = math::min(math::max(max - self.gravity + force.z, LEVEL_MIN_M_PER_S2), most.up);
        let down = math::min(math::max(self.a_down - force.z, LEVEL_MIN_M_PER_S2), most.down);
        let vertical = z_2.z * self.k_v_vertical;
        let level = if vertical > 0.0 { down } else { up };
        let resting = self.gravity - force.z;
        let lift = resting - vertical * unit_factor(level, vertical * vertical);
        let reach = math::min(self.reach(lift, max), self.reach(resting, max));
        let left = math::max(reach - math::sqrt(force.xy().norm_squared()), LEVEL_MIN_M_PER_S2);
        FeedbackLimits { up, down, across: math::min(left, most.across) }
    }

    /// By how far z_1 moves until z_2 has come to rest, at these levels: at most |z_2| / k_v + |z_2|^2 / (2 M).
    ///
    /// With the reference at z_1, feedback is at least s(k_v z_2; M) long, so |z_2|' <= -M k_v |z_2| / sqrt(M^2 + k_v^2
    /// |z_2|^2), and the way is the integral of sqrt(M^2 + k_v^2 z^2) / (k_v M) from zero to |z_2|.
    pub fn stopping_way(&self, z_2: &Vector3<f32>, levels: &FeedbackLimits) -> Vector3<f32> {
        let FeedbackLimits { up, down, across } = *levels;
        let time = |speed: f32, level: f32, k_v: f32| 1.0 / k_v + 0.5 * speed / level;
        let horizontal = time(math::sqrt(z_2.xy().norm_squared()), across, self.k_v_across);
        let vertical = time(z_2.z.abs(), if z_2.z > 0.0 { down } else { up }, self.k_v_vertical);
        Vector3::new(z_2.x * horizontal, z_2.y * horizontal, z_2.z * vertical)
    }

    /// ubar where the reference is at rest at z_1, m/s^2.
    pub fn stopping(&self, z_2: &Vector3<f32>, force: &Vector3<f32>, max: f32, most: &FeedbackLimits) -> Vector3<f32> {
        self.saturated([&Vector3::zeros(), z_2], force, max, most)
    }

    /// The inputs of the filters c, x and y in turn, for a position and its derivatives: p + p' / k_f, and that with
    /// 1 / k_s as well. p is the first's output, the first is the second's, the second is z_1's. Along the vertical
    /// there is one filter, and both are p.
    pub fn stages(&self, state: &State, filters: &Filters, force: &Vector3<f32>) -> [Vector3<f32>; 2] {
        let [of_command, of_intermediate, _] = self.lags;
        let (p, v) = (state.position, state.velocity);
        let mut first = p + v * of_command;
        let mut both =
            p + v * (of_command + of_intermediate) + (filters.command + force) * (of_command * of_intermediate);
        (first.z, both.z) = (p.z, p.z);
        [first, both]
    }

    /// 1/k_f + 1/k_s + 1/k_d, s.
    pub fn lag(&self) -> f32 {
        self.all_lags
    }
}
