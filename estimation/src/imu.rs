//! The inertial sensor's samples, made ready: integrated for the estimator, low-passed for the law, watched for faults.
//!
//! A sample has two uses:
//!
//! - Attitude and velocity are *integrals*. Samples at 1 kHz are integrated as they come ([`integrator`]), unfiltered:
//!   an integral needs no low-pass, its mean over 5 ms is one, and it delays nothing. Rotor vibration at 70 to 130 Hz
//!   stays what it is, a motion to and fro.
//! - The law takes the body rate *at* its ticks: a vibration as fast as these would alias to a constant rate. So the
//!   gyro passes a second-order [low-pass](low_pass) first, which stops that rate altogether, and the newest of its
//!   values is the law's. With ticks at 100 Hz:
//!
//! | sample at | low-pass | mean over 5 ms | a BMI088's own filter |
//! |---|---|---|---|
//! | 70 Hz | 0.31 | 0.81 | 0.94 |
//! | 100 Hz | 0 | 0.64 | 0.80 |
//! | 130 Hz | 0.15 | 0.44 | 0.62 |
//! | 200 Hz | 0.28 | 0 | 0.32 |
//! | delay | 3.7 ms | none: integrals | 1.9 ms |
//!
//! Between two increments a tick turns the attitude on by the increment [under way](Conditioner::under_way).
//!
//! Above 150 Hz the low-pass lets up to a third through: the sensor's own filter is what stops that, and each
//! [sensor]'s is chosen for it. What a sensor shows is as late as its filter ([`ImuParameters::late`]). So a sample
//! counts as of that much earlier, and the estimator carries the state on to the present. The law's body rates stay
//! late, by both filters and up to a sample more: [`ImuParameters::rates_late`] must be counted in the margins of the
//! sampled loops.
//!
//! Where the rotors' speeds are known, [notches](rotor_notches) at these stand in front of the low-pass. They are late
//! as well, by [`RotorNotches::delay_max`] at most.
//!
//! [`faults`] finds invalid samples: stuck ones, full scale, an accelerometer that does not answer. A shock is over
//! sooner than full scale is a fault, and the sensor's own filter hides its peak, but its increment is flagged, for the
//! estimator to be less sure afterwards ([`Clipped`](crate::estimator::Clipped)). Up to [`BRIDGED_MAX_US`] without
//! samples are bridged, by the mean of the samples on both sides; after more the next sample begins anew, and so does
//! the estimator. [`calibration`] corrects every sample; [`standstill`] and [`six_point`] find what it corrects by.
//! [`vibration`] measures what shakes the accelerometer, for an operator to see.
//!
//! SI units, body frame (x forward, y left, z up), time in us.

pub mod calibration;
pub mod faults;
pub mod integrator;
pub mod low_pass;
pub mod rotor_notches;
pub mod sensor;
pub mod six_point;
pub mod standstill;
pub mod vibration;

pub use calibration::Calibration;
pub use faults::ImuFault;
pub use sensor::ImuParameters;
pub use vibration::{Vibration, VibrationReport};

use crate::estimator::Increment;
use crate::measurement::{ImuSample, Stamped};
use controller_core::error::{ParameterError, require_positive};
use faults::FaultMonitor;
use integrator::{Integrator, Sample};
use low_pass::LowPass;
use nalgebra::Vector3;
use rotor_notches::{ROTOR_COUNT, RotorNotches};

/// How long an increment lasts, us, where no sample is missing.
pub const INCREMENT_US: u64 = 5_000;

/// The longest time without samples that is bridged, us: an increment then stays below
/// [`crate::estimator::EXTRAPOLATION_MAX_US`].
pub const BRIDGED_MAX_US: u64 = 15_000;

/// The result of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditioned {
    /// An increment that it completes.
    pub increment: Option<Increment>,
    /// Its fault, or that of those before it.
    pub fault: Option<ImuFault>,
}

/// From samples to increments.
#[derive(Debug, Clone, PartialEq)]
pub struct Conditioner {
    /// The time between the law's ticks, us.
    period: u64,
    late: u64,
    calibration: Calibration,
    watch: FaultMonitor,
    notches: RotorNotches,
    low_pass: LowPass,
    integrator: Integrator,
    newest: Option<Stamped<ImuSample>>,
}

