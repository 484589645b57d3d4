//! One flight with failures, from boot to the ground.

use super::Vehicle;
use super::expected::{self, Severity};
use super::failure::{Failure, Failures};
use super::phase::{Phase, Sight};
use super::watch;
use estimation::estimator::Rejected;
use flight::{Inputs, Mode, Outcome, Output, Reason, Request, Transition};
use nalgebra::{UnitQuaternion, Vector3};
use verification::piloted::{PilotedVehicle, Place};

/// The hardest touchdown that is gentle, m/s: of a landing, and of going down by the IMU alone: 0.6 m/s, a landing's
/// 0.5 m/s that frozen poses have taught it to take for nothing, and 0.2 m/s for each second that it goes down after
/// them.
const GENTLE_TOUCHDOWN_M_PER_S: (f64, f64) = (0.6, 1.4);

/// After this time since the last failure the operator lands the vehicle, whatever it does.
const OPERATOR_TIMEOUT_TICKS: u64 = 2_000;

/// Ticks after that by which it must be.
const DOWN_BY: u64 = 6_000;

/// For which it is watched once it is down and its motors stand.
const WATCHED_TICKS: u64 = 100;

/// Failures and when they strike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    pub phase: Phase,
    pub first: Failure,
    /// Another one, so many ticks later.
    pub second: Option<(Failure, u64)>,
    /// How high it flies, m.
    pub height: f32,
}

/// What came of it.
#[derive(Debug, Clone)]
pub struct Flown {
    pub case: Case,
    /// The modes from the first failure on, with the reasons, and when, s after it.
    pub path: Vec<(Transition, f64)>,
    /// Every transition of the flight.
    pub taken: Vec<Transition>,
    /// The hardest touchdown after the first failure, m/s, and whether everything that had failed permitted a gentle
    /// one.
    pub touchdown: Option<f64>,
    pub is_gentle: bool,
    /// Ticks flown.
    pub ticks: u64,
    /// What must not be.
    pub complaints: Vec<String>,
}

impl Flown {
    /// Whether it came down without poses.
    pub fn is_by_imu(&self) -> bool {
        self.path.iter().any(|(transition, _)| transition.to == Mode::Descending)
            || self.case.phase == Phase::Descending
    }
}

/// A flight on its way.
struct Flight<'m> {
    case: Case,
    vehicle: PilotedVehicle<'m>,
    failures: Failures,
    /// When the failures struck, ticks.
    struck: (Option<u64>, Option<u64>),
    sight: Sight,
    heartbeat: Option<u64>,
    /// Since when it stands on the ground with its motors off, ticks.
    down: Option<u64>,
    /// When it last touched the ground, us.
    hit: u64,
    /// The rotor that the vehicle has found to fail.
    lost: Option<usize>,
    /// Why the last tick's pose was refused, if it was.
    refused: Option<Rejected>,
    flown: Flown,
}

/// Flies a case.
pub fn fly(vehicle: &Vehicle, case: Case) -> Flown {
    let mut place = Place::new(&vehicle.scenario.configuration);
    let certification = if case.phase == Phase::Locked { Err(&vehicle.refused) } else { Ok(&vehicle.certified) };
    let piloted = PilotedVehicle::new(&vehicle.scenario, certification, &vehicle.settings, &mut place, 0).unwrap();
    let mut flight = Flight {
        case,
        vehicle: piloted,
        failures: Failures::none(vehicle.scenario.configuration.vehicle().mass),
        struck: (None, None),
        sight: Sight { tick: 0, mode: Mode::Boot, lasts: 0, height: 0.0, asked: case.height, now: 0 },
        heartbeat: None,
        down: None,
        hit: 0,
        refused: None,
        lost: None,
        flown: Flown {
            case,
            path: Vec::new(),
            taken: Vec::new(),
            touchdown: None,
            is_gentle: true,
            ticks: 0,
            complaints: Vec::new(),
        },
    };
    while !flight.is_over() {
        flight.tick(vehicle);
    }
    if flight.flown.complaints.is_empty() {
        flight.check_arming(vehicle);
    }
    flight.flown
}

