//! The firmware of the MicoAir H743 V2: its tasks by priority, and nothing else.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use controller_core::flight::Pilot;
    use defmt_rtt as _;
    use embassy_executor::{Executor, InterruptExecutor};
    use embassy_stm32::interrupt;
    use embassy_stm32::interrupt::{InterruptExt, Priority};
    use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
    use firmware::boards::micoair_h743::{Board, BoardMotors, BoardWatchdog, DividedBattery};
    use firmware::boards::stm32::clock::SystemClock;
    use firmware::boards::stm32::imu::BoardImu;
    use firmware::boards::stm32::light::Lamp;
    use firmware::boards::stm32::link::{Receiver, SimulatorReceiver, SimulatorTransmitter, Transmitter};
    use firmware::boards::stm32::storage::ParameterFlash;
    use firmware::control::Control;
    use firmware::hil::{self, SelectedMotors};
    use firmware::outputs::Outputs;
    use firmware::parameters::storage::Storage;
    use firmware::{boot, imu, link, status};
    use panic_probe as _;
    use static_cell::StaticCell;

    type Shared = firmware::shared::Shared<CriticalSectionRawMutex>;
    type Hil = hil::Hil<CriticalSectionRawMutex>;

    /// Control interrupts everything but the drivers' own interrupts.
    static CONTROL: InterruptExecutor = InterruptExecutor::new();

    /// The sensor interrupts all but control.
    static SENSOR: InterruptExecutor = InterruptExecutor::new();

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let board = Board::take();
        defmt::info!("started by {} on MicoAir H743 V2", board.restart);
        static SHARED: StaticCell<Shared> = StaticCell::new();
        let shared = SHARED.init_with(Shared::new);
        static HIL: StaticCell<Hil> = StaticCell::new();
        let hil = HIL.init_with(Hil::new);
        let parameters = Storage::load(board.storage, shared);
        static PLACE: boot::Place = boot::Place::new();
        let (pilot, outputs) = defmt::unwrap!(boot::start(&PLACE, &shared.parameters));

        interrupt::SAI1.set_priority(Priority::P6);
        let spawner = CONTROL.start(interrupt::SAI1);
        spawner.spawn(defmt::unwrap!(control(shared, hil, pilot, outputs, board.motors, board.watchdog)));

        interrupt::SAI2.set_priority(Priority::P7);
        let spawner = SENSOR.start(interrupt::SAI2);
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
    async fn show(shared: &'static Shared, light: Lamp, battery: DividedBattery) {
        status::run(light, battery, &SystemClock, shared).await;
    }

    #[embassy_executor::task]
    async fn keep(shared: &'static Shared, mut storage: Storage<ParameterFlash>) {
        storage.keep(&SystemClock, shared).await;
    }

    #[interrupt]
    unsafe fn SAI1() {
        // SAFETY: called from this handler only, which runs no sooner than `start` has unmasked it.
        unsafe { CONTROL.on_interrupt() }
    }

    #[interrupt]
    unsafe fn SAI2() {
        // SAFETY: as above.
        unsafe { SENSOR.on_interrupt() }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is firmware: README.md says how to build and flash it");
}
