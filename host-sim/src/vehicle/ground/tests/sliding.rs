//! Friction that is used up: on all feet, on one, and what comes down with a speed along the ground.

use super::*;
use crate::vehicle::ground::friction::across;

/// The vehicle's, in single precision.
const GRAVITY_M_PER_S2: f64 = 9.81_f32 as f64;

/// The speed along the ground, m/s, after `steps` under `force`, N, of what stood at rest.
fn pulled(force: Vector3<f64>, steps: u32) -> f64 {
    let (mut ground, plant, _) = on_the_ground();
    let mut state = *plant.state();
    for _ in 0..steps {
        state = ground.hold(&state, &force, &Vector3::zeros()).unwrap();
    }
    assert!(state.position.z == plant.state().position.z && state.attitude == plant.state().attitude);
    let moved = (state.position - plant.state().position).norm();
    let speed = state.velocity.norm();
    assert!((moved - 0.5 * speed * f64::from(steps) * STEP_S).abs() < 1e-9, "{moved} m at {speed} m/s");
    speed
}

#[test]
fn what_is_pulled_harder_than_friction_holds_slides_by_the_rest() {
    let (_, _, weight) = on_the_ground();
    let mass = weight / GRAVITY_M_PER_S2;
    for (share, lift) in [(0.59, 0.0), (0.29, 0.5), (0.0, 1.0)] {
        assert_eq!(pulled(Vector3::new(0.0, share * weight, lift * weight), 1000), 0.0, "{share}");
    }
    for (share, lift) in [(0.7, 0.0), (0.4, 0.5), (0.3, 1.0)] {
        let speed = pulled(Vector3::new(share * weight, 0.0, lift * weight), 1000);
        let expected = (share - FRICTION_COEFFICIENT * (1.0 - lift)) * weight / mass;
        assert!((speed - expected).abs() < 1e-9, "{share}: {speed} m/s, not {expected}");
    }
}

#[test]
fn a_slope_holds_what_stands_on_it_up_to_the_angle_of_friction() {
    let (_, _, weight) = on_the_ground();
    // Gravity that leans is a slope.
    let speed = |angle: f64| pulled(Vector3::new(angle.sin(), 0.0, 1.0 - angle.cos()) * weight, 500);
    let steepest = FRICTION_COEFFICIENT.atan();
    assert_eq!((speed(0.1), speed(0.99 * steepest)), (0.0, 0.0));
    for angle in [1.05 * steepest, 1.0] {
        let expected = 0.5 * GRAVITY_M_PER_S2 * (angle.sin() - FRICTION_COEFFICIENT * angle.cos());
        assert!((speed(angle) - expected).abs() < 1e-9, "{angle}: {} m/s, not {expected}", speed(angle));
    }
}

#[test]
fn what_slides_without_a_push_stops_by_friction_and_stays() {
    let (mut ground, plant, _) = on_the_ground();
    let mut state = BodyState { velocity: Vector3::new(0.3, -0.4, 0.0), ..*plant.state() };
    let stop = 0.5 / (FRICTION_COEFFICIENT * GRAVITY_M_PER_S2);
    for _ in 0..(stop / STEP_S) as u32 + 2 {
        state = ground.hold(&state, &Vector3::zeros(), &Vector3::zeros()).unwrap();
    }
    let gone = state.position - plant.state().position;
    assert!((gone - Vector3::new(0.3, -0.4, 0.0) * (0.5 * stop)).norm() < 5e-4, "{gone}");
    assert_eq!(state.velocity, Vector3::zeros());
    assert_eq!(ground.hold(&state, &Vector3::zeros(), &Vector3::zeros()), Some(state));
}

/// A vehicle that touches the ground at a lean of `roll`, rad, while it moves at `velocity`, m/s.
fn skidding(roll: f64, velocity: Vector3<f64>) -> (Ground, Plant, f64) {
    let (mut ground, mut plant, weight) = on_the_ground();
    let state = BodyState { attitude: attitude_from_euler(roll, 0.0, 0.0), velocity, ..*plant.state() };
    let rise = Lean::measure(&state).map_or(0.0, |lean| lean.rise().0);
    let (state, _) = ground.touch(&BodyState { position: state.position + Vector3::z() * rise, ..state }).unwrap();
    plant.place(state);
    (ground, plant, weight)
}

#[test]
fn an_impact_takes_as_much_speed_along_the_ground_as_friction_can() {
    for (along, down, left) in [(0.5, 0.1, 0.44), (0.5, 0.5, 0.2), (0.2, 0.5, 0.0)] {
        for roll in [0.0, 0.2] {
            let (_, plant, _) = skidding(roll, Vector3::new(0.0, along, -down));
            assert!((plant.state().velocity - Vector3::y() * left).norm() < 1e-12, "{}", plant.state().velocity);
        }
    }
}

#[test]
fn a_hover_that_touches_the_ground_slides_on_and_does_not_tip_over() {
    for roll in [0.0, 0.02, -0.02, 0.05, -0.05] {
        for share in [1.0, 0.98, 0.9] {
            let (mut ground, mut plant, weight) = skidding(roll, Vector3::new(0.0, 0.5, -0.05));
            let mut farthest = 0.0_f64;
            for _ in 0..200 {
                ground.act(&mut plant, share * weight, &Vector3::zeros());
                farthest = farthest.max(tilt(plant.state()));
            }
            let speed = plant.state().velocity.y;
            assert!(farthest < 1.3 * roll.abs() + 1e-6, "{roll}, {share}: leant by {farthest}");
            assert!(speed > 0.2, "{roll}, {share}: {speed} m/s");
        }
    }
}

#[test]
fn a_sliding_foot_feels_friction_times_what_it_carries() {
    for (roll, along) in [(0.2, 0.8), (-0.2, 0.8), (0.1, -0.6), (0.4, -0.8)] {
        let (mut ground, mut plant, _) = skidding(roll, Vector3::new(0.0, along, -1e-3));
        let mut before = *plant.state();
        for step in 0..10 {
            assert_eq!(ground.act(&mut plant, 0.0, &Vector3::zeros()), None);
            let change = (plant.state().velocity - before.velocity) / STEP_S;
            let carried = change.z + GRAVITY_M_PER_S2;
            let expected = -FRICTION_COEFFICIENT * carried * along.signum();
            assert!(carried > 0.0 && (change.y - expected).abs() < 0.15, "{roll} {along} {step}: {change}");
            before = *plant.state();
        }
    }
}

#[test]
fn however_it_slides_no_energy_appears() {
    let mut slid = 0.0_f64;
    for k in 0..400 {
        let phase = f64::from(k);
        let roll = 0.5 * (0.7 * phase).sin();
        let along = Vector3::new((1.3 * phase).sin(), (0.9 * phase).cos(), -0.3 - 0.3 * (2.1 * phase).sin()) * 1.5;
        let (mut ground, mut plant, weight) = skidding(roll, along);
        let start = plant.state().position;
        fall(&mut ground, &mut plant, weight);
        assert_eq!(plant.state().velocity, Vector3::zeros(), "{k}");
        slid = slid.max(across(&(plant.state().position - start)).norm());
    }
    assert!(slid > 0.2, "{slid} m");
}
