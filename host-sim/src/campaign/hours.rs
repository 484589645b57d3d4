//! Hours of flight: ten-minute missions, one after the other, on one pilot that never reboots, with faults sprinkled in.
//!
//! | a mission, s | what happens | what must follow |
//! |---|---|---|
//! | 0 | another wind; on the ground | |
//! | 3 to 80 | arms, takes off, holds | it is up in a time that is always the same; 50 s of hover are measured |
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
use controller_core::flight::{FlightSettings, Outcome, Pose, Reason, Refusal, Stamped, Velocity};
use nalgebra::Vector3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use scenario::Scenario;
use scenario::reality::estimator::Estimator;
use script::{MISSION, Script};
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

/// What all of them showed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Hours {
    /// Hour by hour.
    pub hours: Vec<Hour>,
    /// The shortest and longest of each of the delays, ticks.
    pub extremes: [(u64, u64); TIMED.len()],
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
    let settings = FlightSettings { take_off_height: script::HEIGHT, ..FlightSettings::DEFAULT };
    let mut scenario = scenario.clone();
    scenario.reality.estimator.get_or_insert(Estimator { imu_noise: 0.5, ..Estimator::default() });
    let mut vehicle = PilotedVehicle::new(&scenario, Ok(certified), &settings, &mut place, plan.start)?;
    let mass = f64::from(certified.configuration().vehicle().mass);
    let mut random = ChaCha8Rng::seed_from_u64(plan.seed);
    let mut world = World { poses: true, ..World::default() };
    let mut shown = Hours { extremes: [(u64::MAX, 0); TIMED.len()], ..Hours::default() };
    let (mut heard, mut up) = (None, 0);
    for _ in 0..plan.hours {
        let mut sums = Sums::default();
        for _ in 0..plan.missions {
            let number = shown.missions;
            let script = Script::new(number, &mut random);
            let wind = random.random_range(0.0..std::f64::consts::TAU);
            world.push = Vector3::new(wind.cos(), wind.sin(), 0.0) * (mass * random.random_range(0.0..0.8));
            let mut reasons = Vec::new();
            for tick in 0..MISSION {
                world.poses = !script.is_dark(tick);
                if script.moves_frame(tick) {
                    world.moves += 1;
                    world.offset = Vector3::from_fn(|_, _| random.random_range(-2.0..2.0));
                }
                let given = script.given(tick, vehicle.pilot().mode(), vehicle.now(), &mut heard);
                let (outcome, _) = vehicle.tick(&given, &mut world)?;
                match outcome.answer {
                    // A pose in a thousand is beyond its gates, and then there is a second to wait.
                    Some(Err(Refusal::PosesUnsettled)) => shown.refusals += 1,
                    Some(Err(refusal)) => return Err(Ended::Refused(number, refusal)),
                    _ => {}
                }
                if HOVER.contains(&tick) {
                    sums.hover(&outcome, &vehicle.vehicle().state().position, &world.offset);
                }
                let Some(transition) = outcome.transition else { continue };
                if !matches!(transition.reason, Reason::Started | Reason::Ready | Reason::NotReady) {
                    reasons.push(transition.reason);
                    shown.taken.push((number * MISSION + tick, transition.reason));
                }
                if transition.reason == Reason::TakeOffCommanded {
                    up = tick;
                }
                if let Some(which) = TIMED.iter().position(|reason| *reason == transition.reason) {
                    let since =
                        if transition.reason == Reason::TakenOff { up } else { script.cause(transition.reason) };
                    let took = tick - since;
                    let (least, most) = shown.extremes[which];
                    shown.extremes[which] = (least.min(took), most.max(took));
                    sums.delays[which].0 += took as f64;
                    sums.delays[which].1 += 1.0;
                }
            }
            if reasons != script.wanted() {
                return Err(Ended::Mission(number, reasons));
            }
            shown.missions += 1;
        }
        let hour = sums.hour();
        tell(&hour);
        shown.hours.push(hour);
    }
    (shown.moves, shown.position) = (world.moves, vehicle.vehicle().state().position);
    Ok(shown)
}

/// How much the last hour may differ from the first, relative: means over 300 s of noise that takes about half a second to forget.
const ALIKE: f64 = 0.15;

/// How far apart two delays of one kind may be, ticks.
const SPREAD: u64 = 1;

impl Hours {
    /// Whether every delay was the same all the time, and the last hour as good as the first.
    ///
    /// # Errors
    /// Says what was not.
    pub fn check(&self) -> Result<(), String> {
        for (reason, (least, most)) in TIMED.iter().zip(self.extremes) {
            if most.checked_sub(least).is_none_or(|apart| apart > SPREAD) {
                return Err(format!("{reason:?}: after {least} to {most} ticks, not more than {SPREAD} apart"));
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
