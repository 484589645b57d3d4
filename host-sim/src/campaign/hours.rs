//! Hours of flight: ten-minute missions, one after the other, on one pilot that never reboots, with faults sprinkled in.
//!
//! | a mission, s | what happens | what must follow |
//! |---|---|---|
//! | 0 | another wind; on the ground; two parameters are changed, how high it takes off and how fast it lands | both are what it does |
//! | 3 to 80 | arms, takes off, holds | it is up in a time that is always the same for the same height; 50 s of hover are measured |
//! | 80 to 260 | points, then a circle, by setpoints; the ground station falls silent for 4 s | holds, and flies on when asked |
//! | 260 | setpoints cease | holds |
//! | 280, 300 | no poses for 0.7 s; for 1.5 s | nothing; levels, and holds when they are back |
//! | 320, 340 | the frame of the poses moves, and says so; a point to go to | brakes; goes there |
//! | 360 | a command to land; in one mission of four the battery is low instead, and changed on the ground | lands |
//! | 500, 550 | the frame moves on the ground; no poses for 2 s | ready to arm again |
//!
//! Where the scenario has no `[estimator]`, the IMU has half the noise and half the walk of a BMI088 as the filter assumes it: with all of its walk an
//! accelerometer is off by a tenth of g after nine hours, which is not plausible, and the vehicle rightly refuses to arm.
//!
//! Each time is up to two seconds later, by the seed. A mission is judged by the transitions it took, in order, and by how long each took. The
//! vehicle's clock starts where the caller says: a counter of it with 32 bits overflows on the way, if there is one.

mod script;

use crate::piloted::{Meddler, PilotedError, PilotedVehicle, Place};
use crate::reality::RealVehicle;
use controller_core::certificate::certified::Certified;
use controller_core::estimator::PoseMeasurement;
use controller_core::flight::{FlightSettings, Mode, Outcome, Pose, Reason, Refusal, Stamped, Velocity};
use nalgebra::Vector3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use scenario::Scenario;
use scenario::reality::estimator::Estimator;
use script::{HEIGHTS, MISSION, SPEEDS, Script};
use std::fmt;

/// What is to be flown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plan {
    /// Hours.
    pub hours: u64,
    /// Missions in each of them; six fill it.
    pub missions: u64,
    /// The vehicle's clock at the beginning, us.
    pub start: u64,
    /// Decides everything that is drawn.
    pub seed: u64,
}

/// The hover that is measured, ticks of a mission.
const HOVER: std::ops::Range<u64> = 3_000..8_000;

/// What one hour showed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Hour {
    /// RMS of the distance between vehicle and reference in hover, m.
    pub hover: f64,
    /// RMS of the estimate's error meanwhile, m.
    pub estimate: f64,
    /// Ticks from a cause to its consequence, means over the hour, in the order of [`TIMED`].
    pub delays: [f64; TIMED.len()],
}

/// Consequences that are timed: of the take-off command, of the last heartbeat, setpoint and pose, of a battery that is low.
pub const TIMED: [Reason; 5] =
    [Reason::TakenOff, Reason::GroundStationLost, Reason::SetpointsLost, Reason::PoseLost, Reason::BatteryLow];

/// What the parameters that were changed before a mission did in it, of all missions with the same choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Obeyed {
    /// What was chosen: m, or m/s.
    pub chosen: f32,
    /// The least and the greatest of what came of it: m above the ground in hover, or m/s downwards while landing.
    pub found: (f64, f64),
    /// The shortest and the longest time that it took, ticks: from the take-off's command to its height; of a landing, nothing is said.
    pub took: (u64, u64),
}

impl Obeyed {
    fn nothing(chosen: f32) -> Self {
        Self { chosen, found: (f64::INFINITY, f64::NEG_INFINITY), took: (u64::MAX, 0) }
    }

    fn find(&mut self, value: f64) {
        let (least, most) = self.found;
        self.found = (least.min(value), most.max(value));
    }

    fn take(&mut self, ticks: u64) {
        self.took = widened(self.took, ticks);
    }
}

