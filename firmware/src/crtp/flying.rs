//! What a client has flown: a stream of its setpoints, or the path of one of its commands.
//!
//! Both go to the governor as setpoints of one sender, and so within the certified bounds, however far or fast they
//! are. A command that leaves a vehicle the time it needs is flown by the clock. One that does not becomes a place to go
//! to, as fast as the bounds allow, which are proven for that and not for haste; a trajectory takes as much longer as it
//! needs. A stream takes over from a path, and a command from a stream. Whatever else ends the flight of setpoints (a
//! landing, a failure, another client) ends the path.

use super::errors::{BUSY, INVALID, NOT_THERE};
use super::high_level::{Command, Pace, Vertical};
use super::limits::Limits;
use super::parameters::Settings;
use super::path::{Along, Path};
use super::pieces::Pieces;
use super::polynomial::{Moving, Point, Segment};
use super::setpoint::Streamed;
use crate::shared::{CrtpView, Event, QueuedRequest, Report, Severity};
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use controller_core::reference::Reference;
use embassy_sync::blocking_mutex::raw::RawMutex;
use flight::{Mode, Request, SETPOINT_AGE_MAX_US, Stamped};
use nalgebra::{RealField, Vector3};

/// The sender of its setpoints, as other senders are known by system and component. No system has this number.
pub const SENDER: (u8, u8) = (0, 1);

/// Time between the setpoints of a path.
pub const SETPOINT_INTERVAL_US: u64 = 10_000;

/// How long it may take until setpoints are flown.
const BEGINNING_MAX_US: u64 = 500_000;

/// The shortest and the longest that a command may take, s.
const DURATION_MIN_S: f32 = 0.1;
const DURATION_MAX_S: f32 = 3_600.0;

/// How many times as long as it was uploaded a trajectory may take, and how many times as short.
const TIMESCALE_MAX: f32 = 100.0;

/// How long a vehicle is led at rest before it is led by the clock: the governor follows what moves as it is sent once it
/// has caught up with it.
const LEAD_IN_US: u64 = 2_000_000;

/// How near its end a reference is there, m, and how slow it is then, m/s.
const ARRIVED_M: f32 = 0.01;
const ARRIVED_M_PER_S: f32 = 0.02;

/// How far above its goal a landing goes on by itself, m, until it finds the ground: sooner than to hover down there.
const LANDING_M: f32 = 0.1;

/// A path under way. Behind its end the vehicle is led at rest.
#[derive(Debug, Clone, Copy)]
struct Begun {
    path: Path,
    /// When the command came, us, and when the path begins.
    asked: u64,
    begins: u64,
    /// Whether the vehicle lands at its end.
    lands: bool,
    /// When that was reached, us.
    over: Option<u64>,
}

/// What is flown.
pub struct Flying<'a, M: RawMutex> {
    shared: CrtpView<'a, M>,
    /// Trajectories.
    pub pieces: Pieces<'a>,
    path: Option<Begun>,
    /// Whether the last path was flown to its end, and none began since.
    is_over: bool,
    /// When the last setpoint of a stream came, us.
    streamed: Option<u64>,
}

impl<'a, M: RawMutex> Flying<'a, M> {
    /// Nothing, with memory for trajectories.
    pub const fn new(shared: CrtpView<'a, M>, memory: &'a mut [u8]) -> Self {
        Self { shared, pieces: Pieces::new(memory), path: None, is_over: false, streamed: None }
    }

    /// Whether a path is flown (false) or was, to its end (true).
    pub fn path(&self) -> Option<bool> {
        if self.path.is_some_and(|begun| begun.over.is_none()) { Some(false) } else { self.is_over.then_some(true) }
    }

    /// Whether pieces in memory are flown.
    pub fn flies_pieces(&self) -> bool {
        self.path.is_some_and(|begun| begun.over.is_none() && matches!(begun.path, Path::Pieces(_)))
    }

