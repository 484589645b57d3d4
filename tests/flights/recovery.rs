//! The whole loop, six degrees of freedom at 100 Hz: from any attitude and spin the vehicle rights itself in time.

use crate::support::body::Body;
use crate::support::random;
use controller_core::controller::Controller;
use controller_core::reference::{Trajectory, hover::Hover};
use nalgebra::{Quaternion, Vector3};
use rand::RngExt;

/// The body takes five Runge-Kutta steps in it (0.04 rad each at 20 rad/s).
const PERIOD_S: f64 = 0.01;

/// When the attitude error must be small, and until when it must stay so.
const SETTLED_TICKS: usize = 600;
const WATCHED_TICKS: usize = 1000;

#[test]
fn a_thousand_random_attitudes_and_spins_settle_within_six_seconds() {
    let vehicle = random::paper_vehicle();
    let gains = random::paper_gains(&vehicle);
    let mut rng = random::generator(20);
    let mut slowest = 0;
    for number in 0..1000_u32 {
        let hover = Hover::new(Vector3::zeros(), random::heading_at_rest(&mut rng)).unwrap();
        let reference = hover.at(0);
        let nu = reference.heading.direction();
        let heading = Quaternion::new(f64::from(1.0 + nu.x), 0.0, 0.0, f64::from(nu.y));
        // Exact half turns from the desired attitude in one of four.
        let half_turn = number % 4 == 0 && heading.norm() > 1e-3;
        let attitude = if half_turn {
            heading.normalize() * Quaternion::from_imag(random::direction(&mut rng).cast::<f64>().normalize())
        } else {
            random::attitude(&mut rng).cast::<f64>().normalize()
        };
        let mut body = Body::resting(Vector3::zeros(), attitude);
        if !number.is_multiple_of(8) {
            let spin = rng.random_range(0.0..20.0);
            body.angular_velocity = random::direction(&mut rng).cast::<f64>() * spin;
        }
        let mut controller = Controller::uncertified(vehicle, gains, None, PERIOD_S as f32).unwrap();
        let mut last_large = 0;
        for tick in 0..WATCHED_TICKS {
            let (wrench, diagnostics) = controller.step(&body.state(), &reference).unwrap();
            if diagnostics.mrp.norm() >= 0.01 {
                last_large = tick;
            }
            body.advance(&vehicle, &wrench, PERIOD_S, 5);
        }
        assert!(last_large < SETTLED_TICKS, "flight {number}: MRP error above 0.01 at {last_large} ticks");
        slowest = slowest.max(last_large);
    }
    println!("slowest of 1000 flights: MRP error below 0.01 for good after {:.2} s", PERIOD_S * (slowest + 1) as f64);
}
