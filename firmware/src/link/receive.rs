//! What comes in: bytes to frames, frames to values for the other tasks.
//!
//! A message that cannot be used changes nothing, is counted and, once a second at most, reported in words. No input
//! panics.

#![expect(deprecated, reason = "superseded messages: clients still send them")]

use super::COMPONENT_ID;
use super::commander::Commander;
use super::frame::{Frame, Parser};
use super::pose::{PoseRefusal, Poses, SOURCE_TIMEOUT_US, is_pose};
use super::repetitions::Repetitions;
use super::set_mode::SetMode;
use crate::hardware::Clock;
use crate::parameters::table::Name;
use crate::shared::{Event, Ping, Protocol, ReceiveView, Reply, Severity, Traffic};
use addressed::Addressed;
use core::fmt::Display;
use embassy_futures::select::{Either, select};
use embassy_futures::yield_now;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::Read;
use explained::Explained;
use mavlink::MessageData;
use mavlink::dialects::common::{
    COMMAND_INT_DATA, COMMAND_LONG_DATA, FILE_TRANSFER_PROTOCOL_DATA, HEARTBEAT_DATA, LOG_ERASE_DATA,
    LOG_REQUEST_DATA_DATA, LOG_REQUEST_END_DATA, LOG_REQUEST_LIST_DATA, MISSION_ACK_DATA, MISSION_CLEAR_ALL_DATA,
    MISSION_COUNT_DATA, MISSION_ITEM_DATA, MISSION_ITEM_INT_DATA, MISSION_REQUEST_DATA, MISSION_REQUEST_INT_DATA,
    MISSION_REQUEST_LIST_DATA, MISSION_SET_CURRENT_DATA, MavType, PARAM_REQUEST_LIST_DATA, PARAM_REQUEST_READ_DATA,
    PARAM_SET_DATA, SET_GPS_GLOBAL_ORIGIN_DATA, SET_POSITION_TARGET_LOCAL_NED_DATA, SETUP_SIGNING_DATA, TIMESYNC_DATA,
};
use senders::Senders;
use upload::Upload;

mod addressed;
mod commands;
mod explained;
mod foreign;
mod missions;
mod parameters;
mod places;
mod recordings;
mod senders;
mod setpoint_clock;
mod setpoints;
mod signatures;
mod upload;

/// The longest wait for bytes. Nothing hangs on it: it keeps the wait a bounded one.
const READ_TIMEOUT_US: u64 = 1_000_000;

/// The wait after a line that failed.
const RETRY_DELAY_US: u64 = 10_000;

/// The least interval between texts about one kind of refusal.
const TEXT_INTERVAL_US: u64 = 1_000_000;

/// The least interval between answers to TIMESYNC.
const TIME_INTERVAL_US: u64 = 20_000;

/// Bytes read at once.
const READ_CHUNK_BYTES: usize = 64;

/// Receives for ever.
pub async fn receive<R: Read, M: RawMutex>(mut line: R, clock: &impl Clock, shared: ReceiveView<'_, M>) -> ! {
    let mut parser = Parser::new();
    let mut receiver = Receiver::new(shared);
    let mut chunk = [0; READ_CHUNK_BYTES];
    let mut on_port = shared.on_port().is_raised();
    let mut has_retried = false;
    loop {
        let wake = clock.now().saturating_add(READ_TIMEOUT_US);
        match select(line.read(&mut chunk), clock.until(wake)).await {
            Either::First(Ok(count @ 1..)) => {
                has_retried = false;
                let now = clock.now();
                if on_port != shared.on_port().is_raised() {
                    on_port = !on_port;
                    parser.forget();
                }
                parser.feed(chunk.get(..count).unwrap_or(&chunk), now, &mut |frame| receiver.take(frame));
                receiver.count(parser.discarded(), now);
                // A burst has more questions than answers can wait: the other half sends them in between.
                yield_now().await;
            }
            // The read that reports an overrun has ended it. Whoever waits then, on a line that is never silent for
            // that long, finds the next overrun, and never a byte.
            Either::First(_) if !has_retried => {
                has_retried = true;
                yield_now().await;
            }
            // A line that ended or failed may come back, but must not take all the time there is.
            Either::First(_) => {
                has_retried = false;
                clock.until(clock.now().saturating_add(RETRY_DELAY_US)).await;
            }
            Either::Second(()) => {}
        }
    }
}

/// Limits the rate of one text.
#[derive(Debug, Default)]
struct RateLimit {
    not_before: u64,
}

