//! What the tasks tell each other. Every value comes with the time it was taken, and every reader says how old is too
//! old.
//!
//! | from | what | to | at most this old |
//! |---|---|---|---|
//! | IMU | [`Shared::imu`] | control | [`controller_core::flight`] decides |
//! | IMU | [`Shared::imu_fault`] | control | 1 s |
//! | IMU | [`Shared::increments`] | control | a tick: each taken once |
//! | link | [`Shared::poses`] | control | a tick: each taken once; [`controller_core::estimator`] decides |
//! | link | [`Shared::pose_delay_unknown`] | control | as of the last pose |
//! | link | [`Shared::ground_station`]: when it was last heard | control | as above |
//! | link | [`Shared::setpoint`] | control | a tick: taken once |
//! | link | [`Shared::requests`], [`Shared::disarm`] | control | a tick: taken once |
//! | radio | [`Shared::killed`]; [`Shared::sticks`] | control; link | as last heard |
//! | radio | [`Shared::ground_station`], [`Shared::setpoint`], [`Shared::requests`] | control | as the link's |
//! | control | [`Shared::answers`] | link (COMMAND_ACK) | until sent |
//! | control | [`Shared::commander`]: who armed | link | while it is armed |
//! | control | [`Shared::flier`]: whose setpoints are flown | link | a tick |
//! | link | [`Shared::origin`] | link, its other half | until another comes |
//! | status | [`Shared::voltage`] | control, link | 1 s |
//! | control | [`Shared::report`] | link, status | one report a tick |
//! | control, link, status | [`Shared::announce`] | link (STATUSTEXT), status (log) | until sent |
//! | link | [`Shared::calibrations`] | IMU | until taken |
//! | link | [`Shared::hil`] | motors, sensors | until reboot |
//! | link | [`Shared::traffic`] | link, status | a count |
//! | link | [`Shared::replies`] | link, its other half | until sent |
//! | board | [`Shared::last_words`] | status | until reboot |
//! | board | [`Shared::clock_doubtful`] | control | until reboot |
//! | port | [`Shared::on_port`] | link, both halves | until it moves |
//! | parameters | [`Shared::saving`] | control | while it lasts |
//! | link | [`Shared::judging`] | control | while it lasts |
//! | link | [`Shared::restarting`], [`Shared::into_bootloader`] | control, restart | until the restart |
//! | restart | [`Shared::can_restart`], [`Shared::has_bootloader`] | link | for ever |
//! | control | [`Shared::recorder`] | link | until the next flight |
//! | control | [`Shared::recorder`] | card | as long as the ring holds it |
//! | any | [`Shared::announce`] | card, while it is ready | until logged |
//! | card | [`Shared::card`] | link, status | [`CARD_SILENCE`] |
//! | link, and back | [`Shared::library`]: what is on the card | card, and back | until the next question |
//! | parameters | [`Shared::parameters`] | every task | the present values |
//! | link, and back | [`Shared::signing`]: the key, and what was signed with it | link, parameters | the present state |
//!
//! A board keeps one [`Shared`] in a `StaticCell` and hands out references; its mutex is one that also holds against
//! the control task's interrupt. No queue makes a sender wait: what does not fit is refused or counted.

mod card;
mod event;
mod flag;
mod flier;
mod lately;
mod latest;
mod library;
mod queue;
mod reply;
mod report;
mod requests;

pub use card::{CARD_EVENTS, CARD_SILENCE, CardState, CardStatus};
pub use event::{Event, Severity, TEXT_MAX, Text};
pub use flag::Flag;
pub use flier::Flier;
pub use latest::Latest;
pub use library::{Answer, Bytes, CHUNK, Library, Question};
pub use queue::{Full, Queue};
pub use reply::{Asked, Calibration, MissionList, Ping, Procedure, Reply};
pub use report::{Report, Timing, Traffic};
pub use requests::{REQUESTS, Requests};

use self::lately::Lately;
use crate::last_words::LastWords;
use crate::link::acknowledgement::Order;
use crate::link::origin::Origin;
use crate::link::signing::{Key, Signing, Stamp};
use crate::parameters::Parameters;
use crate::recorder::Recorder;
use controller_core::estimator::{Increment, PoseMeasurement};
use controller_core::flight::{ImuSample, Mode, Refusal, Request, Stamped};
use controller_core::governor::Setpoint;
use controller_core::imu::ImuFault;
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use mavlink::dialects::common::MavResult;

/// IMU increments that wait for control, which takes all of them: 40 ms.
pub const INCREMENTS: usize = 8;

/// Poses that wait for control, which takes all of them: 40 ms of them at 200 Hz.
pub const POSES: usize = 8;

