//! Outgoing messages and their times: telemetry by the clock; answers, replies and events as they come.
//!
//! Every write has [`WRITE_TIMEOUT_US`]; a line that takes no more loses frames, and holds up nothing but this task.

use super::acknowledgement::{Acknowledgement, Order};
use super::bench_report::{Line, Sources};
use super::download::{Download, Message};
use super::files::NoFiles;
use super::mission_lists::About;
use super::origin::Origin;
use super::streams::{Schedule, interval_of_rate};
use super::telemetry::bench::NAMED_COUNT;
use super::telemetry::kind::Kind;
use super::telemetry::{View, vehicle};
use super::time_sync;
use super::writer::Writer;
use crate::deadline::send;
use crate::hardware::Clock;
use crate::parameters::calibration;
use crate::parameters::table::Name;
use crate::shared::{Calibrated, Event, MissionList, MissionReport, Reply, Severity, TransmitView};
use embassy_futures::select::select;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::Write;
use mavlink::MessageData;
use mavlink::dialects::common::{
    LOG_ENTRY_DATA, MESSAGE_INTERVAL_DATA, MISSION_ACK_DATA, MISSION_COUNT_DATA, MISSION_CURRENT_DATA,
    MISSION_ITEM_REACHED_DATA, MISSION_REQUEST_INT_DATA, MavResult,
};

/// The longest a frame may take to be written: 280 bytes take 49 ms at 57,600 baud.
pub const WRITE_TIMEOUT_US: u64 = 100_000;

/// Time between the values of a list of parameters, and between the lines of a report: slow enough to leave the line to
/// the rest.
const LIST_INTERVAL_US: u64 = 20_000;

/// The greatest age of a report that is still sent, and of a voltage.
const REPORT_AGE_MAX_US: u64 = 1_000_000;

/// Answers to commands that are remembered, to be given again; and commands that wait for another's answer.
const ANSWERS_REMEMBERED: usize = 8;
const OWED_CAPACITY: usize = 6;

/// A command that is answered as another is.
#[derive(Clone, Copy)]
struct Owed {
    order: Order,
    of: u32,
    /// How often; 0 for a free place.
    times: u8,
}

/// No command has this number.
const NO_ORDER: Order = Order { command: 0, sender: (0, 0), frame: 0 };

/// Transmits for ever: in turn a message that is due and one that was requested, so that neither keeps the other from
/// being sent, however slow the line.
pub async fn transmit<W: Write, M: RawMutex>(mut line: W, clock: &impl Clock, shared: TransmitView<'_, M>) -> ! {
    let mut speaker = Transmitter::new(shared, clock.now());
    loop {
        let mut silent = true;
        for turn in [Transmitter::send_scheduled, Transmitter::send_queued] {
            if turn(&mut speaker, clock.now()) {
                silent = false;
                speaker.writer.sign(shared.signing(), clock.now());
                send(&mut line, clock, WRITE_TIMEOUT_US, speaker.writer.bytes()).await;
            }
        }
        if silent {
            let due = clock.until(speaker.next());
            select(due, shared.outgoing().wait()).await;
        }
    }
}

/// Finds the next message and writes it. Nothing here waits, so there is one future for all messages.
struct Transmitter<'a, M: RawMutex> {
    shared: TransmitView<'a, M>,
    schedule: Schedule,
    /// The next of a list of parameters, and when it is due, us.
    list: Option<(usize, u64)>,
    /// The next line of a bench report, and when it is due, us.
    report: Option<(usize, u64)>,
    /// The named value that has its turn.
    turn: usize,
    /// What is still to be sent of the logs.
    download: Download,
    /// What was said of the mission.
    mission: MissionReport,
    writer: Writer,
    /// Lost events that were reported.
    reported: u32,
    /// The last answers to commands, one of each frame.
    answered: [Acknowledgement; ANSWERS_REMEMBERED],
    /// Where the last was put; the next takes the place of the oldest.
    next_answer: usize,
    /// Questions that one of them answers, now or once it is there.
    owed: [Owed; OWED_CAPACITY],
    next_owed: usize,
}

