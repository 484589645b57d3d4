//! The inertial sensors that the firmware drives: how each is set, and how late it makes a motion.
//!
//! A gyro's own filter is what stands between a vibration and its samples. It is taken as a second-order Butterworth
//! filter of the bandwidth f that the data sheet gives, which is late by sqrt(2) / (2 pi f); no data sheet gives a
//! delay. Bandwidths are set so that no sensor passes more of a vibration on to control than [`GAIN_MAX_SHARE`] times
//! what a BMI088 does, at any rate of control, and so that none is much later than that one:
//!
//! | sensor | samples | gyro's bandwidth | late | and by the time to the next sample |
//! |---|---|---|---|---|
//! | BMI088 | 1000 Hz | 116 Hz | 1.94 ms | 2.94 ms |
//! | BMI270 | 1600 Hz | 94 Hz | 2.39 ms | 3.02 ms |
//! | ICM-42688-P | 1000 Hz | 126 Hz | 1.91 ms | 2.91 ms |
//! | ICM-42605 | 1000 Hz | 122 Hz | 1.97 ms | 2.97 ms |
//!
//! An ICM's samples are an eighth of a millisecond later than its filter, for what follows that. The accelerometers'
//! filters are up to 1.2 ms less late, which is not distinguished.

use super::faults::Ranges;
use super::low_pass::LowPass;

/// How much more of a vibration than a BMI088 any sensor may pass on to control's ticks.
pub const GAIN_MAX_SHARE: f32 = 1.2;

/// A sensor and how it is to be read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImuParameters {
    /// Samples a second, Hz.
    pub rate: f32,
    /// The gyro's full scale, rad/s.
    pub gyro_range: f32,
    /// The accelerometer's full scale, m/s^2.
    pub accelerometer_range: f32,
    /// By how much two samples of the accelerometer differ, m/s^2, from which on it may have felt more than its full
    /// scale: its own filter flattens a shock.
    pub leap: f32,
    /// Where the gyro's own filter leaves half the power, Hz; infinite without a filter.
    pub gyro_bandwidth: f32,
    /// How late a sample is when it can be read, by the sensor's own filters, us.
    pub late: u64,
}

impl ImuParameters {
    /// A BMI088 at 1 kHz: 2000 deg/s, 24 g.
    ///
    /// Its accelerometer's filter has 145 Hz. Where half a sine of a millisecond reaches the full scale, that filter
    /// rises by 0.22 of the full scale from one sample to the next, 52 m/s^2; some is left for vibration.
    pub const BMI088: Self = Self {
        rate: 1000.0,
        gyro_range: 34.906_586,
        accelerometer_range: 235.36,
        leap: 40.0,
        gyro_bandwidth: 116.0,
        late: 1_940,
    };

    /// A BMI270 at 1.6 kHz: 2000 deg/s, 16 g. Its accelerometer's filter has 188 Hz, and rises by 0.23.
    pub const BMI270: Self = Self {
        rate: 1600.0,
        accelerometer_range: 156.906_4,
        leap: 28.0,
        gyro_bandwidth: 94.0,
        late: 2_395,
        ..Self::BMI088
    };

    /// An ICM-42688-P at 1 kHz: 2000 deg/s, 16 g. Both filters are the same, and rise by 0.18.
    pub const ICM42688P: Self =
        Self { accelerometer_range: 156.906_4, leap: 22.0, gyro_bandwidth: 126.0, late: 1_911, ..Self::BMI088 };

    /// An ICM-42605 at 1 kHz: 2000 deg/s, 16 g. As an ICM-42688-P, by what its filters can be set to.
    pub const ICM42605: Self = Self { leap: 21.0, gyro_bandwidth: 122.0, late: 1_970, ..Self::ICM42688P };

    /// A BMI088 as simulators have it, without filters of its own.
    pub const PROMPT: Self = Self { leap: f32::MAX, gyro_bandwidth: f32::INFINITY, late: 0, ..Self::BMI088 };

    /// Every sensor that the firmware drives, by name.
    pub const DRIVEN: [(&str, Self); 4] = [
        ("BMI088", Self::BMI088),
        ("BMI270", Self::BMI270),
        ("ICM-42688-P", Self::ICM42688P),
        ("ICM-42605", Self::ICM42605),
    ];

    /// How late the body rates of a law with ticks every `period` us are at most, s, as long as they change slowly: by
    /// both filters, and by the time to the next sample.
    pub fn rates_late(&self, period: u64) -> f32 {
        self.low_pass(period).delay() + self.late as f32 * 1e-6 + 1.0 / self.rate
    }

    /// Where what it shows ends.
    pub fn ranges(&self) -> Ranges {
        Ranges { gyro: self.gyro_range, accelerometer: self.accelerometer_range, leap: self.leap }
    }

    /// The low-pass for the body rates of a law with ticks every `period` us.
    pub fn low_pass(&self, period: u64) -> LowPass {
        LowPass::before_ticks(period, self.rate.into())
    }
}

#[cfg(test)]
mod tests;
