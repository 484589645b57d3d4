//! A campaign of recoveries: a certified vehicle thrown into the air in every way, in wind, its state known.
//!
//! Each flight starts anywhere within 10 m of where it is to be, at any attitude (uniform), with up to 5 m/s, 15 rad/s
//! across and 6 rad/s about its thrust axis, in wind of up to 5 m/s from any side (2.5 m/s^2 on a Hummingbird), and is
//! to hover or, every other one, to fly its file's own reference.

use super::draw::circumstances;
use super::fly_all;
use super::outcome::Outcome;
use controller_core::certificate::certified::Certified;
use controller_core::error::ParameterError;
use scenario::Scenario;
use scenario::campaign::{Asked, ModelRanges, NoiseRanges, Ranges};

/// What is drawn.
const RANGES: Ranges = Ranges {
    duration: 60.0,
    reference: Asked::InTurn,
    attitude: true,
    offset: 10.0,
    velocity: 5.0,
    rate: 15.0,
    yaw_rate: 6.0,
    wind: 5.0,
    gust: 0.0,
    turbulence: 0.0,
    noise: NoiseRanges { gyro: 0.0, position: 0.0, attitude: 0.0, delay: 0.0 },
    model: ModelRanges { mass: 0.0, inertia: 0.0, centre_of_mass: 0.0, thrust_scale: 0.0, rotor_scales: 0.0 },
};

/// Flies `count` recoveries of `scenario`, whose configuration is `certified`; the same every time.
///
/// # Errors
/// If the law refuses the scenario's period; none that was read from a file does.
pub fn recoveries(scenario: &Scenario, certified: &Certified, count: u64) -> Result<Vec<Outcome>, ParameterError> {
    let thrown = |number| circumstances(scenario, &RANGES, 0, number);
    fly_all(Some(certified), count, thrown, |scenario, flight| Outcome::of(scenario, flight, certified.certificate()))
}