impl<'a, M: RawMutex> Transmitter<'a, M> {
    fn new(shared: TransmitView<'a, M>, now: u64) -> Self {
        Self {
            shared,
            schedule: Schedule::new(now),
            list: None,
            report: None,
            turn: 0,
            download: Download::new(),
            mission: MissionReport::default(),
            writer: Writer::new(),
            reported: 0,
            answered: [const { NO_ORDER.answered(MavResult::MAV_RESULT_ACCEPTED) }; _],
            next_answer: 0,
            owed: [Owed { order: NO_ORDER, of: 0, times: 0 }; _],
            next_owed: 0,
        }
    }

    fn system(&self) -> u8 {
        self.shared.parameters().get(Name::SystemId) as u8
    }

    fn send(&mut self, message: &impl MessageData) {
        self.writer.write(self.system(), message);
    }

    /// How often telemetry goes out, us.
    fn telemetry(&self) -> u64 {
        interval_of_rate(self.shared.parameters().get(Name::TelemetryRate))
    }

    /// When something is due, us.
    fn next(&self) -> u64 {
        let listed = [self.list, self.report].into_iter().flatten().map(|(_, time)| time);
        self.schedule.next(self.telemetry()).min(listed.min().unwrap_or(u64::MAX)).min(self.download.due())
    }

    /// Writes the first message that is due; whether there is one.
    fn send_scheduled(&mut self, now: u64) -> bool {
        let telemetry = self.telemetry();
        let report = self.shared.report().recent(REPORT_AGE_MAX_US, now);
        self.schedule.set_bench(report.is_none_or(|report| report.state.is_none()));
        while let Some(kind) = self.schedule.next_due(telemetry, now) {
            if self.send_message(kind, now) {
                return true;
            }
        }
        self.send_mission_progress() || self.send_listed(now) || self.send_reported(now) || self.send_download(now)
    }

    /// Writes what the mission has done since: an item reached, or another current one.
    fn send_mission_progress(&mut self) -> bool {
        let Some(mission) = self.shared.report().get().map(|report| report.value.mission) else { return false };
        if mission.done.1 != self.mission.done.1 {
            self.mission.done = mission.done;
            self.send(&MISSION_ITEM_REACHED_DATA { seq: mission.done.0.into() });
        } else if mission.next != self.mission.next {
            self.mission.next = mission.next;
            self.send(&MISSION_CURRENT_DATA { seq: mission.next.into() });
        } else {
            return false;
        }
        true
    }

    /// Writes the next of a list of parameters, if there is one and it is due.
    fn send_listed(&mut self, now: u64) -> bool {
        let Some((index, time)) = self.list.filter(|&(_, time)| now >= time) else { return false };
        let name = Name::from_index(index);
        self.list = name.map(|_| (index + 1, time.max(now.saturating_sub(LIST_INTERVAL_US)) + LIST_INTERVAL_US));
        let Some(name) = name else { return false };
        self.send_parameter(name);
        true
    }

    /// Writes the next line of a bench report, if there is one and it is due.
    fn send_reported(&mut self, now: u64) -> bool {
        let Some((number, time)) = self.report.filter(|&(_, time)| now >= time) else { return false };
        let shared = self.shared;
        let sources = Sources {
            started: shared.started().get().map(|started| started.value),
            vehicle: shared.recorder().vehicle(),
            verdict: shared.verdict().get().map(|verdict| verdict.value),
            calibrated: self.calibrated(),
            report: shared.report().recent(REPORT_AGE_MAX_US, now),
        };
        let line = sources.line(number);
        let next = if matches!(line, Line::LeftOut) { time } else { now.saturating_add(LIST_INTERVAL_US) };
        self.report = Some((number + 1, next));
        match line {
            Line::Text(event) => self.send(&vehicle::text(&event)),
            Line::LeftOut => return false,
            Line::End => {
                self.report = None;
                return false;
            }
        }
        true
    }