impl Flight<'_> {
    fn is_over(&mut self) -> bool {
        let Sight { tick, mode, .. } = self.sight;
        let last = match (self.struck, self.case.second) {
            ((Some(first), _), None) => Some(first),
            (struck, _) => struck.1,
        };
        match last {
            None if tick > 4_000 => {
                self.complain(format!("{:?} is never reached, but {mode:?}", self.case.phase));
                true
            }
            None => false,
            Some(last) if tick > last + OPERATOR_TIMEOUT_TICKS + DOWN_BY => {
                self.complain(format!("still {mode:?} at {:?}", self.vehicle.vehicle().state().position));
                true
            }
            Some(last) => {
                // What never flew is watched for a while all the same.
                let watched = tick - last > 3 * WATCHED_TICKS;
                watched && self.down.is_some_and(|since| tick - since > WATCHED_TICKS)
            }
        }
    }

    fn complain(&mut self, words: String) {
        let tick = self.sight.tick;
        self.flown.complaints.push(format!("tick {tick}: {words}"));
    }

    fn tick(&mut self, vehicle: &Vehicle) {
        self.strike();
        let mut given = self.case.phase.given(&Sight { now: self.sight.now + 10_000, ..self.sight });
        if let Some(last) = self.struck.1.or(self.struck.0).filter(|_| self.struck.0.is_some())
            && self.sight.tick >= last + OPERATOR_TIMEOUT_TICKS
            && self.sight.tick.is_multiple_of(100)
        {
            given = Inputs { request: Some(Request::Land), setpoint: None, ..given };
        }
        let given = self.failures.spoil(Inputs { now: self.sight.now, ..given }, &mut self.heartbeat);
        let before = self.sight.mode;
        let (outcome, command) = match self.vehicle.tick(&given, &mut self.failures) {
            Ok(answer) => answer,
            Err(error) => return self.complain(error.to_string()),
        };
        self.lost = outcome.lost.map(|lost| lost.rotor).or(self.lost);
        self.sight.tick += 1;
        self.sight.lasts = if outcome.mode == before { self.sight.lasts + 1 } else { 0 };
        self.sight = Sight {
            mode: outcome.mode,
            height: self.vehicle.vehicle().state().position.z,
            now: self.vehicle.now(),
            ..self.sight
        };
        for words in watch::complaints(before, &outcome, command, &vehicle.certified, self.lost) {
            self.complain(words);
        }
        if given.killed && outcome.output != Output::Stop {
            self.complain(format!("killed, and {:?}", outcome.output));
        }
        if let Some(transition) = outcome.transition {
            self.note(transition);
        }
        self.check_touchdown();
        self.check_pose(&outcome);
        self.check_severity();
        let stands = self.stands();
        self.down = self.down.or(Some(self.sight.tick)).filter(|_| stands && outcome.output == Output::Stop);
        self.flown.ticks += 1;
    }

    /// Lets fail what is to fail now.
    fn strike(&mut self) {
        let Case { phase, first, second, .. } = self.case;
        if phase.loses_poses(&self.sight) {
            self.failures.strike(Failure::PoseLost, &mut self.vehicle);
        }
        if self.struck.0.is_none() && phase.is_reached(&self.sight) {
            self.struck.0 = Some(self.sight.tick);
            self.failures.strike(first, &mut self.vehicle);
        }
        if let ((Some(at), None), Some((second, later))) = (self.struck, second)
            && self.sight.tick >= at + later
        {
            self.struck.1 = Some(self.sight.tick);
            self.failures.strike(second, &mut self.vehicle);
        }
    }

    fn note(&mut self, transition: Transition) {
        self.flown.taken.push(transition);
        if let Some(first) = self.struck.0 {
            self.flown.path.push((transition, (self.sight.tick - first) as f64 * 0.01));
        }
        let speed = self.vehicle.vehicle().state().velocity.norm();
        // Who hits the ground hard may lose count of its speed; and who does not know it takes a steady updraft for the
        // ground.
        let counts = self.flown.is_gentle || self.flown.touchdown.is_none();
        let knows = counts && !self.failures.has(Failure::PoseVague);
        if transition.reason == Reason::Landed && knows && !self.is_on_ground() {
            self.complain(format!("landed {} m above the ground, at {speed} m/s", self.sight.height));
        }
    }

    fn stands(&self) -> bool {
        self.vehicle.vehicle().surroundings().standing
    }

    /// Whether it stands, or has hardly left the ground.
    fn is_on_ground(&self) -> bool {
        self.stands() || self.sight.height < 0.1
    }

    /// What has failed, and for how long, s.
    fn failed(&self) -> Vec<(Failure, f64)> {
        let now = self.sight.now;
        // What a hit on the ground has given to the velocity, beyond the accelerometer's range, differs from a drift
        // only in time.
        let counts_from = |failure| if failure == Failure::PoseDrifts { self.hit } else { 0 };
        let lasts = |failure| Some(self.failures.since(failure, now)?.min((now - counts_from(failure)) as f64 * 1e-6));
        let failed = |failure| Some((failure, lasts(failure)?));
        let second = self.case.second.filter(|_| self.struck.1.is_some()).map(|(second, _)| second);
        self.struck.0.map(|_| self.case.first).into_iter().chain(second).filter_map(failed).collect()
    }

    /// Whether the mode does enough about what has failed, and not too much.
    fn check_severity(&mut self) {
        if self.struck.0.is_none() {
            return;
        }
        let (failed, phase) = (self.failed(), self.case.phase);
        let (least, mut most) = (expected::least(phase, &failed), expected::most(phase, &failed));
        let last = self.struck.1.or(self.struck.0).unwrap_or(0);
        if self.sight.tick > last + OPERATOR_TIMEOUT_TICKS {
            most = most.max(Severity::Land);
        }
        let does = Severity::from_mode(self.sight.mode);
        if self.flown.taken.last().is_some_and(|last| last.reason == Reason::PoseRegained) && self.sight.lasts == 0 {
            // One transition a tick: what else there is to be done is done in the next.
            return;
        }
        // What has hit the ground hard may do as much as it likes.
        let gentle = failed.iter().all(|(failure, _)| expected::answer(*failure, phase).is_gentle);
        let is_hit = !gentle && self.flown.touchdown.is_some();
        let is_down = self.is_on_ground() && does == Severity::Off && most >= Severity::Land;
        // Once off, always off: arming is not requested.
        let rearmed = self.down.is_some() && does != Severity::Off;
        if does < least || (does > most && !is_down && !is_hit) || rearmed {
            let Sight { mode, height, .. } = self.sight;
            self.complain(format!("{mode:?} at {height:.3} m, not {least:?} to {most:?}, {failed:.2?}"));
        }
    }

    fn check_touchdown(&mut self) {
        let Some(touchdown) = self.vehicle.vehicle_mut().take_touchdown() else { return };
        self.hit = self.sight.now;
        if self.struck.0.is_none() {
            return;
        }
        let hardest = self.flown.touchdown.map_or(touchdown.speed, |hardest| hardest.max(touchdown.speed));
        self.flown.touchdown = Some(hardest);
        let (failed, phase) = (self.failed(), self.case.phase);
        let gentle = failed.iter().all(|(failure, _)| expected::answer(*failure, phase).is_gentle);
        // What has hardly left the ground counts as standing, and drops those 5 cm.
        let drops = phase == Phase::Spooling;
        let most = if drops || expected::most(phase, &failed) >= Severity::Descend {
            GENTLE_TOUCHDOWN_M_PER_S.1
        } else {
            GENTLE_TOUCHDOWN_M_PER_S.0
        };
        self.flown.is_gentle &= gentle && phase != Phase::Stopped;
        if self.flown.is_gentle && touchdown.speed > most {
            self.complain(format!("touched down at {:.3} m/s, {most} m/s are gentle", touchdown.speed));
        }
    }

    /// What makes it land at most leaves its poses to be believed, also where it hits the ground harder than the
    /// accelerometer can show. One in a hundred thousand is refused for its noise, but not two after each other.
    fn check_pose(&mut self, outcome: &Outcome) {
        let refused = outcome.pose.and_then(Result::err).filter(|refused| refused.is_lie());
        let (failed, phase) = (self.failed(), self.case.phase);
        let is_gentle = failed.iter().all(|one| expected::answer(one.0, phase).is_gentle);
        if let (Some(why), Some(_)) = (refused, self.refused)
            && is_gentle
            && expected::most(phase, &failed) <= Severity::Land
        {
            self.complain(format!("refused two poses: {why:?}"));
        }
        self.refused = refused;
    }

    /// Down and off, it disarms, and arms again only if nothing speaks against it.
    fn check_arming(&mut self, vehicle: &Vehicle) {
        let state = *self.vehicle.vehicle().state();
        let lies = (UnitQuaternion::new_normalize(state.attitude) * Vector3::z()).z < 0.85;
        let forbidden = lies
            || self.case.phase == Phase::Locked
            || self.failed().iter().any(|(failure, _)| expected::answer(*failure, self.case.phase).forbids_arming);
        for request in [Request::Disarm, Request::Arm] {
            let given = self.case.phase.given(&Sight { tick: 100, now: self.sight.now + 10_000, ..self.sight });
            let given = self.failures.spoil(Inputs { request: Some(request), ..given }, &mut self.heartbeat);
            let before = self.sight.mode;
            let (outcome, command) = self.vehicle.tick(&given, &mut self.failures).unwrap();
            self.sight = Sight { mode: outcome.mode, now: self.vehicle.now(), tick: self.sight.tick + 1, ..self.sight };
            self.flown.taken.extend(outcome.transition);
            for words in watch::complaints(before, &outcome, command, &vehicle.certified, self.lost) {
                self.complain(words);
            }
            let armed = request == Request::Arm && outcome.answer == Some(Ok(()));
            if armed && forbidden {
                self.complain("armed although something speaks against it".to_owned());
            }
            if outcome.mode == Mode::Stopped && self.case.first != Failure::Killed && !given.killed {
                self.complain("stopped although somebody has looked".to_owned());
            }
        }
    }
}
