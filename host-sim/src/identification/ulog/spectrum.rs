//! The spectrum of a raw gyro: which frequencies shake the vehicle, and how strongly.
//!
//! The samples of `sensor_gyro_fifo`, ours or PX4's, are cut into windows of N = 512, half over one another, each
//! without its mean and weighed with Hann's window w. What a vibration of amplitude a at the frequency k f_s / N leaves is
//!
//! ```text
//! a_k = 2 |sum_n w_n x_n exp(-2 pi i k n / N)| / sum_n w_n
//! ```
//!
//! of which the mean square over all windows is shown. A frequency between two of these loses up to a seventh of its
//! amplitude. Where samples are missing a window ends.

use super::reader::Ulog;
use crate::reports::plots::axis::Axis;
use crate::reports::plots::drawing::{Drawing, Inks, Side};
use crate::reports::report::plot::Color;
use std::f64::consts::TAU;
use std::fmt::Write;

/// The topic of raw samples.
pub const GYRO_TOPIC: &str = "sensor_gyro_fifo";

/// Samples of a window.
const WINDOW_SAMPLES: usize = 512;

/// Samples of a record at most.
const RECORD_SAMPLES_MAX: usize = 32;

/// Below it motion is flight.
const PEAK_FREQUENCY_MIN_HZ: f64 = 15.0;

/// Peaks that are named: so many at most, and none below this share of the greatest.
const PEAKS_MAX: usize = 5;
const PEAK_SHARE_MIN: f64 = 0.01;

/// Two records follow one another, and are of one sensor, to this share of the time between samples.
const TIME_TOLERANCE_SHARE: f64 = 0.5;
const RATE_TOLERANCE_SHARE: f64 = 0.05;

/// Amplitudes over frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// From one frequency to the next, Hz; the first is zero.
    pub step: f64,
    /// About x, y and z, rad/s.
    pub amplitudes: [Vec<f64>; 3],
    /// What was looked at, s.
    pub seconds: f64,
}

impl Spectrum {
    /// Of a log's raw gyro.
    ///
    /// # Errors
    /// In words, if there is none, or no window of it.
    pub fn of(log: &Ulog) -> Result<Self, String> {
        let (runs, between) = runs(log)?;
        let weights: Vec<f64> = (0..WINDOW_SAMPLES).map(|n| 0.5 - 0.5 * turn(n).1).collect();
        let total: f64 = weights.iter().sum();
        let mut squares = [const { Vec::new() }; 3].map(|_: Vec<f64>| vec![0.0; WINDOW_SAMPLES / 2]);
        let mut windows = 0.0;
        for run in &runs {
            for window in run.windows(WINDOW_SAMPLES).step_by(WINDOW_SAMPLES / 2) {
                windows += 1.0;
                for (axis, squares) in squares.iter_mut().enumerate() {
                    let mean = window.iter().map(|sample| sample[axis]).sum::<f64>() / WINDOW_SAMPLES as f64;
                    let weighed: Vec<f64> =
                        window.iter().zip(&weights).map(|(sample, weight)| (sample[axis] - mean) * weight).collect();
                    for (k, square) in squares.iter_mut().enumerate() {
                        *square += (2.0 / total).powi(2) * power(&weighed, k);
                    }
                }
            }
        }
        if windows == 0.0 {
            return Err(format!("{GYRO_TOPIC}: nowhere {WINDOW_SAMPLES} samples without a gap"));
        }
        Ok(Self {
            step: 1.0 / (between * WINDOW_SAMPLES as f64),
            amplitudes: squares.map(|axis| axis.into_iter().map(|square| (square / windows).sqrt()).collect()),
            seconds: runs.iter().map(Vec::len).sum::<usize>() as f64 * between,
        })
    }

    /// All axes together, rad/s.
    fn together(&self, k: usize) -> f64 {
        self.amplitudes.iter().map(|axis| axis[k] * axis[k]).sum::<f64>().sqrt()
    }