    /// What has been calibrated.
    fn calibrated(&self) -> Calibrated {
        let (accelerometer, level) = calibration::found(self.shared.parameters());
        Calibrated { gyro: self.shared.gyro_calibrated().is_raised(), accelerometer, level }
    }

    /// Writes the next message about the logs, if one is requested and due.
    fn send_download(&mut self, now: u64) -> bool {
        match self.download.next(now, self.shared) {
            Some(Message::Entry(entry)) => self.send(&entry),
            Some(Message::Data(data)) => self.send(&data),
            None => return false,
        }
        true
    }

    /// Writes a message of the present state; whether there was a value to send.
    fn send_message(&mut self, kind: Kind, now: u64) -> bool {
        let shared = self.shared;
        let voltage = shared.voltage().get().filter(|voltage| voltage.age(now) <= REPORT_AGE_MAX_US);
        let view = View {
            now,
            report: shared.report().get().filter(|report| report.age(now) <= REPORT_AGE_MAX_US),
            imu: shared.imu().get().filter(|sample| sample.age(now) <= REPORT_AGE_MAX_US),
            vibration: shared.vibration().recent(REPORT_AGE_MAX_US, now),
            calibrated: self.calibrated(),
            turn: self.turn,
            voltage: voltage.map(|voltage| voltage.value),
            traffic: shared.traffic().get().map_or_else(Default::default, |traffic| traffic.value),
            simulated: shared.hil().is_raised(),
            is_logged: shared.card().health(now),
            rotor_speeds: shared.rotor_speeds().get().filter(|speeds| speeds.age(now) <= REPORT_AGE_MAX_US),
            controllers: shared.controllers().recent(REPORT_AGE_MAX_US, now),
            origin: shared.origin().get().map_or_else(Origin::default, |origin| origin.value),
        };
        self.turn = self.turn.wrapping_add(usize::from(kind == Kind::NamedValue)) % NAMED_COUNT;
        let system = self.system();
        view.write(kind, system, &mut self.writer)
    }

    /// Writes the next requested message, the vehicle's decisions first; whether there is one.
    fn send_queued(&mut self, now: u64) -> bool {
        let shared = self.shared;
        if self.send_owed() {
            return true;
        }
        if let Some(answer) = shared.answers().take() {
            return self.reply(answer, now);
        }
        if let Some(event) = shared.events().take() {
            self.send(&vehicle::text(&event));
            return true;
        }
        let lost = shared.lost_events().get().wrapping_sub(self.reported);
        if lost > 0 {
            self.reported = self.reported.wrapping_add(lost);
            self.send(&vehicle::text(&Event::new(Severity::Warning, format_args!("{lost} events lost"))));
            return true;
        }
        // Not every event is sent.
        while let Some(reply) = shared.replies().take() {
            if self.reply(reply, now) {
                return true;
            }
        }
        false
    }

    /// Answers a command as the one that it is the same as, if that is answered; whether there was one.
    fn send_owed(&mut self) -> bool {
        let answered = &self.answered;
        let found = self.owed.iter_mut().filter(|owed| owed.times > 0).find_map(|owed| {
            let answer = answered.iter().find(|answer| answer.order.frame == owed.of)?;
            owed.times -= 1;
            Some(owed.order.answered(answer.result))
        });
        found.map(|acknowledgement| self.acknowledge(acknowledgement)).is_some()
    }

    /// Answers a command and remembers what was answered.
    fn acknowledge(&mut self, acknowledgement: Acknowledgement) {
        self.send(&acknowledgement);
        let before = self.answered.iter().position(|before| before.order.frame == acknowledgement.order.frame);
        let place = before.unwrap_or_else(|| {
            self.next_answer = (self.next_answer + 1) % ANSWERS_REMEMBERED;
            self.next_answer
        });
        if let Some(place) = self.answered.get_mut(place) {
            *place = acknowledgement;
        }
    }