    /// When the next setpoint of a path is due, us.
    pub fn due(&self, now: u64) -> u64 {
        if self.path.is_some() { (now / SETPOINT_INTERVAL_US + 1) * SETPOINT_INTERVAL_US } else { u64::MAX }
    }

    fn request(&self, request: Request) {
        let setpoints = (request == Request::FlySetpoints).then_some(SENDER);
        self.shared.request(QueuedRequest { request, order: None, setpoints });
    }

    fn report(&self) -> Option<Report> {
        self.shared.report().get().map(|report| report.value)
    }

    /// Takes what a client streams.
    pub fn stream(&mut self, streamed: &Streamed, now: u64) {
        match streamed {
            Streamed::Setpoint(setpoint) => {
                (self.path, self.is_over) = (None, false);
                let is_new = self.streamed.is_none_or(|last| now.saturating_sub(last) > SETPOINT_AGE_MAX_US);
                self.streamed = Some(now);
                self.put(setpoint, is_new, now);
            }
            Streamed::Stop => self.stop(),
            Streamed::End | Streamed::Nothing => {
                // A hand off the sticks ends a stream, and no command.
                if self.streamed.take().is_some() && self.report().is_some_and(|report| report.mode == Mode::Flying) {
                    self.request(Request::Hold);
                }
            }
        }
    }

    /// Hands a setpoint to control, unless others' are flown; with a request to fly it.
    fn put(&self, setpoint: &Setpoint, with_request: bool, now: u64) {
        let is_anothers = self.shared.setpoint_owner().get().is_some_and(|owner| owner != SENDER);
        let refusal = if self.shared.sticks().get().is_some_and(|sticks| sticks.value) {
            "the sticks fly"
        } else if is_anothers && !with_request {
            "another sender's are flown"
        } else {
            self.shared.setpoint().put(*setpoint, now);
            if with_request {
                self.request(Request::FlySetpoints);
            }
            return;
        };
        self.shared.announce(Event::new(Severity::Warning, format_args!("Setpoint refused: {refusal}")));
    }

    /// Disarms a vehicle that stands, and lands one that flies: the emergency stop alone drops it.
    pub fn stop(&mut self) {
        (self.path, self.streamed) = (None, None);
        let Some(report) = self.report().filter(|report| report.mode.is_armed()) else { return };
        self.request(if report.is_airborne { Request::Land } else { Request::Disarm });
    }

    /// Forgets what is flown, without a word to control.
    pub fn forget(&mut self) {
        (self.path, self.streamed, self.is_over) = (None, None, false);
    }

    /// Begins what a command asks for.
    /// Errors: a number of [`super::errors`].
    pub fn command(&mut self, command: &Command, settings: &Settings, now: u64) -> Result<(), u8> {
        let (path, lands) = match *command {
            Command::Define { number, kind, address, count } => {
                return self.pieces.define(number, kind, address, count);
            }
            Command::Stop => {
                self.stop();
                return Ok(());
            }
            // Whose groups change is the session's.
            Command::SetGroup(_) => return Ok(()),
            _ => self.planned(command, settings)?,
        };
        let is_led = self.path.is_some() && self.is_flown();
        let (path, begins) = self.paced(path, is_led, now)?;
        let first = path.at(0.0, &self.pieces).ok_or(INVALID)?;
        (self.streamed, self.is_over) = (None, false);
        self.path = Some(Begun { path, asked: now, begins, lands, over: None });
        self.put(&setpoint(&path, &first.at_rest()), !is_led, now);
        Ok(())
    }

