//! The values that tasks exchange, and each task's access to them.
//!
//! Every value has the time it was taken, and every reader sets its greatest age. A task has no reference to the
//! [values](Values) but a view of them: [`ControlView`] is the control task's. A view has a method for each value that
//! its task has to do with, and what comes from that method can be [read](Read), [written](Write) or [taken](Take), and
//! no more than that. Every view can [announce](Values::announce) an event to the operator.
//!
//! The tables in this file define which task may do what, and the views are made of them: [`Values`] shows for each
//! value who writes and who reads it, and each view what its task can do.
//!
//! ```compile_fail,E0599
//! # use embassy_sync::blocking_mutex::raw::RawMutex;
//! fn fly<M: RawMutex>(shared: firmware::shared::RadioView<'_, M>) {
//!     shared.killed().put(true, 0);
//!     let report = shared.report().get().unwrap();
//!     shared.report().put(report.value, 0); // the radio does not write the report
//! }
//! ```
//!
//! A board keeps one [`Shared`] in a `StaticCell` and hands out views; its mutex is one that also holds against the
//! control task's interrupt. No queue makes a sender wait: what does not fit is refused or counted.

pub(crate) mod access;
mod card;
mod count;
pub(crate) mod event;
mod flag;
mod latest;
mod library;
mod mission;
mod protocol;
mod queue;
mod recent_texts;
mod reply;
pub(crate) mod report;
mod requests;
mod setpoint_owner;
mod table;

pub use access::{All, Read, Take, Write};
pub use card::{CARD_EVENTS_CAPACITY, CARD_TIMEOUT_US, CardState, CardStatus};
pub use count::Count;
pub use event::{Event, Severity, TEXT_MAX, Text};
pub use flag::Flag;
pub use latest::Latest;
pub use library::{Answer, Bytes, LOG_CHUNK_BYTES, Library, Question};
pub use mission::Mission;
pub use protocol::Protocol;
pub use queue::{Full, Queue};
pub use reply::{Calibration, MissionList, Ping, Procedure, Reply};
pub use report::{Calibrated, MissionReport, Report, Started, Timing, Traffic, Verdict};
pub use requests::{QueuedRequest, REQUESTS_CAPACITY, Requests};
pub use setpoint_owner::SetpointOwner;

use self::recent_texts::RecentTexts;
use crate::esc::controller::{Controller, RotorSpeeds};
use crate::hardware::MOTOR_COUNT;
use crate::last_words::LastWords;
use crate::link::acknowledgement::Order;
use crate::link::origin::Origin;
use crate::link::signing::{Key, Signing, Stamp};
use crate::parameters::table::Name;
use crate::parameters::{Parameters, ValueRefusal};
use crate::recorder::Recorder;
use crate::recorder::gyro::GyroLog;
use controller_core::governor::Setpoint;
use core::fmt::Display;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use estimation::estimator::{Increment, PoseMeasurement};
use estimation::imu::{ImuFault, VibrationReport};
use flight::{ImuSample, Mode, Refusal, Request, Stamped};
use mavlink::dialects::common::MavResult;
use table::{offers, values, views};

/// IMU increments that wait for control, which takes all of them: 40 ms.
pub const INCREMENTS_CAPACITY: usize = 8;

/// Poses that wait for control, which takes all of them: 40 ms of them at 200 Hz.
pub const POSES_CAPACITY: usize = 8;

/// Calibrations that wait to be begun.
pub const CALIBRATIONS_CAPACITY: usize = 2;

/// Events that wait to be sent or logged.
pub const EVENTS_CAPACITY: usize = 8;

/// Replies that wait to be sent, and as many answers of control: more than there can be requests on their way.
pub const REPLIES_CAPACITY: usize = 8;

/// Everything that passes between tasks, for the code that starts them.
pub struct Shared<M: RawMutex>(Values<M>);