    /// The places of the greatest peaks, the greatest first.
    fn peaks(&self) -> Vec<usize> {
        let least = ((PEAK_FREQUENCY_MIN_HZ / self.step) as usize).max(2);
        let all: Vec<f64> = (0..WINDOW_SAMPLES / 2).map(|k| self.together(k)).collect();
        // Hann's window makes a peak of a single frequency three places wide.
        let is_peak = |k: &usize| (k - 2..=(k + 2).min(all.len() - 1)).all(|other| all[other] <= all[*k]);
        let mut peaks: Vec<usize> = (least..all.len()).filter(is_peak).collect();
        peaks.sort_by(|a, b| all[*b].total_cmp(&all[*a]));
        peaks.truncate(PEAKS_MAX);
        let greatest = peaks.first().map_or(0.0, |k| all[*k]);
        peaks.retain(|k| all[*k] >= PEAK_SHARE_MIN * greatest);
        peaks
    }

    /// The greatest peaks, a line each.
    pub fn told(&self) -> String {
        let rate = 2.0 * self.step * (WINDOW_SAMPLES / 2) as f64;
        let mut text =
            format!("{:.1} s of the gyro at {rate:.0} Hz; greatest peaks, rad/s about x, y, z:\n", self.seconds);
        for k in self.peaks() {
            let [x, y, z] = self.amplitudes.each_ref().map(|axis| axis[k]);
            // A string takes whatever is written to it.
            let _ = writeln!(text, "{:6.1} Hz  {x:.3} {y:.3} {z:.3}", k as f64 * self.step);
        }
        text
    }

    /// As an SVG picture.
    pub fn svg(&self) -> String {
        const SIZE: (u32, u32) = (900, 420);
        const LINE_HEIGHT_PX: f64 = 14.0;
        let (left, right, top, bottom) =
            (5.0 * LINE_HEIGHT_PX, 900.0 - 2.0 * LINE_HEIGHT_PX, 4.0 * LINE_HEIGHT_PX, 420.0 - 3.0 * LINE_HEIGHT_PX);
        let shown = || self.amplitudes.iter().flat_map(|axis| axis.iter().skip(2)).filter(|value| **value > 0.0);
        let least = shown().fold(f64::MAX, |least, value| value.min(least)).log10().floor();
        let greatest = shown().fold(0.0_f64, |most, value| value.max(most)).log10().ceil();
        let frequencies = Axis { least: 0.0, greatest: self.step * (WINDOW_SAMPLES / 2) as f64, logarithmic: false };
        let amplitudes =
            Axis { least: 10_f64.powf(least), greatest: 10_f64.powf(greatest.max(least + 1.0)), logarithmic: true };
        let x = |frequency: f64| left + frequencies.share(frequency) * (right - left);
        let y = |amplitude: f64| bottom - amplitudes.share(amplitude) * (bottom - top);
        let mut drawing = Drawing::new(SIZE);
        for (value, text) in amplitudes.marks(6.0) {
            drawing.stroke(vec![(left, y(value)), (right, y(value))], Color::Grid, 1.0);
            drawing.words(
                text,
                (left - 0.6 * LINE_HEIGHT_PX, y(value) + 0.35 * LINE_HEIGHT_PX),
                Side::End,
                LINE_HEIGHT_PX,
                Color::Muted,
            );
        }
        drawing.stroke(vec![(left, bottom), (right, bottom)], Color::Axis, 1.0);
        for (value, text) in frequencies.marks(12.0) {
            drawing.stroke(vec![(x(value), bottom), (x(value), bottom + 0.3 * LINE_HEIGHT_PX)], Color::Axis, 1.0);
            drawing.words(text, (x(value), bottom + 1.4 * LINE_HEIGHT_PX), Side::Middle, LINE_HEIGHT_PX, Color::Muted);
        }
        drawing.words("Hz", (right, bottom + 2.6 * LINE_HEIGHT_PX), Side::End, LINE_HEIGHT_PX, Color::Muted);
        drawing.words(
            "rad/s",
            (left - 0.6 * LINE_HEIGHT_PX, top - LINE_HEIGHT_PX),
            Side::End,
            LINE_HEIGHT_PX,
            Color::Muted,
        );
        for (place, (axis, name)) in self.amplitudes.iter().zip(["x", "y", "z"]).enumerate() {
            let color = Color::at_place(place);
            let curve = axis.iter().enumerate().skip(1);
            let points = curve.map(|(k, value)| (x(k as f64 * self.step), y(*value))).collect();
            drawing.stroke(points, color, 1.5);
            let at = left + 7.5 * LINE_HEIGHT_PX * place as f64;
            drawing.stroke(
                vec![(at, 1.5 * LINE_HEIGHT_PX), (at + 1.8 * LINE_HEIGHT_PX, 1.5 * LINE_HEIGHT_PX)],
                color,
                1.8,
            );
            drawing.words(
                format!("about {name}"),
                (at + 2.2 * LINE_HEIGHT_PX, 1.85 * LINE_HEIGHT_PX),
                Side::Start,
                LINE_HEIGHT_PX,
                Color::Ink,
            );
        }
        for k in self.peaks().into_iter().take(3) {
            let at = (x(k as f64 * self.step), y(self.together(k)) - 0.6 * LINE_HEIGHT_PX);
            drawing.words(format!("{:.0} Hz", k as f64 * self.step), at, Side::Middle, LINE_HEIGHT_PX, Color::Ink);
        }
        drawing.svg(Inks::Light, "Amplitudes of the gyro's vibration over frequency")
    }
}