    /// A path as the vehicle can fly it, and when it begins, us.
    fn paced(&self, path: Path, is_led: bool, now: u64) -> Result<(Path, u64), u8> {
        let asked = path.duration().unwrap_or(0.0);
        let slower = self.limits()?.slower(&path, &self.pieces).ok_or(INVALID)?;
        let is_in_time = slower <= 1.0;
        if !is_in_time {
            let words = format_args!("{asked:.1} s is too short: as fast as certified");
            self.shared.announce(Event::new(Severity::Information, words));
        }
        // Since when it has been led by the clock, or at rest.
        let since = match self.path.filter(|_| is_led) {
            Some(Begun { path: Path::Place(..), over, .. }) => over,
            Some(begun) => Some(begun.begins),
            None => None,
        };
        let rests = since.is_none() && self.report().is_some_and(|report| !report.is_airborne || is_resting(&report));
        match path {
            Path::Segment(segment) if !is_in_time || since.is_none() && !rests => {
                let end = segment.at(segment.duration);
                Ok((Path::Place(end.position(), end.yaw.value), now))
            }
            Path::Pieces(along) => {
                let path = Path::Pieces(Along { timescale: along.timescale * slower, ..along });
                Ok((path, begins(since, now)))
            }
            path => Ok((path, begins(since, now))),
        }
    }

    fn limits(&self) -> Result<Limits, u8> {
        let Some(Stamped { value: Ok(certified), .. }) = self.shared.verdict().get() else { return Err(BUSY) };
        let governor = self.shared.parameters().governor_limits();
        let speeds = [governor.horizontal_speed, governor.vertical_speed];
        Ok(Limits { bounds: *certified.configuration().bounds(), speeds })
    }

    /// Whether its setpoints are flown.
    fn is_flown(&self) -> bool {
        self.report().is_some_and(|report| report.mode == Mode::Flying)
            && self.shared.setpoint_owner().get() == Some(SENDER)
    }

    /// The path of a command from where the vehicle is now, and whether the vehicle lands at its end.
    fn planned(&self, command: &Command, settings: &Settings) -> Result<(Path, bool), u8> {
        let here = self.here().ok_or(BUSY)?;
        let (place, yaw) = (here.position(), here.yaw.value);
        Ok(match *command {
            Command::TakeOff(vertical) => (vertically(&here, &vertical, settings.take_off_speed)?, false),
            Command::Land(vertical) => (vertically(&here, &vertical, settings.landing_speed)?, true),
            Command::GoTo { is_relative, is_straight, place: goal, yaw: turned, duration } => {
                let (goal, turned) = if is_relative { (place + goal, yaw + turned) } else { (goal, turned) };
                let duration = granted(duration)?;
                let to = if is_straight { Segment::straight } else { Segment::to_rest };
                (Path::Segment(to(&here, &goal, turned, duration)), false)
            }
            Command::Start { is_shifted, is_turned, is_reversed, number, timescale } => {
                let (definition, length) = self.pieces.defined(number).ok_or(NOT_THERE)?;
                if !(1.0 / TIMESCALE_MAX..=TIMESCALE_MAX).contains(&timescale) {
                    return Err(INVALID);
                }
                let mut along =
                    Along { definition, length, timescale, is_reversed, shift: Vector3::zeros(), turn: 0.0 };
                let begun = |along: &Along| Path::Pieces(*along).at(0.0, &self.pieces).ok_or(INVALID);
                if is_turned {
                    along.turn = yaw - begun(&along)?.yaw.value;
                }
                if is_shifted {
                    along.shift = place - begun(&along)?.position();
                }
                (Path::Pieces(along), false)
            }
            Command::Define { .. } | Command::Stop | Command::SetGroup(_) => return Err(INVALID),
        })
    }

    /// Where a path begins: where the vehicle is led now, or else where it is; none while it is not armed.
    fn here(&self) -> Option<Point> {
        let report = self.report().filter(|report| report.mode.is_armed())?;
        let yaw = |direction: nalgebra::Vector2<f32>| RealField::atan2(direction.y, direction.x);
        if let Some(reference) = report.reference.filter(|_| report.mode.is_guided()) {
            let (p, v, a) = (reference.position, reference.velocity, reference.acceleration);
            let axes = [Moving::new(p.x, v.x, a.x), Moving::new(p.y, v.y, a.y), Moving::new(p.z, v.z, a.z)];
            let heading = reference.heading;
            return Some(Point { axes, yaw: Moving::new(yaw(heading.direction()), heading.rate(), 0.0) });
        }
        let state = report.state?;
        let ahead = nalgebra::UnitQuaternion::new_unchecked(state.attitude) * Vector3::x();
        Some(Point::resting(&state.position, yaw(ahead.xy())))
    }

