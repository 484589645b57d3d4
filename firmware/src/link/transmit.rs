//! What goes out, and when: telemetry by the clock; answers, replies and events as they come.
//!
//! Every write has [`WRITE_TIME_MAX`]; a line that takes no more loses frames, and holds up nothing but this task.

use super::telemetry;
use super::time_sync;
use super::writer::Writer;
use crate::deadline::send;
use crate::hardware::Clock;
use crate::parameters::table::Name;
use crate::shared::{Event, Reply, Report, Severity, Shared};
use controller_core::flight::Stamped;
use embassy_futures::select::select;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::Write;
use mavlink::MessageData;
use mavlink::dialects::common::COMMAND_ACK_DATA;

/// The longest a frame may take to be written, us: 280 bytes take 49 ms at 57,600 baud.
pub const WRITE_TIME_MAX: u64 = 100_000;

/// Time between heartbeats, and between questions for the time, us.
pub const HEARTBEAT_INTERVAL: u64 = 1_000_000;

/// Time between the values of a list of parameters, us: slow enough to leave the line to the rest.
const LIST_INTERVAL: u64 = 20_000;

/// The greatest age of a report that is still sent, and of a voltage, us.
const REPORT_AGE_MAX: u64 = 1_000_000;

/// Transmits for ever: in turn something that is due and something that was asked for, so that neither keeps the other from
/// being sent, however slow the line.
pub async fn transmit<W: Write, M: RawMutex>(mut line: W, clock: &impl Clock, shared: &Shared<M>) -> ! {
    let mut speaker = Speaker::new(shared, clock.now());
    loop {
        let mut silent = true;
        for turn in [Speaker::scheduled, Speaker::queued] {
            if turn(&mut speaker, clock.now()) {
                silent = false;
                send(&mut line, clock, WRITE_TIME_MAX, speaker.writer.bytes()).await;
            }
        }
        if silent {
            let due = clock.until(speaker.schedule.next());
            select(due, shared.outgoing.wait()).await;
        }
    }
}

/// When what is due, us.
struct Schedule {
    attitude: u64,
    position: u64,
    heartbeat: u64,
    status: u64,
    sync: u64,
    /// The next of a list of parameters.
    list: Option<(usize, u64)>,
}

impl Schedule {
    fn next(&self) -> u64 {
        let list = self.list.map_or(u64::MAX, |(_, time)| time);
        list.min(self.attitude).min(self.position).min(self.heartbeat).min(self.status).min(self.sync)
    }
}

/// Whether `due` has come; it is then an interval on, or an interval from now if that has passed as well.
fn comes(due: &mut u64, interval: u64, now: u64) -> bool {
    let has_come = now >= *due;
    if has_come {
        let next = due.saturating_add(interval);
        *due = if next > now { next } else { now.saturating_add(interval) };
    }
    has_come
}

/// Finds what to say next and writes it. Nothing here waits, so there is one future for all messages.
struct Speaker<'a, M: RawMutex> {
    shared: &'a Shared<M>,
    schedule: Schedule,
    writer: Writer,
    /// Lost events that were told of.
    told: u32,
}

impl<'a, M: RawMutex> Speaker<'a, M> {
    fn new(shared: &'a Shared<M>, now: u64) -> Self {
        let schedule = Schedule { attitude: now, position: now, heartbeat: now, status: now, sync: now, list: None };
        Self { shared, schedule, writer: Writer::new(), told: 0 }
    }

    fn say(&mut self, message: &impl MessageData) {
        self.writer.write(self.shared.parameters.get(Name::SystemId) as u8, message);
    }

    /// Writes the first message that is due; whether there is one.
    fn scheduled(&mut self, now: u64) -> bool {
        // Within 10 and 50 Hz, as the table has it.
        let interval = (1e6 / self.shared.parameters.get(Name::TelemetryRate)) as u64;
        let report = self.shared.report.get().filter(|report| report.age(now) <= REPORT_AGE_MAX);
        let state = report.as_ref().and_then(|report| Some((report.time, report.value.state.as_ref()?)));
        if comes(&mut self.schedule.attitude, interval, now)
            && let Some((time, state)) = state
        {
            self.say(&telemetry::attitude(time, state));
        } else if comes(&mut self.schedule.position, interval, now)
            && let Some((time, state)) = state
        {
            self.say(&telemetry::position(time, state));
        } else if comes(&mut self.schedule.heartbeat, HEARTBEAT_INTERVAL, now) {
            let mode = report.map(|report| report.value.mode);
            self.say(&telemetry::heartbeat(mode, self.shared.hil.is_raised()));
        } else if comes(&mut self.schedule.status, HEARTBEAT_INTERVAL, now) {
            self.status(report.as_ref(), now);
        } else if comes(&mut self.schedule.sync, HEARTBEAT_INTERVAL, now) {
            self.say(&time_sync::question(now));
        } else if let Some((index, mut time)) = self.schedule.list.filter(|&(_, time)| now >= time) {
            comes(&mut time, LIST_INTERVAL, now);
            let name = Name::from_index(index);
            self.schedule.list = name.map(|_| (index + 1, time));
            let Some(name) = name else { return false };
            self.parameter(name);
        } else {
            return false;
        }
        true
    }

    /// Writes the next thing that was asked for, what the vehicle decided first; whether there is one.
    fn queued(&mut self, now: u64) -> bool {
        let shared = self.shared;
        if let Some(answer) = shared.answers.take() {
            return self.reply(answer, now);
        }
        if let Some(event) = shared.events.take() {
            self.say(&telemetry::text(&event));
            return true;
        }
        let lost = shared.lost_events().wrapping_sub(self.told);
        if lost > 0 {
            self.told = self.told.wrapping_add(lost);
            self.say(&telemetry::text(&Event::new(Severity::Warning, format_args!("{lost} events lost"))));
            return true;
        }
        shared.replies.take().is_some_and(|reply| self.reply(reply, now))
    }

    /// Writes a reply; a list of parameters is put on the schedule.
    fn reply(&mut self, reply: Reply, now: u64) -> bool {
        match reply {
            Reply::Command { command, result } => self.say(&COMMAND_ACK_DATA { command, result }),
            Reply::Ping(ping) => self.say(&ping),
            Reply::TimeSync { asked } => self.say(&time_sync::answer(asked, now)),
            Reply::Parameter(name) => self.parameter(name),
            Reply::AllParameters => {
                self.schedule.list = Some((0, now));
                return false;
            }
        }
        true
    }

    fn status(&mut self, report: Option<&Stamped<Report>>, now: u64) {
        let voltage = self.shared.voltage.get().filter(|voltage| voltage.age(now) <= REPORT_AGE_MAX);
        let traffic = self.shared.traffic.get().map_or_else(Default::default, |traffic| traffic.value);
        let report = report.map(|report| &report.value);
        self.say(&telemetry::status(voltage.map(|voltage| voltage.value), report, traffic));
    }

    fn parameter(&mut self, name: Name) {
        self.say(&telemetry::parameter(name, self.shared.parameters.get(name)));
    }
}
