//! The firmware on QEMU's emulated boards: its tasks by priority, and nothing else. A simulator has sensors and motors.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use defmt_semihosting as _;
    use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
    use firmware::boards::mps2::bench::{Lamp, NoBattery, NoMotors};
    use firmware::boards::mps2::time::BoardClock;
    use firmware::boards::mps2::watchdog::BoardWatchdog;
    use firmware::boards::mps2::{self, executors, exit, idle, uart};
    use firmware::boards::recorder;
    use firmware::boot;
    use firmware::configuration::{PERIOD_US, Pilot};
    use firmware::control::Control;
    use firmware::hil::{self, Hil, SelectedMotors};
    use firmware::link::{receive, transmit};
    use firmware::outputs::Outputs;
    use firmware::recorder::ring::Ring;
    use firmware::shared::Shared;
    use firmware::status;

    static SHARED: Shared<CriticalSectionRawMutex> = Shared::new();
    static HIL: Hil<CriticalSectionRawMutex> = Hil::new();

    /// How long the control task may take to come back.
    const WATCHDOG_TIMEOUT_US: u32 = if PERIOD_US > 10_000 { 5 * PERIOD_US as u32 } else { 50_000 };

    #[cortex_m_rt::entry]
    fn main() -> ! {
        mps2::init(mps2::begin());
        defmt::info!("{} emulated", firmware::configuration::NAME);
        static PLACE: boot::Place = boot::Place::new();
        let Ok((pilot, outputs)) = boot::start(&PLACE, SHARED.for_boot()) else {
            exit::fail("the embedded scenario has not four rotors")
        };
        SHARED.for_boot().hil().raise();
        if let Some(memory) = recorder::take(false) {
            SHARED.for_boot().recorder().attach(Ring::recover(memory), firmware::configuration::NAME);
        }

        let spawner = executors::start_flight();
        spawner.spawn(control(pilot, outputs).unwrap());
        spawner.spawn(to_simulator().unwrap());
        spawner.spawn(from_simulator().unwrap());
        let spawner = executors::start_background();
        spawner.spawn(from_ground().unwrap());
        spawner.spawn(to_ground().unwrap());
        spawner.spawn(show_status().unwrap());
        idle::idle(|| HIL.awaiting())
    }

    #[embassy_executor::task]
    async fn control(pilot: &'static mut Pilot, outputs: Outputs) {
        let shared = SHARED.for_control();
        let mut motors =
            SelectedMotors { pins: NoMotors, hil: &HIL, requested: shared.hil(), clock: BoardClock, period: PERIOD_US };
        let mut watchdog = BoardWatchdog::start(WATCHDOG_TIMEOUT_US);
        Control::new(shared, pilot, outputs).run(&BoardClock, &mut motors, &mut watchdog).await;
    }

    #[embassy_executor::task]
    async fn to_simulator() {
        hil::transmit(&HIL, uart::SIMULATOR.split().1, &BoardClock, SHARED.for_simulator(), PERIOD_US).await;
    }

    #[embassy_executor::task]
    async fn from_simulator() {
        hil::receive(&HIL, uart::SIMULATOR.split().0, &BoardClock, SHARED.for_simulator(), PERIOD_US).await;
    }

    #[embassy_executor::task]
    async fn from_ground() {
        receive::receive(uart::GROUND.split().0, &BoardClock, SHARED.for_receive()).await;
    }

    #[embassy_executor::task]
    async fn to_ground() {
        transmit::transmit(uart::GROUND.split().1, &BoardClock, SHARED.for_transmit()).await;
    }

    #[embassy_executor::task]
    async fn show_status() {
        status::run(Lamp, NoBattery, &BoardClock, SHARED.for_status()).await;
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is firmware: docs/boards.md says how to build and emulate it");
}
