//! One flight on a source that lies, and what came of it.

use super::lie::{Liar, Lie};
use controller_core::certificate::certified::Certified;
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use flight::{FlightSettings, Inputs, Leg, MissionItem, Mode, Output, Reason, Request};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use scenario::Scenario;
use verification::piloted::{PilotedVehicle, Place};

/// The box that it may not leave: a radius and a height about where it was armed.
pub const BOX_M: f32 = 3.0;

/// What an operator has chosen.
const FLIGHT_SETTINGS: FlightSettings =
    FlightSettings { fence_radius: BOX_M, fence_height: BOX_M, tracking_error_max: 1.5, ..FlightSettings::DEFAULT };

/// When the operator arms, and commands something, in ticks.
const ARM_TICK: u64 = 250;
const GO_TICK: u64 = 300;

/// How long it holds before it is commanded to go on, and goes on before it is commanded to hold, in ticks.
const HOLD_TICKS: u64 = 50;
const GOING_TICKS: u64 = 150;

/// How long it flies a setpoint that is a point before it goes round, in ticks.
const AT_POINT: u64 = 600;

/// What an operator commands, or what has become of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    TakeOff,
    /// The take-off is over: it holds.
    Up,
    /// Setpoints, to a point and then round.
    Setpoints,
    /// A mission from the ground: two places and a landing.
    Mission,
    /// A place to go to.
    GoTo,
    /// A hold on the way there.
    Hold,
    /// A landing out of a hold.
    Land,
}

impl Event {
    pub const ALL: [Self; 7] =
        [Self::TakeOff, Self::Up, Self::Setpoints, Self::Mission, Self::GoTo, Self::Hold, Self::Land];

    /// What the operator requests at `tick`, in a mode that has lasted for so many ticks.
    fn request(self, tick: u64, mode: Mode, lasts: u64, height: f32) -> Option<Request> {
        match self {
            _ if tick == ARM_TICK => Some(Request::Arm),
            Self::Setpoints if tick == GO_TICK => Some(Request::FlySetpoints),
            Self::Mission if tick == GO_TICK => Some(Request::FlyMission(Some(0))),
            _ if tick == GO_TICK => Some(Request::TakeOff(Some(height))),
            Self::GoTo | Self::Hold if mode == Mode::Holding && lasts == HOLD_TICKS => {
                let motion = Motion::Position(Vector3::new(1.5, -1.5, 0.5 * height + 0.5));
                Some(Request::GoTo(Setpoint { motion, turn: HeadingSetpoint::Keep }))
            }
            Self::Hold if mode == Mode::Holding && lasts == HOLD_TICKS + GOING_TICKS => Some(Request::Hold),
            Self::Land if mode == Mode::Holding && lasts == HOLD_TICKS => Some(Request::Land),
            _ => None,
        }
    }

    /// Whether it happens in this tick, or has happened.
    fn has_happened(self, tick: u64, mode: Mode, lasts: u64) -> bool {
        match self {
            Self::TakeOff | Self::Setpoints | Self::Mission => tick >= GO_TICK,
            Self::Up | Self::GoTo => mode == Mode::Holding && lasts >= HOLD_TICKS,
            Self::Hold => mode == Mode::Holding && lasts >= HOLD_TICKS + GOING_TICKS,
            Self::Land => mode == Mode::Landing,
        }
    }
}

/// The mission's item of a number.
fn mission_item(number: u8, height: f32) -> Option<MissionItem> {
    let (leg, position) = match number {
        0 => (Leg::Waypoint, Vector3::new(1.0, 0.5, height)),
        1 => (Leg::Waypoint, Vector3::new(-1.0, 1.0, 0.5 * height + 0.5)),
        2 => (Leg::Land, Vector3::new(-0.5, 0.0, 0.0)),
        _ => return None,
    };
    Some(MissionItem { leg, position, turn: HeadingSetpoint::Keep, radius: 0.3, hold: 0 })
}

/// Where in a flight the source begins to lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Begins {
    /// From the first pose on, in a flight that takes off.
    AtBoot,
    /// So long after this, s.
    After(Event, f64),
}

/// A flight to be flown.
#[derive(Debug, Clone)]
pub struct Case {
    pub begins: Begins,
    /// How high it flies, m.
    pub height: f32,
    /// None: the poses are honest throughout.
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
    let mut vehicle = PilotedVehicle::new(&scenario, Ok(certified), &FLIGHT_SETTINGS, &mut place, 0).unwrap();
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
    let mut was_wanted_down = false;
    let (event, after) = match case.begins {
        Begins::AtBoot => (Event::TakeOff, 0.0),
        Begins::After(event, seconds) => (event, seconds),
    };
    let (mut mode, mut lasts, mut down, mut happened) = (Mode::Boot, 0_u64, None::<Down>, None);
    for tick in 0..12_000_u64 {
        let now = vehicle.now() + 10_000;
        if event.has_happened(tick, mode, lasts) {
            happened = happened.or(Some(now));
        }
        let begun = happened.map(|then| then + (after * 1e6) as u64).filter(|begun| *begun <= now);
        let lies_from = if case.begins == Begins::AtBoot { Some(0) } else { begun };
        if liar.since.is_none() && lies_from.is_some() {
            liar.since = lies_from;
            liar.until = case.ends_after.map_or(u64::MAX, |after| now + (after * 1e6) as u64);
        }
        let seconds = begun.map_or(0.0, |since| now as f64 * 1e-6 - since as f64 * 1e-6);
        let wanted_down = begun.is_some() && seconds >= case.land_after;
        let lands = wanted_down && (!was_wanted_down || tick.is_multiple_of(100));
        was_wanted_down = wanted_down;
        let request = if lands { Some(Request::Land) } else { event.request(tick, mode, lasts, case.height) };
        let moving = event == Event::Setpoints && tick.is_multiple_of(20) && !wanted_down;
        let given = Inputs {
            ground_station: Some(now - tick % 100 * 10_000),
            request,
            setpoint: moving.then(|| setpoint(mode, lasts, case.height)),
            mission_item: vehicle
                .pilot()
                .mission_item(request.as_ref())
                .and_then(|number| mission_item(number, case.height)),
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
            let out = f64::max(state.position.xy().norm(), state.position.z) - f64::from(BOX_M);
            flown.out = flown.out.max(out);
            if mode == Mode::Holding && lasts >= 50 {
                flown.off = flown.off.max((state.position - Vector3::z() * f64::from(case.height)).norm());
            }
        }
        if begun.is_some() && (goes_down || !mode.is_armed() && flown.flew) {
            let down = down.get_or_insert(Down { since: now, from: state.position.z, touched: None });
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

/// Up to a point, and then once round in 12 s on a circle of 1 m.
fn setpoint(mode: Mode, lasts: u64, height: f32) -> Setpoint {
    let motion = if mode == Mode::Flying && lasts >= AT_POINT {
        let (sine, cosine) = (0.5 * (lasts - AT_POINT) as f32 * 0.01).sin_cos();
        Motion::Velocity(Vector3::new(-sine, cosine, 0.0) * 0.5)
    } else {
        Motion::Position(Vector3::new(0.0, 0.0, height))
    };
    Setpoint { motion, turn: HeadingSetpoint::Keep }
}