fn widened((least, most): (u64, u64), value: u64) -> (u64, u64) {
    (least.min(value), most.max(value))
}

/// What all of them showed.
#[derive(Debug, Clone, PartialEq)]
pub struct Hours {
    /// Hour by hour.
    pub hours: Vec<Hour>,
    /// The shortest and longest of each of the delays, ticks.
    pub extremes: [(u64, u64); TIMED.len()],
    /// What became of each height of a take-off, and of each speed of a landing, that were chosen.
    pub heights: [Obeyed; HEIGHTS.len()],
    /// See [`Self::heights`].
    pub speeds: [Obeyed; SPEEDS.len()],
    /// Missions flown.
    pub missions: u64,
    /// How often the frame of the poses has moved.
    pub moves: u64,
    /// How often somebody had to ask again, because a pose of the last second was not believed.
    pub refusals: u64,
    /// Every transition but those between checks and ready, with its tick since the beginning.
    pub taken: Vec<(u64, Reason)>,
    /// Where the vehicle was at the end, m.
    pub position: Vector3<f64>,
}

/// Why it came to an end before its time.
#[derive(Debug, Clone, PartialEq)]
pub enum Ended {
    /// The vehicle cannot be flown, or no further.
    Vehicle(PilotedError),
    /// A mission took other transitions than it should: its number, and the reasons.
    Mission(u64, Vec<Reason>),
    /// In this mission something was refused that should not have been.
    Refused(u64, Refusal),
}

impl fmt::Display for Ended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Vehicle(error) => write!(f, "{error}"),
            Self::Mission(number, reasons) => write!(f, "mission {number} did not go as it should: {reasons:?}"),
            Self::Refused(number, refusal) => write!(f, "mission {number}: {refusal}"),
        }
    }
}

impl std::error::Error for Ended {}

impl From<PilotedError> for Ended {
    fn from(error: PilotedError) -> Self {
        Self::Vehicle(error)
    }
}

/// What is done to vehicle and poses at the moment.
#[derive(Debug, Clone, Copy, Default)]
struct World {
    /// N, world.
    push: Vector3<f64>,
    poses: bool,
    /// Where the frame of the poses has moved the vehicle, m; and how often it has moved.
    offset: Vector3<f32>,
    moves: u64,
}

impl Meddler for World {
    fn act(&mut self, vehicle: &mut RealVehicle, _: u64) {
        vehicle.push(self.push);
    }

    fn pose(&mut self, pose: Stamped<Pose>, _: u64) -> Option<Stamped<PoseMeasurement>> {
        let Stamped { value, time } = pose;
        let nothing = Velocity::World(Vector3::zeros());
        // A pose that is too far away is none.
        let moved = Pose::new(value.position() + self.offset, nothing, value.attitude()).ok().filter(|_| self.poses)?;
        // The counter has eight bits, and runs over.
        Some(Stamped { value: PoseMeasurement::new(&moved).reset_counter(self.moves as u8), time })
    }
}

/// Sums over an hour.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    squares: f64,
    misses: f64,
    samples: f64,
    delays: [(f64, f64); TIMED.len()],
}

impl Sums {
    fn hover(&mut self, outcome: &Outcome, position: &Vector3<f64>, offset: &Vector3<f32>) {
        let (Some(Ok(flown)), Some(estimated)) = (&outcome.flown, &outcome.estimated) else { return };
        let there = position + offset.cast::<f64>();
        self.squares += (there - flown.reference.position.cast::<f64>()).norm_squared();
        self.misses += (there - estimated.state.position.cast::<f64>()).norm_squared();
        self.samples += 1.0;
    }

    fn hour(&self) -> Hour {
        Hour {
            hover: (self.squares / self.samples).sqrt(),
            estimate: (self.misses / self.samples).sqrt(),
            delays: self.delays.map(|(sum, count)| sum / count),
        }
    }
}

