//! What sampling at 100 Hz costs: along flights with inputs held between ticks V_1 and V_2 need not fall at every
//! sample. Prints how often each rises where the law rather than rounding or the tracking of a moving reference
//! decides.

use super::attitude::{Weights, random_rate_error};
use super::position::{Translation, random_translation};
use super::{PERIOD_S, hover};
use crate::support::body::Body;
use crate::support::oracle::Law;
use crate::support::random;
use controller_core::controller::Controller;
use nalgebra::Vector3;

/// Below this, in m^2/s^3 or J, single precision rather than the law decides which way a Lyapunov function goes.
const ROUNDING_FLOOR: f64 = 1e-9;

#[test]
fn v_1_seldom_rises_with_inputs_held_at_100_hz() {
    // A minute: 30 m and 30 m/s away, braking at M_p takes half of it.
    const FLIGHT_TICKS: u32 = 6_000;
    let vehicle = random::paper_vehicle();
    let gains = random::paper_gains(&vehicle);
    let law = Law::new(&vehicle, &gains);
    let mut rng = random::generator(73);
    let (mut rises, mut samples) = (0_u32, 0_u32);
    for _ in 0..400 {
        let mut x = random_translation(&mut rng, &law, 30.0);
        let mut controller = Controller::uncertified(vehicle, gains, None, PERIOD_S as f32).unwrap();
        let mut before = x.v_1(&law);
        for _ in 0..FLIGHT_TICKS {
            if before < ROUNDING_FLOOR {
                break;
            }
            let feedback = x.tick(&mut controller);
            // Midpoint steps of the error dynamics with the thrust where it should be; 20 of them in a tick.
            let h = PERIOD_S / 20.0;
            for _ in 0..20 {
                let along = |h: f64, k: [Vector3<f64>; 4]| Translation(std::array::from_fn(|i| x.0[i] + h * k[i]));
                x = along(h, along(h / 2.0, x.flow(&law, feedback)).flow(&law, feedback));
            }
            let now = x.v_1(&law);
            rises += u32::from(now > before);
            samples += 1;
            before = now;
        }
    }
    println!("inputs held at 100 Hz, thrust along u: V_1 rises in {rises} of {samples} samples");
    assert!(rises < samples / 1000);
}

#[test]
fn v_2_seldom_rises_with_inputs_held_at_100_hz() {
    const FLIGHT_TICKS: u32 = 600;
    let vehicle = random::paper_vehicle();
    let gains = random::paper_gains(&vehicle);
    let law = Law::new(&vehicle, &gains);
    let weights = Weights::sufficient(&law);
    let mut rng = random::generator(74);
    // Violent samples, rises of V_1 and of V_2 there: first from rest at the reference, then from far and fast.
    let mut counts = [[0_u32; 3]; 2];
    for number in 0..1_000 {
        let [samples, rises_1, rises_2] = &mut counts[number % 2];
        let mut body = Body::resting(Vector3::zeros(), random::attitude(&mut rng).cast().normalize());
        body.angular_velocity = random_rate_error(&mut rng);
        if number % 2 == 1 {
            body.position = random::vector(&mut rng, 20.0).cast();
            body.velocity = random::vector(&mut rng, 10.0).cast();
        }
        let mut controller = Controller::uncertified(vehicle, gains, None, PERIOD_S as f32).unwrap();
        let (mut v_1, mut v_2, mut violent) = (f64::INFINITY, f64::INFINITY, true);
        for _ in 0..FLIGHT_TICKS {
            let (wrench, d) = controller.step(&body.state(), &hover()).unwrap();
            let errors = [d.position_error, d.velocity_error, d.filtered, d.intermediate];
            let now = Translation(errors.map(|v| v.cast())).v_1(&law);
            *samples += u32::from(violent);
            *rises_1 += u32::from(violent && now > v_1);
            v_1 = now;
            let now = weights.v_2(&law, d.mrp.cast(), d.angular_velocity_error.cast());
            *rises_2 += u32::from(violent && now > v_2);
            v_2 = now;
            violent = d.mrp.norm() > 0.05 || d.angular_velocity_error.norm() > 0.5;
            body.advance(&vehicle, &wrench, PERIOD_S, 5);
        }
    }
    for (from, [samples, rises_1, rises_2]) in ["rest at the reference", "far and fast"].iter().zip(counts) {
        println!(
            "inputs held at 100 Hz, whole loop from any attitude and spin, {from}: V_2 rises in {rises_2} of {samples} \
             violent samples, V_1 (which the attitude error drives) in {rises_1}"
        );
        assert!(rises_2 < samples / 500);
    }
}
