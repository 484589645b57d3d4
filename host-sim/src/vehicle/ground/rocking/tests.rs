use super::*;
use scenario::body::attitude_from_euler;

const VEHICLE_WEIGHT: Weight = Weight { mass: 0.5, inertia: Vector3::new(4e-3, 3e-3, 7e-3), gravity: 9.81 };

/// Leaning by `roll`, rad, which grows by `rate`, rad/s.
fn rolled(roll: f64, rate: f64) -> BodyState {
    let still = Vector3::zeros();
    let attitude = attitude_from_euler(roll, 0.0, 0.4);
    BodyState { position: still, velocity: still, attitude, angular_velocity: Vector3::new(rate, 0.0, 0.0) }
}

#[test]
fn the_origin_rises_as_fast_as_the_lean_lifts_it() {
    let rise = |roll: f64| Lean::measure(&rolled(roll, 0.0)).unwrap().rise().0;
    for roll in [0.01, 0.2, 0.5] {
        let (_, rising) = Lean::measure(&rolled(roll, 2.0)).unwrap().rise();
        let slope = (rise(roll + 1e-5) - rise(roll - 1e-5)) / 2e-5;
        assert!((rising - 2.0 * slope).abs() < 1e-8, "{rising} and {slope}");
        let (_, other) = Lean::measure(&rolled(-roll, -2.0)).unwrap().rise();
        assert!((other - rising).abs() < 1e-12, "to the other side {other}");
    }
    assert!(Lean::measure(&rolled(0.0, 1.0)).is_none() && Lean::measure(&rolled(0.53, 0.0)).is_none());
}

#[test]
fn a_foot_slides_under_what_turns_fast_about_it_and_lets_go_of_what_turns_faster() {
    let on_foot = |rate: f64| {
        let state = rolled(0.2, 0.0);
        let mut rocking = Rocking::begin(&state, Lean::measure(&state).unwrap(), &VEHICLE_WEIGHT);
        rocking.lean.rate = rate;
        (rocking.advance(&VEHICLE_WEIGHT, &Vector3::zeros(), &Vector3::zeros(), 1e-3), rocking.sliding.norm())
    };
    // Turning freely at theta', the foot rises by r_z theta'^2 against g.
    let free = (9.81 / (0.1 * (0.2_f64.cos() + 0.2_f64.sin()))).sqrt();
    for (rate, slides) in [(0.5 * free, false), (0.99 * free, true), (-0.5 * free, false), (-0.99 * free, true)] {
        let (rocked, sliding) = on_foot(rate);
        assert!(
            matches!(rocked, Rocked::Leaning(_)) && (sliding > 1e-4) == slides,
            "{rate}: {rocked:?}, {sliding} m/s"
        );
    }
    for rate in [free, -free] {
        assert_eq!(on_foot(1.01 * rate), (Rocked::Off, 0.0), "{rate}");
    }
}
