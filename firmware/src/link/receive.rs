//! What comes in: bytes to frames, frames to what the other tasks want to know.
//!
//! A message that cannot be used changes nothing, is counted and, once a second at most, told in words. No input panics.

use super::command::{Action, Command, Repetitions, action};
use super::frame::{Frame, Parser};
use super::pose::Poses;
use super::reply::{CommandResult, Reply};
use super::setpoint::setpoint;
use super::{COMPONENT, is_addressed, ping};
use crate::hardware::Clock;
use crate::parameters::table::Name;
use crate::shared::{Asked, Origin, Severity, Shared, Traffic};
use core::fmt;
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::Read;
use mavlink::MessageData;
use mavlink::dialects::common::{
    ATT_POS_MOCAP_DATA, COMMAND_LONG_DATA, HEARTBEAT_DATA, MavParamType, MavType, ODOMETRY_DATA,
    PARAM_REQUEST_LIST_DATA, PARAM_REQUEST_READ_DATA, PARAM_SET_DATA, SET_POSITION_TARGET_LOCAL_NED_DATA,
};

/// The longest wait for bytes, us. Nothing hangs on it: it keeps the wait a bounded one.
const SILENCE: u64 = 1_000_000;

/// The wait after a line that failed, us.
const RECOVERY: u64 = 10_000;

/// How often a kind of refusal is told in words, us.
const TEXT_INTERVAL: u64 = 1_000_000;

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
                for &byte in chunk.iter().take(count) {
                    let mut next = parser.push(byte, now);
                    while let Some(frame) = next {
                        receiver.take(&frame);
                        next = parser.next_frame();
                    }
                }
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
    fn announce<M: RawMutex>(&mut self, shared: &Shared<M>, now: u64, words: impl fmt::Display) {
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
        match frame.message {
            HEARTBEAT_DATA::ID => self.heartbeat(frame),
            // In a simulation the simulator says where the vehicle is.
            ODOMETRY_DATA::ID | ATT_POS_MOCAP_DATA::ID if !self.shared.hil.is_raised() => self.pose(frame),
            SET_POSITION_TARGET_LOCAL_NED_DATA::ID => self.setpoint(frame),
            COMMAND_LONG_DATA::ID => self.command(frame),
            ping::ID => self.ping(frame),
            PARAM_REQUEST_LIST_DATA::ID | PARAM_REQUEST_READ_DATA::ID | PARAM_SET_DATA::ID => self.parameter(frame),
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

    fn reply(&self, reply: Reply) {
        // Without room the sender gets no answer, and asks again.
        let _ = self.shared.replies.try_send(reply);
    }

    /// Any ground station's will do. Its type is the fifth byte; the other fields are of no interest, known or not.
    fn heartbeat(&mut self, frame: &Frame<'_>) {
        if frame.holds::<HEARTBEAT_DATA>() && frame.byte(4) == MavType::MAV_TYPE_GCS as u8 {
            self.shared.ground_station.put((), frame.time);
        }
    }

    fn pose(&mut self, frame: &Frame<'_>) {
        match self.poses.take(frame) {
            Ok(Some(pose)) => self.shared.pose.put(pose, frame.time),
            Ok(None) => {}
            Err(refusal) => {
                self.refused();
                self.pose_refused.announce(self.shared, frame.time, refusal);
            }
        }
    }

    fn setpoint(&mut self, frame: &Frame<'_>) {
        let Some(message) = frame.decode::<SET_POSITION_TARGET_LOCAL_NED_DATA>() else { return self.refused() };
        if !is_addressed(message.target_system, message.target_component, self.own_system()) {
            return;
        }
        match setpoint(&message) {
            Ok(setpoint) => self.shared.setpoint.put(setpoint, frame.time),
            Err(refusal) => {
                self.refused();
                self.setpoint_refused.announce(self.shared, frame.time, refusal);
            }
        }
    }

    fn command(&mut self, frame: &Frame<'_>) {
        let Some(command) = Command::from_frame(frame) else { return self.refused() };
        if !is_addressed(command.target_system, command.target_component, self.own_system()) {
            return;
        }
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
        self.reply(Reply::Command { origin, result });
    }

    fn ping(&mut self, frame: &Frame<'_>) {
        match ping::question(frame) {
            Ok(Some(reply)) => self.reply(reply),
            Ok(None) => {}
            Err(()) => self.refused(),
        }
    }

    fn parameter(&mut self, frame: &Frame<'_>) {
        let own = self.own_system();
        if let Some(list) = frame.decode::<PARAM_REQUEST_LIST_DATA>() {
            if is_addressed(list.target_system, list.target_component, own) {
                self.reply(Reply::AllParameters);
            }
        } else if let Some(read) = frame.decode::<PARAM_REQUEST_READ_DATA>() {
            // A negative index: by name.
            let name = match usize::try_from(read.param_index) {
                Ok(index) => Name::from_index(index),
                Err(_) => Name::from_bytes(&*read.param_id),
            };
            if is_addressed(read.target_system, read.target_component, own) {
                self.reply_with_parameter(name);
            }
        } else if let Some(set) = frame.decode::<PARAM_SET_DATA>() {
            if is_addressed(set.target_system, set.target_component, own) {
                let name = Name::from_bytes(&*set.param_id);
                if let Some(name) = name {
                    self.set_parameter(name, set.param_value, set.param_type);
                }
                self.reply_with_parameter(name);
            }
        } else {
            self.refused();
        }
    }

    /// Its value, as it is now, answers every question about a parameter.
    fn reply_with_parameter(&mut self, name: Option<Name>) {
        match name {
            Some(name) => self.reply(Reply::Parameter(name)),
            None => self.refused(),
        }
    }

    fn set_parameter(&mut self, name: Name, value: f32, kind: MavParamType) {
        let shared = self.shared;
        if shared.is_armed() {
            shared.announce(Severity::Warning, "Parameters change only while disarmed");
        } else if kind != MavParamType::MAV_PARAM_TYPE_REAL32 {
            shared.announce(Severity::Warning, format_args!("{}: is a REAL32", name.row().name));
        } else if let Err(error) = shared.parameters.set(name, value) {
            shared.announce(Severity::Warning, error);
        }
    }
}