// The tasks.
views! {
    /// What a board may do before its tasks begin.
    BootView = for_boot;
    /// What [control](crate::control) may do.
    ControlView = for_control;
    /// What the [IMU](crate::imu)'s task may do besides passing samples on.
    ImuView = for_imu;
    /// The task with inertial samples: the IMU's or a simulator's.
    SamplesView = for_samples;
    /// What the task that repeats the motors' commands may do with what their [controllers](crate::esc) answer.
    MotorsView = for_motors;
    /// What a [simulator](crate::hil)'s tasks may do besides that.
    SimulatorView = for_simulator;
    /// What the [link](crate::link)'s receiving half may do.
    ReceiveView = for_receive;
    /// What the link's sending half may do.
    TransmitView = for_transmit;
    /// What may be done by the task that speaks [CRTP](crate::crtp).
    CrtpView = for_crtp;
    /// What may be done by the task that watches the computer's [port](crate::link::port).
    PortView = for_port;
    /// What the [radio](crate::radio)'s task may do.
    RadioView = for_radio;
    /// What the [line](crate::syslink) to a radio chip may do.
    PacketRadioView = for_packet_radio;
    /// What the memory [card](crate::card)'s task may do.
    CardView = for_card;
    /// What the [status](crate::status) task may do.
    StatusView = for_status;
    /// What may be done by the task that [stores](crate::parameters::storage) parameters.
    StorageView = for_storage;
    /// What the [restart](crate::restart)'s task may do.
    RestartView = for_restart;
}

