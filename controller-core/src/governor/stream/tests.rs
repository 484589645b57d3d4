use super::*;

#[test]
fn a_point_on_a_rising_circle_is_where_it_will_be() {
    let (rate, radius) = (1.3_f32, 0.8);
    let at = |time: f32| {
        let (sin, cos) = (rate * time).sin_cos();
        let (out, along) = (Vector3::new(cos, sin, 0.0) * radius, Vector3::new(-sin, cos, 0.0) * radius);
        let up = Vector3::z();
        let r = rate;
        [out + up * (0.3 * time), along * r + up * 0.3, -out * (r * r), -along * (r * r * r), out * (r * r * r * r)]
    };
    let [from, velocity, acceleration, ..] = at(0.4);
    let point = Stream::new(velocity, acceleration).ahead(0.35);
    let [position, velocity, acceleration, jerk, snap] = at(0.75);
    for (found, expected) in [
        (point.position + from, position),
        (point.velocity, velocity),
        (point.acceleration, acceleration),
        (point.jerk, jerk),
        (point.snap, snap),
    ] {
        assert!((found - expected).norm() < 1e-5, "{found} for {expected}");
    }
    assert!((point.rate - rate).abs() < 1e-5);
}

#[test]
fn an_acceleration_that_changes_evenly_goes_on_changing() {
    let (first, change) = (Vector3::new(0.5, -0.2, 0.1), Vector3::new(-0.4, 0.1, 0.05));
    let velocity = |time: f32| Vector3::new(1.0, -0.4, 0.2) + first * time + change * (0.5 * time * time);
    // Along its path: no turn in it.
    let straight = Stream::new(Vector3::zeros(), first).followed_by(Vector3::zeros(), first + change * 0.05, 0.05);
    let point = straight.ahead(0.2);
    assert!((point.acceleration - first - change * 0.25).norm() < 1e-5 && (point.jerk - change).norm() < 1e-4);
    assert!((point.velocity - (first + change * 0.05) * 0.2 - change * 0.02).norm() < 1e-5);
    // On a bent path too, nearly; and the bend then is not taken for a turn that lasts.
    let bent = Stream::new(velocity(0.0), first).followed_by(velocity(0.05), first + change * 0.05, 0.05);
    let point = bent.ahead(0.1);
    assert!((point.acceleration - first - change * 0.15).norm() < 3e-3, "{}", point.acceleration);
    assert!(point.rate == 0.0);
}

#[test]
fn absurd_streams_make_finite_points_or_none_that_could_be_followed() {
    for size in [0.0, 1e-30, 1e-3, 1.0, 1e6] {
        for other in [0.0, 1e-30, 1.0, 1e6] {
            let first = Stream::new(Vector3::new(size, 0.0, size), Vector3::new(1.0, other, 0.0));
            let point = first.followed_by(Vector3::new(other, size, 0.0), Vector3::repeat(-other), 0.002).ahead(0.5);
            assert!(point.velocity.norm().is_finite() && point.rate.is_finite(), "{point:?}");
        }
    }
}
