//! The vehicle as the link shows it: newest telemetry, its words, and its answers to commands.
//!
//! This side is a ground station: it sends a heartbeat each second, unless it is told to be silent.

use super::line::Line;
use crate::output::interrupt::Interrupt;
use firmware::frames;
use firmware::link::frame::{Frame, Parser};
use mavlink::dialects::common::{
    COMMAND_ACK_DATA, COMMAND_LONG_DATA, HEARTBEAT_DATA, HIGHRES_IMU_DATA, LOCAL_POSITION_NED_DATA, MavCmd,
    MavModeFlag, MavResult, MavType, NAMED_VALUE_FLOAT_DATA, PARAM_REQUEST_READ_DATA, PARAM_SET_DATA, PARAM_VALUE_DATA,
    STATUSTEXT_DATA, SYS_STATUS_DATA, VIBRATION_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MessageData};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// This side's MAVLink system and component: a ground station's.
const OWN_SYSTEM: u8 = 255;
const OWN_COMPONENT: u8 = 190;

/// Between heartbeats.
const HEARTBEAT_PERIOD: Duration = Duration::from_millis(500);

/// How long an answer may take, and how often a question is sent again.
const ANSWER_TIMEOUT: Duration = Duration::from_millis(1_500);
const ATTEMPTS_MAX: usize = 4;

/// How old a value may be that counts.
const VALUE_AGE_MAX: Duration = Duration::from_millis(2_500);

/// Why the walk ends before its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stop {
    /// A signal has come.
    Interrupted(u8),
    /// Nobody answers any more.
    Left,
    /// The vehicle does not answer: to what.
    Silent(String),
    /// A file cannot be written.
    Unwritable(String),
}

/// Something that came, and when.
type Seen<T> = Option<(T, Duration)>;

/// The time since the walk began, as the vehicle's passes: an emulated one's passes more slowly.
struct Clock {
    began: Instant,
    slower: f64,
}

impl Clock {
    fn now(&self) -> Duration {
        self.began.elapsed().div_f64(self.slower)
    }

    fn fresh<T: Clone>(&self, seen: &Seen<T>) -> Option<T> {
        seen.as_ref().filter(|(_, when)| self.now() - *when < VALUE_AGE_MAX).map(|(value, _)| value.clone())
    }
}

/// The link's end, and what came over it.
pub struct Vehicle {
    line: Line,
    interrupt: Interrupt,
    parser: Parser,
    sequence: u8,
    clock: Clock,
    /// When the next heartbeat is due; none while it keeps silent.
    heartbeat_due: Option<Duration>,
    system: u8,
    heartbeat: Seen<HEARTBEAT_DATA>,
    imu: Seen<(u64, Vector3<f32>, Vector3<f32>)>,
    position: Seen<LOCAL_POSITION_NED_DATA>,
    status: Seen<SYS_STATUS_DATA>,
    vibration: Seen<VIBRATION_DATA>,
    named: BTreeMap<String, (f32, Duration)>,
    texts: Vec<String>,
    answers: Vec<(MavCmd, MavResult)>,
    parameters: BTreeMap<String, f32>,
}

impl Vehicle {
    /// Nothing received yet, of a vehicle whose time passes so many times more slowly than ours.
    pub fn new(line: Line, interrupt: Interrupt, slower: f64) -> Self {
        Self {
            line,
            interrupt,
            parser: Parser::new(),
            sequence: 0,
            clock: Clock { began: Instant::now(), slower },
            heartbeat_due: Some(Duration::ZERO),
            system: 1,
            heartbeat: None,
            imu: None,
            position: None,
            status: None,
            vibration: None,
            named: BTreeMap::new(),
            texts: Vec::new(),
            answers: Vec::new(),
            parameters: BTreeMap::new(),
        }
    }

    /// The time since the walk began, as the vehicle's passes.
    pub fn now(&self) -> Duration {
        self.clock.now()
    }

    /// Takes what has come, for some 10 ms, and sends what is due.
    ///
    /// # Errors
    /// A signal.
    pub fn serve(&mut self) -> Result<(), Stop> {
        if let Some(signal) = self.interrupt.signal() {
            return Err(Stop::Interrupted(signal));
        }
        if self.heartbeat_due.is_some_and(|due| self.now() >= due) {
            self.heartbeat_due = Some(self.now() + HEARTBEAT_PERIOD);
            self.send(&HEARTBEAT_DATA { mavtype: MavType::MAV_TYPE_GCS, ..HEARTBEAT_DATA::DEFAULT });
        }
        let mut chunk = [0; 4096];
        let count = self.line.receive(&mut chunk);
        let now = self.now().as_micros() as u64;
        let mut parser = std::mem::replace(&mut self.parser, Parser::new());
        parser.feed(&chunk[..count], now, &mut |frame| self.take(frame));
        self.parser = parser;
        Ok(())
    }

