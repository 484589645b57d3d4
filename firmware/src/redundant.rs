//! Two inertial sensors as one: the second takes over when the first fails, and keeps the vehicle until it is switched
//! off.
//!
//! ```text
//! first ── answers with [`TAKE_OVER_AFTER_FAULTS`] faults in a row ──────────────┐
//!       ── its gyro or accelerometer repeats one value ───────────────────┼──> second, for good
//!       ── its accelerometer does not answer for [`SILENT_AFTER_SAMPLES`] samples ┘
//! ```
//!
//! There is no way back: a sensor that failed once under way is not trusted with the rest of it. Nor is there a way to
//! a second that has never answered; powering it up takes longer than the flight rules wait. [`Imu::standby`] finds
//! that out, on the ground.
//!
//! A takeover by silence lasts at most 15 ms from the first's last sample to the second's first, which is bridged
//! ([`estimation::imu::BRIDGED_MAX_US`]): the faults are counted before either sensor's driver begins to power it up
//! anew.

use crate::hardware::{Fault, Imu, RawImu, Unit};
use estimation::imu::faults::FaultMonitor;
use estimation::imu::{ImuFault, ImuParameters};

/// Faults of the first in a row after which the second takes over: 10 ms at worst.
pub const TAKE_OVER_AFTER_FAULTS: u8 = 4;

/// Samples without a force in a row after which the second takes over: as many as make a sensor stuck.
pub const SILENT_AFTER_SAMPLES: u8 = 20;

/// Both, and which of them speaks.
pub struct Redundant<First, Second> {
    first: First,
    second: Second,
    unit: Unit,
    /// Whether the second answered its last read.
    is_ready: bool,
    /// The first's samples.
    watch: FaultMonitor,
    /// The first's faults in a row. One under way counts: a caller with a timeout drops it.
    faults: u8,
    /// The first's samples in a row that had no force.
    silent: u8,
}

impl<First: Imu, Second: Imu> Redundant<First, Second> {
    /// The first speaks.
    pub fn new(first: First, second: Second) -> Self {
        let watch = FaultMonitor::new(first.parameters().ranges());
        Self { first, second, unit: Unit::First, is_ready: false, watch, faults: 0, silent: 0 }
    }

    /// Whether the first's newest answer is the last that is borne.
    fn fails(&mut self, answer: &Result<RawImu, Fault>) -> bool {
        let Ok(sample) = answer else { return self.faults >= TAKE_OVER_AFTER_FAULTS };
        self.faults = 0;
        self.silent = if sample.specific_force.is_some() { 0 } else { self.silent.saturating_add(1) };
        let fault = self.watch.check(&sample.angular_velocity, sample.specific_force.as_ref());
        self.silent >= SILENT_AFTER_SAMPLES || matches!(fault, Some(ImuFault::GyroStuck | ImuFault::AccelerometerStuck))
    }
}

impl<First: Imu, Second: Imu> Imu for Redundant<First, Second> {
    async fn sample(&mut self) -> Result<RawImu, Fault> {
        if self.unit == Unit::First {
            self.faults = self.faults.saturating_add(1);
            let answer = if self.faults > TAKE_OVER_AFTER_FAULTS && self.is_ready {
                Err(Fault)
            } else {
                self.first.sample().await
            };
            if !self.fails(&answer) || !self.is_ready {
                return answer;
            }
            self.unit = Unit::Second;
        }
        self.second.sample().await
    }

    fn parameters(&self) -> ImuParameters {
        match self.unit {
            Unit::First => self.first.parameters(),
            Unit::Second => self.second.parameters(),
        }
    }

    fn is_polled(&self) -> bool {
        match self.unit {
            Unit::First => self.first.is_polled(),
            Unit::Second => self.second.is_polled(),
        }
    }

    fn unit(&self) -> Unit {
        self.unit
    }

    async fn standby(&mut self) -> Option<Result<RawImu, Fault>> {
        if self.unit == Unit::Second {
            return None;
        }
        // Not before it has answered: a wait for it may be dropped.
        self.is_ready = false;
        let answer = self.second.sample().await;
        self.is_ready = answer.is_ok();
        Some(answer)
    }
}

#[cfg(test)]
mod tests;
