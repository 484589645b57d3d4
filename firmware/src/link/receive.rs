//! What comes in: bytes to frames, frames to what the other tasks want to know.
//!
//! A message that cannot be used changes nothing, is counted and, once a second at most, told in words. No input panics.

use super::command::{Action, Command, Repetitions, action};
use super::frame::{Frame, Parser};
use super::pose::Poses;
use super::reply::{CommandResult, Reply};
use super::setpoint::setpoint;
use super::{COMPONENT, message};
use crate::hardware::Clock;
use crate::parameters::table::Name;
use crate::shared::{Asked, Origin, Severity, Shared, Text, Traffic};
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::Read;

/// The longest wait for bytes, us. Nothing hangs on it: it keeps the wait a bounded one.
const SILENCE: u64 = 1_000_000;

/// The wait after a line that failed, us.
const RECOVERY: u64 = 10_000;

/// How often a kind of refusal is told in words, us.
const TEXT_INTERVAL: u64 = 1_000_000;

/// MAV_TYPE_GCS.
const GROUND_STATION: u8 = 6;

/// Bytes read at once.
const CHUNK: usize = 64;

/// Receives for ever.
pub async fn receive<R: Read, M: RawMutex>(mut line: R, clock: &impl Clock, shared: &Shared<M>) -> ! {
    let mut parser = Parser::new();
    let mut receiver = Receiver::new(shared);
    let mut chunk = [0; CHUNK];
    loop {
        let wake = clock.now().saturating_add(SILENCE);
        match select(line.read(&mut chunk), clock.until(wake)).await {
            Either::First(Ok(count @ 1..)) => {
                let now = clock.now();
                parser.feed(chunk.get(..count).unwrap_or(&chunk), now, &mut |frame| receiver.take(frame));
                receiver.count(parser.discarded(), now);
            }
            // A line that ended or failed may come back, but must not take all the time there is.
            Either::First(_) => clock.until(clock.now().saturating_add(RECOVERY)).await,
            Either::Second(()) => {}
        }
    }
}

/// Says something once in a while.
#[derive(Debug, Default)]
struct Occasionally {
    not_before: u64,
}

impl Occasionally {
    fn announce<M: RawMutex>(&mut self, shared: &Shared<M>, now: u64, words: &[&str]) {
        if now >= self.not_before {
            self.not_before = now.saturating_add(TEXT_INTERVAL);
            shared.announce(Severity::Warning, words);
        }
    }
}

/// Acts on frames.
pub struct Receiver<'a, M: RawMutex> {
    shared: &'a Shared<M>,
    poses: Poses,
    repetitions: Repetitions,
    pose_refused: Occasionally,
    setpoint_refused: Occasionally,
    traffic: Traffic,
}

impl<'a, M: RawMutex> Receiver<'a, M> {
    /// Nothing received yet.
    #[must_use]
    pub fn new(shared: &'a Shared<M>) -> Self {
        Self {
            shared,
            poses: Poses::default(),
            repetitions: Repetitions::default(),
            pose_refused: Occasionally::default(),
            setpoint_refused: Occasionally::default(),
            traffic: Traffic::default(),
        }
    }

    /// Acts on one frame.
    pub fn take(&mut self, frame: &Frame<'_>) {
        let own = self.own_system();
        self.traffic.frames = self.traffic.frames.wrapping_add(1);
        // Our own words, come back over a line that echoes.
        if (frame.header.system, frame.header.component) == (own, COMPONENT) {
            return;
        }
        if !frame.is_whole() {
            return self.refused();
        }
        // Whether the addressee at this place of the message is this vehicle or everyone.
        let is_addressed = |offset| {
            let (system, component) = (frame.byte(offset), frame.byte(offset + 1));
            (system == 0 || system == own) && (component == 0 || component == COMPONENT)
        };
        match frame.message {
            message::HEARTBEAT => self.heartbeat(frame),
            // In a simulation the simulator says where the vehicle is.
            message::ODOMETRY | message::ATT_POS_MOCAP if !self.shared.hil.is_raised() => self.pose(frame),
            message::SET_POSITION_TARGET_LOCAL_NED if is_addressed(50) => self.setpoint(frame),
            message::COMMAND_LONG if is_addressed(30) => self.command(frame),
            message::PING => self.ping(frame),
            message::PARAM_REQUEST_LIST if is_addressed(0) => self.shared.reply(Reply::AllParameters),
            message::PARAM_REQUEST_READ if is_addressed(2) => self.read_parameter(frame),
            message::PARAM_SET if is_addressed(4) => self.set_parameter(frame),
            _ => {}
        }
    }

