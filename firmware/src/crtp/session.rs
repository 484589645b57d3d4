//! A client's session: each packet to what it is about, and what goes back.
//!
//! Nothing here waits. Without a key any client commands, as over MAVLink. Packets of this protocol cannot be signed: a
//! vehicle whose key keeps out what is not signed answers questions, and takes neither commands nor setpoints, poses,
//! parameters or trajectories.

use super::errors::{BUSY, UNKNOWN_COMMAND};
use super::flying::Flying;
use super::high_level::Command;
use super::localisation::{Localised, localised};
use super::log::{Log, Variables, View};
use super::packet::{DATA_MAX_BYTES, Packet};
use super::parameters::{Desk, Settable};
use super::setpoint::Streamed;
use super::{contents, errors, high_level, memories, platform, ports, setpoint, supervisor};
use crate::link::commander::COMMANDER_TIMEOUT_US;
use crate::link::pose::{PoseRefusal, SOURCE_TIMEOUT_US};
use crate::link::setpoint::Here;
use crate::parameters::table::Name;
use crate::shared::{CrtpView, Event, Protocol, QueuedRequest, Report, Severity, TEXT_MAX, Text};
use core::fmt;
use embassy_sync::blocking_mutex::raw::RawMutex;
use estimation::estimator::PoseMeasurement;
use flight::{Mode, PoseError, Request, Stamped};
use heapless::{Deque, Vec};

/// Packets that wait to be sent. Where there is no room, none is taken in.
const OUTGOING_MAX: usize = 8;

/// How long a client may be silent and still be there.
const CLIENT_TIMEOUT_US: u64 = 10_000_000;

/// How often the console is looked at.
const CONSOLE_INTERVAL_US: u64 = 50_000;

/// How long a command to arm may take until it is answered.
const ARMING_MAX_US: u64 = 100_000;

/// The greatest age of what is logged.
const AGE_MAX_US: u64 = 1_000_000;

/// How long the watchdog of the emergency stop goes without being fed.
const WATCHDOG_MAX_US: u64 = 1_000_000;

/// The channel of a packet without meaning, which radios and scanning clients send.
const NOTHING: (u8, u8) = (ports::LINK, 3);

/// What a command waits for, to be answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wish {
    Arm,
    Disarm,
    Recover,
}

/// A command that is not answered yet.
#[derive(Debug, Clone)]
struct Wished {
    /// The beginning of its answer.
    answer: Packet,
    wish: Wish,
    /// us.
    answered_by: u64,
}

/// A client's session.
pub struct Session<'a, M: RawMutex> {
    shared: CrtpView<'a, M>,
    log: Log,
    desk: Desk<'a, M>,
    flying: Flying<'a, M>,
    outgoing: Deque<Packet, OUTGOING_MAX>,
    /// What is left of a text on its way to the console.
    text: Vec<u8, { TEXT_MAX + 1 }>,
    /// When the client was last heard, us.
    heard: Option<u64>,
    wished: Option<Wished>,
    /// When the last pose was true, us.
    posed: Option<u64>,
    /// When the watchdog of the emergency stop was fed, us; none before the first time.
    fed: Option<u64>,
}

impl<'a, M: RawMutex> Session<'a, M> {
    /// No client yet; trajectories are uploaded to `memory`.
    pub const fn new(shared: CrtpView<'a, M>, memory: &'a mut [u8]) -> Self {
        Self {
            shared,
            log: Log::new(),
            desk: Desk::new(shared),
            flying: Flying::new(shared, memory),
            outgoing: Deque::new(),
            text: Vec::new(),
            heard: None,
            wished: None,
            posed: None,
            fed: None,
        }
    }

    /// Whether another packet may come: its answer has a place.
    pub fn has_room(&self) -> bool {
        !self.outgoing.is_full()
    }

    /// When [`Self::next`] may have something, us.
    pub fn due(&self, now: u64) -> u64 {
        let later = |interval| now.saturating_add(interval);
        let console = if self.heard.is_some() { later(CONSOLE_INTERVAL_US) } else { u64::MAX };
        let wished = if self.wished.is_some() { later(CONSOLE_INTERVAL_US / 10) } else { u64::MAX };
        self.log.due().min(self.flying.due(now)).min(console).min(wished)
    }