// What there is, and which views may do what with it.
values! {
    /// The newest inertial sample, calibrated and low-passed, with its data-ready time. [`flight`] decides how old it
    /// may be.
    pub imu: Latest<M, ImuSample> {
        Write: SamplesView; Read: ControlView, StatusView, TransmitView, CrtpView
    }
    /// How much the accelerometer is shaken.
    pub vibration: Latest<M, VibrationReport> { Write: SamplesView; Read: TransmitView }
    /// Raised once the gyro's bias was found since the boot.
    pub gyro_calibrated: Flag { Write: ImuView; Read: TransmitView }
    /// The newest fault of gyro or accelerometer. It counts for 1 s.
    pub imu_fault: Latest<M, ImuFault> { Write: SamplesView; Read: ControlView }
    /// What the inertial samples add up to, in order. Put in with [`Values::increment`].
    pub increments: Queue<M, Increment, INCREMENTS_CAPACITY> { Take: ControlView }
    /// What they add up to since the last of these, where it goes on from that.
    pub under_way: Latest<M, Increment> { Write: SamplesView; Read: ControlView }
    /// Increments that were dropped for want of room.
    pub lost_increments: Count { Read: StatusView }
    /// Requested calibrations.
    pub calibrations: Queue<M, Calibration, CALIBRATIONS_CAPACITY> { Write: ReceiveView; Take: ImuView }
    /// Poses in the order in which they came, with the times at which they were true;
    /// [`estimator`](estimation::estimator) decides how old they may be. Without room a pose is dropped: the next will
    /// do.
    pub poses: Queue<M, Stamped<PoseMeasurement>, POSES_CAPACITY> {
        Write: ReceiveView, SimulatorView, CrtpView; Take: ControlView
    }
    /// The protocol that brings poses, and when it last did: another's are refused while they come.
    pub pose_protocol: Latest<M, Protocol> { Write: ReceiveView, CrtpView }
    /// Raised while poses come whose delay neither TIMESYNC nor `POSE_DELAY` gives.
    pub pose_delay_unknown: Flag { Write: ReceiveView, CrtpView; Read: ControlView }
    /// Its time is that of the last heartbeat of a ground station.
    pub ground_station: Latest<M, ()> { Write: ReceiveView, RadioView, CrtpView; Read: ControlView, StatusView }
    /// The newest setpoint. An unread one is replaced: only the last counts.
    pub setpoint: Latest<M, Setpoint> { Write: ReceiveView, RadioView, CrtpView; Take: ControlView }
    /// How fast the rotors turn, while their controllers answer. [`flight`] decides how old it may be.
    pub rotor_speeds: Latest<M, RotorSpeeds> {
        Write: MotorsView, SimulatorView; Read: SamplesView, ControlView, TransmitView, CrtpView
    }
    /// Raised where notches on the gyro may follow the rotors.
    pub follows_rotors: Flag { Write: BootView; Read: SamplesView }
    /// What the controllers have answered. It counts for 1 s.
    pub controllers: Latest<M, [Controller; MOTOR_COUNT]> { Write: MotorsView; Read: TransmitView }
    /// Requests for control, in the order they came. Put in with [`Values::request`].
    pub requests: Requests<M> { Take: ControlView }
    /// Raised by a disarm command with force; no full queue can lose it. Raised with [`Values::request_disarm`].
    pub disarm: Flag { Take: ControlView }
    /// Whether the kill switch was on in the radio's last frame: latched through silence.
    pub killed: Latest<M, bool> { Write: RadioView; Read: ControlView }
    /// Whether a radio's sticks fly, by its switch. Latched through silence until a client on the link requests to fly
    /// setpoints.
    pub sticks: Latest<M, bool> { Write: RadioView, ReceiveView; Read: CrtpView }
    /// What the last control tick did. More views read from it whether the vehicle [is armed](Values::is_armed) or a
    /// motor [turns](Values::is_turning).
    pub report: Latest<M, Report> {
        Write: ControlView; Read: RadioView, ReceiveView, TransmitView, CrtpView, StatusView
    }
    /// The station on the link that armed the vehicle, by system and component, and when; none if none did.
    pub commander: Latest<M, Option<(u8, u8)>> { Write: ControlView; Read: ReceiveView, CrtpView }
    /// Its time is when that station was last received.
    pub commander_heard: Latest<M, ()> { Write: ReceiveView; Read: CrtpView }
    /// Whose setpoints are flown, or will be once they come, by system and component; none without such a request on
    /// the link.
    pub setpoint_owner: SetpointOwner { Write: ControlView; Read: ReceiveView, CrtpView }
    /// The mission's items. They are replaced while it is not flown.
    pub mission: Mission<M> { Write: ReceiveView; Read: ControlView, TransmitView }
    /// Answers to requests. Put in with [`Values::answer`].
    pub answers: Queue<M, Reply, REPLIES_CAPACITY> { Take: TransmitView }
    /// Replies from the receiving half of the link to the sending half. Put in with [`Values::reply`].
    pub replies: Queue<M, Reply, REPLIES_CAPACITY> { Take: TransmitView }
    /// Events on their way to the ground station. Put in with [`Values::announce`], as the next two are.
    pub events: Queue<M, Event, EVENTS_CAPACITY> { Take: TransmitView }
    /// The same events on their way to the log.
    pub log: Queue<M, Event, EVENTS_CAPACITY> { Take: StatusView }
    /// Raised while a client that speaks CRTP is there.
    pub has_console: Flag { Write: CrtpView }
    /// The same events on their way to its console.
    pub console: Queue<M, Event, EVENTS_CAPACITY> { Take: CrtpView }
    /// The same events on their way to the card, while that is ready.
    pub card_events: Queue<M, Event, CARD_EVENTS_CAPACITY> { Take: CardView }
    /// Events that found one of the queues full.
    pub lost_events: Count { Read: TransmitView, StatusView }
    /// There is something new for the link's sending half.
    pub outgoing: Signal<M, ()> { Write: CardView; Take: TransmitView }
    /// What the link received.
    pub traffic: Latest<M, Traffic> { Write: ReceiveView; Read: TransmitView, StatusView }
    /// Where the local frame is on the globe, if a ground station has set it.
    pub origin: Latest<M, Origin> { Write: ReceiveView; Read: ControlView, TransmitView }
    /// The battery, V. It counts for 1 s.
    pub voltage: Latest<M, f32> { Write: StatusView; Read: ControlView, TransmitView, CrtpView }
    /// Raised (while disarmed, until reboot) by a command to take sensors from a simulator and give it the motors.
    pub hil: Flag { Write: ReceiveView, BootView; Read: ControlView, ImuView, MotorsView, TransmitView, CrtpView }
    /// Whether the link is on a computer's port, and not on the serial line: see [`crate::link::port`].
    pub on_port: Flag { Write: PortView; Read: ReceiveView, TransmitView }
    /// Raised while parameters are written to flash: nothing begins to turn. Control reads this and the next two with
    /// [`Values::is_busy`].
    pub saving: Flag { Write: StorageView; Read: ReceiveView, RestartView }
    /// Raised while a changed configuration is certified: nothing begins to turn.
    pub judging: Flag {}
    /// Raised by a command to restart: nothing begins to turn any more.
    pub restarting: Flag { Write: ReceiveView, RestartView }
    /// Raised with it where a bootloader is to start and not the firmware.
    pub into_bootloader: Flag { Write: ReceiveView; Read: RestartView }
    /// Raised where the board can restart.
    pub can_restart: Flag { Write: RestartView; Read: ReceiveView }
    /// Raised where there is a bootloader to start.
    pub has_bootloader: Flag { Write: RestartView; Read: ReceiveView }
    /// Raised at boot where the clock's crystal does not run: arming is refused.
    pub clock_doubtful: Flag { Write: BootView; Read: ControlView }
    /// What made the chip start, and the board's name; a desktop has neither.
    pub started: Latest<M, Started> { Write: BootView; Read: TransmitView }
    /// The certificate's verdict on what is to be flown.
    pub verdict: Latest<M, Verdict> { Write: BootView; Read: TransmitView, CrtpView }
    /// Why the vehicle restarted by itself, where it did.
    pub last_words: Latest<M, LastWords> { Write: BootView; Read: StatusView }
    /// What may be set from the ground.
    pub parameters: Parameters<M> {
        All: BootView, StorageView; Write: ImuView;
        Read: ControlView, SimulatorView, MotorsView, ReceiveView, TransmitView, CrtpView, PacketRadioView, StatusView,
            CardView
    }
    /// The link's signing. Its key is set with [`Values::set_signing`].
    pub signing: Signing<M> { All: StorageView; Read: ControlView, ReceiveView, TransmitView, CrtpView }
    /// The last seconds of the last flight. The card reads on while control writes; the link reads once that ended.
    pub recorder: Recorder<M> { All: BootView; Write: ControlView; Take: ReceiveView; Read: TransmitView, CardView }
    /// The raw gyro on its way to the card, where `LOG_GYRO` asks for it and the board has memory for it.
    pub gyro_log: GyroLog<M> { All: BootView; Write: SamplesView; Take: CardView; Read: ControlView }
    /// The memory card, where the board has one. Its task may be silent for [`CARD_TIMEOUT_US`].
    pub card: CardStatus { Write: CardView; Read: ReceiveView, TransmitView, StatusView }
    /// The link's questions about the card's files.
    pub library: Library<M> { Write: CardView; Read: TransmitView }
    recent_texts: RecentTexts<M> {}
}

