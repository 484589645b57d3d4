//! A second-order low-pass on three axes that stops one frequency altogether: Butterworth's poles with two zeros on the
//! imaginary axis.
//!
//! ```text
//! H(s) = (1 + s^2 / w_z^2) / (1 + sqrt(2) s / w_c + s^2 / w_c^2)
//! ```
//!
//! The zeros are at the rate of the control ticks, because what swings as fast as one looks seems to stand still; or at
//! the first multiple of it above `ROTOR_FREQUENCY_MIN_HZ`, since nothing vibrates below that. The poles are at
//! `POLE_FREQUENCY_SHARE` of the zeros, no higher than `CUTOFF_MAX_HZ`. Zeros beyond half the rate of the samples are
//! at that half, where a digital Butterworth filter has its own. In front of w_z the numerator is real and positive:
//! the phase, and with it the delay, are those of the poles alone.
//!
//! | ticks | zeros | poles | delay at 1 kHz |
//! |---|---|---|---|
//! | 50, 100 Hz | 100 Hz | 60 Hz | 3.7 ms |
//! | 200 Hz | 200 Hz | 120 Hz | 1.8 ms |
//! | 250 Hz | 250 Hz | 120 Hz | 1.8 ms |
//! | 500 Hz, 1 kHz | 500 Hz | 120 Hz | 1.8 ms |
//!
//! By the bilinear transform, with both frequencies put right:
//!
//! ```text
//! K = tan(pi f_c / f_s),   r = 1 / tan(pi f_z / f_s)^2,   n = 1 / (1 + sqrt(2) K + K^2)
//! b_0 = b_2 = K^2 (1 + r) n,  b_1 = 2 K^2 (1 - r) n,  a_1 = 2 (K^2 - 1) n,  a_2 = (1 - sqrt(2) K + K^2) n
//! y_k = b_0 x_k + b_1 x_k-1 + b_2 x_k-2 - a_1 y_k-1 - a_2 y_k-2
//! ```
//!
//! Its delay for slow changes is exactly sqrt(2) / (2 K f_s): the bilinear transform changes nothing at frequency zero.
//! Source: A. V. Oppenheim, R. W. Schafer, *Discrete-Time Signal Processing*, chapter 7.

use controller_core::math;
use nalgebra::Vector3;

/// The lowest frequency at which rotors vibrate, Hz.
const ROTOR_FREQUENCY_MIN_HZ: f64 = 70.0;

/// The poles' frequency over that of the zeros.
const POLE_FREQUENCY_SHARE: f64 = 0.6;

/// The poles' highest frequency, Hz: about that of a sensor's own filter. Higher ones would gain half a millisecond at
/// most, and pass all of the rotors' vibration on to the rotors.
const CUTOFF_MAX_HZ: f64 = 120.0;

/// The filter and its memory, in transposed direct form: two numbers per axis.
#[derive(Debug, Clone, PartialEq)]
pub struct LowPass {
    b0: f32,
    b1: f32,
    a1: f32,
    a2: f32,
    delay: f32,
    first: Vector3<f32>,
    second: Vector3<f32>,
}

impl LowPass {
    /// In front of control ticks every `period` us, of `rate` samples a second.
    pub fn before_ticks(period: u64, rate: f64) -> Self {
        let ticks = 1e6 / period.max(1) as f64;
        let multiple = (ROTOR_FREQUENCY_MIN_HZ / ticks) as u32 + 1;
        let stopped = (ticks * f64::from(multiple)).min(0.5 * rate);
        Self::new((POLE_FREQUENCY_SHARE * stopped).min(CUTOFF_MAX_HZ).min(0.25 * rate), stopped, rate)
    }

    /// Poles at `cutoff`, where the gain of a Butterworth filter would be half the power; zeros at `stopped`; `rate`
    /// samples a second; all in Hz.
    pub fn new(cutoff: f64, stopped: f64, rate: f64) -> Self {
        let k = math::tan(core::f64::consts::PI * cutoff / rate);
        let tangent = math::tan(core::f64::consts::PI * stopped / rate);
        let r = 1.0 / (tangent * tangent);
        let normal = 1.0 / (1.0 + core::f64::consts::SQRT_2 * k + k * k);
        Self {
            b0: (k * k * (1.0 + r) * normal) as f32,
            b1: (2.0 * k * k * (1.0 - r) * normal) as f32,
            a1: (2.0 * (k * k - 1.0) * normal) as f32,
            a2: ((1.0 - core::f64::consts::SQRT_2 * k + k * k) * normal) as f32,
            delay: (core::f64::consts::FRAC_1_SQRT_2 / (k * rate)) as f32,
            first: Vector3::zeros(),
            second: Vector3::zeros(),
        }
    }

    /// The delay of slow changes, s.
    pub fn delay(&self) -> f32 {
        self.delay
    }

    /// As if `value` had been there for ever.
    pub fn settle(&mut self, value: &Vector3<f32>) {
        self.second = value * (self.b0 - self.a2);
        self.first = value * (1.0 - self.b0);
    }

    /// The next sample in, the filtered one out.
    pub fn take(&mut self, sample: &Vector3<f32>) -> Vector3<f32> {
        let weighed = sample * self.b0;
        let out = weighed + self.first;
        self.first = sample * self.b1 - out * self.a1 + self.second;
        self.second = weighed - out * self.a2;
        out
    }
}

#[cfg(test)]
mod tests;