    fn take(&mut self, frame: &Frame<'_>) {
        let now = self.now();
        if let Some(heartbeat) = frame.decode::<HEARTBEAT_DATA>() {
            // A companion's or another ground station's is not the vehicle's.
            if frame.header.component == 1 && heartbeat.mavtype == MavType::MAV_TYPE_QUADROTOR {
                self.system = frame.header.system;
                self.heartbeat = Some((heartbeat, now));
            }
            return;
        }
        if frame.header.system != self.system {
            return;
        }
        if let Some(imu) = frame.decode::<HIGHRES_IMU_DATA>() {
            let force = frames::body(&Vector3::new(imu.xacc, imu.yacc, imu.zacc));
            self.imu =
                Some(((imu.time_usec, force, frames::body(&Vector3::new(imu.xgyro, imu.ygyro, imu.zgyro))), now));
        } else if let Some(position) = frame.decode() {
            self.position = Some((position, now));
        } else if let Some(status) = frame.decode() {
            self.status = Some((status, now));
        } else if let Some(vibration) = frame.decode() {
            self.vibration = Some((vibration, now));
        } else if let Some(named) = frame.decode::<NAMED_VALUE_FLOAT_DATA>() {
            self.named.insert(named.name.to_str().unwrap_or("").to_owned(), (named.value, now));
        } else if let Some(text) = frame.decode::<STATUSTEXT_DATA>() {
            self.texts.push(text.text.to_str().unwrap_or("").to_owned());
        } else if let Some(answer) = frame.decode::<COMMAND_ACK_DATA>() {
            self.answers.push((answer.command, answer.result));
        } else if let Some(value) = frame.decode::<PARAM_VALUE_DATA>() {
            self.parameters.insert(value.param_id.to_str().unwrap_or("").to_owned(), value.param_value);
        }
    }

    /// Sends a message.
    pub fn send(&mut self, message: &impl MessageData) {
        let header = MavHeader { system_id: OWN_SYSTEM.into(), component_id: OWN_COMPONENT, sequence: self.sequence };
        self.sequence = self.sequence.wrapping_add(1);
        let mut frame = MAVLinkV2MessageRaw::new();
        frame.serialize_message_data(header, message);
        self.line.send(frame.raw_bytes());
    }

    /// Serves the link until `found` has something, or a time is over.
    ///
    /// # Errors
    /// A signal.
    pub fn wait<T>(
        &mut self,
        timeout: Duration,
        mut found: impl FnMut(&mut Self) -> Option<T>,
    ) -> Result<Option<T>, Stop> {
        let end = self.now() + timeout;
        loop {
            self.serve()?;
            if let Some(found) = found(self) {
                return Ok(Some(found));
            }
            if self.now() >= end {
                return Ok(None);
            }
        }
    }

    /// Serves the link for a while.
    ///
    /// # Errors
    /// A signal.
    pub fn pass(&mut self, time: Duration) -> Result<(), Stop> {
        self.wait(time, |_| None::<()>).map(drop)
    }

    /// Commands something; the answer, which may be that it is under way.
    ///
    /// # Errors
    /// No answer, or a signal.
    pub fn command(&mut self, command: MavCmd, parameters: [f32; 7]) -> Result<MavResult, Stop> {
        let [param1, param2, param3, param4, param5, param6, param7] = parameters;
        self.answers.clear();
        for confirmation in 0..ATTEMPTS_MAX {
            self.send(&COMMAND_LONG_DATA {
                param1,
                param2,
                param3,
                param4,
                param5,
                param6,
                param7,
                command,
                target_system: self.system,
                target_component: 1,
                confirmation: confirmation as u8,
            });
            if let Some(answer) = self.wait(ANSWER_TIMEOUT, |vehicle| vehicle.answer(command))? {
                return Ok(answer);
            }
        }
        Err(Stop::Silent(format!("command {}", command as u32)))
    }

    /// The newest answer to a command, taken away.
    pub fn answer(&mut self, command: MavCmd) -> Option<MavResult> {
        let place = self.answers.iter().rposition(|(of, _)| *of == command)?;
        Some(self.answers.remove(place).1)
    }

