use super::*;
use crate::crtp::polynomial::{Moving, Segment};
use nalgebra::Vector3;

const LIMITS: Limits = Limits {
    bounds: ReferenceBounds {
        horizontal_speed: 5.0,
        horizontal_acceleration: 2.0,
        vertical_acceleration: 0.5,
        jerk: 4.0,
        snap: 10.0,
        heading_rate: 1.0,
        heading_second_derivative: 2.0,
    },
    speeds: [3.0, 1.0],
};

fn slower(goal: Vector3<f32>, yaw: f32, duration: f32) -> Option<f32> {
    let path = Path::Segment(Segment::to_rest(&Point::resting(&Vector3::zeros(), 0.0), &goal, yaw, duration));
    LIMITS.slower(&path, &Pieces::new(&mut []))
}

#[test]
fn what_fits_is_flown_as_it_was_asked_for() {
    for (goal, yaw, duration) in [(Vector3::x(), 0.0, 4.0), (Vector3::z(), 0.0, 5.0), (Vector3::zeros(), 1.0, 4.0)] {
        assert_eq!(slower(goal, yaw, duration), Some(1.0), "{goal} {yaw}");
    }
}

/// The peaks of a way from rest to rest, of length d in T: 2.1875 d/T, 7.5132 d/T^2, 52.5 d/T^3, 840 d/T^4.
#[test]
fn what_does_not_fit_is_slowed_by_the_bound_that_it_breaks() {
    for (goal, yaw, duration, expected) in [
        // Snap; vertical speed; acceleration across; the rate of the yaw.
        (Vector3::x(), 0.0, 1.0, (840.0_f32 / 10.0).powf(0.25)),
        (Vector3::z() * 80.0, 0.0, 100.0, 2.1875 * 0.8 / 1.0),
        (Vector3::x() * 40.0, 0.0, 10.0, (7.5132_f32 * 0.4 / 2.0).sqrt().max(2.1875 * 4.0 / 3.0)),
        (Vector3::zeros(), 3.0, 4.0, 2.1875 * 0.75 / 1.0),
    ] {
        let found = slower(goal, yaw, duration).unwrap() / ROOM;
        // Steps of a twentieth, and the peak may lie between two places.
        assert!(found >= 0.99 * expected && found <= 1.06 * expected, "{goal} {yaw}: {found} {expected}");
    }
}

#[test]
fn what_no_slowness_makes_fit_is_refused() {
    assert_eq!(slower(Vector3::x() * 1e6, 0.0, 1.0), None);
    let moving = Point { yaw: Moving::resting(0.0), axes: [Moving::new(0.0, f32::NAN, 0.0); 3] };
    let path = Path::Segment(Segment::to_rest(&moving, &Vector3::zeros(), 0.0, 1.0));
    assert_eq!(LIMITS.slower(&path, &Pieces::new(&mut [])), None);
}
