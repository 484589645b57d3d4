use super::*;
use scenario::Scenario;
use std::sync::LazyLock;

const STEP: f64 = 1e-3;

fn on_the_ground() -> (Ground, Plant, f64) {
    let scenario = Scenario::paper().unwrap();
    let (vehicle, limits) = (scenario.configuration.vehicle(), scenario.configuration.limits());
    let (ground, state) = Ground::under(vehicle, 0.1, &scenario.initial);
    let weight = ground.weight;
    (ground, Plant::new(vehicle, limits, STEP, state), weight)
}

fn energy(plant: &Plant, weight: f64) -> f64 {
    static PAPER: LazyLock<Scenario> = LazyLock::new(|| Scenario::paper().unwrap());
    let state = plant.state();
    let inertia = PAPER.configuration.vehicle().inertia.map(f64::from);
    let spin = state.angular_velocity.component_mul(&inertia).dot(&state.angular_velocity);
    0.5 * (weight / 9.81 * state.velocity.norm_squared() + spin) + weight * state.position.z
}

#[test]
fn it_starts_level_and_at_rest_with_the_yaw_it_was_given() {
    let (ground, plant, _) = on_the_ground();
    let initial = Scenario::paper().unwrap().initial;
    assert!(ground.standing);
    assert_eq!(plant.state().position, Vector3::new(5.0, 5.0, 0.1));
    assert!((plant.state().yaw() - initial.yaw()).abs() < 1e-12);
    assert!((up(plant.state()) - Vector3::z()).norm() < 1e-12);
    assert!((ground.specific_force(plant.state(), 0.0) - Vector3::z() * 9.81).norm() < 1e-5);
}

#[test]
fn it_rests_for_minutes_without_moving_whatever_the_rotors_do_below_its_weight() {
    let (mut ground, mut plant, weight) = on_the_ground();
    let start = *plant.state();
    for k in 0..300_000 {
        let phase = f64::from(k) * 0.01;
        let torque = Vector3::new(phase.sin(), phase.cos(), 0.3) * 0.4;
        assert_eq!(ground.act(&mut plant, weight * (0.5 + 0.5 * phase.sin()), &torque), None);
    }
    assert_eq!(*plant.state(), start);
}

#[test]
fn it_lifts_off_as_soon_as_thrust_exceeds_weight() {
    let (mut ground, mut plant, weight) = on_the_ground();
    for _ in 0..1000 {
        ground.act(&mut plant, weight * 1.1, &Vector3::zeros());
    }
    assert!(!ground.standing);
    // A tenth of g, upward, for a second.
    assert!((plant.state().position.z - 0.1 - 0.4905).abs() < 1e-3, "{:?}", plant.state());
    assert!((ground.specific_force(plant.state(), weight * 1.1).z - 1.1 * 9.81).abs() < 1e-5);
}

#[test]
fn a_fall_ends_without_a_bounce_upright_and_within_a_step_of_the_ground() {
    let (mut ground, mut plant, weight) = on_the_ground();
    for _ in 0..500 {
        ground.act(&mut plant, weight * 1.5, &Vector3::new(2e-5, 0.0, 0.0));
    }
    let touchdowns: Vec<_> = (0..5000).filter_map(|_| ground.act(&mut plant, 0.0, &Vector3::zeros())).collect();
    let [Touchdown { speed, tilt }] = touchdowns[..] else { panic!("{touchdowns:?}") };
    assert!(speed > 1.0 && tilt > 1e-4, "{speed} {tilt}");
    assert!((up(plant.state()) - Vector3::z()).norm() < 1e-12);
    assert_eq!(plant.state().velocity, Vector3::zeros());
    assert!((0.0..=speed * STEP).contains(&(0.1 - plant.state().position.z)), "{:?}", plant.state());
}

#[test]
fn one_that_comes_down_on_its_side_stays_there() {
    let (mut ground, mut plant, weight) = on_the_ground();
    for _ in 0..500 {
        ground.act(&mut plant, weight * 2.0, &Vector3::new(0.01, 0.0, 0.0));
    }
    let tilt = (0..5000).find_map(|_| ground.act(&mut plant, 0.0, &Vector3::zeros())).unwrap().tilt;
    assert!(tilt > LEGS_TILT_MAX);
    assert!((up(plant.state()).z - tilt.cos()).abs() < 1e-9);
}

#[test]
fn without_thrust_no_energy_appears() {
    let (mut ground, mut plant, weight) = on_the_ground();
    for k in 0..40 {
        // Hops of all heights, some too short to leave the ground in.
        for _ in 0..3 * k {
            ground.act(&mut plant, weight * 1.3, &Vector3::new(1e-4, -2e-4, 1e-4));
        }
        let mut before = energy(&plant, weight);
        for _ in 0..1000 {
            ground.act(&mut plant, 0.0, &Vector3::zeros());
            let now = energy(&plant, weight);
            assert!(now <= before + 1e-9, "hop {k}: {before} {now}");
            before = now;
        }
        assert!(ground.standing);
    }
}
