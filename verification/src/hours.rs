//! Hours of flight: ten-minute missions, one after the other, on one pilot that never reboots, with faults sprinkled
//! in.
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
//! Where the scenario has no `[estimator]`, the IMU has half the noise and half the walk of a BMI088 as the filter
//! assumes it: with all of its walk an accelerometer is off by a tenth of g after nine hours, which is not plausible,
//! and the vehicle rightly refuses to arm.
//!
//! Each time is up to two seconds later, by the seed. A mission is judged by the transitions it took, in order, and by
//! how long each took. The vehicle's clock starts where the caller says: a counter of it with 32 bits overflows on the
//! way, if there is one.

mod results;
mod script;

use crate::piloted::{Meddler, PilotedError, PilotedVehicle, Place};
use controller_core::certificate::certified::Certified;
use estimation::estimator::PoseMeasurement;
use flight::{FlightSettings, Mode, Outcome, Pose, Reason, Refusal, Stamped, Velocity};
use host_sim::vehicle::reality::RealVehicle;
use nalgebra::Vector3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use results::widened;
pub use results::{Hour, Hours, ParameterEffect, TIMED_REASONS};
use scenario::Scenario;
use scenario::reality::estimator::Estimator;
use script::{MISSION_TICKS, Script};
use std::fmt;

/// The plan of a long flight.
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
const HOVER_TICKS: std::ops::Range<u64> = 3_000..8_000;

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

/// The current disturbance of vehicle and poses.
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
        vehicle.push(self.push, Vector3::zeros());
    }

    fn pose(&mut self, pose: Stamped<Pose>, _: u64) -> Option<Stamped<PoseMeasurement>> {
        let Stamped { value, time } = pose;
        let nothing = Velocity::World(Vector3::zeros());
        // A pose that is too far away is missing.
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
    delays: [(f64, f64); TIMED_REASONS.len()],
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

/// Flies what `plan` says on the vehicle of `scenario`, whose configuration is `certified`; `report` gets each hour.
///
/// # Errors
/// [`Ended`]: the first mission that does not go as it should ends it.
pub fn fly(
    scenario: &Scenario,
    certified: &Certified,
    plan: &Plan,
    mut report: impl FnMut(&Hour),
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
        heartbeat: None,
        results: Hours::new(),
    };
    for _ in 0..plan.hours {
        let mut sums = Sums::default();
        for _ in 0..plan.missions {
            campaign.mission(&mut sums)?;
        }
        let hour = sums.hour();
        report(&hour);
        campaign.results.hours.push(hour);
    }
    let Campaign { vehicle, world, mut results, .. } = campaign;
    (results.moves, results.position) = (world.moves, vehicle.vehicle().state().position);
    Ok(results)
}

/// Everything that goes on from mission to mission.
struct Campaign<'m> {
    vehicle: PilotedVehicle<'m>,
    /// kg.
    mass: f64,
    random: ChaCha8Rng,
    world: World,
    /// When the ground station's last heartbeat came, us.
    heartbeat: Option<u64>,
    results: Hours,
}

/// The state within a mission.
#[derive(Default)]
struct Course {
    /// The transitions taken so far.
    reasons: Vec<Reason>,
    /// When the take-off was commanded, ticks.
    up: u64,
    /// The maximum speed downwards while landing, m/s.
    sinking: f64,
}

impl Campaign<'_> {
    /// One mission, into the hour's `sums` and the results.
    fn mission(&mut self, sums: &mut Sums) -> Result<(), Ended> {
        let number = self.results.missions;
        let script = Script::new(number, &mut self.random);
        self.wind();
        let mut course = Course::default();
        for tick in 0..MISSION_TICKS {
            // As control does, in every tick; what is armed keeps what it was armed with.
            self.vehicle.choose(&script.settings());
            self.meddle(&script, tick);
            let mode = self.vehicle.pilot().mode();
            let given = script.given(tick, mode, self.vehicle.now(), &mut self.heartbeat);
            let (outcome, _) = self.vehicle.tick(&given, &mut self.world)?;
            self.measure(&script, tick, &outcome, sums, &mut course);
            match outcome.answer {
                // A pose in a thousand is beyond its gates, and then there is a second to wait.
                Some(Err(Refusal::PosesUnsettled)) => self.results.refusals += 1,
                Some(Err(refusal)) => return Err(Ended::Refused(number, refusal)),
                _ => {}
            }
            if let Some(transition) = outcome.transition {
                self.note(&script, tick, transition.reason, sums, &mut course);
            }
        }
        if course.reasons != script.expected_reasons() {
            return Err(Ended::Mission(number, course.reasons));
        }
        self.results.speeds[script.choice().1].find(course.sinking);
        self.results.missions += 1;
        Ok(())
    }

    /// Another wind, from somewhere.
    fn wind(&mut self) {
        let from = self.random.random_range(0.0..std::f64::consts::TAU);
        let force = self.mass * self.random.random_range(0.0..0.8);
        self.world.push = Vector3::new(from.cos(), from.sin(), 0.0) * force;
    }

    /// Withholds or moves the poses in this tick.
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
        if HOVER_TICKS.contains(&tick) {
            sums.hover(outcome, &state.position, &self.world.offset);
            // It stands on the ground at the origin.
            self.results.heights[script.choice().0].find(state.position.z);
        }
        if outcome.mode == Mode::Landing {
            course.sinking = course.sinking.max(-state.velocity.z);
        }
    }

    /// A transition, with what it took.
    fn note(&mut self, script: &Script, tick: u64, reason: Reason, sums: &mut Sums, course: &mut Course) {
        if !matches!(reason, Reason::Started | Reason::Ready | Reason::NotReady) {
            course.reasons.push(reason);
            self.results.taken.push((self.results.missions * MISSION_TICKS + tick, reason));
        }
        if reason == Reason::TakeOffCommanded {
            course.up = tick;
        }
        let Some(which) = TIMED_REASONS.iter().position(|timed| *timed == reason) else { return };
        let since = if reason == Reason::TakenOff { course.up } else { script.cause(reason) };
        let took = tick - since;
        if reason == Reason::TakenOff {
            self.results.heights[script.choice().0].take(took);
        }
        self.results.extremes[which] = widened(self.results.extremes[which], took);
        sums.delays[which].0 += took as f64;
        sums.delays[which].1 += 1.0;
    }
}