impl RateLimit {
    fn warn<M: RawMutex>(&mut self, shared: ReceiveView<'_, M>, now: u64, words: impl Display) {
        if now >= self.not_before {
            self.not_before = now.saturating_add(TEXT_INTERVAL_US);
            shared.announce(Event::new(Severity::Warning, words));
        }
    }
}

/// Acts on frames.
pub struct Receiver<'a, M: RawMutex> {
    shared: ReceiveView<'a, M>,
    poses: Poses,
    repetitions: Repetitions,
    commander: Commander,
    pose_refused: RateLimit,
    setpoint_refused: RateLimit,
    stranger_refused: RateLimit,
    log_refused: RateLimit,
    parameter_refused: RateLimit,
    signature_refused: RateLimit,
    /// When TIMESYNC may be answered again, us.
    next_time_sent: u64,
    traffic: Traffic,
    setpoints: Senders,
    foreign: Explained,
    upload: Upload,
}

impl<'a, M: RawMutex> Receiver<'a, M> {
    /// Nothing received yet.
    pub fn new(shared: ReceiveView<'a, M>) -> Self {
        Self {
            shared,
            poses: Poses::default(),
            repetitions: Repetitions::default(),
            commander: Commander::default(),
            pose_refused: RateLimit::default(),
            setpoint_refused: RateLimit::default(),
            stranger_refused: RateLimit::default(),
            log_refused: RateLimit::default(),
            parameter_refused: RateLimit::default(),
            signature_refused: RateLimit::default(),
            next_time_sent: 0,
            traffic: Traffic::default(),
            setpoints: Senders::default(),
            foreign: Explained::default(),
            upload: Upload::default(),
        }
    }

    /// Acts on one frame.
    pub fn take(&mut self, frame: &Frame<'_>) {
        let own = self.own_system();
        self.traffic.frames = self.traffic.frames.wrapping_add(1);
        // Our own frames, echoed by the line.
        if (frame.header.system, frame.header.component) == (own, COMPONENT_ID) {
            return;
        }
        if self.is_genuine(frame) {
            self.dispatch(frame);
        }
    }

    /// Acts on a frame that counts. Never inlined: what it calls would not be inlined any more, 600 bytes more.
    #[inline(never)]
    fn dispatch(&mut self, frame: &Frame<'_>) {
        let sender = (frame.header.system, frame.header.component);
        self.retry_upload(frame.time);
        if self.commander.receive(sender, self.shared.commander().get(), frame.time) {
            self.shared.commander_heard().put((), frame.time);
        }
        match frame.message {
            HEARTBEAT_DATA::ID => self.decoded(frame, Self::heartbeat),
            message if is_pose(message) => self.pose(frame),
            SET_POSITION_TARGET_LOCAL_NED_DATA::ID => self.addressed(frame, Self::setpoint),
            COMMAND_LONG_DATA::ID => self.command(frame, frame.decode::<COMMAND_LONG_DATA>().as_ref()),
            COMMAND_INT_DATA::ID => self.command(frame, frame.decode::<COMMAND_INT_DATA>().as_ref()),
            SetMode::ID => self.command(frame, Some(&SetMode::read(frame))),
            SET_GPS_GLOBAL_ORIGIN_DATA::ID => self.addressed(frame, Self::set_origin),
            MISSION_COUNT_DATA::ID => self.addressed(frame, Self::mission_count),
            MISSION_ITEM_INT_DATA::ID | MISSION_ITEM_DATA::ID => self.mission_item(frame),
            MISSION_ACK_DATA::ID => self.addressed(frame, Self::mission_ack),
            MISSION_REQUEST_DATA::ID => self.addressed(frame, Self::mission_request),
            MISSION_REQUEST_INT_DATA::ID => self.addressed(frame, Self::mission_request_int),
            MISSION_SET_CURRENT_DATA::ID => self.addressed(frame, Self::mission_set_current),
            MISSION_REQUEST_LIST_DATA::ID => self.addressed(frame, Self::mission_list),
            MISSION_CLEAR_ALL_DATA::ID => self.addressed(frame, Self::mission_clear),
            FILE_TRANSFER_PROTOCOL_DATA::ID => self.file(frame),
            TIMESYNC_DATA::ID => self.decoded(frame, Self::time_sync),
            SETUP_SIGNING_DATA::ID => self.addressed(frame, Self::set_up_signing),
            Ping::ID => self.decoded(frame, Self::ping),
            PARAM_REQUEST_LIST_DATA::ID => self.addressed(frame, Self::list_parameters),
            PARAM_REQUEST_READ_DATA::ID => self.addressed(frame, Self::read_parameter),
            LOG_REQUEST_LIST_DATA::ID => self.addressed(frame, Self::list_recordings),
            LOG_REQUEST_DATA_DATA::ID => self.addressed(frame, Self::read_recording),
            LOG_REQUEST_END_DATA::ID => self.addressed(frame, Self::end_reading),
            LOG_ERASE_DATA::ID => self.addressed(frame, Self::erase_recordings),
            PARAM_SET_DATA::ID => self.addressed(frame, Self::set_parameter),
            _ => self.foreign(frame),
        }
    }

