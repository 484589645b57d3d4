//! The low-passes of a log's body rates: the gyro's own and the firmware's, at the IMU's rate.
//!
//! All of it is linear, so the model's torques are passed through the same two ([`super::impulses`]). The gyro's noise
//! went through them as well. It was white before; afterwards neighbouring samples correlate by 1/16. Without a delay
//! the law answers one sample before the next: the residual of a rate would then correlate with the model's rotors, and
//! the lag of a vehicle without delay would come out a third of a millisecond too small. So each sample is replaced by
//! its innovation, the sample less its prediction:
//!
//! ```text
//! rho_j = sum h_i h_i+jN / sum h_i^2                      h: response to an impulse, N samples of the IMU to a tick
//! n_k - sum a_j n_k-j,   sum_j a_j rho_|i-j| = rho_i      i, j = 1 to 3: G. U. Yule, G. Walker
//! ```
//!
//! The motion that the rates show besides passes the same filter. It is slow, and [`super::noise`] takes it for a
//! random walk before and after.

use super::flight_log::{FlightLog, Source};
use crate::vehicle::instruments::gyro_filter;
use estimation::imu::ImuParameters;
use estimation::imu::low_pass::LowPass;
use nalgebra::{SMatrix, SVector, Vector3};

/// From how many samples the next is predicted.
const PREDICTOR_SAMPLES: usize = 3;
/// Samples of the IMU after an impulse, which has died away by then.
const RESPONSE_SAMPLES_MAX: usize = 1000;

/// The two low-passes, in the order they are passed.
#[derive(Debug, Clone)]
pub struct LowPasses {
    passes: [LowPass; 2],
    samples: usize,
    /// a.
    prediction: SVector<f64, PREDICTOR_SAMPLES>,
}

impl LowPasses {
    /// Those of a log, if its body rates came from an IMU.
    #[must_use]
    pub fn of_log(log: &FlightLog) -> Option<Self> {
        let imu = ImuParameters::BMI088;
        let samples = (log.period * f64::from(imu.rate)).round().max(1.0) as usize;
        let period = (log.period * 1e6).round() as u64;
        (log.source == Source::Estimator).then(|| Self::new([gyro_filter(), imu.low_pass(period)], samples))
    }

    fn new(passes: [LowPass; 2], samples: usize) -> Self {
        let mut new = Self { passes, samples, prediction: SVector::zeros() };
        let mut at_rest = new.clone();
        let impulse = std::iter::once(1.0).chain(std::iter::repeat_n(0.0, RESPONSE_SAMPLES_MAX));
        let response: Vec<f64> = impulse.map(|sample| at_rest.take(&Vector3::repeat(sample)).x).collect();
        let together =
            |ticks: usize| response.iter().zip(response.iter().skip(ticks * samples)).map(|(a, b)| a * b).sum::<f64>();
        let rho = SMatrix::<f64, PREDICTOR_SAMPLES, PREDICTOR_SAMPLES>::from_fn(|i, j| together(i.abs_diff(j)));
        let next = SVector::<f64, PREDICTOR_SAMPLES>::from_fn(|i, _| together(i + 1));
        new.prediction = rho.cholesky().map_or_else(SVector::zeros, |rho| rho.solve(&next));
        new
    }

    /// How many samples of the IMU a tick has.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// The next sample of the IMU in, what comes out.
    pub fn take(&mut self, sample: &Vector3<f64>) -> Vector3<f64> {
        let [own, ours] = &mut self.passes;
        ours.take(&own.take(&sample.map(|of_axis| of_axis as f32))).map(f64::from)
    }

    /// The innovations of a series with a sample a tick: each sample less its prediction from those before. Before the
    /// first stands the first.
    #[must_use]
    pub fn innovations(&self, series: &[f64]) -> Vec<f64> {
        let before = |tick: usize, by: usize| series[tick.saturating_sub(by)];
        let predicted = |tick: usize| -> f64 {
            self.prediction.iter().enumerate().map(|(index, weight)| weight * before(tick, index + 1)).sum()
        };
        series.iter().enumerate().map(|(tick, sample)| sample - predicted(tick)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand::rngs::Xoshiro256PlusPlus;
    use rand_distr::{Distribution, StandardNormal};

    /// How much samples that are `apart` go together: 1 is altogether.
    fn together(series: &[f64], apart: usize) -> f64 {
        let product = |apart: usize| series.iter().zip(series.iter().skip(apart)).map(|(a, b)| a * b).sum::<f64>();
        product(apart) / product(0)
    }

    #[test]
    fn white_noise_that_went_through_them_is_white_again() {
        let mut passes = LowPasses::new([gyro_filter(), ImuParameters::BMI088.low_pass(10_000)], 10);
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let measured: Vec<f64> = (0..2_000_000)
            .map(|_| passes.take(&Vector3::repeat(StandardNormal.sample(&mut random))).x)
            .enumerate()
            .filter_map(|(sample, measured)| (sample % 10 == 0).then_some(measured))
            .collect();
        assert!((together(&measured, 1) - 0.060).abs() < 0.01, "{}", together(&measured, 1));
        let white = passes.innovations(&measured);
        for apart in 1..=5 {
            // 200,000 samples of noise that is white go together by 0.0022, one standard deviation.
            assert!(together(&white, apart).abs() < 0.007, "{apart}: {}", together(&white, apart));
        }
    }
}
