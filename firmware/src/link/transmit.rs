//! What goes out, and when: telemetry by the clock; answers, replies and events as they come.
//!
//! Every write has [`WRITE_TIME_MAX`]; a line that takes no more loses frames, and holds up nothing but this task.

use super::frame::{FRAME_MAX, Header, encode, encode_payload};
use super::reply::{CommandResult, Reply};
use super::{COMPONENT, ping, telemetry};
use crate::hardware::Clock;
use crate::parameters::table::Name;
use crate::shared::{Answer, Event, Origin, Severity, Shared, Text};
use embassy_futures::select::{Either4, select, select4};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::Write;
use mavlink::MessageData;

/// The longest a frame may take to be written, us: 280 bytes take 49 ms at 57,600 baud.
pub const WRITE_TIME_MAX: u64 = 100_000;

/// Time between heartbeats, us.
pub const HEARTBEAT_INTERVAL: u64 = 1_000_000;

/// Time between the values of a list of parameters, us: slow enough to leave the line to the rest.
const LIST_INTERVAL: u64 = 20_000;

/// The greatest age of a report that is still sent, and of a voltage, us.
const REPORT_AGE_MAX: u64 = 1_000_000;

/// Transmits for ever.
pub async fn transmit<W: Write, M: RawMutex>(line: W, clock: &impl Clock, shared: &Shared<M>) -> ! {
    let mut transmitter = Transmitter { line, clock, shared, sequence: 0, told: 0 };
    let mut schedule = Schedule::new(clock.now());
    loop {
        let (replies, answers, events) = (&shared.replies, &shared.answers, &shared.events);
        match select4(clock.until(schedule.next()), replies.receive(), answers.receive(), events.receive()).await {
            Either4::First(()) => transmitter.scheduled(&mut schedule).await,
            Either4::Second(Reply::AllParameters) => schedule.list = Some((0, clock.now())),
            Either4::Second(reply) => transmitter.reply(reply).await,
            Either4::Third(answer) => transmitter.answer(answer).await,
            Either4::Fourth(event) => transmitter.send(&telemetry::text(&event)).await,
        }
    }
}

/// When what is due, us.
struct Schedule {
    heartbeat: u64,
    state: u64,
    /// The next of a list of parameters.
    list: Option<(usize, u64)>,
}

impl Schedule {
    fn new(now: u64) -> Self {
        Self { heartbeat: now, state: now, list: None }
    }

    fn next(&self) -> u64 {
        self.list.map_or(u64::MAX, |(_, time)| time).min(self.heartbeat).min(self.state)
    }
}

/// The time after `due` by whole intervals that lies after `now`: a late transmission does not bring a burst of others.
fn following(due: u64, interval: u64, now: u64) -> u64 {
    let next = due.saturating_add(interval);
    if next > now { next } else { now.saturating_add(interval) }
}

/// Writes messages.
struct Transmitter<'a, W: Write, C: Clock, M: RawMutex> {
    line: W,
    clock: &'a C,
    shared: &'a Shared<M>,
    sequence: u8,
    /// Lost events that were told of.
    told: u32,
}

impl<W: Write, C: Clock, M: RawMutex> Transmitter<'_, W, C, M> {
    /// Sends what is due by now.
    async fn scheduled(&mut self, schedule: &mut Schedule) {
        let now = self.clock.now();
        if now >= schedule.state {
            // Within 10 and 50 Hz, as the table has it.
            let interval = (1e6 / self.shared.parameters.get(Name::TelemetryRate)) as u64;
            schedule.state = following(schedule.state, interval, now);
            self.state(now).await;
        }
        if now >= schedule.heartbeat {
            schedule.heartbeat = following(schedule.heartbeat, HEARTBEAT_INTERVAL, now);
            self.heartbeat(now).await;
        }
        if let Some((index, time)) = schedule.list.filter(|&(_, time)| now >= time) {
            let name = Name::from_index(index);
            schedule.list = name.map(|_| (index + 1, following(time, LIST_INTERVAL, now)));
            if let Some(name) = name {
                self.parameter(name).await;
            }
        }
    }

    async fn state(&mut self, now: u64) {
        let Some(report) = self.shared.report.get().filter(|report| report.age(now) <= REPORT_AGE_MAX) else { return };
        if let Some(attitude) = telemetry::attitude(&report) {
            self.send(&attitude).await;
        }
        if let Some(position) = telemetry::position(&report) {
            self.send(&position).await;
        }
    }

    async fn heartbeat(&mut self, now: u64) {
        let shared = self.shared;
        let report = shared.report.get().filter(|report| report.age(now) <= REPORT_AGE_MAX).map(|report| report.value);
        let mode = report.map(|report| report.mode);
        self.send(&telemetry::heartbeat(mode, shared.hil.is_raised())).await;
        let voltage = shared.voltage.get().filter(|voltage| voltage.age(now) <= REPORT_AGE_MAX);
        let traffic = shared.traffic.get().map_or_else(Default::default, |traffic| traffic.value);
        self.send(&telemetry::status(voltage.map(|voltage| voltage.value), report.as_ref(), traffic)).await;
        let lost = shared.lost_events();
        if lost != self.told {
            let text = Text::new(format_args!("{} events lost", lost.wrapping_sub(self.told)));
            self.told = lost;
            self.send(&telemetry::text(&Event { severity: Severity::Warning, text })).await;
        }
    }

    async fn reply(&mut self, reply: Reply) {
        match reply {
            Reply::Command { origin, result } => self.acknowledge(&origin, result).await,
            Reply::Ping { time, sequence, system, component } => {
                self.send(&ping::answer(time, sequence, system, component)).await;
            }
            Reply::Parameter(name) => self.parameter(name).await,
            // Sent by the schedule.
            Reply::AllParameters => {}
        }
    }

    async fn answer(&mut self, answer: Answer) {
        let result = if answer.result.is_ok() { CommandResult::Accepted } else { CommandResult::Denied };
        self.acknowledge(&answer.origin, result).await;
    }

    async fn parameter(&mut self, name: Name) {
        let value = self.shared.parameters.get(name);
        self.send(&telemetry::parameter(name, value)).await;
    }

    async fn acknowledge(&mut self, origin: &Origin, result: CommandResult) {
        let payload = telemetry::acknowledgement(origin, result);
        let (message, extra_crc) = telemetry::ACKNOWLEDGEMENT;
        let mut buffer = [0; FRAME_MAX];
        let header = self.header();
        let frame = encode_payload(header, message, extra_crc, &payload, &mut buffer);
        self.write(frame).await;
    }

    async fn send<D: MessageData>(&mut self, message: &D) {
        let mut buffer = [0; FRAME_MAX];
        let header = self.header();
        self.write(encode(header, message, &mut buffer)).await;
    }

    fn header(&mut self) -> Header {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        Header { system: self.shared.parameters.get(Name::SystemId) as u8, component: COMPONENT, sequence }
    }

    /// Writes one frame in its time or gives it up: what is out of it by then, its receiver takes for noise.
    async fn write(&mut self, frame: &[u8]) {
        let end = self.clock.now().saturating_add(WRITE_TIME_MAX);
        let line = &mut self.line;
        let all = async {
            let mut rest = frame;
            while let Ok(count @ 1..) = line.write(rest).await {
                rest = rest.get(count..).unwrap_or(&[]);
                if rest.is_empty() {
                    break;
                }
            }
        };
        let _ = select(all, self.clock.until(end)).await;
    }
}
