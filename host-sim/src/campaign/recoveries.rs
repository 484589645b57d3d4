//! A campaign of recoveries: a certified vehicle thrown into the air in every way, in wind.
//!
//! Each flight starts anywhere within 10 m of where it is to be, at any attitude (uniform), with up to 5 m/s, 15 rad/s across and
//! 6 rad/s about its thrust axis, in wind of up to 5 m/s from any side (2.5 m/s^2 on a Hummingbird), and is to hover or, every
//! other one, to fly its file's own reference.

use super::fly_all;
use crate::flight::Flight;
use controller_core::certificate::Certificate;
use controller_core::certificate::certified::Certified;
use controller_core::error::ParameterError;
use controller_core::heading::Heading;
use controller_core::reference::hover::Hover;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use scenario::Scenario;
use scenario::body::BodyState;
use scenario::reality::drag::Drag;
use scenario::reality::wind::Wind;
use scenario::timing::Timing;
use std::sync::Arc;

/// How long a flight lasts, s.
const DURATION: f64 = 60.0;
/// How near its reference it must stay to have settled, m.
const NEAR: f64 = 0.2;
/// Room for the rounding of a wrench's components against a bound, relative.
const ROUNDING: f64 = 1e-6;

/// What one flight showed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Start minus lowest height, m.
    pub height_lost: f64,
    /// Greatest height above the start and the reference, m.
    pub rise: f64,
    /// Since when it has been near its reference, s; none if it was away at the end.
    pub settled: Option<f64>,
    /// Ticks with a command that a rotor could not follow.
    pub clipped: u64,
    /// Ticks with a thrust, torque or rotor command beyond its certified bound.
    pub beyond: u64,
}

/// Flies `count` recoveries of `scenario`, whose configuration is `certified`; the same every time.
///
/// # Errors
/// If the law refuses the scenario's period; none that was read from a file does.
pub fn recoveries(scenario: &Scenario, certified: &Certified, count: u64) -> Result<Vec<Outcome>, ParameterError> {
    let hover = Arc::new(Hover::new(Vector3::zeros(), Heading::FORWARD)?);
    let circumstances = |number| {
        let mut thrown = scenario.clone();
        if number % 2 == 0 {
            thrown.trajectory = hover.clone();
        }
        throw(&mut thrown, number);
        thrown
    };
    fly_all(Some(certified), count, circumstances, |scenario, flight| {
        outcome(scenario, flight, certified.certificate())
    })
}

/// The start and the wind of flight `number`.
fn throw(scenario: &mut Scenario, number: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(number);
    let mut ball = |radius: f64| loop {
        let v = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0));
        if v.norm() <= 1.0 {
            break v * radius;
        }
    };
    let (offset, velocity, rates, wind) = (ball(10.0), ball(5.0), ball(15.0), ball(5.0));
    let mut normal = || StandardNormal.sample(&mut random);
    let attitude = UnitQuaternion::from_quaternion(Quaternion::new(normal(), normal(), normal(), normal()));
    scenario.initial = BodyState {
        position: scenario.trajectory.at(0).position.map(f64::from) + offset,
        velocity,
        attitude: attitude.into_inner(),
        angular_velocity: Vector3::new(rates.x, rates.y, rates.z * (6.0 / 15.0)),
    };
    let mass = f64::from(scenario.configuration.vehicle().mass);
    let drag = Drag { linear: Vector3::repeat(0.5 * mass), ..Drag::default() };
    scenario.reality.drag.get_or_insert(drag);
    // The vertical estimate is for little: wind blows across.
    scenario.reality.wind = Some(Wind { steady: Vector3::new(wind.x, wind.y, 0.0), ..Wind::default() });
    scenario.timing = Timing { ticks: (DURATION / scenario.timing.period()) as u64, ..scenario.timing };
}

fn outcome(scenario: &Scenario, mut flight: Flight, certificate: &Certificate) -> Outcome {
    let start = scenario.initial.position.z;
    let mut outcome = Outcome { height_lost: 0.0, rise: f64::NEG_INFINITY, settled: Some(0.0), clipped: 0, beyond: 0 };
    let mut away = true;
    for _ in 0..scenario.timing.ticks {
        let Ok(tick) = flight.tick() else {
            return Outcome { settled: None, height_lost: f64::INFINITY, ..outcome };
        };
        let (position, wanted) = (&tick.state.position, tick.reference.position.map(f64::from));
        outcome.height_lost = outcome.height_lost.max(start - position.z);
        outcome.rise = outcome.rise.max(position.z - start.max(wanted.z));
        outcome.clipped += u64::from(tick.clipped);
        let (thrust, torque) = (f64::from(tick.wrench.thrust), tick.wrench.torque.map(|t| f64::from(t.abs())));
        let raised = 1.0 + ROUNDING;
        let rotors = tick.rotor_thrusts.iter().enumerate().all(|(rotor, asked)| {
            let asked = f64::from(*asked);
            certificate
                .rotor(rotor)
                .is_some_and(|proven| (proven.least - ROUNDING..=proven.greatest * raised).contains(&asked))
        });
        let proven = certificate.thrust();
        let within = (proven.least / raised..=proven.greatest * raised).contains(&thrust)
            && torque.iter().zip(certificate.torque().iter()).all(|(asked, proven)| *asked <= proven * raised)
            && rotors;
        outcome.beyond += u64::from(!within);
        away = (position - wanted).norm() > NEAR;
        if away {
            outcome.settled = Some((tick.time_us + scenario.timing.period_us) as f64 * 1e-6);
        }
    }
    Outcome { settled: outcome.settled.filter(|_| !away), ..outcome }
}
