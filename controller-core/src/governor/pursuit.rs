//! The command generator: a double integrator that makes for the target as fast as its cylinder of accelerations allows.
//!
//! Wanted velocity: w = feed + |e|-directed approach, cut to the speed limits. Commanded acceleration: w - u, scaled (not
//! cut by component) into the cylinder C. "How long" is measured by C itself, ||y|| = max(|y_12|/A_12, |y_3|/A_3), so one
//! number says both how hard a step is and how much of C it uses, and everything along one direction is the scalar
//! problem of [`super::braking`]: from rest the path is the straight segment to the target, run without overshoot and ended
//! on the exact point.
//!
//! The bounds do not depend on any of this: alpha in C is all the windows ask for. From a state in motion, arrival is by
//! feedback: far from the target w turns slowly and ||w - u|| falls at nearly one a tick until u = w, which then persists;
//! when the target is passed at speed the same law brakes and returns. That every such pursuit ends is shown by test (at
//! worst 1.4 times as late as stopping first would) and by the campaign in `tests/governor_campaign.rs`, not proven.

use super::braking::{BRAKING_SHARE, approach_speed};
use super::windows::Windows;
use crate::math;
use nalgebra::Vector3;

/// A cylinder about the vertical: |y_12| <= `horizontal`, |y_3| <= `vertical`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cylinder {
    per_horizontal: f32,
    per_vertical: f32,
}

impl Cylinder {
    const NONE: Self = Self { per_horizontal: 0.0, per_vertical: 0.0 };

    fn new(horizontal: f32, vertical: f32) -> Self {
        Self { per_horizontal: 1.0 / horizontal, per_vertical: 1.0 / vertical }
    }

    /// ||y||: at most one inside.
    fn measure(&self, y: &Vector3<f32>) -> f32 {
        (math::sqrt(y.x * y.x + y.y * y.y) * self.per_horizontal).max(y.z.abs() * self.per_vertical)
    }

    /// `y` brought inside along its own direction; as it is if inside. Rounds towards zero.
    fn limited(&self, y: &Vector3<i64>) -> Vector3<i64> {
        shortened(y, self.measure(&single(y)), 1.0)
    }
}

/// `y` as single precision has it.
fn single(y: &Vector3<i64>) -> Vector3<f32> {
    y.map(|component| component as f32)
}

/// `y` with its measure brought down to `to`, rounded towards zero; as it is if its measure is one or less.
fn shortened(y: &Vector3<i64>, measure: f32, to: f32) -> Vector3<i64> {
    if measure <= 1.0 { *y } else { (single(y) * (to / measure)).map(|x| x as i64) }
}

/// The law, in length units and ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pursuit {
    accelerations: Cylinder,
    speeds: Cylinder,
}

impl Pursuit {
    /// Not designed yet.
    pub const NONE: Self = Self { accelerations: Cylinder::NONE, speeds: Cylinder::NONE };

    /// Speeds in m/s.
    pub fn new(windows: &Windows, horizontal_speed: f32, vertical_speed: f32, period: f32) -> Self {
        let unit = windows.per_metre * period;
        Self {
            accelerations: Cylinder::new(windows.horizontal, windows.vertical),
            speeds: Cylinder::new(horizontal_speed * unit, vertical_speed * unit),
        }
    }

    /// The acceleration that takes velocity `u` to `wanted`, as far as one tick may.
    pub fn towards_velocity(&self, wanted: &Vector3<i64>, u: &Vector3<i64>) -> Vector3<i32> {
        self.accelerations.limited(&(self.speeds.limited(wanted) - u)).map(|component| component as i32)
    }

    /// The velocity wanted to reach a target `error` away that moves with `feed` and accelerates with `acceleration` (units per
    /// tick squared): the greatest along `error` from which braking ends on it. Braking is planned with what following the
    /// target leaves.
    pub fn approach(&self, error: &Vector3<i64>, feed: &Vector3<i64>, acceleration: &Vector3<f32>) -> Vector3<i64> {
        let share = (BRAKING_SHARE - self.accelerations.measure(acceleration)).max(LEAST_SHARE);
        let distance = self.accelerations.measure(&single(error)) / share;
        feed + shortened(error, distance, approach_speed(distance))
    }
}

/// The share of the acceleration with which targets are closed in on that take all of it.
const LEAST_SHARE: f32 = 0.1;

