use super::*;
use scenario::Scenario;
use std::sync::LazyLock;

mod sliding;

const STEP_S: f64 = 1e-3;

fn on_the_ground() -> (Ground, Plant, f64) {
    let scenario = Scenario::paper().unwrap();
    let (vehicle, limits) = (scenario.configuration.vehicle(), scenario.configuration.limits());
    let (ground, state) = Ground::under(vehicle, 0.1, &scenario.initial, STEP_S);
    let weight = ground.weight.newtons();
    (ground, Plant::new(vehicle, limits, STEP_S, state), weight)
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
    assert!(ground.stands());
    assert_eq!(plant.state().position, Vector3::new(5.0, 5.0, 0.1));
    assert!((plant.state().yaw() - initial.yaw()).abs() < 1e-12);
    assert!((up(plant.state()) - Vector3::z()).norm() < 1e-12);
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
    assert!(!ground.stands());
    // A tenth of g, upward, for a second.
    assert!((plant.state().position.z - 0.1 - 0.4905).abs() < 1e-3, "{:?}", plant.state());
}

#[test]
fn a_fall_ends_without_a_bounce_upright_and_within_a_step_of_the_ground() {
    let (mut ground, mut plant, weight) = on_the_ground();
    for _ in 0..500 {
        ground.act(&mut plant, weight * 1.5, &Vector3::new(2e-5, 0.0, 0.0));
    }
    let touchdowns: Vec<_> = (0..5000).filter_map(|_| ground.act(&mut plant, 0.0, &Vector3::zeros())).collect();
    let [Touchdown { speed, tilt, .. }] = touchdowns[..] else { panic!("{touchdowns:?}") };
    assert!(speed > 1.0 && tilt > 1e-4, "{speed} {tilt}");
    assert!((up(plant.state()) - Vector3::z()).norm() < 1e-12);
    assert_eq!(plant.state().velocity, Vector3::zeros());
    assert!((0.0..=speed * STEP_S).contains(&(0.1 - plant.state().position.z)), "{:?}", plant.state());
}

#[test]
fn one_that_comes_down_on_its_side_stays_there() {
    let (mut ground, mut plant, weight) = on_the_ground();
    for _ in 0..500 {
        ground.act(&mut plant, weight * 2.0, &Vector3::new(0.01, 0.0, 0.0));
    }
    let tilt = (0..5000).find_map(|_| ground.act(&mut plant, 0.0, &Vector3::zeros())).unwrap().tilt;
    assert!(tilt > TILT_MAX_RAD);
    assert!((up(plant.state()).z - tilt.cos()).abs() < 1e-9);
}

/// Lets the vehicle fall for a second, without gaining energy; how far it leaned where it touched the ground.
fn fall(ground: &mut Ground, plant: &mut Plant, weight: f64) -> f64 {
    let (mut before, mut leant) = (energy(plant, weight), 0.0_f64);
    for k in 0..1000 {
        let touched = ground.act(plant, 0.0, &Vector3::zeros());
        leant = touched.map_or(leant, |touched| leant.max(touched.tilt));
        let now = energy(plant, weight);
        assert!(now <= before + 1e-9, "{k}: {before} {now}");
        before = now;
    }
    assert!(ground.stands());
    leant
}

#[test]
fn without_thrust_no_energy_appears() {
    let (mut ground, mut plant, weight) = on_the_ground();
    for k in 0..40 {
        // Hops of all heights, some too short to leave the ground in.
        for _ in 0..3 * k {
            ground.act(&mut plant, weight * 1.3, &Vector3::new(1e-4, -2e-4, 1e-4));
        }
        fall(&mut ground, &mut plant, weight);
    }
}

