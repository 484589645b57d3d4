//! A rotor that fails under the whole pilot, on sensors as they are: IMU with noise, poses 20 ms late, motor commands.
//! The vehicle says which rotor it is, turns, comes down by itself or where it is told, lands softly, and does not arm
//! again.
//!
//! `cargo test -p host-sim rotor_loss -- --nocapture` prints the figures that stand in `docs/rotor-loss.md`.

use crate::support::extended;
use controller_core::allocation::remaining::LostRotor;
use controller_core::certificate::certified::Certified;
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use flight::{FlightSettings, Inputs, Mode, Output, Pose, Reason, Refusal, Request, Stamped};
use nalgebra::Vector3;
use verification::piloted::{Meddler, PilotedVehicle, Place, PoseMeasurement};

/// When it gets which command, ticks of 10 ms, and when it is watched no longer.
const ARM_TICK: u64 = 200;
const TAKE_OFF_TICK: u64 = 220;
const END_TICK: u64 = 6_000;

/// How high it flies, m.
const HOVER_HEIGHT: f32 = 3.0;

/// Where a rotor fails.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Climbing,
    Holding,
    UnderWay,
    Landing,
    WithoutPose,
}

impl Phase {
    const ALL: [Self; 5] = [Self::Climbing, Self::Holding, Self::UnderWay, Self::Landing, Self::WithoutPose];

    /// Whether it is reached, in a mode that has lasted for so many ticks, m high.
    fn is_reached(self, mode: Mode, lasts: u64, height: f64) -> bool {
        match self {
            Self::Climbing => mode == Mode::TakingOff && height > 0.5 * f64::from(HOVER_HEIGHT),
            Self::Holding => mode == Mode::Holding && lasts == 100,
            Self::UnderWay => mode == Mode::Holding && lasts == 110,
            Self::Landing => mode == Mode::Landing && lasts == 100,
            Self::WithoutPose => mode == Mode::Descending && lasts == 130,
        }
    }

    /// What leads there.
    fn request(self, mode: Mode, lasts: u64) -> Option<Request> {
        match self {
            Self::Landing if mode == Mode::Holding && lasts == 50 => Some(Request::Land),
            Self::UnderWay if mode == Mode::Holding && lasts == 50 => Some(go_to([5.0, 0.0, HOVER_HEIGHT])),
            _ => None,
        }
    }
}

fn go_to(place: [f32; 3]) -> Request {
    Request::GoTo(Setpoint { motion: Motion::Position(place.into()), turn: HeadingSetpoint::Keep })
}

/// Poses, or none.
struct Poses(bool);

impl Meddler for Poses {
    fn pose(&mut self, pose: Stamped<Pose>, _: u64) -> Option<Stamped<PoseMeasurement>> {
        self.0.then(|| Stamped { value: PoseMeasurement::new(&pose.value), time: pose.time })
    }
}

/// What a flight came to, from the failure on.
#[derive(Debug, Default)]
struct Flown {
    /// What was said of the rotor, and how long after it had failed, s.
    found: Option<(LostRotor, f64)>,
    /// The greatest distance across from where it failed, m.
    farthest: f64,
    /// How far below that it fell in the first two seconds, m.
    fell: f64,
    /// Where it stands, m; the hardest touch, m/s; how long after the failure its motors stood still, s.
    stands: Option<Vector3<f64>>,
    touch: f64,
    down: f64,
    /// The fastest turn, rad/s.
    turned: f64,
    reasons: Vec<Reason>,
    /// Answers to what was asked after the failure, and to arming after the landing.
    answers: Vec<Result<(), Refusal>>,
    arming: Option<Result<(), Refusal>>,
}

/// A vehicle in a phase, a rotor with what it has left, and what is asked a second after it has failed.
struct Case<'a> {
    vehicle: &'a str,
    phase: Phase,
    lost: LostRotor,
    asked: Option<Request>,
}

