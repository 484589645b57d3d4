//! The bounds the law promises whatever happens: the filter box, exactly, and Theorem 1's thrust interval.

use crate::support::random;
use crate::support::random::ChaCha8Rng;
use controller_core::controller::{Controller, Memory};
use controller_core::error::InputError;
use controller_core::gains::Gains;
use controller_core::position::FilterState;
use controller_core::reference::Reference;
use controller_core::state::State;
use controller_core::vehicle::Vehicle;
use nalgebra::Vector3;
use rand::RngExt;

/// The greatest magnitude the law accepts in a state.
const STATE_MAX: f32 = 1e15;

/// A control period between 0.1 ms and the longest allowed.
fn period(rng: &mut ChaCha8Rng) -> f32 {
    if rng.random_bool(0.2) { 0.1 } else { random::log_uniform(rng, 1e-4, 0.1) }
}

/// Every component of `v` lies within ±`level`, to the last bit.
fn inside(v: &Vector3<f32>, level: f32) -> bool {
    v.iter().all(|component| component.abs() <= level)
}

/// Pulls `state` about: small errors, huge ones, and long stretches of the same saturated error.
fn disturb(rng: &mut ChaCha8Rng, state: &mut State, reference: &Reference) {
    let away = random::log_uniform(rng, 1e-3, STATE_MAX / 4.0);
    match rng.random_range(0..20) {
        0 => *state = random::state_around(rng, reference),
        1 => state.position = random::vector(rng, away),
        2 => state.velocity = random::vector(rng, away),
        3 => state.position = -state.position,
        _ => {}
    }
}

#[test]
fn filter_states_stay_in_their_box_to_the_last_bit() {
    const FLIGHT_TICKS: usize = 2_000;
    let mut rng = random::generator(30);
    let mut on_the_wall = 0_u32;
    for number in 0..300 {
        let vehicle = random::vehicle(&mut rng);
        let gains = random::gains(&mut rng, &vehicle);
        let mut controller = Controller::uncertified(vehicle, gains, None, period(&mut rng)).unwrap();
        let filter = FilterState {
            filtered: random::in_box(&mut rng, gains.m_p),
            intermediate: random::in_box(&mut rng, gains.m_p),
        };
        controller.restore(Memory { filter, lift: None });
        let reference = random::reference(&mut rng, &vehicle, &gains);
        let mut state = random::state_around(&mut rng, &reference);
        for tick in 0..FLIGHT_TICKS {
            disturb(&mut rng, &mut state, &reference);
            let (_, diagnostics) = controller.step(&state, &reference).unwrap();
            let FilterState { filtered, intermediate } = controller.memory().filter;
            for signal in [diagnostics.feedback, filtered, intermediate] {
                assert!(inside(&signal, gains.m_p), "run {number}, tick {tick}: {signal:?} leaves ±{}", gains.m_p);
            }
            on_the_wall += u32::from(filtered.amax() == gains.m_p);
        }
    }
    assert!(on_the_wall > 10_000, "only {on_the_wall} ticks reached the wall: the runs are not violent enough");
}

/// T_min and T_max of Theorem 1 for a reference, N, in f64.
fn thrust_interval(vehicle: &Vehicle, gains: &Gains, reference: &Reference) -> (f64, f64) {
    let (mass, gravity, m_p) = (f64::from(vehicle.mass), f64::from(vehicle.gravity), f64::from(gains.m_p));
    let a: Vector3<f64> = reference.acceleration.cast();
    let (horizontal, vertical) = (a.xy().norm(), a.z.abs());
    let least = mass * (gravity - m_p - vertical);
    let most = mass * (3.0_f64.sqrt() * m_p + horizontal.hypot(vertical + gravity));
    (least, most)
}