    /// Writes a reply; a list of parameters is put on the schedule, and so is a message's interval.
    fn reply(&mut self, reply: Reply, now: u64) -> bool {
        match reply {
            Reply::Command(acknowledgement) => self.acknowledge(acknowledgement),
            Reply::Likewise { order, of } => return self.answer_alike(order, of),
            Reply::Ping(ping) => self.send(&ping),
            Reply::TimeSync { asked } => self.send(&time_sync::answer(asked, now)),
            Reply::Parameter(name) => self.send_parameter(name),
            Reply::Message(kind) => return self.send_message(kind, now),
            Reply::Requested(kind, order) => return self.send_requested(kind, order, now),
            Reply::Mode(index) => return self.writer.write_some(self.system(), vehicle::available_mode(index)),
            Reply::MissionCount(MissionList { sender: (target_system, target_component), list }, count) => {
                self.send(&About { message: MISSION_COUNT_DATA { count, target_system, target_component }, list })
            }
            Reply::MissionRequest(MissionList { sender: (target_system, target_component), list }, seq) => {
                self.send(&About { message: MISSION_REQUEST_INT_DATA { seq, target_system, target_component }, list })
            }
            Reply::MissionItem { list: MissionList { sender, list }, number, is_int } => {
                match self.shared.mission().item(number) {
                    Some(item) if is_int => self.send(&About { message: item.message(number, sender), list }),
                    Some(item) => self.send(&About { message: item.old_message(number, sender), list }),
                    // Its list was replaced meanwhile: the client asks again.
                    None => return false,
                }
            }
            Reply::Mission(MissionList { sender: (target_system, target_component), list }, mavtype) => {
                self.send(&About { message: MISSION_ACK_DATA { target_system, target_component, mavtype }, list })
            }
            Reply::NoFiles(request) => self.send(&NoFiles(request)),
            Reply::IntervalOf(kind) => self.send_interval(kind),
            Reply::NoLogs => self.send(&LOG_ENTRY_DATA::DEFAULT),
            Reply::Logs { first, last } => {
                self.download.list(first, last, now, self.shared);
                return false;
            }
            Reply::LogData { id, offset, count } => {
                self.download.read(id, offset, count, now, self.shared);
                return false;
            }
            Reply::LogEnd => {
                self.download.end();
                return false;
            }
            Reply::Interval { kind, interval } => {
                self.schedule.set_interval(kind, interval, now);
                return false;
            }
            Reply::BenchReport => {
                self.report = Some((0, now));
                return false;
            }
            Reply::AllParameters => {
                self.list = Some((0, now));
                return false;
            }
        }
        true
    }

    /// Answers a command as the one of the frame `of`, at once or when that is answered; whether there was an answer.
    fn answer_alike(&mut self, order: Order, of: u32) -> bool {
        match self.owed.iter_mut().find(|owed| (owed.order.frame, owed.of) == (order.frame, of)) {
            Some(owed) => owed.times = owed.times.saturating_add(1),
            None => {
                self.next_owed = (self.next_owed + 1) % OWED_CAPACITY;
                if let Some(place) = self.owed.get_mut(self.next_owed) {
                    *place = Owed { order, of, times: 1 };
                }
            }
        }
        self.send_owed()
    }

    /// Writes a message that a command requested, and has that answered; whether there was a value to send.
    fn send_requested(&mut self, kind: Kind, order: Order, now: u64) -> bool {
        let is_said = self.send_message(kind, now);
        let result = if is_said { MavResult::MAV_RESULT_ACCEPTED } else { MavResult::MAV_RESULT_TEMPORARILY_REJECTED };
        self.shared.reply(Reply::Command(order.answered(result)));
        is_said
    }

    fn send_interval(&mut self, kind: Kind) {
        let interval = self.schedule.interval_of(kind, self.telemetry());
        self.send(&MESSAGE_INTERVAL_DATA {
            interval_us: interval.map_or(-1, |interval| i32::try_from(interval).unwrap_or(i32::MAX)),
            message_id: kind.number() as u16,
        });
    }

    fn send_parameter(&mut self, name: Name) {
        self.send(&vehicle::parameter(name, self.shared.parameters().get(name)));
    }
}