/// A vehicle that has just touched the ground at a lean of `roll` and `pitch`, rad, turned by some yaw.
fn leaning(roll: f64, pitch: f64) -> (Ground, Plant, f64) {
    let (mut ground, mut plant, weight) = on_the_ground();
    let state = BodyState { attitude: attitude_from_euler(roll, pitch, 0.7), ..*plant.state() };
    let (rise, _) = Lean::measure(&state).unwrap().rise();
    let touching = BodyState { position: state.position + Vector3::z() * (0.999 * rise), ..state };
    let (state, touchdown) = ground.touch(&touching).unwrap();
    assert!((touchdown.tilt - (roll.cos() * pitch.cos()).acos()).abs() < 1e-9);
    plant.place(state);
    (ground, plant, weight)
}

#[test]
fn one_that_leans_falls_back_onto_its_feet_as_fast_as_its_weight_makes_it_and_a_gyro_feels_it() {
    for (roll, pitch) in [(0.02, 0.0), (0.2, 0.0), (-0.1, 0.25), (0.0, -0.45)] {
        let (mut ground, mut plant, weight) = leaning(roll, pitch);
        let (began, start, mut turned, mut fastest) = (energy(&plant, weight), tilt(plant.state()), 0.0, 0.0_f64);
        let foot = |state: &BodyState| Lean::measure(state).map(|lean| state.position - lean.arm());
        let (mut before, mut rubbed) = (began, 0.0);
        while tilt(plant.state()) > 1e-9 {
            let last = *plant.state();
            assert_eq!(ground.act(&mut plant, 0.0, &Vector3::zeros()), None);
            let rate = plant.state().angular_velocity.norm();
            (turned, fastest) = (turned + rate * STEP_S, fastest.max(rate));
            let now = energy(&plant, weight);
            assert!(ground.stands() && now <= before + 1e-9, "{before} {now}");
            // Where the foot slides back, friction takes its force times the way.
            let carried = weight + weight / 9.81 * (plant.state().velocity.z - last.velocity.z) / STEP_S;
            let slid = foot(plant.state()).zip(foot(&last)).map_or(0.0, |(foot, last)| (foot - last).xy().norm());
            rubbed += FRICTION_COEFFICIENT * carried * slid;
            // Until the last step, in which the feet take what it has.
            let left = began - rubbed - 0.06 * start * weight * 0.1;
            assert!(tilt(plant.state()) < 1e-9 || now > left, "{began} {rubbed} {now}");
            before = now;
        }
        assert!((turned - start).abs() < 0.01, "{turned} of {start} rad");
        assert!(fastest > 1.0 && turned / fastest < 0.2, "{fastest} rad/s");
        // What it slides back with, friction takes.
        (0..10).for_each(|_| assert_eq!(ground.act(&mut plant, 0.0, &Vector3::zeros()), None));
        assert_eq!((plant.state().velocity, plant.state().angular_velocity), (Vector3::zeros(), Vector3::zeros()));
        assert!((plant.state().position.z - 0.1).abs() < 1e-4, "{:?}", plant.state());
        assert!((plant.state().yaw() - 0.7).abs() < 0.06, "{}", plant.state().yaw());
        let still = *plant.state();
        assert_eq!(ground.act(&mut plant, 0.9 * weight, &Vector3::repeat(0.1)), None);
        assert_eq!(*plant.state(), still);
    }
}

#[test]
fn thrust_holds_it_on_its_foot_and_more_than_its_weight_lifts_it_off() {
    // Half by thrust along the axis, at the feet's distance from the foot, against a weight that is nearer; half by a
    // torque: thrust alone would leave so little on the foot that it slides.
    let (mut ground, mut plant, weight) = leaning(0.1, 0.0);
    let nearer = (0.1_f64.cos() - 0.1_f64.sin()) * weight;
    for _ in 0..200 {
        ground.act(&mut plant, 0.5 * nearer, &(Vector3::x() * (0.5 * nearer * 0.1)));
    }
    assert!(ground.stands() && (tilt(plant.state()) - 0.1).abs() < 1e-3, "{}", tilt(plant.state()));
    for _ in 0..200 {
        ground.act(&mut plant, 1.1 * weight, &Vector3::zeros());
    }
    assert!(!ground.stands() && plant.state().velocity.z > 0.1, "{:?}", plant.state());
}