/// Each component one of: zero, a magnitude anywhere up to the greatest, the greatest itself.
fn any_magnitude(rng: &mut ChaCha8Rng) -> Vector3<f32> {
    Vector3::from_fn(|_, _| {
        let magnitude = match rng.random_range(0..8) {
            0 => 0.0,
            1 => STATE_MAX,
            _ => random::log_uniform(rng, 1e-30, STATE_MAX),
        };
        if rng.random_bool(0.5) { magnitude } else { -magnitude }
    })
}

#[test]
fn thrust_stays_in_theorem_1s_interval_at_any_finite_state() {
    let mut rng = random::generator(31);
    for number in 0..200_000 {
        let vehicle = random::vehicle(&mut rng);
        let gains = random::gains(&mut rng, &vehicle);
        let mut reference = random::reference(&mut rng, &vehicle, &gains);
        let mut filter = FilterState {
            filtered: random::in_box(&mut rng, gains.m_p),
            intermediate: random::in_box(&mut rng, gains.m_p),
        };
        reference.position = any_magnitude(&mut rng);
        reference.velocity = any_magnitude(&mut rng);
        if number % 8 == 0 {
            // The corners where the theorem's bounds are attained: all against gravity, or all with it.
            let (sign, lateral) = if number % 16 == 0 { (1.0, gains.m_p) } else { (-1.0, 0.0) };
            filter.filtered = Vector3::new(lateral, lateral, sign * gains.m_p);
            let along = 0.5 * (1.0 + sign) * reference.acceleration.xy().norm() * 0.5_f32.sqrt();
            reference.acceleration = Vector3::new(along, along, sign * reference.acceleration.z.abs());
        }
        let state = State {
            position: any_magnitude(&mut rng),
            velocity: any_magnitude(&mut rng),
            attitude: random::attitude(&mut rng),
            angular_velocity: any_magnitude(&mut rng),
        };
        let thrust_floor = random::thrust_floor(&mut rng, &vehicle, &gains);
        let mut controller = Controller::uncertified(vehicle, gains, thrust_floor, 0.01).unwrap();
        controller.restore(Memory { filter, lift: None });
        let (wrench, _) = controller.step(&state, &reference).unwrap();
        let (least, most) = thrust_interval(&vehicle, &gains, &reference);
        // The projection trades the lower bound for its floor.
        let least = thrust_floor.map_or(least, f64::from);
        // u is a sum of three terms and T a rounded norm of it: four roundings of the largest magnitude.
        let rounding = 4.0 / 16_777_216.0 * most;
        let thrust = f64::from(wrench.thrust);
        assert!(
            (least - rounding..=most + rounding).contains(&thrust),
            "case {number}: thrust {thrust} N outside [{least}, {most}]\n{state:?}\n{reference:?}"
        );
        assert!(wrench.torque.iter().all(|torque| torque.is_finite()), "case {number}: {:?}", wrench.torque);
        assert!(inside(&controller.memory().filter.intermediate, gains.m_p));
    }
}

#[test]
fn a_state_beyond_the_greatest_magnitude_is_a_typed_error() {
    let vehicle = random::paper_vehicle();
    let gains = random::paper_gains(&vehicle);
    let mut rng = random::generator(32);
    for _ in 0..10_000 {
        let reference = random::reference(&mut rng, &vehicle, &gains);
        let mut state = random::state_around(&mut rng, &reference);
        let beyond = random::log_uniform(&mut rng, 1.000_001 * STATE_MAX, f32::MAX);
        let (axis, sign) = (rng.random_range(0..3), if rng.random_bool(0.5) { 1.0 } else { -1.0 });
        let (vector, field) = match rng.random_range(0..3) {
            0 => (&mut state.position, "state.position"),
            1 => (&mut state.velocity, "state.velocity"),
            _ => (&mut state.angular_velocity, "state.angular_velocity"),
        };
        vector[axis] = sign * beyond;
        let mut controller = Controller::uncertified(vehicle, gains, None, 0.01).unwrap();
        assert_eq!(controller.step(&state, &reference).unwrap_err(), InputError::OutOfRange { field });
    }
}
