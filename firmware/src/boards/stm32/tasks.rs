//! What every STM32 board runs: its tasks by priority.
//!
//! Two executors work in interrupts that the board has no other use for, control above the sensor, both below the drivers' own
//! interrupts; everything else shares the thread.

use super::clock::SystemClock;
use super::imu::BoardImu;
use super::light::Lamp;
use super::link::{Receiver, SimulatorReceiver, SimulatorTransmitter, Transmitter};
use super::restart::Cause;
use super::storage::ParameterFlash;
use crate::boards::chosen::{self, BoardBattery, BoardMotors, BoardWatchdog, CONTROL_INTERRUPT, SENSOR_INTERRUPT};
use crate::control::Control;
use crate::hil::{self, SelectedMotors};
use crate::outputs::Outputs;
use crate::parameters::storage::Storage;
use crate::{boot, imu, link, status};
use controller_core::flight::Pilot;
use embassy_executor::{Executor, InterruptExecutor};
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use static_cell::StaticCell;

type Shared = crate::shared::Shared<CriticalSectionRawMutex>;
type Hil = hil::Hil<CriticalSectionRawMutex>;

/// Everything on the board, each part ready for the task that will own it.
pub struct Board {
    /// The sensor, powered up at its first sample.
    pub imu: BoardImu,
    /// The motors, silent.
    pub motors: BoardMotors,
    /// The watchdog, not started.
    pub watchdog: BoardWatchdog,
    /// The battery.
    pub battery: BoardBattery,
    /// The light, off.
    pub light: Lamp,
    /// What the link receives.
    pub receiver: Receiver,
    /// What the link sends.
    pub transmitter: Transmitter,
    /// What a simulator sends.
    pub simulator_receiver: SimulatorReceiver,
    /// What a simulator receives.
    pub simulator_transmitter: SimulatorTransmitter,
    /// Where parameters live.
    pub storage: ParameterFlash,
    /// Why the chip started.
    pub restart: Cause,
}

/// Control interrupts everything but the drivers' own interrupts.
static CONTROL: InterruptExecutor = InterruptExecutor::new();

/// The sensor interrupts all but control.
static SENSOR: InterruptExecutor = InterruptExecutor::new();

/// Boots the board and flies it, for ever.
pub fn run() -> ! {
    let board = chosen::take();
    defmt::info!("started by {} on {=str}", board.restart, chosen::NAME);
    static SHARED: StaticCell<Shared> = StaticCell::new();
    let shared = SHARED.init_with(Shared::new);
    static HIL: StaticCell<Hil> = StaticCell::new();
    let hil = HIL.init_with(Hil::new);
    let parameters = Storage::load(board.storage, shared);
    static PLACE: boot::Place = boot::Place::new();
    let (pilot, outputs) = defmt::unwrap!(boot::start(&PLACE, &shared.parameters));

    CONTROL_INTERRUPT.set_priority(Priority::P6);
    let spawner = CONTROL.start(CONTROL_INTERRUPT);
    spawner.spawn(defmt::unwrap!(control(shared, hil, pilot, outputs, board.motors, board.watchdog)));

    SENSOR_INTERRUPT.set_priority(Priority::P7);
    let spawner = SENSOR.start(SENSOR_INTERRUPT);
    spawner.spawn(defmt::unwrap!(sample(shared, board.imu)));

    static THREAD: StaticCell<Executor> = StaticCell::new();
    THREAD.init(Executor::new()).run(|spawner| {
        spawner.spawn(defmt::unwrap!(receive(shared, board.receiver)));
        spawner.spawn(defmt::unwrap!(transmit(shared, board.transmitter)));
        spawner.spawn(defmt::unwrap!(simulated_sensors(shared, hil, board.simulator_receiver)));
        spawner.spawn(defmt::unwrap!(simulated_motors(shared, hil, board.simulator_transmitter)));
        spawner.spawn(defmt::unwrap!(show(shared, board.light, board.battery)));
        spawner.spawn(defmt::unwrap!(keep(shared, parameters)));
    })
}

/// What the handler of [`CONTROL_INTERRUPT`] does.
///
/// # Safety
/// For that handler only.
pub unsafe fn on_control_interrupt() {
    // SAFETY: called from one handler, which runs no sooner than `start` has unmasked it.
    unsafe { CONTROL.on_interrupt() }
}

/// What the handler of [`SENSOR_INTERRUPT`] does.
///
/// # Safety
/// For that handler only.
pub unsafe fn on_sensor_interrupt() {
    // SAFETY: as above.
    unsafe { SENSOR.on_interrupt() }
}

#[embassy_executor::task]
async fn control(
    shared: &'static Shared,
    hil: &'static Hil,
    pilot: &'static mut Pilot<'static>,
    outputs: Outputs,
    pins: BoardMotors,
    mut watchdog: BoardWatchdog,
) {
    let mut motors = SelectedMotors { pins, hil, wanted: &shared.hil, clock: SystemClock };
    Control::new(shared, pilot, outputs).run(&SystemClock, &mut motors, &mut watchdog).await;
}

#[embassy_executor::task]
async fn sample(shared: &'static Shared, mut sensor: BoardImu) {
    imu::run(shared, &SystemClock, &mut sensor).await;
}

#[embassy_executor::task]
async fn receive(shared: &'static Shared, line: Receiver) {
    link::receive::receive(line, &SystemClock, shared).await;
}

#[embassy_executor::task]
async fn transmit(shared: &'static Shared, line: Transmitter) {
    link::transmit::transmit(line, &SystemClock, shared).await;
}

#[embassy_executor::task]
async fn simulated_sensors(shared: &'static Shared, hil: &'static Hil, line: SimulatorReceiver) {
    hil::receive(hil, line, &SystemClock, shared).await;
}

#[embassy_executor::task]
async fn simulated_motors(shared: &'static Shared, hil: &'static Hil, line: SimulatorTransmitter) {
    hil::transmit(hil, line, &SystemClock, shared).await;
}

#[embassy_executor::task]
async fn show(shared: &'static Shared, light: Lamp, battery: BoardBattery) {
    status::run(light, battery, &SystemClock, shared).await;
}

#[embassy_executor::task]
async fn keep(shared: &'static Shared, mut storage: Storage<ParameterFlash>) {
    storage.keep(&SystemClock, shared).await;
}
