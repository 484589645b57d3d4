//! What takes over a flight brakes from the vehicle's motion within what braking needs: the whole pilot on a simulated
//! vehicle, on honest poses.
//!
//! `cargo test -p host-sim braking -- --nocapture` prints the figures.

use controller_core::certificate::certified::Certified;
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use flight::{Battery, FlightSettings, Inputs, Mode, Reason, Request, Transition};
use nalgebra::{UnitQuaternion, Vector3};
use rayon::prelude::*;
use scenario::Scenario;
use verification::piloted::{PilotedVehicle, Place, Undisturbed};

/// How far a landing may climb on, m: the extended law from a take-off to 10 m; and the paper's law, whose filters
/// answer 1.6 s late, from one to 3 m.
const CLIMBS_ON_MAX: f64 = 0.5;
const CLIMBS_ON_MAX_PAPER: f64 = 0.9;

/// What a file of a vehicle under the paper's law is called.
const PAPER: &str = "hummingbird-paper-law";

/// How much farther than braking needs a vehicle may go, times, and besides, m: the law answers late.
const FARTHER_MAX: (f64, f64) = (1.1, 0.3);

/// The vehicles' greatest acceleration across of a reference and its jerk, and how they brake along the vertical, m/s^2
/// and m/s^3.
const LEVEL_BOUNDS: (f64, f64) = (2.4675, 3.876);
const VERTICAL_BOUNDS: (f64, f64) = (4.0, 40.0);

/// A slower vehicle has stopped.
const STOPPED_M_PER_S: f64 = 0.05;

/// A fast flight for which there is room.
const FLIGHT_SETTINGS: FlightSettings =
    FlightSettings { fence_radius: 1_000.0, fence_height: 100.0, ..FlightSettings::DEFAULT };

/// When the operator arms, and lets it fly.
const ARM_TICK: u64 = 250;
const GO_TICK: u64 = 300;

/// For how long a flight on setpoints climbs to 5 m.
const CLIMB_TICKS: u64 = 1_000;

