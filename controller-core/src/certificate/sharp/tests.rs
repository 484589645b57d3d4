use super::*;
use crate::math::enclosure::Enclosure;

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
            direction.cos_max - libm::cos(near),
            libm::cos(far) - direction.cos_min,
            direction.sin_max - libm::sin(far),
        ];
        assert!(outwards.iter().all(|by| (0.0..2.0 * cells::CELL_ROUNDING).contains(by)), "{i}: {outwards:?}");
    }
}

#[test]
fn a_bound_that_is_undefined_stays_undefined() {
    let bounds = ReferenceBounds { vertical_acceleration: 1.0, ..ReferenceBounds::REST };
    let [k_f, k_s, m_p, gravity] = [5.0, 10.0, 8.81_f32, 9.81].map(Enclosure::from);
    let reach = Reachable::new(k_f, k_s, m_p, gravity, &bounds);
    assert!(reach.vertical_min.lower() < 0.0 && reach.vertical_min.upper() > 0.0, "{reach:?}");
    let rates = desired_rates(&reach, &bounds, &Vector3::repeat(Enclosure::from(1.0)));
    assert!(rates.angular_velocity.upper().is_nan() && rates.feedforward_torque.x.upper().is_nan(), "{rates:?}");
    assert!(turning_rates(&reach, &bounds)[1].upper().is_nan());
}
