//! The firmware of one board.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use controller_core::flight::{ImuSample, Pose};
    use defmt_semihosting as _;
    use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex as Mutex;
    use firmware::boards::mps2::{self, executors, idle, time::BoardClock, uart, watchdog::BoardWatchdog};
    use firmware::hardware::{Clock, Fault, MotorCommand, Motors, Watchdog};
    use firmware::hil::{self, Hil, SelectedMotors};
    use firmware::shared::Latest;
    use panic_probe as _;

    static HIL: Hil<Mutex> = Hil::new(true);
    static IMU: Latest<Mutex, ImuSample> = Latest::new();
    static POSE: Latest<Mutex, Pose> = Latest::new();

    struct NoPins;
    impl Motors for NoPins {
        async fn write(&mut self, _: MotorCommand) -> Result<(), Fault> {
            Ok(())
        }
    }

    #[embassy_executor::task]
    async fn hil_receive() {
        hil::receive(&HIL, uart::SIMULATOR.split().0, &BoardClock, &IMU, &POSE).await;
    }

    #[embassy_executor::task]
    async fn hil_transmit() {
        hil::transmit(&HIL, uart::SIMULATOR.split().1, &BoardClock, 1).await;
    }

    #[embassy_executor::task]
    async fn chatter() {
        let mut next = 1_000_000;
        loop {
            BoardClock.until(next).await;
            defmt::info!("{} s, lost {}", next / 1_000_000, uart::SIMULATOR.lost());
            next += 1_000_000;
        }
    }

    #[embassy_executor::task]
    async fn control() {
        let mut motors = SelectedMotors { hil: &HIL, pins: NoPins, clock: BoardClock };
        let mut next = BoardClock.now() + 10_000;
        let mut dog = BoardWatchdog::start(50_000);
        let (mut worst, mut missed, mut slowest, mut stale, mut ticks) = (0u64, 0u32, 0u64, 0u32, 0u32);
        loop {
            BoardClock.until(next).await;
            let now = BoardClock.now();
            worst = worst.max(now - next);
            if now - next > 9_000 {
                missed += 1;
            }
            if now - next > 0 || ticks < 6 {
                cortex_m_semihosting::heprintln!("tick {} at {} late {}", ticks, next, now - next);
            }
            let mut command = MotorCommand::Stop;
            if let (Some(imu), Some(pose)) = (IMU.get(), POSE.get()) {
                if imu.age(now) > 1000 || pose.age(now) > 1000 {
                    stale += 1;
                }
                command = MotorCommand::Run([0.55; 4]);
            }
            let _ = motors.write(command).await;
            dog.feed();
            slowest = slowest.max(BoardClock.now() - now);
            ticks += 1;
            if ticks == 6 {
                cortex_m_semihosting::debug::exit(Ok(()));
            }
            if ticks % 500 == 0 {
                cortex_m_semihosting::heprintln!(
                    "{} ticks late {} us, slowest {} us, missed {}, stale {}, z {}",
                    ticks,
                    worst,
                    slowest,
                    missed,
                    stale,
                    POSE.get().map_or(0.0, |p| p.value.position.z)
                );
            }
            next += 10_000;
        }
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let core = cortex_m::Peripherals::take().unwrap();
        mps2::init(core);
        defmt::info!("{}", firmware::configuration::NAME);
        let flight = executors::start_flight();
        let background = executors::start_background();
        flight.spawn(control().unwrap());
        flight.spawn(hil_receive().unwrap());
        flight.spawn(hil_transmit().unwrap());
        background.spawn(chatter().unwrap());
        idle::idle(|| false)
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is firmware: README.md says how to build and flash it");
}