    /// Acts on the frame's message, or counts it as refused if it is no such message.
    fn decoded<D: MessageData>(&mut self, frame: &Frame<'_>, act: fn(&mut Self, &Frame<'_>, &D)) {
        match frame.decode() {
            Some(message) => act(self, frame, &message),
            None => self.refused(),
        }
    }

    /// The same of a message that is for this vehicle or for everyone; others are left alone.
    fn addressed<D: MessageData + Addressed>(&mut self, frame: &Frame<'_>, act: fn(&mut Self, &Frame<'_>, &D)) {
        match frame.decode::<D>() {
            Some(message) if self.is_target(message.target()) => act(self, frame, &message),
            Some(_) => {}
            None => self.refused(),
        }
    }

    /// Whether an addressee is this vehicle or everyone.
    #[inline(never)] // or each message would get a copy
    fn is_target(&self, (system, component): (u8, u8)) -> bool {
        (system == 0 || system == self.own_system()) && (component == 0 || component == COMPONENT_ID)
    }

    /// Shares the counts, with the parser's.
    fn count(&mut self, discarded: u32, now: u64) {
        self.traffic.discarded = discarded;
        self.shared.traffic().put(self.traffic, now);
    }

    fn own_system(&self) -> u8 {
        // Whole and within 1 to 255, as the table has it.
        self.shared.parameters().get(Name::SystemId) as u8
    }

    fn refused(&mut self) {
        self.traffic.refused = self.traffic.refused.wrapping_add(1);
    }

    /// Any ground station's will do. A companion computer's does not: it goes on without an operator.
    fn heartbeat(&mut self, frame: &Frame<'_>, message: &HEARTBEAT_DATA) {
        if message.mavtype == MavType::MAV_TYPE_GCS {
            self.shared.ground_station().put((), frame.time);
            self.commander.add_ground_station((frame.header.system, frame.header.component));
        }
    }

    fn pose(&mut self, frame: &Frame<'_>) {
        // In a simulation the simulator sends the poses.
        if self.shared.hil().is_raised() {
            return;
        }
        let heard = self.shared.pose_protocol().get();
        if heard.is_some_and(|heard| heard.value != Protocol::Mavlink && heard.age(frame.time) <= SOURCE_TIMEOUT_US) {
            return self.pose_refused(frame.time, PoseRefusal::SecondSource);
        }
        // Milliseconds, within 0 and 150, as the table has it.
        let delay = (self.shared.parameters().get(Name::PoseDelay) * 1e3) as u64;
        match self.poses.take(frame, delay) {
            Ok(Some(pose)) => {
                if delay == 0 && !self.poses.is_synchronised() {
                    self.shared.pose_delay_unknown().raise();
                } else {
                    self.shared.pose_delay_unknown().lower();
                }
                self.shared.pose_protocol().put(Protocol::Mavlink, frame.time);
                // Where control does not take them, one more or less makes no difference.
                let _ = self.shared.poses().put(pose);
            }
            Ok(None) => {}
            Err(refusal) => self.pose_refused(frame.time, refusal),
        }
    }

    fn pose_refused(&mut self, now: u64, refusal: PoseRefusal) {
        self.refused();
        self.pose_refused.warn(self.shared, now, format_args!("Pose refused: {refusal}"));
    }

    /// Back to its sender. One with a target is itself an answer.
    fn ping(&mut self, frame: &Frame<'_>, message: &Ping) {
        if (message.target_system, message.target_component) == (0, 0) {
            let (target_system, target_component) = (frame.header.system, frame.header.component);
            self.shared.reply(Reply::Ping(Ping { target_system, target_component, ..message.clone() }));
        }
    }

    /// Answers a question; an answer gives the clocks' offset.
    fn time_sync(&mut self, frame: &Frame<'_>, message: &TIMESYNC_DATA) {
        match message.tc1 {
            // Two clocks at zero would ask each other for ever.
            0 if frame.time >= self.next_time_sent => {
                self.next_time_sent = frame.time.saturating_add(TIME_INTERVAL_US);
                self.shared.reply(Reply::TimeSync { asked: message.ts1 });
            }
            0 => {}
            _ => self.poses.synchronise(frame, message),
        }
    }
}
