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

#[test]
fn jerk_and_snap_of_an_eight_are_known_between_its_setpoints() {
    let rate = 0.85_f32;
    // Acceleration, velocity, jerk and snap of (sin w t, sin 2 w t / 2).
    let at = |time: f32| {
        let ((sin, cos), (sin2, cos2)) = ((rate * time).sin_cos(), (2.0 * rate * time).sin_cos());
        let both = |x: f32, y: f32, power: i32| Vector3::new(x, y, 0.0) * rate.powi(power);
        [both(cos, cos2, 1), both(-sin, -2.0 * sin2, 2), both(-cos, -4.0 * cos2, 3), both(sin, 8.0 * sin2, 4)]
    };
    let [velocity, acceleration, ..] = at(0.0);
    let mut stream = Stream::new(velocity, acceleration);
    for number in 1..1_000 {
        let time = number as f32 * 0.02;
        let [velocity, acceleration, jerk, snap] = at(time);
        stream = stream.followed_by(velocity, acceleration, 0.02);
        let point = stream.ahead(0.0);
        if number > 50 {
            // Of 2.5 m/s^3 and 4.2 m/s^4.
            assert!((point.jerk - jerk).norm() < 0.05, "{time} s: {} for {jerk}", point.jerk);
            assert!((point.snap - snap).norm() < 0.8, "{time} s: {} for {snap}", point.snap);
        }
    }
}

#[test]
fn whatever_is_sent_and_whenever_the_estimate_forgets_it() {
    let mut random = super::super::tests::Random::new(5);
    let circle = |time: f32| {
        let (sin, cos) = time.sin_cos();
        (Vector3::new(-sin, cos, 0.0), Vector3::new(-cos, -sin, 0.0))
    };
    let mut stream = Stream::STILL;
    for _ in 0..20_000 {
        let vector = |random: &mut super::super::tests::Random| Vector3::from_fn(|_, _| 1e6 * random.signed());
        let (velocity, acceleration) = (vector(&mut random), vector(&mut random));
        // The times that grow fastest: short after long.
        stream = stream.followed_by(velocity, acceleration, if random.unit() < 0.5 { 0.01 } else { 0.3 });
        assert!(stream.bend.norm().is_finite() && stream.change.norm().is_finite());
    }
    for number in 0..400 {
        let (velocity, acceleration) = circle(0.02 * number as f32);
        stream = stream.followed_by(velocity, acceleration, 0.02);
    }
    let point = stream.ahead(0.0);
    assert!((point.jerk.norm() - 1.0).abs() < 0.01 && (point.snap.norm() - 1.0).abs() < 0.01, "{point:?}");
}