// What concerns several values at once, and which views can do it.
offers! {
    [M: RawMutex] SamplesView<'_, M> { fn increment(increment: Increment); }
    [M: RawMutex] ControlView<'_, M> {
        fn set_text_time(now: u64);
        fn answer(asked: &QueuedRequest, result: Result<(), Refusal>);
        fn is_busy() -> bool;
    }
    [M: RawMutex] ReceiveView<'_, M> {
        fn request(asked: QueuedRequest);
        fn request_disarm();
        fn reply(reply: Reply);
        fn set_signing(key: Option<Key>, stamp: Stamp, now: u64);
        fn set_parameter(name: Name, value: f32);
        fn is_armed() -> bool;
        fn is_turning() -> bool;
    }
    [M: RawMutex] TransmitView<'_, M> { fn reply(reply: Reply); fn is_armed() -> bool; }
    [M: RawMutex] CrtpView<'_, M> {
        fn request(asked: QueuedRequest);
        fn request_disarm();
        fn set_parameter(name: Name, value: f32);
        fn is_armed() -> bool;
    }
    [M: RawMutex] RadioView<'_, M> { fn request(asked: QueuedRequest); }
    [M: RawMutex] PacketRadioView<'_, M> { fn is_armed() -> bool; }
    [M: RawMutex] ImuView<'_, M> { fn reply(reply: Reply); fn is_armed() -> bool; }
    [M: RawMutex] StatusView<'_, M> { fn is_armed() -> bool; }
    [M: RawMutex] PortView<'_, M> { fn is_turning() -> bool; }
    [M: RawMutex] StorageView<'_, M> { fn is_turning() -> bool; }
    [M: RawMutex] RestartView<'_, M> { fn is_turning() -> bool; }
}

impl<M: RawMutex> Values<M> {
    /// Hands control what the IMU did. Without room it is dropped and counted: the next one does not begin where the
    /// last one in the queue ended, by which control detects a gap.
    pub fn increment(&self, increment: Increment) {
        if self.increments.put(increment).is_err() {
            self.lost_increments.add();
        }
    }

    /// Sends a request to control, in place of the link's or the radio's last of that kind. That one is answered: as
    /// this is, if it is the same.
    pub fn request(&self, asked: QueuedRequest) {
        match (self.requests.put(asked), asked.order) {
            (Some((order, true)), Some(of)) => self.reply(Reply::Likewise { order, of: of.frame }),
            (Some((order, _)), _) => self.acknowledge(order, MavResult::MAV_RESULT_TEMPORARILY_REJECTED),
            _ => {}
        }
    }

    /// Disarms within one tick, in the air as well. Requests that wait came earlier, so none of them may arm
    /// afterwards: they are refused here.
    pub fn request_disarm(&self) {
        while let Some(asked) = self.requests.take() {
            self.answer(&asked, Err(Refusal::DisarmCommanded));
        }
        self.disarm.raise();
    }

