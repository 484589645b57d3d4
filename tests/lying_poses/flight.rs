//! One flight on a source that lies, and what came of it.

use super::lie::{Liar, Lie};
use controller_core::certificate::certified::Certified;
use controller_core::governor::{Motion, Setpoint, Turn};
use flight::{FlightSettings, Inputs, Mode, Output, Reason, Request};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use scenario::Scenario;
use verification::piloted::{PilotedVehicle, Place};

/// The box that it may not leave: a radius and a height, m, about where it was armed.
pub const BOX: f32 = 3.0;

/// What an operator has chosen.
const SETTINGS: FlightSettings =
    FlightSettings { fence_radius: BOX, fence_height: BOX, tracking_error_max: 1.5, ..FlightSettings::DEFAULT };

/// How high it flies, m.
const HEIGHT: f32 = 1.5;

/// When the operator arms, and lets it take off, in ticks.
const ARM: u64 = 250;
const GO: u64 = 300;

/// Where in a flight the source begins to lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Begins {
    /// From the first pose on.
    AtBoot,
    Climbing,
    Holding,
    /// On setpoints that go round.
    Moving,
    /// A second into a landing.
    Landing,
}

impl Begins {
    pub const ALL: [Self; 5] = [Self::AtBoot, Self::Climbing, Self::Holding, Self::Moving, Self::Landing];
}

/// A flight to be flown.
#[derive(Debug, Clone)]
pub struct Case {
    pub begins: Begins,
    pub lies: Vec<Lie>,
    /// When it says the truth again, s after it began to lie, if it does.
    pub ends_after: Option<f64>,
    /// When the operator wants it down, s after it began to lie.
    pub land_after: f64,
    pub seed: u64,
}

/// What came of it.
#[derive(Debug, Clone)]
pub struct Flown {
    pub case: Case,
    /// Whether it left the ground.
    pub flew: bool,
    /// How far it was out of its box before it went down, m.
    pub out: f64,
    /// From when it was to go down, until its motors were off, s; none if they never were.
    pub down_after: Option<f64>,
    /// From its first touchdown on the way down until its motors were off, s.
    pub off_after: Option<f64>,
    /// How far it rose above where it was when it was to go down, m.
    pub rose: f64,
    /// The hardest touchdown, m/s.
    pub touchdown: f64,
    /// How far it was from where it was to hold, before it went down, m.
    pub off: f64,
    /// Modes with the times at which they began, s after the first lie, and why.
    pub path: Vec<(f64, Reason)>,
}

/// How a flight goes down.
struct Down {
    since: u64,
    from: f64,
    touched: Option<u64>,
}

