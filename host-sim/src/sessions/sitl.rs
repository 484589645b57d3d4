//! `sitl`: the firmware's own tasks on a desktop, with MAVLink on UDP for the clients that fly real vehicles.
//!
//! ```text
//! clients -- UDP --> receive -> Shared -> control -> motors -> world
//!         <-- UDP -- transmit <-'   ^------- IMU, poses, battery <-'
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`clock`], [`mod@memory_line`] | time that moves when every task waits; bytes in memory |
//! | [`simulated_hardware`] | vehicle, air, ground, sensors and the camera that sends poses |
//! | `downlink` | the vehicle's frames to the clients ([`crate::sessions::ports`]); CRTP is [`crate::sessions::crtp_port`] |
//! | [`faults`] | simulated faults and their times |
//! | `flash` | the parameters' memory |
//! | [`key`] | the key that signs frames |
//! | `session` | a session's options, and its end |
//! | `record`, `gyro` | the session as MCAP, its raw gyro as ULog |
//!
//! Control, IMU, both halves of the link, status, parameters and restart are the library's tasks that boards run; here
//! they share a thread and a simulated clock, which is let go no further than the desk's. The configuration is
//! certified as at a board's boot, and a scenario that could not be built for a board is refused ([`scenario::board`]).

pub mod clock;
mod downlink;
pub mod faults;
pub(crate) mod flash;
mod gyro;
pub mod hands;
pub mod key;
pub mod memory_line;
mod record;
pub(crate) mod session;
pub mod simulated_hardware;
mod truth;

use crate::output::interrupt::Interrupt;
use crate::reports::recording::session::SessionMoment;
use crate::sessions::crtp_port::CrtpPort;
use crate::sessions::input;
use crate::sessions::pace::Pace;
use crate::sessions::ports::{ClientPort, Ports};
use clock::SimClock;
use controller_core::allocation::Motor;
use controller_core::configuration::Configuration;
use controller_core::error::ParameterError;
use controller_core::tuning::judged::JudgedLoops;
use downlink::Downlink;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use faults::{Faults, FaultyPart};
use firmware::control::Control;
use firmware::crtp::pieces::MEMORY_BYTES;
use firmware::esc::Published;
use firmware::hardware::{Clock, Restart};
use firmware::link::frame::Parser;
use firmware::parameters::storage::Storage;
use firmware::parameters::table::Name;
use firmware::parameters::tuned::Built;
use firmware::recorder::ring::{Ring, SLOT_BYTES};
use firmware::repeat::FRAME_INTERVAL_US;
use firmware::shared::Shared;
use firmware::{boot, crtp, imu, link, restart, status};
use flash::DeskFlash;
use futures::executor::{LocalPool, LocalSpawner};
use futures::task::LocalSpawnExt;
use gyro::GyroFile;
use hands::Holder;
use memory_line::MemoryLine;
use record::SessionRecord;
use scenario::{Scenario, board};
pub use session::{SitlError, SitlSession, SitlSummary};
use simulated_hardware::{PoseSource, SimulatedHardware};
use std::cell::{Cell, RefCell};
use std::future::Future;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};
use truth::Truth;

/// Records that the flight recorder holds: a minute.
const RECORDER_CAPACITY: usize = 6_000;

/// By the desk's clock.
const STATUS_PERIOD: Duration = Duration::from_secs(1);

/// The firmware and its world on one thread.
pub struct Sitl {
    pool: LocalPool,
    clock: SimClock,
    hardware: SimulatedHardware,
    shared: &'static Shared<NoopRawMutex>,
    port: Rc<RefCell<ClientPort>>,
    crtp: Option<CrtpPort>,
    up: MemoryLine,
    faults: Faults,
    texts: Rc<RefCell<Vec<(u64, String)>>>,
    flash: DeskFlash,
    configuration: Configuration,
    motor: Motor,
    loops: &'static JudgedLoops,
    identity: u32,
    /// Whether notches on its gyro may follow the rotors.
    follows_rotors: bool,
    /// The time between control ticks, us.
    period: u64,
    /// What the vehicle is called.
    name: &'static str,
    /// Whether its raw gyro is logged.
    logs_gyro: bool,
    /// Set by the firmware: start it anew.
    restart: Rc<Cell<bool>>,
}

