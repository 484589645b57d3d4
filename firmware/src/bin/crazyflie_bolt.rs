//! The firmware of the Crazyflie Bolt 1.1: its tasks by priority, and nothing else.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use defmt_rtt as _;
    use embassy_executor::{Executor, InterruptExecutor};
    use embassy_stm32::interrupt;
    use embassy_stm32::interrupt::{InterruptExt, Priority};
    use firmware::boards::crazyflie_bolt::{Board, BoardMotors, BoardWatchdog, NoBattery};
    use firmware::boards::stm32::bring_up;
    use firmware::boards::stm32::clock::SystemClock;
    use firmware::boards::stm32::imu::BoardImu;
    use firmware::boards::stm32::light::Lamp;
    use firmware::boards::stm32::link::Receiver;
    use panic_probe as _;
    use static_cell::StaticCell;

    /// Control interrupts everything but the drivers' own interrupts.
    static CONTROL: InterruptExecutor = InterruptExecutor::new();

    /// The sensor interrupts all but control.
    static SENSOR: InterruptExecutor = InterruptExecutor::new();

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let board = Board::take();
        defmt::info!("{} on Crazyflie Bolt 1.1, started by {}", firmware::configuration::NAME, board.restart);

        interrupt::UART4.set_priority(Priority::P6);
        let spawner = CONTROL.start(interrupt::UART4);
        spawner.spawn(defmt::unwrap!(control(board.motors, board.watchdog)));

        interrupt::UART5.set_priority(Priority::P7);
        let spawner = SENSOR.start(interrupt::UART5);
        spawner.spawn(defmt::unwrap!(imu(board.imu)));

        // The controllers have power for as long as these are held: for ever.
        let _power = board.power;

        static THREAD: StaticCell<Executor> = StaticCell::new();
        THREAD.init(Executor::new()).run(|spawner| {
            spawner.spawn(defmt::unwrap!(link(board.receiver)));
            spawner.spawn(defmt::unwrap!(status(board.light, board.battery)));
        })
    }

    #[embassy_executor::task]
    async fn control(motors: BoardMotors, watchdog: BoardWatchdog) {
        bring_up::hold_stop(SystemClock, motors, watchdog).await;
    }

    #[embassy_executor::task]
    async fn imu(imu: BoardImu) {
        bring_up::watch_imu(SystemClock, imu).await;
    }

    #[embassy_executor::task]
    async fn link(receiver: Receiver) {
        bring_up::count_bytes(SystemClock, receiver).await;
    }

    #[embassy_executor::task]
    async fn status(light: Lamp, battery: NoBattery) {
        bring_up::blink(SystemClock, light, battery).await;
    }

    #[interrupt]
    unsafe fn UART4() {
        // SAFETY: called from this handler only, which runs no sooner than `start` has unmasked it.
        unsafe { CONTROL.on_interrupt() }
    }

    #[interrupt]
    unsafe fn UART5() {
        // SAFETY: as above.
        unsafe { SENSOR.on_interrupt() }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is firmware: README.md says how to build and flash it");
}