    /// Shares the counts, with the parser's.
    fn count(&mut self, discarded: u32, now: u64) {
        self.traffic.discarded = discarded;
        self.shared.traffic.put(self.traffic, now);
    }

    fn own_system(&self) -> u8 {
        // Whole and within 1 to 255, as the table has it.
        self.shared.parameters.get(Name::SystemId) as u8
    }

    fn refused(&mut self) {
        self.traffic.refused = self.traffic.refused.wrapping_add(1);
    }

    /// Any ground station's will do. Its type is the fifth byte; the other fields are of no interest, known or not.
    fn heartbeat(&mut self, frame: &Frame<'_>) {
        if frame.byte(4) == GROUND_STATION {
            self.shared.ground_station.put((), frame.time);
        }
    }

    fn pose(&mut self, frame: &Frame<'_>) {
        match self.poses.take(frame) {
            Ok(Some(pose)) => self.shared.pose.put(pose, frame.time),
            Ok(None) => {}
            Err(refusal) => {
                self.refused();
                self.pose_refused.announce(self.shared, frame.time, &["Pose refused: ", refusal.text()]);
            }
        }
    }

    fn setpoint(&mut self, frame: &Frame<'_>) {
        match setpoint(frame) {
            Ok(setpoint) => self.shared.setpoint.put(setpoint, frame.time),
            Err(refusal) => {
                self.refused();
                self.setpoint_refused.announce(self.shared, frame.time, &["Setpoint refused: ", refusal.text()]);
            }
        }
    }

    fn command(&mut self, frame: &Frame<'_>) {
        let command = Command::from_frame(frame);
        if self.repetitions.is_repeated(frame) {
            self.traffic.repeated = self.traffic.repeated.wrapping_add(1);
            return;
        }
        let (system, component) = (frame.header.system, frame.header.component);
        let origin = Origin { system, component, command: command.command };
        let result = match action(&command, self.shared.is_armed()) {
            Action::Ask(request) => match self.shared.request(Asked { request, origin }) {
                Ok(()) => return,
                Err(_) => CommandResult::TemporarilyRejected,
            },
            Action::Disarm => {
                self.shared.request_disarm();
                CommandResult::Accepted
            }
            Action::EnterHil => {
                self.shared.hil.raise();
                CommandResult::Accepted
            }
            Action::Answer(result) => result,
        };
        self.shared.reply(Reply::Command { origin, result });
    }

    /// PING is deprecated in favour of TIMESYNC, but clients still send it and wait for the answer. One that is addressed to
    /// somebody is itself an answer.
    fn ping(&mut self, frame: &Frame<'_>) {
        if frame.u16(12) == 0 {
            let (time, sequence) = (frame.u64(0), frame.u32(8));
            let (system, component) = (frame.header.system, frame.header.component);
            self.shared.reply(Reply::Ping { time, sequence, system, component });
        }
    }

    fn read_parameter(&mut self, frame: &Frame<'_>) {
        // A negative index: by name.
        let name = match usize::try_from(frame.u16(0) as i16) {
            Ok(index) => Name::from_index(index),
            Err(_) => Name::from_bytes(&frame.bytes::<16>(4)),
        };
        self.reply_with_parameter(name);
    }

    fn set_parameter(&mut self, frame: &Frame<'_>) {
        let (value, name, kind) = (frame.f32(0), Name::from_bytes(&frame.bytes::<16>(6)), frame.byte(22));
        if let Some(name) = name {
            self.set(name, value, kind);
        }
        self.reply_with_parameter(name);
    }

    /// Its value, as it is now, answers every question about a parameter.
    fn reply_with_parameter(&mut self, name: Option<Name>) {
        match name {
            Some(name) => self.shared.reply(Reply::Parameter(name)),
            None => self.refused(),
        }
    }

    fn set(&mut self, name: Name, value: f32, kind: u8) {
        let shared = self.shared;
        let refusal = if shared.is_armed() {
            Text::new(&["Parameters change only while disarmed"])
        } else if kind != message::REAL32 {
            Text::new(&[name.row().name, ": is a REAL32"])
        } else if let Err(error) = shared.parameters.set(name, value) {
            error.text()
        } else {
            return;
        };
        shared.announce(Severity::Warning, &[refusal.as_str()]);
    }
}