/// Restarts the firmware, once its tasks have come to rest.
struct Desk(Rc<Cell<bool>>);

impl Restart for Desk {
    const HAS_BOOTLOADER: bool = false;

    fn restart(&mut self) {
        self.0.set(true);
    }

    /// Never called: there is no bootloader.
    fn start_bootloader(&mut self) {
        self.restart();
    }
}

impl Sitl {
    /// Boots the firmware on the scenario's vehicle, which stands on the ground. With it comes why it will not arm, if
    /// it will not. What can be refused at once is; then `say` gets a line, and the scenario is judged, which takes
    /// seconds.
    pub fn boot(
        scenario: &Scenario,
        session: &SitlSession,
        say: impl FnOnce(&str),
    ) -> Result<(Self, Option<String>), String> {
        board::fits(scenario, &session.file)?;
        let (clock, faults, up) = (SimClock::default(), Faults(session.faults.clone()), MemoryLine::default());
        faults.check(scenario.configuration.rotors().map_or(0, |rotors| rotors.len()))?;
        let in_file = |what| format!("{}: {what}", session.file);
        let hardware =
            SimulatedHardware::new(scenario, session.poses, &clock, faults.clone(), up.clone()).map_err(in_file)?;
        let flash = DeskFlash::open(session.parameters.clone())?;
        let port = Rc::new(RefCell::new(ClientPort::open(&session.ports).map_err(|error| error.to_string())?));
        let crtp = session.crtp.map(CrtpPort::open).transpose()?;
        say(&format!("{}: starting; its loops and its model's flights are judged first, some seconds", scenario.name));
        let warning = board::check(scenario, &session.file)?;

        let identity = board::identity(scenario);
        let loops = match identity {
            // Judged already, when the firmware's library was built.
            firmware::configuration::IDENTITY => &firmware::configuration::LOOPS,
            _ => Box::leak(Box::new(board::judged(scenario))),
        };
        let mut sitl = Self {
            pool: LocalPool::new(),
            clock,
            hardware,
            shared: Box::leak(Box::new(Shared::new())),
            port,
            crtp,
            up,
            faults,
            texts: Rc::default(),
            flash,
            configuration: scenario.configuration.clone(),
            motor: scenario.motor(),
            loops,
            identity,
            follows_rotors: board::may_follow_rotors(scenario),
            period: scenario.timing.period_us,
            name: Box::leak(scenario.name.clone().into_boxed_str()),
            logs_gyro: session.gyro.is_some(),
            restart: Rc::default(),
        };
        sitl.start().map_err(|error| in_file(error.to_string()))?;
        if let Some(key) = session.signing_key {
            sitl.shared.set_signing(Some(key), key::now(), 0);
        }
        // Also with one that was kept from an earlier session.
        if let Some(key) = sitl.shared.signing.key() {
            sitl.hardware.sign(key, key::now());
        }
        Ok((sitl, warning))
    }