#[cfg(test)]
mod tests {
    use super::super::tests::TYPICAL;
    use super::super::{GovernorLimits, tests::Random};
    use super::*;

    impl Pursuit {
        /// The acceleration of one tick towards a resting target `error` away.
        fn towards_position(&self, error: Vector3<i64>, u: &Vector3<i64>) -> Vector3<i32> {
            self.towards_velocity(&self.approach(&error, &Vector3::zeros(), &Vector3::zeros()), u)
        }
    }

    fn pursuit() -> (Windows, Pursuit) {
        let windows = Windows::design(&TYPICAL, &GovernorLimits::default(), 0.01).unwrap();
        (windows, Pursuit::new(&windows, 5.0, 2.0, 0.01))
    }

    #[test]
    fn from_rest_the_path_is_the_straight_segment_and_ends_on_the_point() {
        let (windows, pursuit) = pursuit();
        let mut random = Random::new(1);
        for _ in 0..200 {
            let size = windows.per_metre * 10.0_f32.powf(4.0 * random.unit() - 3.0);
            let target = Vector3::from_fn(|_, _| (random.signed() * size) as i64);
            let (mut x, mut u) = (Vector3::zeros(), Vector3::zeros());
            let (length, mut last) = (target.map(|c: i64| c as f64).norm(), 0.0);
            let mut ticks = 0;
            while x != target || u != Vector3::zeros() {
                u += pursuit.towards_position(target - x, &u).map(i64::from);
                x += u;
                let single = x.map(|c: i64| c as f64);
                let along = single.dot(&target.map(|c| c as f64)) / length;
                let aside = (single.norm_squared() - along * along).max(0.0).sqrt();
                assert!(along >= last - 2.0 && along <= length + 2.0, "{along} of {length}");
                assert!(aside <= 4.0 + 1e-4 * length, "{aside} beside a path of {length}");
                last = along;
                ticks += 1;
                assert!(ticks < 10_000, "{target} not reached: {x}");
            }
        }
    }

    #[test]
    fn no_command_leaves_the_cylinder() {
        let (windows, pursuit) = pursuit();
        let mut random = Random::new(2);
        for _ in 0..100_000 {
            let sizes = [10.0_f32.powf(18.0 * random.unit()), 10.0_f32.powf(9.0 * random.unit())];
            let error = Vector3::from_fn(|_, _| (random.signed() * sizes[0]) as i64);
            let u = Vector3::from_fn(|_, _| (random.signed() * sizes[1]) as i64);
            let command = pursuit.towards_position(error, &u).map(f64::from);
            assert!(command.xy().norm() <= f64::from(windows.horizontal) * (1.0 + 4e-7));
            assert!(command.z.abs() <= f64::from(windows.vertical) * (1.0 + 4e-7));
        }
    }

    #[test]
    fn from_any_motion_the_target_is_reached_within_half_again_the_time_of_stopping_first() {
        let (windows, pursuit) = pursuit();
        let mut random = Random::new(3);
        let mut worst: f32 = 0.0;
        for _ in 0..20_000 {
            let size = windows.per_metre * 10.0_f32.powf(5.0 * random.unit() - 3.5);
            let fast = windows.per_metre * 0.01 * 10.0_f32.powf(4.0 * random.unit() - 3.0);
            let target = Vector3::from_fn(|_, _| (random.signed() * size) as i64);
            let start = Vector3::from_fn(|_, _| (random.signed() * fast) as i64);
            let still = Vector3::zeros();
            let stop_and_go = {
                let (mut x, mut u, mut ticks, mut stopped) = (still, start, 0, false);
                while x != target || u != still {
                    stopped |= u == still;
                    u += if stopped {
                        pursuit.towards_position(target - x, &u)
                    } else {
                        pursuit.towards_velocity(&still, &u)
                    }
                    .map(i64::from);
                    x += u;
                    ticks += 1;
                }
                ticks
            };
            let (mut x, mut u, mut ticks) = (still, start, 0);
            while x != target || u != still {
                u += pursuit.towards_position(target - x, &u).map(i64::from);
                x += u;
                ticks += 1;
                assert!(ticks < 100_000, "{target} not reached from {start}");
            }
            let ratio = ticks as f32 / (stop_and_go + 10) as f32;
            worst = worst.max(ratio);
        }
        assert!(worst < 1.5, "{worst} times as long");
    }
}