impl Conditioner {
    /// For a sensor with `parameters`, whose samples `calibration` corrects, and a law with ticks every `period` us.
    ///
    /// # Errors
    /// Names the parameter that is not positive.
    pub fn new(parameters: &ImuParameters, calibration: &Calibration, period: u64) -> Result<Self, ParameterError> {
        let p = parameters;
        for (value, field) in [
            (p.rate, "imu.rate"),
            (p.gyro_range, "imu.gyro_range"),
            (p.accelerometer_range, "imu.accelerometer_range"),
            (p.leap, "imu.leap"),
        ] {
            require_positive(value, field)?;
        }
        Ok(Self {
            period,
            late: p.late,
            calibration: *calibration,
            watch: FaultMonitor::new(p.ranges()),
            notches: RotorNotches::new(p.rate),
            low_pass: p.low_pass(period),
            integrator: Integrator::EMPTY,
            newest: None,
        })
    }

    /// Goes on with the samples of another sensor. There is no gap if its first one comes within [`BRIDGED_MAX_US`] of
    /// the last.
    ///
    /// # Errors
    /// As [`Self::new`]; nothing has changed then.
    pub fn take_over(&mut self, parameters: &ImuParameters, calibration: &Calibration) -> Result<(), ParameterError> {
        let mut other = Self::new(parameters, calibration, self.period)?;
        if let Some(newest) = &self.newest {
            other.low_pass.settle(&newest.value.angular_velocity);
        }
        *self = Self { integrator: self.integrator.clone(), newest: self.newest, ..other };
        Ok(())
    }

    /// The newest sample as the law takes it: corrected, the body rate filtered. Its time is that of the motion it
    /// shows, but for notches and low-pass.
    pub fn newest(&self) -> Option<Stamped<ImuSample>> {
        self.newest
    }

    /// What the newest samples add up to since the last increment; none where that ended with the newest.
    pub fn under_way(&self) -> Option<Increment> {
        self.integrator.under_way()
    }

    /// Corrects samples in another way from now on.
    pub fn calibrate(&mut self, calibration: &Calibration) {
        self.calibration = *calibration;
    }

    /// The rotors turn so fast, rad/s; none: nobody knows. Counts until it is told again, or for
    /// [`rotor_notches::SPEEDS_TIMEOUT_US`].
    pub fn follow_rotors(&mut self, speeds: &[Option<f32>; ROTOR_COUNT]) {
        self.notches.follow(speeds);
    }

    /// Takes the sample that could be read at `time` (us): the gyro's, rad/s, and the accelerometer's, m/s^2, if that
    /// one answered; the last specific force counts on where it did not. A sample that is not finite, or not later than
    /// the last, is left out.
    pub fn sample(
        &mut self,
        time: u64,
        angular_velocity: &Vector3<f32>,
        specific_force: Option<&Vector3<f32>>,
    ) -> Conditioned {
        let fault = self.watch.check(angular_velocity, specific_force);
        if fault == Some(ImuFault::NotFinite) {
            return Conditioned { increment: None, fault };
        }
        let rate = self.calibration.rate(angular_velocity);
        let force = specific_force.map(|force| self.calibration.force(force));
        let time = time.saturating_sub(self.late);
        let sample = Sample { time, rate, force, clipped: self.watch.clipped() };
        match self.integrator.age(time) {
            Some(0) => Conditioned { increment: None, fault: fault.or(Some(ImuFault::Clock)) },
            Some(age) if age <= BRIDGED_MAX_US => {
                let smooth = self.low_pass.take(&self.notches.take(&rate));
                let increment = self.integrator.take(&sample, INCREMENT_US);
                self.keep(time, &smooth, force);
                Conditioned { increment, fault }
            }
            before => {
                self.notches.begin();
                self.low_pass.settle(&rate);
                self.integrator.begin(&sample);
                self.keep(time, &rate, force);
                Conditioned { increment: None, fault: fault.or(before.map(|_| ImuFault::Gap)) }
            }
        }
    }

    fn keep(&mut self, time: u64, rate: &Vector3<f32>, force: Option<Vector3<f32>>) {
        let before = || self.newest.map(|newest| newest.value.specific_force);
        let specific_force = force.or_else(before).unwrap_or_default();
        self.newest = Some(Stamped { value: ImuSample { angular_velocity: *rate, specific_force }, time });
    }
}

#[cfg(test)]
mod tests;