    /// Acts on a packet that came at `now`, us.
    pub fn take(&mut self, packet: &Packet, now: u64) {
        if (packet.port, packet.channel) == NOTHING || !ports::ALL.contains(&packet.port) {
            return;
        }
        self.heard = Some(now);
        self.shared.has_console().raise();
        self.shared.ground_station().put((), now);
        let answer = self.answer(packet, now);
        self.send(answer);
    }

    fn send(&mut self, packet: Option<Packet>) {
        if let Some(packet) = packet {
            // There is room, or the packet would not have been taken in.
            let _ = self.outgoing.push_back(packet);
        }
    }

    fn answer(&mut self, packet: &Packet, now: u64) -> Option<Packet> {
        match (packet.port, packet.channel) {
            (ports::PARAMETERS, 0) => return contents::answer::<Settable>(packet),
            (ports::PARAMETERS, 1) => return self.desk.act(packet, false),
            (ports::PARAMETERS, _) => {
                let may_set = self.is_trusted();
                return self.desk.act(packet, may_set);
            }
            (ports::LOG, 0) => return contents::answer::<Variables>(packet),
            (ports::LOG, 1) => return self.log.control(packet, now),
            (ports::MEMORY, channel) => {
                let may_write = channel != memories::WRITE || self.is_trusted();
                let is_flown = self.flying.flies_pieces();
                return memories::answer(packet, &mut self.flying.pieces, is_flown, may_write);
            }
            (ports::COMMANDER | ports::SETPOINT, _) => self.stream(packet, now),
            (ports::HIGH_LEVEL, 0) => return self.high_level(packet, now),
            (ports::LOCALISATION, _) => self.localise(packet, now),
            (ports::SUPERVISOR, 0) => return self.supervised(packet),
            (ports::SUPERVISOR, 1) => self.supervise(packet, now),
            (ports::PLATFORM, 0) => return self.platform(packet, now),
            _ => return platform::answer(packet),
        }
        None
    }

    /// Whether this client is one that may command, by the key; says so if it is not.
    fn is_trusted(&self) -> bool {
        let must_be_signed = self.shared.parameters().get(Name::SignedOnly) > 0.0;
        let is_kept_out = self.shared.signing().keeps_out_unsigned(must_be_signed);
        if is_kept_out {
            self.warn(format_args!("Refused: CRTP cannot be signed (SIGN_ONLY)"));
        }
        !is_kept_out
    }

    fn warn(&self, words: fmt::Arguments<'_>) {
        self.shared.announce(Event::new(Severity::Warning, words));
    }

    fn report(&self) -> Option<Report> {
        self.shared.report().get().map(|report| report.value)
    }

    fn stream(&mut self, packet: &Packet, now: u64) {
        let state = self.report().and_then(|report| report.state);
        match setpoint::streamed(packet, state.as_ref().and_then(Here::at).as_ref()) {
            Ok(Streamed::Nothing) => self.flying.stream(&Streamed::Nothing, now),
            Ok(streamed) if self.is_trusted() => self.flying.stream(&streamed, now),
            Ok(_) => {}
            Err(refusal) => self.warn(format_args!("Setpoint refused: {refusal}")),
        }
    }

    fn high_level(&mut self, packet: &Packet, now: u64) -> Option<Packet> {
        let groups = self.desk.settings.group as u8;
        let result = match high_level::read(packet.data()) {
            None => Err(UNKNOWN_COMMAND),
            Some((group, _)) if group != 0 && group & groups == 0 => Ok(()),
            Some(_) if !self.is_trusted() => Err(BUSY),
            Some((_, Command::SetGroup(group))) => {
                self.desk.settings.group = group.into();
                Ok(())
            }
            Some((_, command)) => self.flying.command(&command, &self.desk.settings, now),
        };
        if let Err(error) = result {
            self.warn(format_args!(
                "Command {} refused: {}",
                packet.data().first().unwrap_or(&0),
                errors::words(error)
            ));
        }
        // Three bytes of the command, whether it has as many or not.
        let said = [0, 1, 2].map(|place| packet.data().get(place).copied().unwrap_or(0));
        Some(Packet::new(ports::HIGH_LEVEL, 0).with(&said).with(&[result.err().unwrap_or(0)]))
    }