    /// A parameter's value, asked for.
    ///
    /// # Errors
    /// No answer, or a signal.
    pub fn parameter(&mut self, name: &str) -> Result<f32, Stop> {
        self.parameters.remove(name);
        self.question(name, |vehicle| {
            vehicle.send(&PARAM_REQUEST_READ_DATA {
                param_index: -1,
                target_system: vehicle.system,
                target_component: 1,
                param_id: name.into(),
            });
        })
    }

    /// Sets a parameter; what it is then.
    ///
    /// # Errors
    /// No answer, or a signal.
    pub fn set_parameter(&mut self, name: &str, value: f32) -> Result<f32, Stop> {
        self.parameters.remove(name);
        self.question(name, |vehicle| {
            vehicle.send(&PARAM_SET_DATA {
                param_value: value,
                target_system: vehicle.system,
                target_component: 1,
                param_id: name.into(),
                param_type: mavlink::dialects::common::MavParamType::MAV_PARAM_TYPE_REAL32,
            });
        })
    }

    fn question(&mut self, name: &str, ask: impl Fn(&mut Self)) -> Result<f32, Stop> {
        for _ in 0..ATTEMPTS_MAX {
            ask(self);
            if let Some(value) = self.wait(ANSWER_TIMEOUT, |vehicle| vehicle.parameters.get(name).copied())? {
                return Ok(value);
            }
        }
        Err(Stop::Silent(format!("parameter {name}")))
    }

    /// Has a message sent every so many us, for as long as the check takes.
    ///
    /// # Errors
    /// No answer, or a signal.
    pub fn stream<D: MessageData>(&mut self, interval_us: f32) -> Result<(), Stop> {
        let parameters = [D::ID as f32, interval_us, 0.0, 0.0, 0.0, 0.0, 0.0];
        self.command(MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, parameters).map(drop)
    }

    /// Sends heartbeats, or none.
    pub fn speak(&mut self, speaks: bool) {
        self.heartbeat_due = speaks.then(|| self.now());
    }

    /// Its last heartbeat, if that is recent.
    pub fn heartbeat(&self) -> Option<HEARTBEAT_DATA> {
        self.clock.fresh(&self.heartbeat)
    }

    /// Whether the last heartbeat has this flag.
    pub fn has(&self, flag: MavModeFlag) -> bool {
        self.heartbeat().is_some_and(|heartbeat| heartbeat.base_mode.contains(flag))
    }

    /// The newest sample: its time, us, specific force, m/s^2, and body rates, rad/s, in body axes.
    pub fn imu_sample(&self) -> Option<(u64, Vector3<f32>, Vector3<f32>)> {
        self.clock.fresh(&self.imu)
    }

    /// Where it is, m, north, east, down.
    pub fn position(&self) -> Option<Vector3<f32>> {
        self.clock.fresh(&self.position).map(|position| Vector3::new(position.x, position.y, position.z))
    }

    /// Its sensors and battery.
    pub fn status(&self) -> Option<SYS_STATUS_DATA> {
        self.clock.fresh(&self.status)
    }

    /// Levels, m/s^2, and samples at full scale.
    pub fn vibration(&self) -> Option<(Vector3<f32>, u32)> {
        let VIBRATION_DATA { vibration_x, vibration_y, vibration_z, clipping_0, .. } =
            self.clock.fresh(&self.vibration)?;
        Some((Vector3::new(vibration_x, vibration_y, vibration_z), clipping_0))
    }

    /// A named value, if it is recent: they come in turn.
    pub fn named(&self, name: &str) -> Option<f32> {
        self.named.get(name).filter(|(_, when)| self.now() - *when < 2 * VALUE_AGE_MAX).map(|(value, _)| *value)
    }

    /// Forgets named values, so that those to come are of now.
    pub fn forget_named(&mut self) {
        self.named.clear();
    }

    /// Words since the last time, taken away.
    pub fn texts(&mut self) -> Vec<String> {
        std::mem::take(&mut self.texts)
    }

    /// Whether it has said something that begins so; what it said before is forgotten.
    pub fn has_said(&mut self, beginning: &str) -> bool {
        match self.texts.iter().position(|text| text.starts_with(beginning)) {
            Some(place) => {
                self.texts.drain(..=place);
                true
            }
            None => false,
        }
    }

    /// Whether the line itself is there.
    pub fn is_connected(&self) -> bool {
        self.line.is_open()
    }
}