/// Flies what `plan` says on the vehicle of `scenario`, whose configuration is `certified`; `tell` hears of each hour.
///
/// # Errors
/// [`Ended`]: the first mission that does not go as it should ends it.
pub fn fly(
    scenario: &Scenario,
    certified: &Certified,
    plan: &Plan,
    mut tell: impl FnMut(&Hour),
) -> Result<Hours, Ended> {
    let mut place = Place::new(certified.configuration());
    let mut scenario = scenario.clone();
    scenario.reality.estimator.get_or_insert(Estimator { imu_noise: 0.5, ..Estimator::default() });
    let settings = FlightSettings::DEFAULT;
    let mut campaign = Campaign {
        vehicle: PilotedVehicle::new(&scenario, Ok(certified), &settings, &mut place, plan.start)?,
        mass: f64::from(certified.configuration().vehicle().mass),
        random: ChaCha8Rng::seed_from_u64(plan.seed),
        world: World { poses: true, ..World::default() },
        heard: None,
        shown: Hours::nothing(),
    };
    for _ in 0..plan.hours {
        let mut sums = Sums::default();
        for _ in 0..plan.missions {
            campaign.mission(&mut sums)?;
        }
        let hour = sums.hour();
        tell(&hour);
        campaign.shown.hours.push(hour);
    }
    let Campaign { vehicle, world, mut shown, .. } = campaign;
    (shown.moves, shown.position) = (world.moves, vehicle.vehicle().state().position);
    Ok(shown)
}

/// Everything that goes on from mission to mission.
struct Campaign<'m> {
    vehicle: PilotedVehicle<'m>,
    /// kg.
    mass: f64,
    random: ChaCha8Rng,
    world: World,
    /// When the ground station was heard last, us.
    heard: Option<u64>,
    shown: Hours,
}

/// What is remembered within a mission.
#[derive(Default)]
struct Course {
    /// The transitions that are told.
    reasons: Vec<Reason>,
    /// When the take-off was commanded, ticks.
    up: u64,
    /// The greatest speed downwards while landing, m/s.
    sinking: f64,
}

impl Campaign<'_> {
    /// One mission, into the hour's `sums` and what is shown.
    fn mission(&mut self, sums: &mut Sums) -> Result<(), Ended> {
        let number = self.shown.missions;
        let script = Script::new(number, &mut self.random);
        self.wind();
        let mut course = Course::default();
        for tick in 0..MISSION {
            // As control does, in every tick; what is armed keeps what it was armed with.
            self.vehicle.choose(&script.settings());
            self.meddle(&script, tick);
            let mode = self.vehicle.pilot().mode();
            let given = script.given(tick, mode, self.vehicle.now(), &mut self.heard);
            let (outcome, _) = self.vehicle.tick(&given, &mut self.world)?;
            self.measure(&script, tick, &outcome, sums, &mut course);
            match outcome.answer {
                // A pose in a thousand is beyond its gates, and then there is a second to wait.
                Some(Err(Refusal::PosesUnsettled)) => self.shown.refusals += 1,
                Some(Err(refusal)) => return Err(Ended::Refused(number, refusal)),
                _ => {}
            }
            if let Some(transition) = outcome.transition {
                self.note(&script, tick, transition.reason, sums, &mut course);
            }
        }
        if course.reasons != script.wanted() {
            return Err(Ended::Mission(number, course.reasons));
        }
        self.shown.speeds[script.choice().1].find(course.sinking);
        self.shown.missions += 1;
        Ok(())
    }

    /// Another wind, from somewhere.
    fn wind(&mut self) {
        let from = self.random.random_range(0.0..std::f64::consts::TAU);
        let force = self.mass * self.random.random_range(0.0..0.8);
        self.world.push = Vector3::new(from.cos(), from.sin(), 0.0) * force;
    }

    /// What is done to the poses in this tick.
    fn meddle(&mut self, script: &Script, tick: u64) {
        self.world.poses = !script.is_dark(tick);
        if script.moves_frame(tick) {
            self.world.moves += 1;
            self.world.offset = Vector3::from_fn(|_, _| self.random.random_range(-2.0..2.0));
        }
    }

    /// How well it hovers, how high, and how fast it comes down.
    fn measure(&mut self, script: &Script, tick: u64, outcome: &Outcome, sums: &mut Sums, course: &mut Course) {
        let state = self.vehicle.vehicle().state();
        if HOVER.contains(&tick) {
            sums.hover(outcome, &state.position, &self.world.offset);
            // It stands on the ground at the origin.
            self.shown.heights[script.choice().0].find(state.position.z);
        }
        if outcome.mode == Mode::Landing {
            course.sinking = course.sinking.max(-state.velocity.z);
        }
    }

    /// A transition, with what it took.
    fn note(&mut self, script: &Script, tick: u64, reason: Reason, sums: &mut Sums, course: &mut Course) {
        if !matches!(reason, Reason::Started | Reason::Ready | Reason::NotReady) {
            course.reasons.push(reason);
            self.shown.taken.push((self.shown.missions * MISSION + tick, reason));
        }
        if reason == Reason::TakeOffCommanded {
            course.up = tick;
        }
        let Some(which) = TIMED.iter().position(|timed| *timed == reason) else { return };
        let since = if reason == Reason::TakenOff { course.up } else { script.cause(reason) };
        let took = tick - since;
        if reason == Reason::TakenOff {
            self.shown.heights[script.choice().0].take(took);
        }
        self.shown.extremes[which] = widened(self.shown.extremes[which], took);
        sums.delays[which].0 += took as f64;
        sums.delays[which].1 += 1.0;
    }
}

