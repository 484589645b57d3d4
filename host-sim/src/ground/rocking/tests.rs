use super::*;
use scenario::body::attitude_from_euler;

const WEIGHT: Weight = Weight { mass: 0.5, inertia: Vector3::new(4e-3, 3e-3, 7e-3), gravity: 9.81 };

/// Leaning by `roll`, rad, which grows by `rate`, rad/s.
fn rolled(roll: f64, rate: f64) -> BodyState {
    let still = Vector3::zeros();
    let attitude = attitude_from_euler(roll, 0.0, 0.4);
    BodyState { position: still, velocity: still, attitude, angular_velocity: Vector3::new(rate, 0.0, 0.0) }
}

#[test]
fn the_origin_rises_as_fast_as_the_lean_lifts_it() {
    let rise = |roll: f64| Lean::of(&rolled(roll, 0.0)).unwrap().rise().0;
    for roll in [0.01, 0.2, 0.5] {
        let (_, rising) = Lean::of(&rolled(roll, 2.0)).unwrap().rise();
        let slope = (rise(roll + 1e-5) - rise(roll - 1e-5)) / 2e-5;
        assert!((rising - 2.0 * slope).abs() < 1e-8, "{rising} and {slope}");
        let (_, other) = Lean::of(&rolled(-roll, -2.0)).unwrap().rise();
        assert!((other - rising).abs() < 1e-12, "to the other side {other}");
    }
    assert!(Lean::of(&rolled(0.0, 1.0)).is_none() && Lean::of(&rolled(0.53, 0.0)).is_none());
}

#[test]
fn a_foot_lets_go_of_what_turns_fast_about_it() {
    let on_foot = |rate: f64| {
        let state = rolled(0.2, 0.0);
        let mut rocking = Rocking::begin(&state, Lean::of(&state).unwrap(), &WEIGHT);
        rocking.lean.rate = rate;
        rocking.advance(&WEIGHT, &Vector3::zeros(), &Vector3::zeros(), 1e-3)
    };
    // z'' = -g holds nothing: SPREAD (cos - sin) theta'' - r_z theta'^2, theta'' = -m g SPREAD (cos - sin) / I.
    let (near, inertia): (f64, f64) = (0.1 * (0.2_f64.cos() - 0.2_f64.sin()), 4e-3 + 0.5 * 0.02);
    let falling = 0.5 * 9.81 * near * near / inertia;
    let free = ((9.81 - falling) / (0.1 * (0.2_f64.cos() + 0.2_f64.sin()))).sqrt();
    for rate in [free, -free] {
        assert!(matches!(on_foot(0.99 * rate), Rocked::Leaning(_)), "{rate}");
        assert_eq!(on_foot(1.01 * rate), Rocked::Off, "{rate}");
    }
}
