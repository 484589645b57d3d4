//! What comes in: bytes to frames, frames to what the other tasks want to know.
//!
//! A message that cannot be used changes nothing, is counted and, once a second at most, told in words. No input panics.

use super::COMPONENT;
use super::command::{Action, Repetitions, action};
use super::frame::{Frame, Parser};
use super::pose::Poses;
use super::setpoint::setpoint;
use crate::hardware::Clock;
use crate::parameters::table::Name;
use crate::shared::{Asked, Event, Ping, Procedure, Reply, Severity, Shared, Traffic};
use core::fmt::Display;
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::Read;
use mavlink::MessageData;
use mavlink::dialects::common::{
    ATT_POS_MOCAP_DATA, COMMAND_LONG_DATA, HEARTBEAT_DATA, MavParamType, MavResult, MavType, ODOMETRY_DATA,
    PARAM_REQUEST_LIST_DATA, PARAM_REQUEST_READ_DATA, PARAM_SET_DATA, SET_POSITION_TARGET_LOCAL_NED_DATA,
    TIMESYNC_DATA,
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
    fn warn<M: RawMutex>(&mut self, shared: &Shared<M>, now: u64, words: impl Display) {
        if now >= self.not_before {
            self.not_before = now.saturating_add(TEXT_INTERVAL);
            shared.announce(Event::new(Severity::Warning, words));
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
            HEARTBEAT_DATA::ID => self.decoded(frame, Self::heartbeat),
            // In a simulation the simulator says where the vehicle is.
            ODOMETRY_DATA::ID | ATT_POS_MOCAP_DATA::ID if !self.shared.hil.is_raised() => self.pose(frame),
            SET_POSITION_TARGET_LOCAL_NED_DATA::ID => self.decoded(frame, Self::setpoint),
            COMMAND_LONG_DATA::ID => self.decoded(frame, Self::command),
            TIMESYNC_DATA::ID => self.decoded(frame, Self::time_sync),
            Ping::ID => self.decoded(frame, Self::ping),
            PARAM_REQUEST_LIST_DATA::ID => self.decoded(frame, Self::list_parameters),
            PARAM_REQUEST_READ_DATA::ID => self.decoded(frame, Self::read_parameter),
            PARAM_SET_DATA::ID => self.decoded(frame, Self::set_parameter),
            _ => {}
        }
    }

    /// Acts on the frame's message, or counts it as refused if it is no such message.
    fn decoded<D: MessageData>(&mut self, frame: &Frame<'_>, act: fn(&mut Self, &Frame<'_>, &D)) {
        match frame.decode() {
            Some(message) => act(self, frame, &message),
            None => self.refused(),
        }
    }

    /// Whether an addressee is this vehicle or everyone.
    fn is_addressed(&self, system: u8, component: u8) -> bool {
        (system == 0 || system == self.own_system()) && (component == 0 || component == COMPONENT)
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

    /// Any ground station's will do.
    fn heartbeat(&mut self, frame: &Frame<'_>, message: &HEARTBEAT_DATA) {
        if message.mavtype == MavType::MAV_TYPE_GCS {
            self.shared.ground_station.put((), frame.time);
        }
    }

    fn pose(&mut self, frame: &Frame<'_>) {
        // Milliseconds, within 0 and 150, as the table has it.
        let delay = (self.shared.parameters.get(Name::PoseDelay) * 1e3) as u64;
        match self.poses.take(frame, delay) {
            Ok(Some(pose)) => {
                // Where control does not take them, one more or less makes no difference.
                let _ = self.shared.poses.put(pose);
            }
            Ok(None) => {}
            Err(refusal) => {
                self.refused();
                self.pose_refused.warn(self.shared, frame.time, format_args!("Pose refused: {refusal}"));
            }
        }
    }

    fn setpoint(&mut self, frame: &Frame<'_>, message: &SET_POSITION_TARGET_LOCAL_NED_DATA) {
        if !self.is_addressed(message.target_system, message.target_component) {
            return;
        }
        match setpoint(message) {
            Ok(setpoint) => self.shared.setpoint.put(setpoint, frame.time),
            Err(refusal) => {
                self.refused();
                self.setpoint_refused.warn(self.shared, frame.time, format_args!("Setpoint refused: {refusal}"));
            }
        }
    }

    fn command(&mut self, frame: &Frame<'_>, message: &COMMAND_LONG_DATA) {
        if !self.is_addressed(message.target_system, message.target_component) {
            return;
        }
        if self.repetitions.is_repeated(frame) {
            self.traffic.repeated = self.traffic.repeated.wrapping_add(1);
            return;
        }
        let command = message.command;
        let result = match action(message, self.shared.is_armed()) {
            Action::Ask(request) => match self.shared.request(Asked { request, command }) {
                Ok(()) => return,
                Err(_) => MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
            },
            Action::ForceDisarm => {
                self.shared.request_disarm();
                MavResult::MAV_RESULT_ACCEPTED
            }
            Action::EnterHil => {
                self.shared.hil.raise();
                MavResult::MAV_RESULT_ACCEPTED
            }
            Action::Calibrate(procedure) => match self.calibrate(procedure) {
                Ok(()) => return,
                Err(result) => result,
            },
            Action::Answer(result) => result,
        };
        self.shared.reply(Reply::Command { command, result });
    }

    /// Hands it to the IMU task, which answers.
    fn calibrate(&mut self, procedure: Option<Procedure>) -> Result<(), MavResult> {
        let refused = if self.shared.is_armed() {
            "Calibration: only while disarmed"
        } else if self.shared.hil.is_raised() {
            "Calibration: a simulator has the sensors"
        } else {
            return self.shared.calibrations.put(procedure).map_err(|_| MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
        };
        self.shared.announce(Event::new(Severity::Warning, refused));
        Err(MavResult::MAV_RESULT_DENIED)
    }

    /// Back to its sender. One that is addressed to somebody is itself an answer.
    #[expect(deprecated, reason = "see there")]
    fn ping(&mut self, frame: &Frame<'_>, message: &Ping) {
        if (message.target_system, message.target_component) == (0, 0) {
            let (target_system, target_component) = (frame.header.system, frame.header.component);
            self.shared.reply(Reply::Ping(Ping { target_system, target_component, ..message.clone() }));
        }
    }

    /// A question is answered, and an answer says what the clocks differ by.
    fn time_sync(&mut self, frame: &Frame<'_>, message: &TIMESYNC_DATA) {
        match message.tc1 {
            0 => self.shared.reply(Reply::TimeSync { asked: message.ts1 }),
            _ => self.poses.synchronise(frame, message),
        }
    }

    fn list_parameters(&mut self, _: &Frame<'_>, message: &PARAM_REQUEST_LIST_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            self.shared.reply(Reply::AllParameters);
        }
    }

    fn read_parameter(&mut self, _: &Frame<'_>, message: &PARAM_REQUEST_READ_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            // A negative index: by name.
            let name = match usize::try_from(message.param_index) {
                Ok(index) => Name::from_index(index),
                Err(_) => message.param_id.to_str().ok().and_then(Name::from_name),
            };
            self.reply_with_parameter(name);
        }
    }

    fn set_parameter(&mut self, _: &Frame<'_>, message: &PARAM_SET_DATA) {
        if self.is_addressed(message.target_system, message.target_component) {
            let name = message.param_id.to_str().ok().and_then(Name::from_name);
            if let Some(name) = name {
                self.set(name, message.param_value, message.param_type);
            }
            self.reply_with_parameter(name);
        }
    }

    /// Its value, as it is now, answers every question about a parameter.
    fn reply_with_parameter(&mut self, name: Option<Name>) {
        match name {
            Some(name) => self.shared.reply(Reply::Parameter(name)),
            None => self.refused(),
        }
    }

    fn set(&mut self, name: Name, value: f32, kind: MavParamType) {
        let shared = self.shared;
        let warn = |words: &dyn Display| shared.announce(Event::new(Severity::Warning, words));
        if shared.is_armed() {
            warn(&"Parameters change only while disarmed");
        } else if kind != MavParamType::MAV_PARAM_TYPE_REAL32 {
            warn(&format_args!("{}: is a REAL32", name.row().name));
        } else if let Err(error) = shared.parameters.set(name, value) {
            warn(&error);
        }
    }
}
