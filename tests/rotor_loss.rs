//! A rotor that fails under the whole pilot, on sensors as they are: IMU with noise, poses 20 ms late, motor commands.
//! The vehicle says which rotor it is, turns, comes down by itself, lands softly near where it was, and does not arm
//! again.
//!
//! `cargo test -p host-sim rotor_loss -- --nocapture` prints the figures that stand in `docs/rotor-loss.md`.

use crate::support::extended;
use controller_core::allocation::remaining::Lost;
use controller_core::certificate::certified::Certified;
use controller_core::governor::{Motion, Setpoint, Turn};
use flight::{FlightSettings, Inputs, Mode, Output, Reason, Request};
use nalgebra::Vector3;
use verification::piloted::{PilotedVehicle, Place, Undisturbed};

/// When it gets which command, ticks of 10 ms.
const ARM: u64 = 200;
const TAKE_OFF: u64 = 220;

/// How high it flies, m.
const HEIGHT: f32 = 3.0;

/// Where a rotor fails.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Climbing,
    Holding,
    Moving,
    Landing,
    Descending,
}

/// What a flight came to.
#[derive(Debug)]
struct Flown {
    /// What was said of the rotor, and how long after it had failed, s.
    found: Option<(Lost, f64)>,
    /// Greatest distance from where it was to be, across, m; and height lost, m.
    farthest: f64,
    lost: f64,
    /// Where it stands, m from where the rotor failed, across; and the hardest touch, m/s.
    place: f64,
    touch: f64,
    /// How long after the failure it stood with its motors off, s.
    down: Option<f64>,
    turned: f64,
    reasons: Vec<Reason>,
    answer: Option<Result<(), flight::Refusal>>,
}

fn fly(name: &str, phase: Phase, rotor: usize, left: f32, told: Option<[f32; 3]>) -> Flown {
    let published = extended::published();
    let scenario = published.into_iter().find(|one| one.name == name).unwrap_or_else(|| extended::vehicle(name));
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let mut place = Place::new(&scenario.configuration);
    let settings = FlightSettings::DEFAULT;
    let mut vehicle = PilotedVehicle::new(&scenario, Ok(&certified), &settings, &mut place, 0).unwrap();
    let mut flown = Flown {
        found: None,
        farthest: 0.0,
        lost: 0.0,
        place: 0.0,
        touch: 0.0,
        down: None,
        turned: 0.0,
        reasons: Vec::new(),
        answer: None,
    };
    let (mut failed, mut since, mut from) = (None, 0, Vector3::zeros());
    let mut mode = Mode::Boot;
    for tick in 1..6_000 {
        let request = match tick {
            ARM => Some(Request::Arm),
            TAKE_OFF => Some(Request::TakeOff(Some(HEIGHT))),
            _ if phase == Phase::Landing && mode == Mode::Holding && since == 50 => Some(Request::Land),
            _ if phase == Phase::Moving && mode == Mode::Holding && since == 50 => Some(Request::GoTo(Setpoint {
                motion: Motion::Position(Vector3::new(5.0, 0.0, HEIGHT)),
                turn: Turn::Keep,
            })),
            _ if failed.is_some_and(|failed: u64| tick == failed + 100) => {
                told.map(|place| Request::GoTo(Setpoint { motion: Motion::Position(place.into()), turn: Turn::Keep }))
            }
            _ if flown.down.is_some() => Some(Request::Arm),
            _ => None,
        };
        let given =
            Inputs { request, ground_station: Some(vehicle.now() + vehicle.pilot().period()), ..Inputs::default() };
        let poses = failed.is_none() && (phase != Phase::Descending || mode != Mode::Holding || since < 50);
        let (outcome, _) = if poses || phase != Phase::Descending {
            vehicle.tick(&given, &mut Undisturbed)
        } else {
            vehicle.tick(&given, &mut Blind)
        }
        .unwrap();
        since = if outcome.mode == mode { since + 1 } else { 0 };
        mode = outcome.mode;
        let state = *vehicle.vehicle().state();
        let reached = match phase {
            Phase::Climbing => mode == Mode::TakingOff && state.position.z > 0.5 * f64::from(HEIGHT),
            Phase::Holding => mode == Mode::Holding && since == 100,
            Phase::Moving => mode == Mode::Holding && since == 110,
            Phase::Landing => mode == Mode::Landing && since == 100,
            Phase::Descending => mode == Mode::Descending && since == 130,
        };
        if reached && failed.is_none() {
            failed = Some(tick);
            from = state.position;
            vehicle.weaken(rotor, left);
        }
        let Some(failed) = failed else { continue };
        let time = (tick - failed) as f64 * 0.01;
        flown.reasons.extend(outcome.transition.map(|transition| transition.reason));
        flown.found = flown.found.or(outcome.lost.map(|lost| (lost, time)));
        if std::env::var("TRACE").is_ok() && (state.position.z < 0.15 || tick % 50 == 0 || outcome.transition.is_some())
        {
            println!(
                "{time:.2} {mode:?} z {:.3} xy {:.2} {:.2} v {:.2?} w {:.1?} up {:.2} ref z {:.2} est err {:.3} pose {:?} out {:?} stands {}",
                state.position.z,
                state.position.x,
                state.position.y,
                state.velocity.as_slice(),
                state.angular_velocity.as_slice(),
                (nalgebra::UnitQuaternion::new_unchecked(state.attitude) * Vector3::z()).z,
                outcome.flown.as_ref().map_or(f32::NAN, |f| f.as_ref().map_or(f32::NAN, |f| f.reference.position.z)),
                outcome.estimated.map_or(9.9, |e| (e.state.position.cast::<f64>() - state.position).norm()),
                outcome.pose,
                outcome.output,
                vehicle.vehicle().stands()
            );
        }
        flown.farthest = flown.farthest.max((state.position - from).xy().norm());
        flown.lost = flown.lost.max(from.z - state.position.z);
        flown.turned = flown.turned.max(state.angular_velocity.z.abs());
        if let Some(touchdown) = vehicle.vehicle_mut().take_touchdown() {
            flown.touch = flown.touch.max(touchdown.speed);
        }
        if flown.down.is_some() {
            flown.answer = outcome.answer;
            break;
        }
        if vehicle.vehicle().stands() && outcome.output == Output::Stop {
            flown.down = Some(time);
            flown.place = (state.position - from).xy().norm();
        }
    }
    flown
}

/// No poses.
struct Blind;

impl verification::piloted::Meddler for Blind {
    fn pose(
        &mut self,
        _: flight::Stamped<flight::Pose>,
        _: u64,
    ) -> Option<flight::Stamped<estimation::estimator::PoseMeasurement>> {
        None
    }
}

#[test]
fn a_vehicle_without_a_rotor_lands_softly_where_it_was_from_every_phase() {
    for name in std::env::var("NAMES").as_deref().unwrap_or("hummingbird,pelican,study").split(',') {
        for phase in if std::env::var("TRACE").is_ok() {
            vec![Phase::Holding]
        } else {
            vec![Phase::Climbing, Phase::Holding, Phase::Moving, Phase::Landing, Phase::Descending]
        } {
            for (rotor, left) in if std::env::var("TRACE").is_ok() {
                vec![(0, 0.0)]
            } else {
                vec![(0, 0.0), (2, 0.0), (1, 0.3), (3, 0.6)]
            } {
                let flown = fly(name, phase, rotor, left, None);
                println!("{name} {phase:?} rotor {} left {left}: {flown:?}", rotor + 1);
            }
        }
    }
}