    fn localise(&mut self, packet: &Packet, now: u64) {
        let number = self.shared.parameters().get(Name::RadioAddress) as u8;
        match localised(packet, number, &self.desk.settings, self.report().as_ref()) {
            Some(Localised::Pose(pose)) if self.is_trusted() => self.pose(pose, now),
            Some(Localised::EmergencyStop) if self.is_trusted() => self.emergency_stop(now),
            Some(Localised::WatchdogFed) if self.is_trusted() => self.fed = Some(now),
            _ => {}
        }
    }

    fn pose(&mut self, pose: Result<PoseMeasurement, PoseError>, now: u64) {
        let shared = self.shared;
        // In a simulation the simulator sends the poses.
        if shared.hil().is_raised() {
            return;
        }
        let heard = shared.pose_protocol().get();
        let is_second = heard.is_some_and(|heard| heard.value != Protocol::Crtp && heard.age(now) <= SOURCE_TIMEOUT_US);
        let value = match pose {
            _ if is_second => return self.warn(format_args!("Pose refused: {}", PoseRefusal::SecondSource)),
            Err(error) => return self.warn(format_args!("Pose refused: {error}")),
            Ok(pose) => pose,
        };
        // Milliseconds, within 0 and 150, as the table has it. Packets have no time of their own.
        let delay = (shared.parameters().get(Name::PoseDelay) * 1e3) as u64;
        if delay == 0 {
            shared.pose_delay_unknown().raise();
        } else {
            shared.pose_delay_unknown().lower();
        }
        shared.pose_protocol().put(Protocol::Crtp, now);
        let time = now.saturating_sub(delay);
        // Of two that a busy sender sends at once the first will do.
        if self.posed.is_none_or(|last| last < time) {
            self.posed = Some(time);
            // Where control does not take them, one more or less makes no difference.
            let _ = shared.poses().put(Stamped { value, time });
        }
    }

    /// Stops the motors, in the air as well.
    fn emergency_stop(&mut self, now: u64) {
        self.fed = None;
        let Some(armed) = self.shared.commander().get().filter(|_| self.shared.is_armed()) else { return };
        let heard = self.shared.commander_heard().get().map_or(armed.time, |heard| heard.time.max(armed.time));
        if armed.value.is_some() && now.saturating_sub(heard) <= COMMANDER_TIMEOUT_US {
            return self.warn(format_args!("Refused: another station commands"));
        }
        self.flying.forget();
        self.shared.request_disarm();
    }

    fn bits(&self) -> u16 {
        supervisor::bits(self.report().as_ref(), self.flying.path())
    }

    fn supervised(&self, packet: &Packet) -> Option<Packet> {
        let (&question, bits) = (packet.data().first()?, self.bits());
        let answer = Packet::new(ports::SUPERVISOR, 0).with(&[question | supervisor::ANSWERED]);
        match question {
            supervisor::ALL_BITS => Some(answer.with(&bits.to_le_bytes())),
            1.. if question < supervisor::ALL_BITS => Some(answer.with(&[(bits >> (question - 1) & 1) as u8])),
            _ => None,
        }
    }

    fn supervise(&mut self, packet: &Packet, now: u64) {
        let [command, rest @ ..] = packet.data() else { return };
        let answer = Packet::new(ports::SUPERVISOR, 1).with(&[command | supervisor::ANSWERED]);
        match (*command, rest) {
            (supervisor::ARM, [arm, ..]) => self.wish(answer, if *arm == 0 { Wish::Disarm } else { Wish::Arm }, now),
            (supervisor::RECOVER, _) => self.wish(answer, Wish::Recover, now),
            (supervisor::EMERGENCY_STOP, _) if self.is_trusted() => self.emergency_stop(now),
            (supervisor::FEED_WATCHDOG, _) if self.is_trusted() => self.fed = Some(now),
            _ => {}
        }
    }