/// Sine and cosine of n / N turns.
fn turn(n: usize) -> (f64, f64) {
    (TAU * (n % WINDOW_SAMPLES) as f64 / WINDOW_SAMPLES as f64).sin_cos()
}

/// The square of the sum at frequency `k`, by Goertzel's recursion.
fn power(samples: &[f64], k: usize) -> f64 {
    let twice = 2.0 * turn(k).1;
    let (one, two) = samples.iter().fold((0.0, 0.0), |(one, two), sample| (sample + twice * one - two, one));
    one * one + two * two - twice * one * two
}

/// Samples that follow one another, of three axes, rad/s.
type Run = Vec<[f64; 3]>;

/// The samples in runs; and the time between two of them, s.
fn runs(log: &Ulog) -> Result<(Vec<Run>, f64), String> {
    let topic = log.topic(GYRO_TOPIC).ok_or(format!("has no {GYRO_TOPIC}: was LOG_GYRO 1 when the vehicle booted"))?;
    let mut names: Vec<String> = ["timestamp_sample", "dt", "scale", "samples"].map(str::to_owned).into();
    names.extend(["x", "y", "z"].iter().flat_map(|axis| (0..RECORD_SAMPLES_MAX).map(move |n| format!("{axis}[{n}]"))));
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let rows = topic.columns(&names).ok_or(format!("{GYRO_TOPIC}: not as PX4 has it"))?;
    let (mut runs, mut first, mut due) = (Vec::<Run>::new(), None, f64::NAN);
    for row in &rows {
        let &[time, between, scale, count, ref counts @ ..] = &row[..] else { continue };
        let first = *first.get_or_insert(between);
        let is_usable = between > 0.0 && (between / first - 1.0).abs() < RATE_TOLERANCE_SHARE;
        if !is_usable {
            due = f64::NAN;
            continue;
        }
        let begins = time - (count - 1.0) * between;
        // The first record follows none: NaN is near nothing.
        let follows = (begins - due).abs() < TIME_TOLERANCE_SHARE * between;
        if !follows {
            runs.push(Vec::new());
        }
        due = time + between;
        let sample = |n: usize| [0, 1, 2].map(|axis| counts[axis * RECORD_SAMPLES_MAX + n] * scale);
        if let Some(run) = runs.last_mut() {
            run.extend((0..(count as usize).min(RECORD_SAMPLES_MAX)).map(sample));
        }
    }
    let between = first.filter(|between| *between > 0.0).ok_or(format!("{GYRO_TOPIC}: no time between samples"))?;
    Ok((runs, between * 1e-6))
}

#[cfg(test)]
mod tests;