/// Calibrations that wait to be begun.
pub const CALIBRATIONS: usize = 2;

/// Events that wait to be sent or logged.
pub const EVENTS: usize = 8;

/// Replies that wait to be sent, and as many answers of control: more than there can be requests on their way.
pub const REPLIES: usize = 8;

/// Everything that passes between tasks.
pub struct Shared<M: RawMutex> {
    /// The newest inertial sample, calibrated and low-passed, with its data-ready time.
    pub imu: Latest<M, ImuSample>,
    /// The newest fault of gyro or accelerometer.
    pub imu_fault: Latest<M, ImuFault>,
    /// What the inertial samples add up to, in order. Put them in with [`Self::increment`].
    pub increments: Queue<M, Increment, INCREMENTS>,
    /// Calibrations that somebody asked for.
    pub calibrations: Queue<M, Calibration, CALIBRATIONS>,
    /// Poses in the order in which they came, with the times at which they were true. Without room a pose is dropped:
    /// the next will do.
    pub poses: Queue<M, Stamped<PoseMeasurement>, POSES>,
    /// Its time says when a ground station was last heard.
    pub ground_station: Latest<M, ()>,
    /// The newest setpoint. An unread one is replaced: only the last counts.
    pub setpoint: Latest<M, Setpoint>,
    /// Requests for control, in the order they came. Put them in with [`Self::request`].
    pub requests: Requests<M>,
    /// Raised while parameters are written to flash: nothing begins to turn.
    pub saving: Flag,
    /// Raised while a changed configuration is certified: nothing begins to turn.
    pub judging: Flag,
    /// Raised by a command to restart: nothing begins to turn any more.
    pub restarting: Flag,
    /// Raised with it where a bootloader is to start and not the firmware.
    pub into_bootloader: Flag,
    /// Raised where somebody can restart the vehicle.
    pub can_restart: Flag,
    /// Raised where there is a bootloader to start.
    pub has_bootloader: Flag,
    /// Whether the link is on a computer's port, and not on the serial line: see [`crate::link::port`].
    pub on_port: Flag,
    /// Raised while poses come whose delay neither TIMESYNC nor `POSE_DELAY` knows.
    pub pose_delay_unknown: Flag,
    /// Raised at boot where the clock's crystal does not run: nobody arms.
    pub clock_doubtful: Flag,
    /// Why the vehicle restarted by itself, where it did.
    pub last_words: Latest<M, LastWords>,
    /// Whether the kill switch of a radio was on when it was heard last; so it stays.
    pub killed: Latest<M, bool>,
    /// Whether a radio's sticks fly, by its switch. So it stays when the radio falls silent, until somebody on the link
    /// asks to fly setpoints.
    pub sticks: Latest<M, bool>,
    /// Raised by a disarm command with force, taken by control; no full queue can lose it. Raise it with
    /// [`Self::request_disarm`].
    pub disarm: Flag,
    /// Whose setpoints are flown, or will be once they come, by system and component; none where nobody on the link has
    /// asked for that.
    pub flier: Flier,
    /// The station on the link that armed the vehicle, by system and component, and when; none if somebody else did.
    pub commander: Latest<M, Option<(u8, u8)>>,
    /// Answers to requests. Put them in with [`Self::answer`].
    pub answers: Queue<M, Reply, REPLIES>,
    /// Where the local frame is on the globe, if a ground station has said so.
    pub origin: Latest<M, Origin>,
    /// The battery, V.
    pub voltage: Latest<M, f32>,
    /// What the last control tick did.
    pub report: Latest<M, Report>,
    /// What the link received.
    pub traffic: Latest<M, Traffic>,
    /// Events on their way to the ground station.
    pub events: Queue<M, Event, EVENTS>,
    /// The same events on their way to the log.
    pub log: Queue<M, Event, EVENTS>,
    /// Raised (while disarmed, until reboot) by a command to take sensors from a simulator and give it the motors.
    pub hil: Flag,
    /// What the receiving half of the link gives the sending half to say. Put it in with [`Self::reply`].
    pub replies: Queue<M, Reply, REPLIES>,
    /// There is something new among answers, events and replies.
    pub outgoing: Signal<M, ()>,
    /// What may be set from the ground.
    pub parameters: Parameters<M>,
    /// Who may speak on the link. Set its key with [`Self::set_signing`].
    pub signing: Signing<M>,
    /// The last seconds of the last flight: control writes, the link reads.
    pub recorder: Recorder<M>,
    /// The memory card, where the board has one.
    pub card: CardStatus<M>,
    /// What the link wants to know of the card's files.
    pub library: Library<M>,
    lately: Lately<M>,
    /// Events that found one of the queues full.
    lost: AtomicU32,
    lost_increments: AtomicU32,
}