    /// Older clients arm and recover on this port. What else it has, a test tone and a light, is answered and not done.
    fn platform(&mut self, packet: &Packet, now: u64) -> Option<Packet> {
        let answer = Packet::new(ports::PLATFORM, 0).with(packet.data().get(..1)?);
        match packet.data() {
            [1, arm, ..] => self.wish(answer, if *arm == 0 { Wish::Disarm } else { Wish::Arm }, now),
            [2, ..] => self.wish(answer, Wish::Recover, now),
            _ => return Some(packet.clone()),
        }
        None
    }

    /// Requests what a command wishes; the answer waits for control.
    fn wish(&mut self, answer: Packet, wish: Wish, now: u64) {
        if self.is_trusted() {
            let request = if wish == Wish::Arm { Request::Arm } else { Request::Disarm };
            self.shared.request(QueuedRequest { request, order: None, setpoints: None });
        }
        self.wished = Some(Wished { answer, wish, answered_by: now.saturating_add(ARMING_MAX_US) });
    }

    /// The answer to what was wished, once it came true or has had its time.
    fn wished(&mut self, now: u64) -> Option<Packet> {
        let mode = self.report().map_or(Mode::Boot, |report| report.mode);
        let Wished { answer, wish, answered_by } = self.wished.as_ref()?;
        let (is_done, state) = match wish {
            Wish::Arm => (mode.is_armed(), mode.is_armed()),
            Wish::Disarm => (!mode.is_armed(), mode.is_armed()),
            Wish::Recover => (mode != Mode::Stopped, mode != Mode::Stopped),
        };
        if !is_done && now < *answered_by {
            return None;
        }
        let answer = answer.clone().with(&[is_done.into(), state.into()]);
        self.wished = None;
        Some(answer)
    }

    /// Part of a text for the console.
    fn console(&mut self) -> Option<Packet> {
        if self.text.is_empty() {
            let event = self.shared.console().take()?;
            let text = Text::new(&event);
            // There is room for a text and the end of its line.
            let _ = self.text.extend_from_slice(text.as_str().as_bytes());
            let _ = self.text.push(b'\n');
        }
        let count = self.text.len().min(DATA_MAX_BYTES);
        let packet = Packet::new(ports::CONSOLE, 0).with(self.text.get(..count)?);
        self.text = Vec::from_slice(self.text.get(count..)?).unwrap_or_default();
        Some(packet)
    }

    /// What goes out next at `now`, us.
    pub fn next(&mut self, now: u64) -> Option<Packet> {
        if self.heard.is_some_and(|heard| now.saturating_sub(heard) > CLIENT_TIMEOUT_US) {
            self.end();
        }
        if self.fed.is_some_and(|fed| now.saturating_sub(fed) > WATCHDOG_MAX_US) {
            self.warn(format_args!("Emergency stop: its watchdog was not fed"));
            self.emergency_stop(now);
        }
        if let Some(packet) = self.outgoing.pop_front() {
            return Some(packet);
        }
        if let Some(packet) = self.wished(now).or_else(|| self.console()) {
            return Some(packet);
        }
        if self.log.due() > now {
            return None;
        }
        let view = self.view(now);
        self.log.next(now, &view)
    }

    /// Leads the vehicle along the path of a command, if there is one.
    pub fn lead(&mut self, now: u64) {
        self.flying.lead(now);
    }

    /// The client is gone.
    fn end(&mut self) {
        self.heard = None;
        self.log = Log::new();
        self.shared.has_console().lower();
        while self.shared.console().take().is_some() {}
    }

    fn view(&self, now: u64) -> View {
        let shared = self.shared;
        View {
            report: shared.report().recent(AGE_MAX_US, now),
            imu: shared.imu().recent(AGE_MAX_US, now),
            voltage: shared.voltage().recent(AGE_MAX_US, now),
            rotor_speeds: shared.rotor_speeds().recent(AGE_MAX_US, now),
            supervisor: self.bits(),
            battery_low: shared.parameters().get(Name::BatteryLow),
        }
    }
}