/// How much the last hour may differ from the first, relative: means over 300 s of noise that takes about half a second to forget.
const ALIKE: f64 = 0.15;

/// How far apart two delays of one kind may be, ticks.
const SPREAD: u64 = 1;

/// How far from the height that was chosen a hover may be, m, and how far from the speed, m/s: gusts and the estimate's noise, and a landing that
/// begins out of a climb or with the ground's cushion.
const HEIGHT_OFF: f64 = 0.02;
const SPEED_OFF: f64 = 0.1;

impl Hours {
    fn nothing() -> Self {
        Self {
            hours: Vec::new(),
            extremes: [(u64::MAX, 0); TIMED.len()],
            heights: HEIGHTS.map(Obeyed::nothing),
            speeds: SPEEDS.map(Obeyed::nothing),
            missions: 0,
            moves: 0,
            refusals: 0,
            taken: Vec::new(),
            position: Vector3::zeros(),
        }
    }

    /// Whether every delay was the same all the time, the last hour as good as the first, and every parameter obeyed.
    ///
    /// # Errors
    /// Says what was not.
    pub fn check(&self) -> Result<(), String> {
        // How long a take-off takes depends on its height: they are compared by it.
        let delays = TIMED.iter().zip(self.extremes).filter(|(reason, _)| **reason != Reason::TakenOff);
        let rises = self.heights.iter().map(|height| (&Reason::TakenOff, height.took));
        for (reason, (least, most)) in delays.chain(rises) {
            if most.checked_sub(least).is_none_or(|apart| apart > SPREAD) {
                return Err(format!("{reason:?}: after {least} to {most} ticks, not more than {SPREAD} apart"));
            }
        }
        for (what, obeyed, off) in [("height", &self.heights, HEIGHT_OFF), ("speed", &self.speeds, SPEED_OFF)] {
            for Obeyed { chosen, found: (least, most), .. } in obeyed {
                let chosen = f64::from(*chosen);
                if !(chosen - off..=chosen + off).contains(least) || !(chosen - off..=chosen + off).contains(most) {
                    return Err(format!("{what}: {chosen} chosen, {least:.3} to {most:.3} found"));
                }
            }
        }
        let (Some(first), Some(last)) = (self.hours.first(), self.hours.last()) else {
            return Err("no hour was flown".to_owned());
        };
        for (what, first, last) in [("hover", first.hover, last.hover), ("estimate", first.estimate, last.estimate)] {
            let is_alike = (1.0 - ALIKE..=1.0 + ALIKE).contains(&(last / first));
            if !is_alike {
                return Err(format!("{what}: RMS {first} m in the first hour, {last} m in the last"));
            }
        }
        Ok(())
    }
}
