//! An input the law cannot use: a typed error that names the field, the memory untouched, and a controller that goes on
//! as if it had never seen it.

use crate::support::random;
use crate::support::random::ChaCha8Rng;
use controller_core::controller::Controller;
use controller_core::error::InputError;
use controller_core::heading::Heading;
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};
use nalgebra::{Quaternion, Vector2, Vector3};
use rand::RngExt;

/// A number no sensor should report, with the error it must earn in a vector named `field`.
fn bad_number(rng: &mut ChaCha8Rng, field: &'static str) -> (f32, InputError) {
    match rng.random_range(0..4) {
        0 => (f32::NAN, InputError::NotFinite { field }),
        1 => (f32::INFINITY, InputError::NotFinite { field }),
        2 => (f32::NEG_INFINITY, InputError::NotFinite { field }),
        _ => (f32::MAX, InputError::OutOfRange { field }),
    }
}

/// Spoils one component of one field, and says how the law must refuse it.
fn spoil(rng: &mut ChaCha8Rng, state: &mut State, reference: &mut Reference, m_p_minus_g: f32) -> InputError {
    let axis = rng.random_range(0..3);
    let vectors: [(&mut Vector3<f32>, &'static str); 8] = [
        (&mut state.position, "state.position"),
        (&mut state.velocity, "state.velocity"),
        (&mut state.angular_velocity, "state.angular_velocity"),
        (&mut reference.position, "reference.position"),
        (&mut reference.velocity, "reference.velocity"),
        (&mut reference.acceleration, "reference.acceleration"),
        (&mut reference.jerk, "reference.jerk"),
        (&mut reference.snap, "reference.snap"),
    ];
    let choice = rng.random_range(0..12);
    if let Some((vector, field)) = vectors.into_iter().nth(choice) {
        let (number, error) = bad_number(rng, field);
        vector[axis] = number;
        return error;
    }
    let field = "state.attitude";
    match choice {
        8 => {
            let component = rng.random_range(0..4);
            state.attitude.coords[component] = if rng.random_bool(0.5) { f32::NAN } else { f32::INFINITY };
            InputError::NotFinite { field }
        }
        9 => {
            // Too long or too short to be a rotation; now and then no direction at all.
            let scale = [0.0, 1e-30, 0.998_9, 1.001_1, 1e30][rng.random_range(0..5)];
            state.attitude = Quaternion::from(state.attitude.coords * scale);
            InputError::NotARotation { field }
        }
        10 => {
            let (rate, acceleration) = if rng.random_bool(0.5) { (1e30, 0.0) } else { (0.0, -1e30) };
            reference.heading = Heading::new(Vector2::new(0.6, 0.8), rate, acceleration).unwrap();
            InputError::OutOfRange { field: "reference.heading" }
        }
        _ => {
            reference.acceleration.z = m_p_minus_g * rng.random_range(1.0..3.0);
            InputError::FallsTooFast
        }
    }
}

/// The bits of a wrench.
fn bits(wrench: &Wrench) -> [u32; 4] {
    [wrench.thrust, wrench.torque.x, wrench.torque.y, wrench.torque.z].map(f32::to_bits)
}

#[test]
fn a_bad_input_names_its_field_and_leaves_no_trace() {
    let mut rng = random::generator(40);
    for _ in 0..200 {
        let vehicle = random::vehicle(&mut rng);
        let gains = random::gains(&mut rng, &vehicle);
        let mut disturbed = Controller::uncertified(vehicle, gains, None, 0.01).unwrap();
        let mut spared = disturbed.clone();
        let mut reference = random::reference(&mut rng, &vehicle, &gains);
        let mut state = random::state_around(&mut rng, &reference);
        for tick in 0..100 {
            if rng.random_bool(0.1) {
                reference = random::reference(&mut rng, &vehicle, &gains);
            }
            state = State { attitude: random::attitude(&mut rng), ..state };
            // The very first input may be a bad one too.
            if rng.random_bool(0.5) {
                let (mut bad_state, mut bad_reference) = (state, reference);
                let expected = spoil(&mut rng, &mut bad_state, &mut bad_reference, gains.m_p - vehicle.gravity);
                let before = disturbed.memory();
                let error = disturbed.step(&bad_state, &bad_reference).unwrap_err();
                assert_eq!(error, expected, "tick {tick}: {bad_state:?} {bad_reference:?}");
                assert_eq!(disturbed.memory(), before, "tick {tick}: the memory changed");
            }
            let (wrench, _) = disturbed.step(&state, &reference).unwrap();
            let (spared_wrench, _) = spared.step(&state, &reference).unwrap();
            assert_eq!(bits(&wrench), bits(&spared_wrench), "tick {tick}");
            assert_eq!(disturbed.memory(), spared.memory(), "tick {tick}");
        }
    }
}