#[test]
fn a_torque_that_rights_it_is_not_held_up_by_the_foot_that_it_lifts() {
    let (mut ground, mut plant, weight) = leaning(0.3, 0.0);
    let mut took = 0;
    while tilt(plant.state()) > 0.01 {
        ground.act(&mut plant, 0.6 * weight, &Vector3::new(-0.3, 0.0, 0.0));
        took += 1;
        assert!(took < 150, "{:?}", plant.state());
    }
    // Pulled by the weight alone it would take longer.
    let (mut ground, mut plant, weight) = leaning(0.3, 0.0);
    for _ in 0..took {
        ground.act(&mut plant, 0.6 * weight, &Vector3::zeros());
    }
    assert!(tilt(plant.state()) > 0.05, "{took} ms");
}

#[test]
fn a_torque_that_turns_it_over_its_foot_leaves_it_lying() {
    let (mut ground, mut plant, weight) = leaning(0.2, 0.0);
    for _ in 0..2000 {
        ground.act(&mut plant, 0.5 * weight, &Vector3::new(0.25, 0.0, 0.0));
    }
    let lying = tilt(plant.state());
    assert!(ground.stands() && lying > TILT_MAX_RAD && lying < TILT_MAX_RAD + 0.02, "{lying}");
    for _ in 0..2000 {
        ground.act(&mut plant, 0.0, &Vector3::zeros());
    }
    assert_eq!(tilt(plant.state()), lying);
}

#[test]
fn what_climbs_touches_nothing_however_its_feet_move() {
    let (mut ground, plant, _) = leaning(0.2, 0.0);
    let tipping = BodyState { angular_velocity: Vector3::new(3.0, 0.0, 0.0), ..*plant.state() };
    assert!(ground.touch(&BodyState { velocity: Vector3::z() * -0.01, ..tipping }).is_some());
    assert_eq!(ground.touch(&BodyState { velocity: Vector3::z() * 0.01, ..tipping }), None);
    assert!(!ground.stands());
}

#[test]
fn hands_take_it_off_its_foot() {
    let (mut ground, plant, _) = leaning(0.2, 0.0);
    ground.take_off_foot();
    assert_eq!((ground.stands(), ground.hold(plant.state(), &Vector3::zeros(), &Vector3::zeros())), (false, None));
    // On all its feet it stays where they leave it.
    let (mut ground, plant, _) = on_the_ground();
    ground.take_off_foot();
    assert_eq!(ground.hold(plant.state(), &Vector3::zeros(), &Vector3::zeros()), Some(*plant.state()));
}

#[test]
fn however_it_lands_no_energy_appears() {
    let (mut ground, mut plant, weight) = on_the_ground();
    let mut leant = 0.0_f64;
    for k in 0..200 {
        for _ in 0..20 + k % 90 {
            let torque = Vector3::new((k as f64).sin(), (1.7 * k as f64).cos(), 0.3) * 0.03;
            ground.act(&mut plant, weight * 1.5, &torque);
        }
        leant = leant.max(fall(&mut ground, &mut plant, weight));
        assert!(tilt(plant.state()) < 1e-9, "hop {k} ended at {}", tilt(plant.state()));
    }
    assert!(leant > 0.2, "{leant}");
}

#[test]
fn the_ground_makes_no_number_of_a_non_finite_motion() {
    let (mut ground, plant, _) = leaning(0.2, 0.0);
    let falling = BodyState { velocity: Vector3::new(0.0, 0.0, f64::NAN), ..*plant.state() };
    assert_eq!(ground.touch(&falling), None);
    for (force, torque) in [(f64::NAN, 0.0), (0.0, f64::NAN)] {
        let (mut ground, plant, _) = leaning(0.2, 0.0);
        let held = ground.hold(plant.state(), &(Vector3::z() * force), &Vector3::repeat(torque));
        assert!(held.is_some_and(|state| !state.is_finite()), "{held:?}");
    }
}