    /// Starts the firmware: with empty memory, and the parameters in flash. The vehicle's clock goes on.
    fn start(&mut self) -> Result<(), ParameterError> {
        // As long as the program: what tasks share is static on a board as well.
        let shared: &'static Shared<NoopRawMutex> = Box::leak(Box::new(Shared::new()));
        let mut parameters = Storage::load(self.flash.clone(), shared.for_storage());
        let memory = Box::leak(vec![[0; SLOT_BYTES]; RECORDER_CAPACITY].into_boxed_slice());
        shared.recorder.attach(Ring::recover(memory), self.name);
        if self.logs_gyro {
            shared.gyro_log.attach(gyro::memory());
        }
        let place = Box::leak(Box::new(boot::Place::new()));
        let (configuration, period) = (self.configuration.clone(), self.period);
        let Self { motor, loops, identity, follows_rotors, .. } = *self;
        let built = Built { configuration, motor, loops, identity, period, follows_rotors };
        let (pilot, outputs) = boot::start_with(place, shared.for_boot(), built)?;

        let pool = LocalPool::new();
        let spawner = pool.spawner();
        let (clock, hardware) = (&self.clock, &self.hardware);
        let downlink = Downlink {
            clock: clock.clone(),
            faults: self.faults.clone(),
            port: Rc::clone(&self.port),
            hardware: hardware.clone(),
            texts: Rc::clone(&self.texts),
            parser: Parser::new(),
        };
        let (mut motors, mut watchdog, time) = (hardware.clone(), hardware.clone(), clock.clone());
        spawn(&spawner, async move {
            Control::new(shared.for_control(), pilot, outputs).run(&time, &mut motors, &mut watchdog).await
        });
        if shared.parameters.get(Name::MotorProtocol) > 0.0 {
            let mut motors = Published::new(hardware.clone(), shared.for_motors(), clock.clone());
            let time = clock.clone();
            spawn(&spawner, async move {
                loop {
                    time.until(time.now() + FRAME_INTERVAL_US).await;
                    motors.publish();
                }
            });
        }
        let (mut sensor, time) = (hardware.clone(), clock.clone());
        spawn(&spawner, async move { imu::run(shared.for_imu(), &time, &mut sensor, period).await });
        let (ear, time) = (self.up.clone(), clock.clone());
        spawn(&spawner, async move { link::receive::receive(ear, &time, shared.for_receive()).await });
        let time = clock.clone();
        spawn(&spawner, async move { link::transmit::transmit(downlink, &time, shared.for_transmit()).await });
        if let Some(port) = &self.crtp {
            let (receiver, sender, time) = (port.clone(), port.clone(), clock.clone());
            spawn(&spawner, async move {
                let mut memory = [0; MEMORY_BYTES];
                crtp::task::run(receiver, sender, &time, shared.for_crtp(), &mut memory).await;
            });
        }
        let (light, battery, time) = (hardware.clone(), hardware.clone(), clock.clone());
        spawn(&spawner, async move { status::run(light, battery, &time, shared.for_status()).await });
        let time = clock.clone();
        spawn(&spawner, async move { parameters.keep(&time, shared.for_storage()).await });
        let (mut desk, time) = (Desk(Rc::clone(&self.restart)), clock.clone());
        spawn(&spawner, async move { restart::run(shared.for_restart(), &time, &mut desk).await });
        spawn(&spawner, hardware.clone().run());
        (self.pool, self.shared) = (pool, shared);
        Ok(())
    }

    /// Takes what clients have sent.
    pub fn receive(&mut self) {
        let (up, silent) = (&self.up, self.faults.has(FaultyPart::GroundStation, self.clock.now()));
        self.port.borrow_mut().receive(|frame| {
            if !silent {
                up.push(frame);
            }
        });
        self.crtp.iter().for_each(|port| port.receive(silent));
    }

    /// Lays a person's hands on the vehicle, and on a kill switch.
    pub fn hold(&self, holder: &Holder) {
        self.hardware.hold(holder.hands);
        if holder.is_killed != self.shared.killed.get().is_some_and(|killed| killed.value) {
            self.shared.killed.put(holder.is_killed, self.clock.now());
        }
    }

    /// Lets time pass until `end`, us.
    pub fn pass(&mut self, end: u64) {
        self.clock.run(&mut self.pool, end);
        if self.restart.take() {
            // What is refused is refused at the first start: the vehicle has as many rotors as then.
            let _ = self.start();
        }
    }

    /// Its state, for a line of status.
    fn moment(&self) -> SessionMoment {
        SessionMoment {
            now: self.clock.now(),
            truth: self.hardware.state(),
            rotors: self.hardware.thrusts(),
            report: self.shared.report.get().map(|report| report.value),
            voltage: self.shared.voltage.get().map(|voltage| voltage.value),
        }
    }

    /// One line: time, mode, position, battery.
    fn status(&self) -> String {
        let report = self.shared.report.get().map(|report| report.value);
        let mode = report.as_ref().map_or("no report", |report| report.mode.text());
        let place = report.and_then(|report| report.state).map_or_else(
            || "position unknown".to_owned(),
            |state| format!("at {:8.3} {:8.3} {:8.3} m", state.position.x, state.position.y, state.position.z),
        );
        let battery = self.shared.voltage.get().map_or_else(String::new, |volts| format!("  {:.2} V", volts.value));
        format!("{:9.2} s  {mode:<11}  {place}{battery}", self.clock.now() as f64 * 1e-6)
    }

