//! Invalid samples: what a failed sensor delivers.
//!
//! A sensor that works is noisy. A BMI088's gyro jitters by three counts, its accelerometer by as many, so that two
//! triples in a row are equal once in a thousand times, and [`STUCK_AFTER_SAMPLES`] never. A triple at full scale hides
//! a larger truth. So may a lesser one of the accelerometer that leaps: the sensor's own filter flattens a peak at full
//! scale. Vibration differs from that by its slope, not by its size.

use crate::estimator::Clipped;
use nalgebra::Vector3;

/// Equal triples in a row after which a sensor is stuck: 20 ms at 1 kHz, as long as a silent one is flown.
pub const STUCK_AFTER_SAMPLES: u8 = 20;

/// Samples at full scale in a row that are a fault: a shock is over sooner.
pub const SATURATED_AFTER_SAMPLES: u8 = 5;

/// The share of a range that counts as its end.
const FULL_SCALE_SHARE: f32 = 0.999;

worded! {
    /// What is wrong with the sensor, the worst first.
    pub enum ImuFault {
        /// A sample that is not finite: left out.
        NotFinite = "IMU: sample is not a number",
        /// The gyro repeats one value.
        GyroStuck = "IMU: gyro stuck",
        /// The gyro has been at full scale.
        GyroSaturated = "IMU: gyro at full scale",
        /// The accelerometer does not answer: its last value is held.
        AccelerometerSilent = "IMU: accelerometer does not answer",
        /// The accelerometer repeats one value.
        AccelerometerStuck = "IMU: accelerometer stuck",
        /// The accelerometer has been at full scale.
        AccelerometerSaturated = "IMU: accelerometer at full scale",
        /// A sample not later than the one before it: left out.
        Clock = "IMU: samples out of order",
        /// More than [`super::BRIDGED_MAX_US`] without a sample: integration begins anew.
        Gap = "IMU: gap in the samples",
    }
}

impl ImuFault {
    /// Whether the gyro fails.
    pub const fn is_of_the_gyro(self) -> bool {
        matches!(self, Self::GyroStuck | Self::GyroSaturated)
    }

    /// Whether the accelerometer fails.
    pub const fn is_of_the_accelerometer(self) -> bool {
        matches!(self, Self::AccelerometerSilent | Self::AccelerometerStuck | Self::AccelerometerSaturated)
    }
}

/// Full scales, rad/s and m/s^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranges {
    /// The gyro's.
    pub gyro: f32,
    /// The accelerometer's.
    pub accelerometer: f32,
    /// By how much two samples of the accelerometer differ, m/s^2, from which on it may have felt more than its range.
    pub leap: f32,
}

/// Whether a component is at the end of a range.
fn reaches(triple: &Vector3<f32>, range: f32) -> bool {
    triple.iter().any(|component| component.abs() >= FULL_SCALE_SHARE * range)
}

/// One of the two sensors.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SampleHistory {
    last: Vector3<f32>,
    equal: u8,
    saturated: u8,
}

impl SampleHistory {
    const NOTHING: Self = Self { last: Vector3::new(0.0, 0.0, 0.0), equal: 0, saturated: 0 };

    /// Whether it is stuck, and whether at full scale, with this triple.
    fn observe(&mut self, triple: &Vector3<f32>, range: f32) -> (bool, bool) {
        let count = |count: u8, more: bool| if more { count.saturating_add(1) } else { 0 };
        self.equal = count(self.equal, *triple == self.last);
        self.saturated = count(self.saturated, reaches(triple, range));
        self.last = *triple;
        (self.equal >= STUCK_AFTER_SAMPLES, self.saturated >= SATURATED_AFTER_SAMPLES)
    }
}

/// The history of both sensors.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultMonitor {
    ranges: Ranges,
    gyro: SampleHistory,
    accelerometer: SampleHistory,
    leapt: bool,
}

impl FaultMonitor {
    /// Nothing seen yet.
    pub fn new(ranges: Ranges) -> Self {
        Self { ranges, gyro: SampleHistory::NOTHING, accelerometer: SampleHistory::NOTHING, leapt: false }
    }

    /// Which sensor was at full scale in the last sample that it gave; the accelerometer maybe before its own filter.
    pub fn clipped(&self) -> Clipped {
        Clipped { gyro: self.gyro.saturated > 0, accelerometer: self.accelerometer.saturated > 0 || self.leapt }
    }

    /// The sensors' worst fault after one more sample, before calibration.
    pub fn check(&mut self, rate: &Vector3<f32>, force: Option<&Vector3<f32>>) -> Option<ImuFault> {
        let finite = rate.iter().chain(force.into_iter().flatten()).all(|component| component.is_finite());
        if !finite {
            return Some(ImuFault::NotFinite);
        }
        let (gyro_stuck, gyro_saturated) = self.gyro.observe(rate, self.ranges.gyro);
        let last = self.accelerometer.last;
        self.leapt = force.map_or(self.leapt, |force| reaches(&(force - last), self.ranges.leap));
        let (stuck, saturated) =
            force.map_or((false, false), |force| self.accelerometer.observe(force, self.ranges.accelerometer));
        [
            (gyro_stuck, ImuFault::GyroStuck),
            (gyro_saturated, ImuFault::GyroSaturated),
            (force.is_none(), ImuFault::AccelerometerSilent),
            (stuck, ImuFault::AccelerometerStuck),
            (saturated, ImuFault::AccelerometerSaturated),
        ]
        .into_iter()
        .find_map(|(holds, fault)| holds.then_some(fault))
    }
}

#[cfg(test)]
mod tests;
