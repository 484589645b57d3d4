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