/// Flies a case on a scenario's vehicle.
pub fn fly(scenario: &Scenario, certified: &Certified, case: &Case) -> Flown {
    let mut place = Place::new(&scenario.configuration);
    let mut scenario = scenario.clone();
    let sensors = scenario.reality.estimator.get_or_insert_default();
    sensors.seed = case.seed;
    let mut vehicle = PilotedVehicle::new(&scenario, Ok(certified), &SETTINGS, &mut place, 0).unwrap();
    let mut liar = Liar::new(&case.lies, ChaCha8Rng::seed_from_u64(case.seed));
    let mut flown = Flown {
        case: case.clone(),
        flew: false,
        out: 0.0,
        down_after: None,
        off_after: None,
        rose: 0.0,
        touchdown: 0.0,
        off: 0.0,
        path: Vec::new(),
    };
    let (mut mode, mut lasts, mut down) = (Mode::Boot, 0_u64, None::<Down>);
    for tick in 0..12_000_u64 {
        let now = vehicle.now() + 10_000;
        let begins = match case.begins {
            Begins::AtBoot => true,
            Begins::Climbing => mode == Mode::TakingOff && vehicle.vehicle().state().position.z > 0.75,
            Begins::Holding => mode == Mode::Holding && lasts >= 50,
            Begins::Moving => mode == Mode::Flying && lasts >= 700,
            Begins::Landing => mode == Mode::Landing && lasts >= 100,
        };
        if liar.since.is_none() && begins {
            liar.since = Some(now);
            liar.until = case.ends_after.map_or(u64::MAX, |after| now + (after * 1e6) as u64);
        }
        let begun = liar.since.map(|since| if case.begins == Begins::AtBoot { 6_000_000 } else { since });
        let seconds = begun.map_or(0.0, |since| now as f64 * 1e-6 - since as f64 * 1e-6);
        let wanted_down = begun.is_some() && seconds >= case.land_after;
        let land = case.begins == Begins::Landing && mode == Mode::Holding && lasts == 50;
        let request = match tick {
            ARM => Some(Request::Arm),
            GO if case.begins == Begins::Moving => Some(Request::FlySetpoints),
            GO => Some(Request::TakeOff(Some(HEIGHT))),
            _ if land || wanted_down && tick.is_multiple_of(100) => Some(Request::Land),
            _ => None,
        };
        let moving = case.begins == Begins::Moving && tick.is_multiple_of(20) && !wanted_down;
        let given = Inputs {
            ground_station: Some(now - tick % 100 * 10_000),
            request,
            setpoint: moving.then(|| setpoint(mode, lasts)),
            ..Inputs::default()
        };
        let Ok((outcome, _)) = vehicle.tick(&given, &mut liar) else { break };
        lasts = if outcome.mode == mode { lasts + 1 } else { 0 };
        mode = outcome.mode;
        let state = *vehicle.vehicle().state();
        let touched = vehicle.vehicle_mut().take_touchdown();
        flown.flew |= outcome.is_airborne && state.position.z > 0.05;
        if let (Some(transition), Some(_)) = (outcome.transition, begun) {
            flown.path.push(((seconds * 100.0).round() * 0.01, transition.reason));
        }
        let goes_down = matches!(mode, Mode::Landing | Mode::Descending);
        if !goes_down && mode.flies() {
            down = None;
            let out = f64::max(state.position.xy().norm(), state.position.z) - f64::from(BOX);
            flown.out = flown.out.max(out);
            if mode == Mode::Holding && lasts >= 50 {
                flown.off = flown.off.max((state.position - Vector3::z() * f64::from(HEIGHT)).norm());
            }
        }
        if begun.is_some() && (goes_down || !mode.is_armed() && flown.flew) {
            let down = down.get_or_insert(Down {
                since: now,
                from: state.position.z + braking(state.velocity.z),
                touched: None,
            });
            flown.rose = flown.rose.max(state.position.z - down.from);
            if let Some(touchdown) = touched {
                down.touched = down.touched.or(Some(now));
                flown.touchdown = flown.touchdown.max(touchdown.speed);
            }
            if outcome.output == Output::Stop && flown.down_after.is_none() {
                flown.down_after = Some((now - down.since) as f64 * 1e-6);
                flown.off_after = Some(down.touched.map_or(0.0, |touched| (now - touched) as f64 * 1e-6));
            }
        }
        let over = flown.down_after.is_some() && state.position.z < 0.05;
        let never = begun.is_some() && wanted_down && !mode.is_armed() && !flown.flew;
        let too_long = wanted_down && seconds > case.land_after + 60.0;
        if over || never || too_long {
            break;
        }
    }
    flown
}

/// How far a vehicle that rises at `speed`, m/s, still does while its reference brakes, m.
fn braking(speed: f64) -> f64 {
    /// The study's vertical bound, m/s^2, and how fast it may be reached, m/s^3.
    const BRAKES: f64 = 0.1755;
    const JERK: f64 = 3.876;
    let up = speed.max(0.0);
    up.powi(2) / (2.0 * BRAKES) + up * BRAKES / (2.0 * JERK)
}

/// Up to a point, and then once round in 12 s on a circle of 1 m.
fn setpoint(mode: Mode, lasts: u64) -> Setpoint {
    let motion = if mode == Mode::Flying && lasts >= 600 {
        let (sine, cosine) = (0.5 * (lasts - 600) as f32 * 0.01).sin_cos();
        Motion::Velocity(Vector3::new(-sine, cosine, 0.0) * 0.5)
    } else {
        Motion::Position(Vector3::new(0.0, 0.0, HEIGHT))
    };
    Setpoint { motion, turn: Turn::Keep }
}