    /// Answers a request that came by a command, and announces a refusal; setpoints that are granted are flown from now
    /// on. An answer that finds no room is dropped: its sender repeats its command.
    pub fn answer(&self, asked: &QueuedRequest, result: Result<(), Refusal>) {
        match result {
            Err(refusal) => self.announce(Event::Refused(refusal)),
            Ok(()) if matches!(asked.request, Request::FlySetpoints) => self.setpoint_owner.set(asked.setpoints),
            Ok(()) => {}
        }
        let Some(order) = asked.order else { return };
        self.acknowledge(
            order,
            if result.is_ok() { MavResult::MAV_RESULT_ACCEPTED } else { MavResult::MAV_RESULT_DENIED },
        );
    }

    /// Answers a command.
    fn acknowledge(&self, order: Order, result: MavResult) {
        let _ = self.answers.put(Reply::Command(order.answered(result)));
        self.outgoing.signal(());
    }

    /// Replies to a sender on the line. Without room the sender gets no reply, and repeats its question.
    pub fn reply(&self, reply: Reply) {
        let _ = self.replies.put(reply);
        self.outgoing.signal(());
    }

    /// Control's time, us, by which texts are held back.
    pub fn set_text_time(&self, now: u64) {
        self.recent_texts.set_time(now);
    }

    /// Announces an event, unless it was announced within the last second, to the ground station, the log and the card.
    /// Where a queue is full the event is dropped and counted: what came first is the cause, what follows is mostly its
    /// consequence.
    pub fn announce(&self, event: Event) {
        if self.recent_texts.repeats(&event) {
            return;
        }
        let is_logged = self.card.state() != CardState::Ready || self.card_events.put(event.clone()).is_ok();
        let is_shown = !self.has_console.is_raised() || self.console.put(event.clone()).is_ok();
        if self.events.put(event.clone()).is_err() | self.log.put(event).is_err() | !is_logged | !is_shown {
            self.lost_events.add();
        }
        self.outgoing.signal(());
    }

    /// Sets a parameter as an operator wishes, or announces why not. One of the configuration is certified first, here,
    /// while arming is refused.
    pub fn set_parameter(&self, name: Name, value: f32) {
        let warn = |words: &dyn Display| self.announce(Event::new(Severity::Warning, words));
        // Raised first and checked afterwards: control either sees it, or has already reported that a motor turns.
        self.judging.raise();
        if self.is_armed() {
            warn(&"Parameters change only while disarmed");
        } else if name.is_tuned() && self.is_turning() {
            warn(&format_args!("{}: not while a motor turns", name.row().name));
        } else {
            match self.parameters.set(name, value) {
                Ok(()) => {
                    self.parameters.set_again();
                    if name.is_tuned() {
                        let words = format_args!("{}: may be flown, from the next boot on", name.row().name);
                        self.announce(Event::new(Severity::Information, words));
                    }
                }
                Err(error) => {
                    warn(&error);
                    if let ValueRefusal::Unfit(_, unfit) = error {
                        warn(&unfit);
                    }
                }
            }
        }
        self.judging.lower();
    }

    /// Has frames signed with a key from `now`, us, on, or not any more, and keeps that: see [`Signing::set`].
    pub fn set_signing(&self, key: Option<Key>, stamp: Stamp, now: u64) {
        self.signing.set(key, stamp, now);
        self.parameters.save_soon();
    }

    /// Whether a task is busy with work during which no motor may start.
    pub fn is_busy(&self) -> bool {
        [&self.saving, &self.judging, &self.restarting].iter().any(|flag| flag.is_raised())
    }

    /// Whether the law drives the motors, by the last report; false before the first.
    pub fn is_armed(&self) -> bool {
        self.report.get().is_some_and(|report| report.value.mode.is_armed())
    }

    /// Whether a motor turns, or may within a tick, by the last report.
    pub fn is_turning(&self) -> bool {
        self.report.get().is_some_and(|report| report.value.mode.is_armed() || report.value.mode == Mode::MotorTest)
    }
}

impl<M: RawMutex> Shared<M> {
    /// No values yet, parameters at their defaults.
    pub const fn new() -> Self {
        Self(Values::new())
    }
}

impl<'a, M: RawMutex> ImuView<'a, M> {
    /// To pass samples on.
    pub const fn samples(self) -> SamplesView<'a, M> {
        SamplesView(self.0)
    }
}

impl<'a, M: RawMutex> SimulatorView<'a, M> {
    /// To pass samples on.
    pub const fn samples(self) -> SamplesView<'a, M> {
        SamplesView(self.0)
    }
}

/// A desktop's tests put down and look at any value. A board's program cannot.
#[cfg(not(target_os = "none"))]
impl<M: RawMutex> core::ops::Deref for Shared<M> {
    type Target = Values<M>;

    fn deref(&self) -> &Values<M> {
        &self.0
    }
}
