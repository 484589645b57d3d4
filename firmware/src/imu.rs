//! The IMU task: each sample as it comes, at 1 kHz, stamped with the time it was read.
//!
//! A sensor that falls silent or answers nonsense leaves the last sample to age; the flight rules decide from its age.
//! While a simulator stands in for the sensors, what this one says counts for nothing. The first fault after good samples,
//! and the first good sample after faults, are events.

use crate::deadline::within;
use crate::hardware::{Clock, Fault, Imu};
use crate::shared::{Event, Severity, Shared};
use controller_core::flight::ImuSample;
use embassy_sync::blocking_mutex::raw::RawMutex;

/// How long a sample may keep us waiting, us. A sensor that must be powered up first takes a tenth of a second for it, and is
/// dropped half-way by less. How old a sample may be is none of this task's business.
pub const PATIENCE: u64 = 200_000;

/// How long to leave a faulty sensor alone, us.
const RETRY: u64 = 1_000;

/// Runs for ever.
pub async fn run<M: RawMutex>(shared: &Shared<M>, clock: &impl Clock, imu: &mut impl Imu) -> ! {
    let mut healthy = true;
    loop {
        let sample = within(clock, PATIENCE, imu.sample()).await.unwrap_or(Err(Fault)).and_then(finite);
        match sample {
            Ok(_) if shared.hil.is_raised() => {}
            Ok(sample) => shared.imu.put(sample, clock.now()),
            Err(Fault) => clock.until(clock.now() + RETRY).await,
        }
        if sample.is_ok() != healthy {
            healthy = sample.is_ok();
            match sample {
                Ok(_) => shared.announce(Event::new(Severity::Information, "IMU answers again")),
                Err(Fault) => shared.announce(Event::new(Severity::Critical, "IMU does not answer")),
            }
        }
    }
}

/// Refuses a sample that is not made of numbers.
fn finite(sample: ImuSample) -> Result<ImuSample, Fault> {
    let numbers = sample.angular_velocity.iter().chain(&sample.specific_force).all(|component| component.is_finite());
    if numbers { Ok(sample) } else { Err(Fault) }
}