    /// Leads the vehicle along its path at `now`, us.
    pub fn lead(&mut self, now: u64) {
        let Some(begun) = self.path else { return };
        let is_flown = self.is_flown();
        if !is_flown && now.saturating_sub(begun.asked) > BEGINNING_MAX_US {
            self.path = None;
            return;
        }
        let time = now.saturating_sub(begun.begins) as f32 * 1e-6;
        let Some(point) = begun.path.at(time, &self.pieces) else {
            self.path = None;
            return;
        };
        let end = begun.path.at(f32::MAX, &self.pieces).unwrap_or(point).position();
        let is_low = |report: &Report| report.reference.is_some_and(|at| at.position.z - end.z < LANDING_M);
        let is_there = match (self.report().filter(|_| is_flown), begun.path.duration()) {
            (Some(report), _) if begun.lands && now > begun.begins && is_low(&report) => true,
            (_, Some(duration)) => time >= duration,
            (Some(report), None) => has_arrived(&report, &end),
            (None, None) => false,
        };
        let led = match begun.over {
            Some(_) => point.at_rest().setpoint(),
            None if is_there || now < begun.begins => setpoint(&begun.path, &point.at_rest()),
            None => setpoint(&begun.path, &point),
        };
        self.put(&led, false, now);
        if is_there && begun.over.is_none() {
            self.is_over = true;
            self.path = Some(Begun { over: Some(now), ..begun });
            if begun.lands {
                self.request(Request::Land);
            }
        }
    }
}

/// The setpoint of a point of a path: a place is gone to, along another the vehicle is led.
fn setpoint(path: &Path, point: &Point) -> Setpoint {
    match path {
        Path::Place(place, yaw) => {
            Setpoint { motion: Motion::Position(*place), turn: HeadingSetpoint::Angle { angle: *yaw, rate: 0.0 } }
        }
        Path::Segment(_) | Path::Pieces(_) => point.setpoint(),
    }
}

/// When a path begins for a vehicle that has been led since then, us, if it has.
fn begins(since: Option<u64>, now: u64) -> u64 {
    since.unwrap_or(now).saturating_add(LEAD_IN_US).max(now)
}

/// Whether a reference is at rest.
fn is_resting(report: &Report) -> bool {
    report.reference.is_none_or(|reference| reference.velocity.norm_squared() < ARRIVED_M_PER_S * ARRIVED_M_PER_S)
}

/// Whether it is at rest at a place, m.
fn has_arrived(report: &Report, place: &Vector3<f32>) -> bool {
    let is_near = |reference: Reference| (reference.position - place).norm_squared() < ARRIVED_M * ARRIVED_M;
    report.reference.is_some_and(is_near) && is_resting(report)
}

/// A duration that is granted, s.
fn granted(duration: f32) -> Result<f32, u8> {
    if duration <= DURATION_MAX_S { Ok(duration.max(DURATION_MIN_S)) } else { Err(INVALID) }
}

/// Straight up or down; at a speed, m/s, where a command says nothing of how fast.
fn vertically(here: &Point, vertical: &Vertical, speed: f32) -> Result<Path, u8> {
    let place = here.position();
    let height = if vertical.is_relative { place.z + vertical.height } else { vertical.height };
    let way = (height - place.z).abs();
    let duration = match vertical.pace {
        Pace::Within(duration) if duration > 0.0 => duration,
        Pace::At(speed) if speed > 0.0 => way / speed,
        _ => way / speed,
    };
    let yaw = vertical.yaw.unwrap_or(here.yaw.value);
    let goal = Vector3::new(place.x, place.y, height);
    Ok(Path::Segment(Segment::to_rest(here, &goal, yaw, granted(duration)?)))
}
