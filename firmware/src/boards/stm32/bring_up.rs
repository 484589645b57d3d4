//! The first life of a board: every driver at work and motors that only ever hear stop.
//!
//! Each function is what a board's binary runs in place of a flight task until that is wired in: the same peripherals at
//! the same priorities, and log lines by which wiring can be checked.

use crate::hardware::{Battery, Clock, Imu, Light, MotorCommand, Motors, Watchdog};
use embedded_io_async::Read;

/// A control tick, us.
const TICK: u64 = 10_000;

/// Between two log lines, us.
const SECOND: u64 = 1_000_000;

/// In place of control: sends stop at 100 Hz, and feeds the watchdog when the frame went out.
pub async fn hold_stop(clock: impl Clock, mut motors: impl Motors, mut watchdog: impl Watchdog) {
    let mut next = clock.now();
    loop {
        next += TICK;
        clock.until(next).await;
        match motors.write(MotorCommand::Stop).await {
            Ok(()) => watchdog.feed(),
            Err(_) => defmt::error!("motors: no frame went out"),
        }
    }
}

/// In place of the IMU task: reads every sample and logs the last of each second.
pub async fn watch_imu(clock: impl Clock, mut imu: impl Imu) {
    let (mut samples, mut faults, mut next) = (0_u32, 0_u32, clock.now() + SECOND);
    let mut last = None;
    loop {
        match imu.sample().await {
            Ok(sample) => (samples, last) = (samples + 1, Some(sample)),
            Err(_) => faults += 1,
        }
        if clock.now() < next {
            continue;
        }
        defmt::info!("imu: {} samples, {} faults", samples, faults);
        if let Some(sample) = last.take() {
            let (rate, force) = (sample.angular_velocity, sample.specific_force);
            defmt::info!("imu: rad/s {} {} {}, m/s^2 {} {} {}", rate.x, rate.y, rate.z, force.x, force.y, force.z);
        }
        (samples, faults, next) = (0, 0, next + SECOND);
    }
}

/// In place of the link: counts what arrives.
pub async fn count_bytes(clock: impl Clock, mut receiver: impl Read) {
    let (mut bytes, mut errors) = (0_usize, 0_u32);
    let mut buffer = [0; 64];
    let mut next = clock.now() + SECOND;
    loop {
        match embassy_futures::select::select(receiver.read(&mut buffer), clock.until(next)).await {
            embassy_futures::select::Either::First(Ok(length)) => bytes += length,
            embassy_futures::select::Either::First(Err(_)) => errors += 1,
            embassy_futures::select::Either::Second(()) => {
                defmt::info!("link: {} bytes, {} errors", bytes, errors);
                (bytes, errors, next) = (0, 0, next + SECOND);
            }
        }
    }
}

/// In place of the status task: blinks, and logs the battery.
pub async fn blink(clock: impl Clock, mut light: impl Light, mut battery: impl Battery) {
    loop {
        light.set(true);
        clock.until(clock.now() + SECOND / 10).await;
        light.set(false);
        clock.until(clock.now() + SECOND - SECOND / 10).await;
        defmt::info!("battery: {} V", battery.voltage().await);
    }
}
