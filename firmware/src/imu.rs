//! The IMU task: each sample as it comes, at 1 kHz, through the conditioner to control; calibration while the vehicle
//! stands.
//!
//! ```text
//! sensor -> RawImu -> Conditioner -> shared increments (each of them), and the one under way
//!                  |             '-> shared imu        (the newest sample, low-passed)
//!                  '-> Calibrator -> parameters, Conditioner
//! ```
//!
//! A sensor that falls silent or answers nonsense leaves the last sample to age; the flight rules decide from its age.
//! While a simulator stands in for the sensors, these do not count. The first fault after good samples, and the first
//! good sample after faults, are events; so is a second sensor that takes over, and one that does not answer on the
//! ground.

mod calibrator;
mod flow;
mod solution;

pub use flow::Flow;

use crate::deadline::within;
use crate::hardware::{Clock, Fault, Imu, RawImu};
use crate::shared::{Event, ImuView, SamplesView, Severity};
use calibrator::Calibrator;
use controller_core::error::ParameterError;
use embassy_sync::blocking_mutex::raw::RawMutex;

/// How long a sample may keep us waiting. A sensor that must be powered up first takes a tenth of a second for it,
/// and is dropped half-way by less. How old a sample may be, others decide.
pub const SAMPLE_TIMEOUT_US: u64 = 200_000;

/// How long to leave a faulty sensor alone.
const RETRY_DELAY_US: u64 = 1_000;

/// How often a task that cannot work looks whether there is anything to do: there never is.
const IDLE_INTERVAL_US: u64 = 1_000_000;

/// Runs for ever, for a control that ticks every `period` us.
pub async fn run<M: RawMutex>(shared: ImuView<'_, M>, clock: &impl Clock, imu: &mut impl Imu, period: u64) -> ! {
    let mut calibrator = Calibrator::new(shared, clock.now());
    let calibration = calibrator.calibration(imu.unit());
    let mut flow = match Flow::new(shared.samples(), &imu.parameters(), calibration, period) {
        Ok(flow) => flow,
        Err(error) => refuse(shared.samples(), clock, &error).await,
    };
    if start_standby(clock, imu).await == Some(Err(Fault)) {
        shared.announce(Event::new(Severity::Warning, "Second IMU does not answer"));
    }
    let (mut unit, mut is_healthy, mut is_polled) = (imu.unit(), true, false);
    loop {
        calibrator.poll(clock.now());
        let standby = if calibrator.needs_standby() { start_standby(clock, imu).await } else { None };
        let sample = within(clock, SAMPLE_TIMEOUT_US, imu.sample()).await.unwrap_or(Err(Fault)).and_then(finite);
        if imu.unit() != unit {
            unit = imu.unit();
            shared.announce(Event::new(Severity::Critical, "IMU: the second takes over"));
            if let Err(error) = flow.take_over(&imu.parameters(), calibrator.calibration(unit)) {
                refuse(shared.samples(), clock, &error).await;
            }
        }
        match &sample {
            Ok(sample) => {
                if calibrator.take(unit, sample, standby) {
                    flow.calibrate(calibrator.calibration(unit));
                }
                if !shared.hil().is_raised() {
                    flow.take(sample);
                }
                if imu.is_polled() != is_polled {
                    is_polled = imu.is_polled();
                    let words =
                        if is_polled { "IMU: no data-ready edges, polled" } else { "IMU: data-ready edges again" };
                    shared.announce(Event::new(Severity::Warning, words));
                }
            }
            Err(Fault) => clock.until(clock.now() + RETRY_DELAY_US).await,
        }
        if sample.is_ok() != is_healthy {
            is_healthy = sample.is_ok();
            match sample {
                Ok(_) => shared.announce(Event::new(Severity::Information, "IMU answers again")),
                Err(Fault) => shared.announce(Event::new(Severity::Critical, "IMU does not answer")),
            }
        }
    }
}

/// A sample of the sensor that stands by.
async fn start_standby(clock: &impl Clock, imu: &mut impl Imu) -> Option<Result<RawImu, Fault>> {
    let answer = within(clock, SAMPLE_TIMEOUT_US, imu.standby()).await.unwrap_or(Some(Err(Fault)))?;
    Some(answer.and_then(finite))
}

/// Refuses a sample that is not made of numbers.
fn finite(sample: RawImu) -> Result<RawImu, Fault> {
    let RawImu { angular_velocity, specific_force, .. } = &sample;
    let numbers = angular_velocity.iter().chain(specific_force.iter().flatten()).all(|component| component.is_finite());
    if numbers { Ok(sample) } else { Err(Fault) }
}

/// A task whose sensor's parameters are invalid: it reports that, and delivers nothing. Nothing arms without samples.
pub async fn refuse<M: RawMutex>(shared: SamplesView<'_, M>, clock: &impl Clock, error: &ParameterError) -> ! {
    shared.announce(Event::new(Severity::Critical, error));
    loop {
        clock.until(clock.now() + IDLE_INTERVAL_US).await;
    }
}
