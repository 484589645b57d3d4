//! The two Lyapunov functions of the paper's proofs, with derivatives worked out from their gradients and the equations
//! of motion (nothing simplified by hand, so that a wrong sign or gain in the law shows).
//!
//! Continuous time: V_1 falls at any z and filter states ([`position`]); V_2 falls for rate errors up to 20 rad/s, and
//! across jumps ([`attitude`]). A force error moves z_1 as well as z_2 ([`force_error`]). With inputs held at 100 Hz
//! neither is monotone: [`held_inputs`] prints how often each rises.

mod attitude;
mod force_error;
mod held_inputs;
mod position;

use crate::support::random;
use crate::support::random::ChaCha8Rng;
use controller_core::gains::Gains;
use controller_core::heading::Heading;
use controller_core::reference::{Reference, Trajectory, hover::Hover};
use controller_core::vehicle::Vehicle;
use nalgebra::Vector3;

const PERIOD_S: f64 = 0.01;

/// At the origin, at rest, pointing forward.
fn hover() -> Reference {
    Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0)
}

/// Table I on the paper's vehicle in every other case, anything else in the rest.
fn configuration(rng: &mut ChaCha8Rng, number: u32) -> (Vehicle, Gains) {
    if number.is_multiple_of(2) {
        let vehicle = random::paper_vehicle();
        (vehicle, random::paper_gains(&vehicle))
    } else {
        let vehicle = random::vehicle(rng);
        (vehicle, random::gains(rng, &vehicle))
    }
}
