//! Notches that follow the rotors: a vibration as fast as a rotor turns does not reach the law, where rotors tell their
//! speeds.
//!
//! One notch for each rotor, and for each of its [`HARMONIC_COUNT`], in front of the [low-pass](super::low_pass). Of f, the
//! rotor's frequency, f_s samples a second, and the depth g from 0 to 1:
//!
//! ```text
//! w = 2 pi f / f_s,   a = w / (2 Q),   k_1 = -cos(w),   k_2 = (1 - a) / (1 + a)
//! A(z) = (k_2 + k_1 (1 + k_2) z^-1 + z^-2) / (1 + k_1 (1 + k_2) z^-1 + k_2 z^-2)
//! y = x - g (x - A x) / 2
//! ```
//!
//! A is an all-pass: its gain is one everywhere, -1 at f and 1 for what does not change. It is computed as a normalised
//! lattice, with c_1 = sin(w), c_2 = 2 sqrt(a) / (1 + a) and the memory s_1, s_2:
//!
//! ```text
//! f_1 = c_2 x - k_2 s_2      A x = k_2 x + c_2 s_2
//! s_1' = c_1 f_1 - k_1 s_1   s_2' = k_1 f_1 + c_1 s_1
//! ```
//!
//! Each line turns a pair of numbers by an angle, for k^2 + c^2 = 1. So |A x|^2 + |s'|^2 = |x|^2 + |s|^2 in every
//! sample, whatever happens to f: a change of speed adds nothing to the memory. With every sample c_2^2 of what s_2
//! holds leaves it, and w turns s_1 into s_2, so that the memory fades while f is in its range.
//!
//! A notch is as deep as its frequency allows: not at all below [`FREQUENCY_MIN_HZ`], where it would be too late and
//! rotors hardly push, wholly from [`FREQUENCY_FULL_HZ`] on, and not at all again near half the rate of the samples. It
//! becomes deeper or shallower by `DEPTH_CHANGE_PER_S` at most, and starts as if the present body rate had been there
//! for ever: a speed that appears or is lost makes no jump. Without a word of speeds for [`SPEEDS_TIMEOUT_US`] all of
//! them fade.
//!
//! For slow changes a notch is late by g a / (f_s (1 - cos(w))): [`RotorNotches::delay_max`] is that of all rotors at
//! the worst frequency. One notch is tuned with each sample, in turn: four samples at most pass from a speed to its
//! notch, and no sample costs more than another by more than a sine and a root.
//!
//! Source: A. H. Gray, J. D. Markel, *A Normalized Digital Filter Structure*, IEEE Transactions on Acoustics, Speech
//! and Signal Processing 23 (1975); P. A. Regalia, S. K. Mitra, P. P. Vaidyanathan, *The Digital All-Pass Filter*,
//! Proceedings of the IEEE 76 (1988).

use controller_core::math;
use nalgebra::Vector3;

/// Rotors that are followed.
pub const ROTOR_COUNT: usize = 4;

/// Multiples of a rotor's frequency that have a notch: the first is its unbalance.
pub const HARMONIC_COUNT: usize = 1;

/// A notch's frequency over its width at half the power, Q. An error of one part in a hundred of the speed leaves 0.16
/// of a vibration.
const QUALITY_FACTOR: f32 = 8.0;

/// Up to here there is no notch, and from here on a whole one, Hz.
pub const FREQUENCY_MIN_HZ: f32 = 45.0;
/// See [`FREQUENCY_MIN_HZ`].
pub const FREQUENCY_FULL_HZ: f32 = 70.0;

/// From here on a notch is shallower, and from here on there is none, as shares of the rate of the samples.
const FULL_SHARE_MAX: f32 = 0.40;
const SHARE_MAX: f32 = 0.45;

/// How fast a depth changes.
const DEPTH_CHANGE_PER_S: f32 = 30.0;

/// How long speeds count that nobody renews.
pub const SPEEDS_TIMEOUT_US: u64 = 50_000;

/// Rotations a second, Hz, in one rad/s.
const HZ_PER_RAD_S: f32 = 1.0 / core::f32::consts::TAU;

/// How deep a notch at `frequency`, Hz, may be; 0 for no number.
fn depth(frequency: f32, rate: f32) -> f32 {
    let rising = (frequency - FREQUENCY_MIN_HZ) / (FREQUENCY_FULL_HZ - FREQUENCY_MIN_HZ);
    let falling = (SHARE_MAX - frequency / rate) / (SHARE_MAX - FULL_SHARE_MAX);
    if frequency.is_finite() { math::clamp(math::min(rising, falling), 0.0, 1.0) } else { 0.0 }
}

/// w of a frequency that is this share of the rate of the samples, as [`math::sin_cos_turns`] takes it.
fn phase(share: f32) -> u64 {
    const PHASE_PER_TURN: f32 = 4_294_967_296.0;
    u64::from((share * PHASE_PER_TURN) as u32) << u32::BITS
}

/// Its a.
fn half_width(share: f32) -> f32 {
    core::f32::consts::PI / QUALITY_FACTOR * share
}

/// One notch on three axes.
#[derive(Debug, Clone, PartialEq)]
struct Notch {
    /// Its frequency as a share of the rate of the samples, once it is tuned, and its depth when it has come to that.
    share: f32,
    wanted: f32,
    /// The depth, g.
    depth: f32,
    k1: f32,
    c1: f32,
    k2: f32,
    c2: f32,
    s1: Vector3<f32>,
    s2: Vector3<f32>,
}