fn certified(name: &str) -> (Scenario, Certified) {
    let file = format!("{}/../vehicles/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let scenario = Scenario::parse(&std::fs::read_to_string(file).unwrap(), name).unwrap();
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    (scenario, certified)
}

/// What became of a vehicle that was interrupted.
#[derive(Debug, Clone, Copy)]
struct Stop {
    /// Its velocity when it was, m/s.
    from: Vector3<f64>,
    /// Where it ended, and how far up it went, from where it was, m.
    way: Vector3<f64>,
    rose: f64,
    /// By how much it came back, m.
    back: f64,
    /// How long it took until it had stopped, s.
    time: f64,
    /// The greatest tilt, degrees.
    tilt: f64,
}

/// What takes over: it is told whether it begins in this tick.
type TakeOver = fn(&mut Inputs, bool);

const LAND: TakeOver = |inputs, begins| inputs.request = begins.then_some(Request::Land).or(inputs.request);
const HOLD: TakeOver = |inputs, begins| inputs.request = begins.then_some(Request::Hold).or(inputs.request);

/// Lets a vehicle `begin` a flight, on setpoints of a velocity or without, until something takes over once it is `due`,
/// by the ticks since the beginning and its velocity.
fn interrupted(
    (scenario, certified): &(Scenario, Certified),
    begin: Request,
    setpoint: Option<Vector3<f32>>,
    take_over: TakeOver,
    due: impl Fn(u64, Vector3<f64>) -> bool,
) -> Stop {
    let mut place = Place::new(&scenario.configuration);
    let mut vehicle = PilotedVehicle::new(scenario, Ok(certified), &FLIGHT_SETTINGS, &mut place, 0).unwrap();
    let (mut is_due, mut begun) = (false, None::<(u64, Vector3<f64>)>);
    let nothing = Vector3::zeros();
    let mut stop = Stop { from: nothing, way: nothing, rose: 0.0, back: 0.0, time: 0.0, tilt: 0.0 };
    let (mut farthest, mut still) = (0.0_f64, 0);
    for tick in 0..6_000_u64 {
        let was_due = is_due;
        is_due |= tick > GO_TICK && due(tick - GO_TICK, vehicle.vehicle().state().velocity);
        let motion = match setpoint {
            Some(velocity) if tick >= GO_TICK + CLIMB_TICKS => Motion::Velocity(velocity),
            _ => Motion::Position(Vector3::z() * 5.0),
        };
        let mut given = Inputs {
            ground_station: Some(vehicle.now()),
            request: [(ARM_TICK, Request::Arm), (GO_TICK, begin)]
                .into_iter()
                .find(|(at, _)| *at == tick)
                .map(|(_, it)| it),
            setpoint: (setpoint.is_some() && tick.is_multiple_of(10))
                .then_some(Setpoint { motion, turn: HeadingSetpoint::Keep }),
            ..Inputs::default()
        };
        if is_due {
            take_over(&mut given, !was_due);
        }
        let (outcome, _) = vehicle.tick(&given, &mut Undisturbed).unwrap();
        let state = *vehicle.vehicle().state();
        let takes_over = |transition: Transition| {
            matches!(transition.to, Mode::Holding | Mode::Landing) && transition.reason != Reason::TakenOff
        };
        if is_due && begun.is_none() && outcome.transition.is_some_and(takes_over) {
            (begun, stop.from) = (Some((tick, state.position)), state.velocity);
        }
        if let Some((tick_begun, from)) = begun {
            assert!(!matches!(outcome.mode, Mode::Descending | Mode::Stopped), "{:?}", outcome.transition);
            let way = state.position - from;
            stop.rose = stop.rose.max(way.z);
            let along = way.dot(&stop.from.try_normalize(0.01).unwrap_or_default());
            farthest = farthest.max(along);
            stop.back = farthest - along;
            let up = UnitQuaternion::new_unchecked(state.attitude) * Vector3::z();
            stop.tilt = stop.tilt.max(up.z.clamp(-1.0, 1.0).acos().to_degrees());
            still = if state.velocity.norm() < STOPPED_M_PER_S { still + 1 } else { 0 };
            if still == 1 {
                (stop.way, stop.time) = (way, (tick - tick_begun) as f64 * 0.01);
            }
            if still == 100 || !outcome.mode.is_armed() {
                return stop;
            }
        }
    }
    panic!("nothing took over, or it never stopped: {stop:?}")
}

#[test]
fn a_landing_at_any_time_after_a_take_off_climbs_on_by_half_a_metre_at_most() {
    for name in ["study", "hummingbird", PAPER] {
        let vehicle = certified(name);
        let cases: Vec<(f32, u64)> =
            [1.5, 3.0, 10.0].into_iter().flat_map(|height| (1..=20).map(move |half| (height, 50 * half))).collect();
        let flown: Vec<(f32, Stop)> = cases
            .into_par_iter()
            .map(|(height, ticks)| {
                let begin = Request::TakeOff(Some(height));
                (height, interrupted(&vehicle, begin, None, LAND, |tick, _| tick >= ticks))
            })
            .collect();
        for height in [1.5, 3.0, 10.0] {
            let of_height = flown.iter().filter(|(of, _)| *of == height);
            let worst = of_height.clone().map(|(_, stop)| *stop).max_by(|a, b| a.rose.total_cmp(&b.rose)).unwrap();
            println!(
                "{name}: to {height} m, LAND after 0.5 to 10 s: climbs on by {:.2} m at most, from {:.2} m/s",
                worst.rose, worst.from.z
            );
            let most = if name == PAPER { CLIMBS_ON_MAX_PAPER } else { CLIMBS_ON_MAX };
            assert!(name == PAPER && height > 3.0 || worst.rose < most, "{name}: {worst:?}");
        }
    }
}

#[test]
fn a_hold_at_full_speed_stops_within_what_the_references_braking_needs() {
    for name in ["study", "hummingbird", PAPER] {
        let vehicle = certified(name);
        for (velocity, fast, (acceleration, jerk)) in [
            (Vector3::new(8.0, 0.0, 0.0), 4.9, LEVEL_BOUNDS),
            (Vector3::new(2.0, 0.0, 0.0), 1.95, LEVEL_BOUNDS),
            (Vector3::new(0.0, 0.0, 3.0), 1.9, VERTICAL_BOUNDS),
            (Vector3::new(0.0, 0.0, -2.0), 0.6, VERTICAL_BOUNDS),
        ] {
            let toward = velocity.map(f64::from).normalize();
            let due = |tick: u64, now: Vector3<f64>| tick > CLIMB_TICKS && now.dot(&toward) >= fast;
            let stop = interrupted(&vehicle, Request::FlySetpoints, Some(velocity), HOLD, due);
            let speed = stop.from.norm();
            let needed = 0.5 * speed * (speed / acceleration + acceleration / jerk);
            let taken = stop.way.norm();
            println!(
                "{name}: HOLD at {speed:.2} m/s along {toward:?}: braking needs {needed:.2} m; ends {taken:.2} m away, \
                 after {:.2} m back and {:.1} s; tilts by {:.0} degrees",
                stop.back, stop.time, stop.tilt
            );
            let (times, besides) = FARTHER_MAX;
            // Along the vertical the paper's law has feedback alone.
            assert!(
                name == PAPER && velocity.z != 0.0 || taken + stop.back < times * needed + besides,
                "{name}: {stop:?}"
            );
        }
    }
}

#[test]
fn every_failsafe_in_a_climb_brakes_as_a_command_does() {
    let vehicle = certified("study");
    let failsafes: [(&str, TakeOver); 4] = [
        ("no setpoints", |inputs, _| inputs.setpoint = None),
        ("no ground station", |inputs, _| inputs.ground_station = None),
        ("an empty battery", |inputs, _| inputs.battery = Battery::Critical),
        ("ticks that are late", |inputs, _| inputs.is_late = true),
    ];
    for (what, failsafe) in failsafes {
        let due = |tick: u64, now: Vector3<f64>| tick > CLIMB_TICKS && now.z >= 0.5;
        let up = Some(Vector3::new(0.0, 0.0, 2.0));
        let stop = interrupted(&vehicle, Request::FlySetpoints, up, failsafe, due);
        println!("{what}: climbs on by {:.2} m from {:.2} m/s", stop.rose, stop.from.z);
        assert!(stop.from.z > 0.3 && stop.rose < CLIMBS_ON_MAX, "{what}: {stop:?}");
    }
}