    fn summary(&self, signal: Option<u8>) -> SitlSummary {
        let report = self.shared.report.get().map(|report| report.value);
        SitlSummary {
            time: self.clock.now() as f64 * 1e-6,
            mode: report.as_ref().map(|report| report.mode),
            position: self.hardware.state().position.into(),
            missed: report.map_or(0, |report| report.timing.missed),
            signal,
        }
    }
}

fn spawn<T: 'static>(spawner: &LocalSpawner, task: impl Future<Output = T> + 'static) {
    // It can only be refused by a pool that is gone.
    let _ = spawner.spawn_local(async move { drop(task.await) });
}

/// Runs a session until its duration is over or a signal comes; `say` gets a line before it starts, `show` those about
/// it.
pub fn run(
    scenario: &Scenario,
    session: &SitlSession,
    interrupt: &Interrupt,
    say: impl FnOnce(&str),
    mut show: impl FnMut(&str),
) -> Result<SitlSummary, SitlError> {
    let create = |(path, text): &(PathBuf, String)| SessionRecord::create(path, scenario, text);
    let mut record = session.recording.as_ref().map(create).transpose().map_err(SitlError::Input)?;
    let mut gyro = session.gyro.as_deref().map(GyroFile::create).transpose().map_err(SitlError::Input)?;
    let (mut sitl, warning) = Sitl::boot(scenario, session, say).map_err(SitlError::Input)?;
    warning.iter().for_each(|warning| show(&format!("warning: {warning}")));
    let Ports { offboard, ground, local } = session.ports;
    show(&format!(
        "{}: MAVLink from udp 127.0.0.1:{local} to {offboard} (offboard) and {ground} (ground stations); Ctrl-C ends it",
        scenario.name
    ));
    if let Some(address) = session.crtp {
        show(&format!("{}: CRTP at udp://{address}", scenario.name));
    }
    let end = session.duration.map(|duration| (duration * 1e6).round() as u64);
    let mut truth = session.truth.map(Truth::open).transpose().map_err(SitlError::Input)?;
    let mut pace = Pace::new(session.speed);
    let mut shown = Instant::now();
    let (words, mut holder) = (session.has_hands.then(input::lines), Holder::default());
    let ended = loop {
        let now = sitl.clock.now();
        for line in words.iter().flat_map(Receiver::try_iter) {
            holder.take(&line).unwrap_or_else(|error| show(&error));
        }
        if let Some(signal) = interrupt.signal() {
            break Ok(sitl.summary(Some(signal)));
        }
        if end.is_some_and(|end| now >= end) {
            break Ok(sitl.summary(None));
        }
        let due = record.as_ref().map_or(u64::MAX, SessionRecord::due);
        let due = due.min(truth.as_ref().map_or(u64::MAX, Truth::due));
        let next = pace.next(now).min(end.unwrap_or(u64::MAX)).min(due);
        // What a client stamps by the desk's clock must not come before that time of a vehicle that lags behind.
        let keeps_up = pace.wait(next);
        if keeps_up || session.poses == PoseSource::Camera {
            sitl.receive();
        }
        holder.pass((next - now) as f32 * 1e-6);
        sitl.hold(&holder);
        sitl.pass(next);
        if let Some(gyro) = &mut gyro {
            gyro.take(&sitl.shared.gyro_log);
        }
        if let Some(truth) = &mut truth {
            truth.write_when_due(sitl.clock.now(), pace.desk_time(sitl.clock.now()), &sitl.hardware.state());
        }
        if sitl.hardware.check().is_err() {
            break Err(SitlError::Diverged(next as f64 * 1e-6));
        }
        for (time, text) in sitl.texts.take() {
            show(&format!("{:9.2} s  \"{text}\"", time as f64 * 1e-6));
            record.iter_mut().try_for_each(|record| record.observe_text(time, &text)).map_err(SitlError::Input)?;
        }
        record.iter_mut().try_for_each(|record| record.observe(&sitl.moment())).map_err(SitlError::Input)?;
        if shown.elapsed() >= STATUS_PERIOD {
            shown += STATUS_PERIOD;
            show(&sitl.status());
        }
    };
    // Also of a session that ended badly: what led to it is in there.
    record.map_or(Ok(()), SessionRecord::finish).map_err(SitlError::Input)?;
    gyro.map_or(Ok(()), GyroFile::finish).map_err(SitlError::Input)?;
    ended
}

#[cfg(test)]
mod tests;
