use super::super::tests::Random;
use super::*;

const PERIOD: f32 = 0.01;

const BOUNDS: Bounds = Bounds {
    speed: Cylinder { horizontal: 5.0, vertical: 2.0 },
    acceleration: Cylinder { horizontal: 2.5, vertical: 0.5 },
    jerk: 4.0,
    snap: 10.0,
};

const REST: HeadMotion = HeadMotion {
    velocity: Vector3::new(0.0, 0.0, 0.0),
    acceleration: Vector3::new(0.0, 0.0, 0.0),
    difference: Vector3::new(0.0, 0.0, 0.0),
};

/// Looks at the bounds, and moves on.
fn moved(head: &HeadMotion, snap: &Vector3<f32>) -> HeadMotion {
    let next = head.after(snap, PERIOD);
    let HeadMotion { velocity: v, acceleration: a, difference: d } = &next;
    assert!(snap.norm() <= BOUNDS.snap * PERIOD * PERIOD && d.norm() <= BOUNDS.jerk * PERIOD, "{next:?}");
    for (y, cylinder) in [(a, BOUNDS.acceleration), (v, BOUNDS.speed)] {
        assert!(y.xy().norm() <= cylinder.horizontal && y.z.abs() <= cylinder.vertical, "{next:?}");
    }
    next
}

#[test]
fn whatever_is_wanted_the_bounds_hold_and_the_way_out_ends_at_rest_from_acceleration() {
    let envelope = Envelope::new(&BOUNDS, 0.0, PERIOD);
    let mut random = Random::new(21);
    let mut turns = 0;
    for _ in 0..300 {
        let (mut head, mut out) = (REST, envelope.retreat(&REST).unwrap());
        let mut wanted = Vector3::zeros();
        for tick in 0..(2_000.0 * random.unit()) as u32 {
            // Held for a while, up to three times what is allowed; across the acceleration at times, which turns it.
            if tick % 40 == 0 {
                wanted = Vector3::from_fn(|_, _| random.signed()) * (BOUNDS.snap * 2.0 * PERIOD * PERIOD);
            }
            let across = Vector3::new(-head.acceleration.y, head.acceleration.x, 0.0) * (5.0 * PERIOD * PERIOD);
            let (snap, way) = envelope.step(&head, &(wanted + across), &out);
            (head, out) = (moved(&head, &snap), way);
            turns += u32::from(out != Retreat::STRAIGHT);
        }
        for _ in 0..300 {
            let (snap, way) = envelope.follow(&head, &out);
            (head, out) = (moved(&head, &snap), way);
        }
        assert!(head.acceleration.norm() < 1e-7 && head.difference.norm() < 1e-7, "{head:?}");
    }
    // Where braking straight is never too late, the turn is not tried.
    assert!(turns > 1_000, "{turns}");
}

#[test]
fn a_circle_near_the_bounds_leaves_a_way_out_that_turns() {
    let envelope = Envelope::new(&BOUNDS, 0.0, PERIOD);
    let rate = 0.5 * core::f32::consts::PI;
    let on = |acceleration: f32| HeadMotion {
        velocity: Vector3::new(0.0, acceleration / rate, 0.0),
        acceleration: Vector3::new(-acceleration, 0.0, 0.0),
        difference: Vector3::new(0.0, -acceleration * rate * PERIOD, 0.0),
    };
    assert!(envelope.retreat(&on(rate * rate)).unwrap() != Retreat::STRAIGHT);
    assert!(envelope.retreat(&on(1.5)) == Some(Retreat::STRAIGHT));
    assert!(envelope.retreat(&on(2.51)).is_none());
    // The same at a speed from which it cannot be slowed down in time.
    let fast = HeadMotion { velocity: Vector3::new(-4.5, 0.0, 0.0), ..on(rate * rate) };
    assert!(envelope.retreat(&fast).is_none());
}
