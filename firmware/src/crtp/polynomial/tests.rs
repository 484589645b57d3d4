use super::*;

fn near(one: f32, other: f32, tolerance: f32) -> bool {
    (one - other).abs() <= tolerance
}

/// A derivative at `time`, power by power.
fn derivative(polynomial: &Polynomial, order: i32, time: f64) -> f64 {
    let terms = polynomial.0.iter().zip(0_i32..).filter(|(_, power)| *power >= order);
    terms
        .map(|(coefficient, power)| {
            let falling: f64 = (0..order).map(|step| f64::from(power - step)).product();
            f64::from(*coefficient) * falling * time.powi(power - order)
        })
        .sum()
}

#[test]
fn a_way_to_rest_begins_as_the_vehicle_moves_and_ends_at_rest_at_the_goal() {
    for (from, goal, duration) in [
        (Moving::resting(0.0), 1.0, 2.0),
        (Moving::new(1.0, -0.5, 0.3), -4.0, 3.5),
        (Moving::new(-2.0, 2.0, -1.0), -2.0, 0.7),
    ] {
        let way = Polynomial::to_rest(&from, goal, duration);
        let (begin, end) = (way.at(0.0), way.at(duration));
        assert_eq!((begin.value, begin.rate, begin.jerk), (from.value, from.rate, 0.0));
        assert!(near(begin.acceleration, from.acceleration, 1e-5));
        assert!(near(end.value, goal, 1e-4) && near(end.rate, 0.0, 1e-3), "{end:?}");
        assert!(near(end.acceleration, 0.0, 2e-2) && near(end.jerk, 0.0, 0.5), "{end:?}");
    }
}

#[test]
fn derivatives_are_those_of_each_power() {
    let way = Polynomial::to_rest(&Moving::new(0.5, 1.0, -0.4), 3.0, 2.5);
    for time in [0.0, 0.2, 1.1, 2.3] {
        let Moving { value, rate, acceleration, jerk, snap } = way.at(time as f32);
        for (order, found) in (0..).zip([value, rate, acceleration, jerk, snap]) {
            let expected = derivative(&way, order, time);
            assert!((f64::from(found) - expected).abs() < 1e-3, "{order} at {time}: {found} {expected}");
        }
    }
}

#[test]
fn a_turn_is_the_shorter_way_round() {
    let from = Point::resting(&Vector3::zeros(), 3.0);
    for (yaw, end) in [(-3.0, TAU - 3.0), (2.0, 2.0), (9.0, 9.0 - TAU), (-0.5, TAU - 0.5)] {
        let segment = Segment::to_rest(&from, &Vector3::zeros(), yaw, 1.0);
        assert!(near(segment.at(1.0).yaw.value, end, 1e-5), "{yaw}: {:?}", segment.at(1.0).yaw);
    }
}

#[test]
fn a_straight_way_has_one_speed_and_nothing_is_beyond_its_ends() {
    let from = Point::resting(&Vector3::new(1.0, 2.0, 3.0), 0.0);
    let segment = Segment::straight(&from, &Vector3::new(3.0, 2.0, 2.0), 0.0, 4.0);
    let speeds = |time| segment.at(time).axes.map(|axis| axis.rate);
    assert_eq!((speeds(0.0), speeds(3.0)), ([0.5, 0.0, -0.25], [0.5, 0.0, -0.25]));
    assert_eq!(segment.at(-1.0), segment.at(0.0));
    assert_eq!(segment.at(9.0).position(), Vector3::new(3.0, 2.0, 2.0));
}

#[test]
fn a_pace_scales_each_derivative_by_its_power() {
    let moving = Moving { value: 1.0, rate: 1.0, acceleration: 1.0, jerk: 1.0, snap: 1.0 };
    let expected = Moving { value: 1.0, rate: -0.5, acceleration: 0.25, jerk: -0.125, snap: 0.0625 };
    assert_eq!(moving.paced(-0.5), expected);
    let mixed = moving.mixed(2.0, &expected, 4.0);
    assert_eq!((mixed.value, mixed.rate, mixed.snap), (6.0, 0.0, 2.25));
}
