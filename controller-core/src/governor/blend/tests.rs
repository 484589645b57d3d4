use super::*;
use crate::governor::envelope::{Bounds, Cylinder};

const REST: HeadMotion = HeadMotion {
    velocity: Vector3::new(0.0, 0.0, 0.0),
    acceleration: Vector3::new(0.0, 0.0, 0.0),
    difference: Vector3::new(0.0, 0.0, 0.0),
};

fn at(elapsed: f32, duration: f32) -> Blend {
    Blend { elapsed, duration, ahead: Vector3::zeros(), moving: REST }
}

#[test]
fn the_step_is_smooth_and_no_steeper_than_is_counted_on() {
    let (ticks, duration) = (2_000, 5.0_f32);
    let step = |tick: u32| at(duration * tick as f32 / ticks as f32, duration).step();
    assert_eq!(step(0), [0.0; 5]);
    assert_eq!(step(ticks), [1.0, 0.0, 0.0, 0.0, 0.0]);
    let mut steepest = [0.0_f32; 4];
    for tick in 1..ticks {
        let (before, here, after) = (step(tick - 1), step(tick), step(tick + 1));
        for order in 0..4 {
            let slope = (after[order] - before[order]) * ticks as f32 / (2.0 * duration);
            let size = STEP_DERIVATIVES_MAX[order] / duration.powi(order as i32 + 1);
            assert!((slope - here[order + 1]).abs() < 1e-3 * size, "{tick}: derivative {}", order + 1);
            steepest[order] = steepest[order].max(here[order + 1].abs() / size);
        }
    }
    assert!(steepest.iter().all(|max| (0.999..1.001).contains(max)), "{steepest:?}");
}

#[test]
fn a_blend_begins_on_the_averages_and_ends_on_the_stream() {
    let all = Vector3::repeat;
    let error = Point {
        position: all(0.3),
        velocity: all(-0.2),
        acceleration: all(0.4),
        jerk: all(0.5),
        snap: all(0.0),
        rate: 0.7,
    };
    let sought = StreamTarget { point: Point { snap: all(2.0), ..error }, error };
    let snap = all(1e-4);
    let StreamTarget { point, error } = at(0.0, 5.0).target(&REST, &sought, &snap, 0.01);
    assert_eq!([error.position, error.velocity, error.acceleration, error.jerk], [Vector3::zeros(); 4]);
    assert!((point.snap - all(1.0)).norm() < 1e-6 && point.rate == 0.0);
    let target = at(5.0, 5.0).target(&REST, &sought, &snap, 0.01);
    assert_eq!(target.error, sought.error);
    assert_eq!(target.point.snap, sought.point.snap);
}

#[test]
fn a_stream_takes_longer_the_farther_it_is_and_never_longer_than_forty_seconds() {
    let both = |horizontal: f32, vertical: f32| Cylinder { horizontal, vertical };
    let bounds = Bounds { speed: both(5.0, 2.0), acceleration: both(2.5, 0.5), jerk: 4.0, snap: 10.0 };
    let envelope = Envelope::new(&bounds, 0.0, 0.01);
    let zero = Vector3::zeros();
    let rest = Point { position: zero, velocity: zero, acceleration: zero, jerk: zero, snap: zero, rate: 0.0 };
    let duration = |far: f32, used: f32| {
        let error = Point { position: Vector3::new(far, 0.0, 0.0), ..rest };
        Watched::NONE.with(&error, [far, 0.0], used).blend(&envelope, 2.2).map(|blend| blend.duration)
    };
    assert_eq!(duration(0.0, 0.5), Some(2.2));
    let [near, far, tight] = [(1.0, 0.5), (10.0, 0.5), (1.0, 0.9)].map(|(far, used)| duration(far, used).unwrap());
    assert!(2.2 < near && near < far && far < 20.0 && near < tight, "{near}, {far}, {tight}");
    assert_eq!(duration(1.0, 1.0), None);
    assert_eq!(duration(1e3, 0.5), None);
    assert_eq!(duration(f32::INFINITY, 0.5), None);
}