impl<M: RawMutex> Shared<M> {
    /// Nothing told yet, parameters at their defaults.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            imu: Latest::new(),
            imu_fault: Latest::new(),
            increments: Queue::new(),
            calibrations: Queue::new(),
            poses: Queue::new(),
            ground_station: Latest::new(),
            setpoint: Latest::new(),
            requests: Requests::new(),
            saving: Flag::new(),
            judging: Flag::new(),
            restarting: Flag::new(),
            into_bootloader: Flag::new(),
            can_restart: Flag::new(),
            has_bootloader: Flag::new(),
            on_port: Flag::new(),
            pose_delay_unknown: Flag::new(),
            clock_doubtful: Flag::new(),
            last_words: Latest::new(),
            killed: Latest::new(),
            sticks: Latest::new(),
            disarm: Flag::new(),
            commander: Latest::new(),
            flier: Flier::new(),
            answers: Queue::new(),
            origin: Latest::new(),
            voltage: Latest::new(),
            report: Latest::new(),
            traffic: Latest::new(),
            events: Queue::new(),
            log: Queue::new(),
            hil: Flag::new(),
            replies: Queue::new(),
            outgoing: Signal::new(),
            parameters: Parameters::new(),
            signing: Signing::new(),
            recorder: Recorder::new(),
            card: CardStatus::new(),
            library: Library::new(),
            lately: Lately::new(),
            lost: AtomicU32::new(0),
            lost_increments: AtomicU32::new(0),
        }
    }

    /// Hands control what the IMU did. Without room it is dropped and counted: the next one does not begin where the
    /// last one in the queue ended, which is how control knows.
    pub fn increment(&self, increment: Increment) {
        if self.increments.put(increment).is_err() {
            self.lost_increments.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Increments that were dropped for want of room.
    #[must_use]
    pub fn lost_increments(&self) -> u32 {
        self.lost_increments.load(Ordering::Relaxed)
    }

    /// Asks control for something, in place of what the link, or the radio, asked for of that kind. That is answered:
    /// as this is, if it is the same.
    pub fn request(&self, asked: Asked) {
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
    /// on. An answer that finds no room is dropped: its
    /// sender asks again for want of one.
    pub fn answer(&self, asked: &Asked, result: Result<(), Refusal>) {
        match result {
            Err(refusal) => self.announce(Event::Refused(refusal)),
            Ok(()) if matches!(asked.request, Request::FlySetpoints) => self.flier.set(asked.setpoints),
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

    /// Replies to somebody on the line. Without room the sender gets no reply, and asks again.
    pub fn reply(&self, reply: Reply) {
        let _ = self.replies.put(reply);
        self.outgoing.signal(());
    }

    /// Control's time, us, by which texts are held back.
    pub fn pass(&self, now: u64) {
        self.lately.pass(now);
    }

    /// Tells people what they were not told within the last second: the ground station, the log and the card. Where a
    /// queue is full the event is dropped and counted: what came first is the cause, what follows is mostly its
    /// consequence.
    pub fn announce(&self, event: Event) {
        if self.lately.has_said(&event) {
            return;
        }
        let is_logged = self.card.state() != CardState::Ready || self.card.events.put(event.clone()).is_ok();
        if self.events.put(event.clone()).is_err() | self.log.put(event).is_err() | !is_logged {
            self.lost.fetch_add(1, Ordering::Relaxed);
        }
        self.outgoing.signal(());
    }

    /// Events that were dropped for want of room.
    #[must_use]
    pub fn lost_events(&self) -> u32 {
        self.lost.load(Ordering::Relaxed)
    }

    /// Has frames signed with a key from `now`, us, on, or not any more, and keeps that: see [`Signing::set`].
    pub fn set_signing(&self, key: Option<Key>, stamp: Stamp, now: u64) {
        self.signing.set(key, stamp, now);
        self.parameters.save_soon();
    }

    /// Whether somebody has something to do during which nothing may begin to turn.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        [&self.saving, &self.judging, &self.restarting].iter().any(|flag| flag.is_raised())
    }

    /// Whether the last report says that the law drives the motors. Until there is a report, nothing does.
    #[must_use]
    pub fn is_armed(&self) -> bool {
        self.report.get().is_some_and(|report| report.value.mode.is_armed())
    }

    /// Whether the last report says that a motor turns, or may within a tick.
    #[must_use]
    pub fn is_turning(&self) -> bool {
        self.report.get().is_some_and(|report| report.value.mode.is_armed() || report.value.mode == Mode::MotorTest)
    }
}

impl<M: RawMutex> Default for Shared<M> {
    fn default() -> Self {
        Self::new()
    }
}
