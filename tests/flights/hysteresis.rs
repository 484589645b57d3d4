//! The hysteresis of the path lifting does what it is for: attitude noise at a half turn makes the law choose a way
//! round once, not again and again.

use crate::support::body::Body;
use crate::support::random;
use crate::support::random::ChaCha8Rng;
use controller_core::controller::Controller;
use controller_core::gains::{GainParameters, Gains};
use controller_core::heading::Heading;
use controller_core::reference::{Trajectory, hover::Hover};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::RngExt;

const FLIGHT_COUNT: usize = 100;
const FLIGHT_TICKS: usize = 200;
const PERIOD_S: f64 = 0.01;

/// Three independent normal numbers (Box and Muller's transform).
fn normal(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| {
        let (radius, angle): (f64, f64) = (1.0 - rng.random::<f64>(), rng.random());
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    })
}

/// How often m* changes in each of the flights of two seconds from exact half turns.
fn changes_of_sign(delta: f32) -> Vec<u32> {
    let vehicle = random::paper_vehicle();
    let gains = Gains::new(GainParameters { delta, ..GainParameters::TABLE_1 }, &vehicle).unwrap();
    let hover = Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap();
    let reference = hover.at(0);
    let mut rng = random::generator(10);
    let flight = |_| {
        // R_d is the identity at the start: the attitude is the attitude error.
        let half_turn = Quaternion::from_imag(random::direction(&mut rng).cast::<f64>().normalize());
        let mut body = Body::resting(Vector3::zeros(), half_turn);
        let mut controller = Controller::uncertified(vehicle, gains, None, PERIOD_S as f32).unwrap();
        let mut changes = 0;
        for _ in 0..FLIGHT_TICKS {
            let noise = UnitQuaternion::from_scaled_axis(normal(&mut rng) * 1.0_f64.to_radians());
            let mut state = body.state();
            state.attitude = (body.attitude * noise.into_inner()).cast();
            let before = controller.memory().lift;
            let (wrench, diagnostics) = controller.step(&state, &reference).unwrap();
            changes += u32::from(before.is_some_and(|lift| lift.sign != diagnostics.lift_sign));
            body.advance(&vehicle, &wrench, PERIOD_S, 5);
        }
        changes
    };
    (0..FLIGHT_COUNT).map(flight).collect()
}

#[test]
fn noise_at_a_half_turn_changes_the_lift_at_most_once_a_flight() {
    let changes = changes_of_sign(GainParameters::TABLE_1.delta);
    println!("delta = 0.02: {} changes in {FLIGHT_COUNT} flights", changes.iter().sum::<u32>());
    assert!(changes.iter().all(|&changes| changes <= 1), "{changes:?}");
}

#[test]
fn without_hysteresis_the_lift_chatters() {
    let total: u32 = changes_of_sign(1e-6).iter().sum();
    println!("delta = 1e-6: {total} changes in {FLIGHT_COUNT} flights");
    assert!(total > 100, "{total} changes: noise this small does not test the hysteresis");
}
