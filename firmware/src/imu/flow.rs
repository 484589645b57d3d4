//! A sensor's samples on their way to control: conditioned, and put down where control finds them.
//!
//! A fault is reported when it sets in, and again when it comes back after [`FAULT_REPORT_PAUSE_US`] without it: eight
//! kinds of faults cannot flood the link.
//!
//! A simulator may send samples as seldom as control ticks. There is nothing between two of them to be filtered, and a
//! low-pass made for 1 kHz would be late by many of them: they pass as they are. And a simulator's sensors may be free
//! of noise, so that equal samples are no fault of theirs.

use crate::esc::controller::SPEED_AGE_MAX_US;
use crate::hardware::RawImu;
use crate::shared::{Event, SamplesView, Severity};
use controller_core::error::ParameterError;
use embassy_sync::blocking_mutex::raw::RawMutex;
use estimation::imu::{Calibration, Conditioned, Conditioner, INCREMENT_US, ImuFault, ImuParameters, Vibration};

/// How long a fault must have been absent to be reported again.
const FAULT_REPORT_PAUSE_US: u64 = 1_000_000;

/// A sensor's samples, as far as they have come.
pub struct Flow<'a, M: RawMutex> {
    shared: SamplesView<'a, M>,
    conditioner: Conditioner,
    vibration: Vibration,
    is_simulated: bool,
    /// The time between control ticks, us.
    period: u64,
    /// When each fault was last seen, us.
    seen: [Option<u64>; ImuFault::ALL.len()],
}

impl<'a, M: RawMutex> Flow<'a, M> {
    /// From a sensor of these parameters, to a control that ticks every `period` us.
    /// An error names the parameter that makes no sense.
    pub fn new(
        shared: SamplesView<'a, M>,
        parameters: &ImuParameters,
        calibration: &Calibration,
        period: u64,
    ) -> Result<Self, ParameterError> {
        let conditioner = Conditioner::new(parameters, calibration, period)?;
        let vibration = Vibration::new(parameters.accelerometer_range);
        Ok(Self { shared, conditioner, vibration, is_simulated: false, period, seen: [None; _] })
    }

    /// From a simulator.
    /// Never fails: the parameters are good.
    pub fn simulated(shared: SamplesView<'a, M>, period: u64) -> Result<Self, ParameterError> {
        Ok(Self { is_simulated: true, ..Self::new(shared, &ImuParameters::PROMPT, &Calibration::NONE, period)? })
    }

    /// Corrects samples in another way from now on.
    pub fn calibrate(&mut self, calibration: &Calibration) {
        self.conditioner.calibrate(calibration);
    }

    /// Goes on with another sensor's samples.
    /// An error names the parameter that makes no sense.
    pub fn take_over(&mut self, parameters: &ImuParameters, calibration: &Calibration) -> Result<(), ParameterError> {
        self.conditioner.take_over(parameters, calibration)?;
        self.vibration = Vibration::new(parameters.accelerometer_range);
        Ok(())
    }

    /// Takes the next sample.
    pub fn take(&mut self, raw: &RawImu) {
        self.shared.gyro_log().put(raw.time, &raw.angular_velocity);
        if self.shared.follows_rotors().is_raised()
            && let Some(speeds) = self.shared.rotor_speeds().recent(SPEED_AGE_MAX_US, raw.time)
        {
            self.conditioner.follow_rotors(&speeds);
        }
        let before = self.conditioner.newest().map(|newest| newest.time);
        let force = raw.specific_force.as_ref();
        let Conditioned { increment, fault } = self.conditioner.sample(raw.time, &raw.angular_velocity, force);
        if let Some(fault) = fault {
            self.report(fault, raw.time);
        }
        // A stuck gyro is treated as missing: without increments nothing arms, and what flies stops as without an IMU.
        if fault == Some(ImuFault::GyroStuck) && !self.is_simulated {
            return;
        }
        let Some(newest) = self.conditioner.newest().filter(|newest| Some(newest.time) != before) else { return };
        let mut sample = newest.value;
        let is_slow = before.is_some_and(|before| raw.time - before >= self.period.min(INCREMENT_US));
        if self.is_simulated && is_slow {
            sample.angular_velocity = raw.angular_velocity;
        }
        self.shared.imu().put(sample, newest.time);
        if let Some(force) = force {
            self.vibration.take(force, before.map_or(0, |before| newest.time.saturating_sub(before)));
        }
        if let Some(increment) = increment {
            self.shared.increment(increment);
            self.shared.vibration().put(self.vibration.report(), newest.time);
        }
        if let Some(under_way) = self.conditioner.under_way() {
            self.shared.under_way().put(under_way, under_way.end);
        }
    }

    fn report(&mut self, fault: ImuFault, time: u64) {
        if self.is_simulated && matches!(fault, ImuFault::GyroStuck | ImuFault::AccelerometerStuck) {
            return;
        }
        if fault.is_of_the_gyro() || fault.is_of_the_accelerometer() {
            self.shared.imu_fault().put(fault, time);
        }
        let Some(seen) = self.seen.get_mut(fault as usize) else { return };
        let is_new = seen.is_none_or(|seen| time.saturating_sub(seen) >= FAULT_REPORT_PAUSE_US);
        *seen = Some(time);
        if is_new {
            self.shared.announce(Event::new(Severity::Critical, fault));
        }
    }
}