fn fly(case: &Case) -> Flown {
    let published = extended::published();
    let scenario = published.into_iter().find(|one| one.name == case.vehicle);
    let scenario = scenario.unwrap_or_else(|| extended::vehicle(case.vehicle));
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let mut place = Place::new(&scenario.configuration);
    let settings = FlightSettings::DEFAULT;
    let mut vehicle = PilotedVehicle::new(&scenario, Ok(&certified), &settings, &mut place, 0).unwrap();
    let mut flown = Flown::default();
    let (mut failed, mut from, mut poses) = (None::<u64>, Vector3::zeros(), Poses(true));
    let (mut mode, mut lasts) = (Mode::Boot, 0);
    for tick in 1..END_TICK {
        let since = failed.map(|failed| tick - failed);
        let request = match tick {
            ARM_TICK => Some(Request::Arm),
            TAKE_OFF_TICK => Some(Request::TakeOff(Some(HOVER_HEIGHT))),
            _ if flown.stands.is_some() => Some(Request::Arm),
            _ if since == Some(100) => case.asked,
            _ => case.phase.request(mode, lasts),
        };
        let ground_station = Some(vehicle.now() + vehicle.pilot().period());
        let given = Inputs { request, ground_station, ..Inputs::default() };
        poses.0 &= case.phase != Phase::WithoutPose || mode != Mode::Holding || lasts < 50;
        let (outcome, _) = vehicle.tick(&given, &mut poses).unwrap();
        lasts = if outcome.mode == mode { lasts + 1 } else { 0 };
        mode = outcome.mode;
        let state = *vehicle.vehicle().state();
        if failed.is_none() && case.phase.is_reached(mode, lasts, state.position.z) {
            failed = Some(tick);
            from = state.position;
            vehicle.weaken(case.lost.rotor, case.lost.left);
        }
        let Some(failed) = failed else { continue };
        let time = (tick - failed) as f64 * 0.01;
        if flown.stands.is_some() {
            flown.arming = outcome.answer;
            break;
        }
        flown.reasons.extend(outcome.transition.map(|transition| transition.reason));
        // What slides over the ground may be felt before it counts as landed; nothing stops in the air.
        assert!(outcome.mode != Mode::Stopped || state.position.z < 0.05, "{outcome:?} at {}", state.position);
        flown.answers.extend(outcome.answer.filter(|_| since == Some(100)));
        flown.found = flown.found.or(outcome.lost.map(|lost| (lost, time)));
        flown.farthest = flown.farthest.max((state.position - from).xy().norm());
        flown.turned = flown.turned.max(state.angular_velocity.z.abs());
        if time < 2.0 {
            flown.fell = flown.fell.max(from.z - state.position.z);
        }
        let touchdown = vehicle.vehicle_mut().take_touchdown();
        flown.touch = flown.touch.max(touchdown.map_or(0.0, |touchdown| touchdown.speed));
        if vehicle.vehicle().stands() && outcome.output == Output::Stop {
            (flown.stands, flown.down) = (Some(state.position), time);
        }
    }
    flown
}

fn holding(vehicle: &str, asked: Option<Request>) -> Flown {
    fly(&Case { vehicle, phase: Phase::Holding, lost: LostRotor { rotor: 2, left: 0.0 }, asked })
}

#[test]
fn a_vehicle_without_a_rotor_lands_softly_from_every_phase() {
    println!("| vehicle | when | rotor; left | found, ms | fell; farthest, m | turned, rad/s | touch, m/s; s after |");
    println!("|---|---|---|---|---|---|---|");
    for vehicle in ["hummingbird", "pelican", "flightmare"] {
        for phase in Phase::ALL {
            for lost in [(0, 0.0), (2, 0.0), (1, 0.3), (3, 0.6)].map(|(rotor, left)| LostRotor { rotor, left }) {
                let flown = fly(&Case { vehicle, phase, lost, asked: None });
                let (found, late) = flown.found.map_or((None, f64::NAN), |(lost, late)| (Some(lost), late));
                println!(
                    "| {vehicle} | {phase:?} | {}; {:.1} | {:.0} | {:.2}; {:.2} | {:.1} | {:.2}; {:.1} |",
                    lost.rotor + 1,
                    lost.left,
                    1e3 * late,
                    flown.fell,
                    flown.farthest,
                    flown.turned,
                    flown.touch,
                    flown.down
                );
                let what = format!("{vehicle} {phase:?} {lost:?}: {flown:?}");
                let is_it = |found: LostRotor| found.rotor == lost.rotor && (found.left - lost.left).abs() < 0.15;
                // What has lost less than half may go on unfound without a pose.
                let may_go_on = phase == Phase::WithoutPose && lost.left > 0.5;
                assert!(found.map_or(may_go_on, is_it), "{what}");
                assert!(lost.left > 0.0 || late <= 0.1, "{what}");
                assert!(flown.stands.is_some() && flown.touch < 1.0, "{what}");
                let last = flown.reasons.last();
                let stops = phase == Phase::WithoutPose && last == Some(&Reason::ImuDoubtful);
                assert!(last == Some(&Reason::Landed) || stops, "{what}");
                let refused = if stops { Refusal::Stopped } else { Refusal::RotorLost };
                assert!(flown.arming == Some(Err(refused)) || found.is_none(), "{what}");
                // Without a pose nothing holds it in its place.
                let (fell, farthest) = if phase == Phase::WithoutPose { (3.0, 13.0) } else { (2.0, 3.0) };
                assert!(flown.fell < fell && flown.farthest < farthest, "{what}");
                let guided = !matches!(phase, Phase::Landing | Phase::WithoutPose);
                assert_eq!(guided && found.is_some(), flown.reasons.contains(&Reason::RotorLost), "{what}");
            }
        }
    }
}

#[test]
fn told_where_it_flies_there_turning_and_lands_there() {
    let flown = holding("hummingbird", Some(go_to([3.0, -2.0, 2.0])));
    assert_eq!(flown.answers, [Ok(())]);
    let stands = flown.stands.unwrap();
    assert!((stands.xy() - Vector3::new(3.0, -2.0, 0.0).xy()).norm() < 0.2, "{flown:?}");
    assert_eq!(flown.reasons, [Reason::RotorLost, Reason::HoldCommanded, Reason::RotorLost, Reason::Landed]);
    assert!(flown.touch < 1.0, "{flown:?}");
}

#[test]
fn it_does_not_hold_for_good_nor_fly_setpoints_but_the_pilot_may_stop_it() {
    assert_eq!(holding("hummingbird", Some(Request::Hold)).answers, [Err(Refusal::MustLand)]);
    assert_eq!(holding("hummingbird", Some(Request::FlySetpoints)).answers, [Err(Refusal::Landing)]);
    assert_eq!(holding("hummingbird", Some(Request::Disarm)).answers, [Err(Refusal::InTheAir)]);
}