impl Notch {
    const OFF: Self = Self {
        share: 0.0,
        wanted: 0.0,
        depth: 0.0,
        k1: 0.0,
        c1: 1.0,
        k2: 0.0,
        c2: 1.0,
        s1: Vector3::new(0.0, 0.0, 0.0),
        s2: Vector3::new(0.0, 0.0, 0.0),
    };

    /// Whether it is off, and stays so.
    fn is_off(&self) -> bool {
        self.depth == 0.0 && self.wanted == 0.0
    }

    /// Takes its frequency over; one that is off starts as if `value` had been there for ever.
    fn tune(&mut self, value: &Vector3<f32>) {
        let (sine, cosine) = math::sin_cos_turns(phase(self.share));
        let a = half_width(self.share);
        let root = math::sqrt(a);
        let normal = 1.0 / (1.0 + a);
        (self.k1, self.c1) = (-cosine, sine);
        (self.k2, self.c2) = ((1.0 - a) * normal, 2.0 * root * normal);
        if self.depth == 0.0 {
            // cot(w / 2) = sin(w) / (1 - cos(w)).
            self.s2 = value * root;
            self.s1 = self.s2 * (sine / (1.0 - cosine));
        }
    }

    /// The next sample in, the filtered one out; the depth may change by `step`.
    fn take(&mut self, value: &Vector3<f32>, step: f32) -> Vector3<f32> {
        self.depth = math::clamp(self.wanted, self.depth - step, self.depth + step);
        let first = value * self.c2 - self.s2 * self.k2;
        let passed = value * self.k2 + self.s2 * self.c2;
        self.s2 = first * self.k1 + self.s1 * self.c1;
        self.s1 = first * self.c1 - self.s1 * self.k1;
        value - (value - passed) * (0.5 * self.depth)
    }
}

/// The notches of all rotors.
#[derive(Debug, Clone, PartialEq)]
pub struct RotorNotches {
    notches: [[Notch; HARMONIC_COUNT]; ROTOR_COUNT],
    /// Whether any is on, or is to be.
    is_on: bool,
    /// Samples a second, Hz.
    rate: f32,
    /// Whose turn it is to be tuned.
    turn: usize,
    /// Samples since speeds were told.
    silence: u32,
    /// After how many speeds are lost.
    silence_max: u32,
}

impl RotorNotches {
    /// Without speeds, of `rate` samples a second, Hz.
    pub fn new(rate: f32) -> Self {
        let silence_max = (SPEEDS_TIMEOUT_US as f32 * 1e-6 * rate) as u32;
        Self {
            notches: [const { [const { Notch::OFF }; HARMONIC_COUNT] }; ROTOR_COUNT],
            is_on: false,
            rate,
            turn: 0,
            silence: silence_max,
            silence_max,
        }
    }

    /// The longest delay of slow changes at `rate` samples a second, s: that of every rotor at [`FREQUENCY_FULL_HZ`].
    pub fn delay_max(rate: f32) -> f32 {
        let each = (1..=HARMONIC_COUNT).map(|harmonic| {
            let share = harmonic as f32 * FREQUENCY_FULL_HZ / rate;
            let (_, cosine) = math::sin_cos_turns(phase(share));
            half_width(share) / (rate * (1.0 - cosine))
        });
        ROTOR_COUNT as f32 * each.sum::<f32>()
    }

    /// The rotors turn so fast, rad/s; none: nobody knows.
    pub fn follow(&mut self, speeds: &[Option<f32>; ROTOR_COUNT]) {
        self.silence = 0;
        for (notches, speed) in self.notches.iter_mut().zip(speeds) {
            for (notch, harmonic) in notches.iter_mut().zip(1_u8..) {
                let frequency = speed.map_or(0.0, |speed| speed.abs() * HZ_PER_RAD_S * f32::from(harmonic));
                notch.wanted = depth(frequency, self.rate);
                // One that fades stays where it was.
                if notch.wanted > 0.0 {
                    self.is_on = true;
                    notch.share = frequency / self.rate;
                }
            }
        }
    }

    /// The next sample follows upon nothing: every notch starts anew.
    pub fn begin(&mut self) {
        self.notches.as_flattened_mut().iter_mut().for_each(|notch| notch.depth = 0.0);
    }

    /// The next sample in, the filtered one out.
    pub fn take(&mut self, sample: &Vector3<f32>) -> Vector3<f32> {
        if !self.is_on {
            return *sample;
        }
        let is_lost = self.silence >= self.silence_max;
        self.silence = self.silence.saturating_add(1);
        let step = DEPTH_CHANGE_PER_S / self.rate;
        let (turn, mut value) = (self.turn, *sample);
        self.turn = if turn + 1 < ROTOR_COUNT * HARMONIC_COUNT { turn + 1 } else { 0 };
        self.is_on = false;
        for (place, notch) in self.notches.as_flattened_mut().iter_mut().enumerate() {
            if is_lost {
                notch.wanted = 0.0;
            }
            self.is_on |= !notch.is_off();
            if notch.is_off() || (notch.depth == 0.0 && place != turn) {
                continue;
            }
            if place == turn {
                notch.tune(&value);
            }
            value = notch.take(&value, step);
        }
        value
    }
}

#[cfg(test)]
mod tests;
