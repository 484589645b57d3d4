use super::*;

#[test]
fn bounds_exceed_others_by_any_single_one_of_them() {
    let of = |angular_velocity: f64, angular_acceleration: f64, yaw: f64| DesiredRates {
        angular_velocity,
        angular_acceleration,
        feedforward_torque: Vector3::new(1.0, 1.0, yaw),
    };
    let others = of(1.0, 1.0, 1.0);
    assert!(!others.exceed(&others) && !of(0.9, 0.9, 0.9).exceed(&others));
    for one in [of(1.1, 0.9, 0.9), of(0.9, 1.1, 0.9), of(0.9, 0.9, 1.1)] {
        assert!(one.exceed(&others), "{one:?}");
    }
}

#[test]
fn every_cell_of_the_quarter_turn_holds_its_cosines_and_sines_by_a_hair() {
    let cell = core::f64::consts::FRAC_PI_2 / ANGLE_CELLS as f64;
    for (i, direction) in Direction::<f64>::quarter_turn().iter().enumerate() {
        let (near, far) = (cell * i as f64, cell * (i + 1) as f64);
        let outwards = [
            direction.cos_greatest - libm::cos(near),
            libm::cos(far) - direction.cos_least,
            direction.sin_greatest - libm::sin(far),
        ];
        assert!(outwards.iter().all(|by| (0.0..2.0 * OUTWARDS).contains(by)), "{i}: {outwards:?}");
    }
}
