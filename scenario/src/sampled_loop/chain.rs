//! One closed loop in samples: law, held and delayed command, lagging actuator, integrators.
//!
//! A command computed at tick k acts from k + d on, d = n + f samples late (n whole, 0 <= f < 1). So between two ticks
//! the actuator sees w_(k-n-1) for a time f and w_(k-n) for the rest:
//!
//! ```text
//! y_m+ = sum_j y_(m-j) / j! + free_m a + newer_m w_(k-n) + older_m w_(k-n-1),   a = y_0
//! newer_m = forced_m(1 - f),   older_m = forced_m(1) - forced_m(1 - f)
//! ```
//!
//! The state of the closed loop is (y_1 .. y_M, a, u_f, u_s, w_(k-1), w_(k-2), ..): its matrix gives the spectral radius.
//! The same recurrence on the unit circle, without the delay line, gives the loop's frequency response.

use super::lag::{INTEGRATORS, INVERSE_FACTORIAL, LagResponse};
use super::law::Law;
use super::spectral_radius::spectral_radius;
use nalgebra::{Complex, DMatrix};

/// A loop whose law, lag and delay are known. All times in samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct SampledLoop {
    law: Law,
    lag: f64,
    whole_delay: f64,
    free: [f64; INTEGRATORS + 1],
    newer: [f64; INTEGRATORS + 1],
    older: [f64; INTEGRATORS + 1],
}

impl SampledLoop {
    /// Closes `law` through an actuator of the given lag >= 0, its commands `delay` >= 0 late.
    pub fn new(law: Law, lag: f64, delay: f64) -> Self {
        let whole_delay = delay.floor();
        let full = LagResponse::over(1.0, lag);
        let late = LagResponse::over(1.0 - (delay - whole_delay), lag);
        let mut older = full.forced;
        for (older, newer) in older.iter_mut().zip(&late.forced) {
            *older -= newer;
        }
        Self { law, lag, whole_delay, free: full.free, newer: late.forced, older }
    }

    /// The same loop with its commands `delay` late instead.
    pub fn with_delay(&self, delay: f64) -> Self {
        Self::new(self.law, self.lag, delay)
    }

    /// The spectral radius of the closed loop: below one, small errors die out by this factor per sample.
    pub fn spectral_radius(&self) -> f64 {
        spectral_radius(self.closed_loop())
    }

    /// From one tick's state to the next.
    fn closed_loop(&self) -> DMatrix<f64> {
        let integrators = self.law.integrators;
        let actuator = integrators;
        let filters = actuator + 1;
        let held = filters + if self.law.filters.is_some() { 2 } else { 0 };
        let fractional = self.older.iter().any(|older| *older != 0.0);
        let whole = self.whole_delay as usize;
        let size = held + whole + usize::from(fractional);

        // The row of w_k, and where w_(k-j) is read: computed now, or from the delay line.
        let mut command = DMatrix::zeros(1, size);
        for m in 0..integrators {
            command[m] = self.law.gains[m];
        }
        if let Some(law) = &self.law.filters {
            command[filters] = law.output[0];
            command[filters + 1] = law.output[1];
        }
        let mut matrix = DMatrix::zeros(size, size);
        for m in 0..=integrators {
            // y_m stands in row m - 1, a = y_0 behind them.
            let row = if m == 0 { actuator } else { m - 1 };
            for j in 0..m {
                matrix[(row, m - j - 1)] += INVERSE_FACTORIAL[j];
            }
            matrix[(row, actuator)] += self.free[m];
            for (age, weight) in [(whole, self.newer[m]), (whole + 1, self.older[m])] {
                if age == 0 {
                    for column in 0..size {
                        matrix[(row, column)] += weight * command[column];
                    }
                } else if weight != 0.0 {
                    matrix[(row, held + age - 1)] += weight;
                }
            }
        }
        if let Some(law) = &self.law.filters {
            for i in 0..2 {
                for m in 0..integrators {
                    matrix[(filters + i, m)] = law.input[i] * law.drive[m];
                }
                for j in 0..2 {
                    matrix[(filters + i, filters + j)] = law.transition[(i, j)];
                }
            }
        }
        for row in held..size {
            if row == held {
                matrix.row_mut(row).copy_from(&command);
            } else {
                matrix[(row, row - 1)] = 1.0;
            }
        }
        matrix
    }

    /// The loop's frequency response L at `angle` = omega h in (0, pi], broken at the actuator's command, with the sign
    /// that makes -1 the critical point.
    pub fn response(&self, angle: f64) -> Complex<f64> {
        let (sin, cos) = angle.sin_cos();
        let z = Complex::new(cos, sin);
        // z - 1, exact at low frequency too.
        let half = (0.5 * angle).sin();
        let increment = Complex::new(-2.0 * half * half, sin);
        let input = |m: usize| z.conj() * self.older[m] + self.newer[m];

        let actual = input(0) / (z - self.free[0]);
        let mut y = [Complex::new(0.0, 0.0); INTEGRATORS + 1];
        let mut command = Complex::new(0.0, 0.0);
        let mut drive = Complex::new(0.0, 0.0);
        for m in 1..=self.law.integrators {
            let mut sum = input(m) + actual * self.free[m];
            for j in 1..m {
                sum += y[m - j] * INVERSE_FACTORIAL[j];
            }
            y[m] = sum / increment;
            command += y[m] * self.law.gains[m - 1];
            if let Some(law) = &self.law.filters {
                drive += y[m] * law.drive[m - 1];
            }
        }
        if let Some(law) = &self.law.filters {
            // (z - transition) x_f = input drive, by Cramer's rule.
            let t = &law.transition;
            let (to_filtered, to_intermediate) = (drive * law.input[0], drive * law.input[1]);
            let determinant = (z - t[(0, 0)]) * (z - t[(1, 1)]) - t[(0, 1)] * t[(1, 0)];
            let filtered = (to_filtered * (z - t[(1, 1)]) + to_intermediate * t[(0, 1)]) / determinant;
            let intermediate = (to_intermediate * (z - t[(0, 0)]) + to_filtered * t[(1, 0)]) / determinant;
            command += filtered * law.output[0] + intermediate * law.output[1];
        }
        let (sin, cos) = (angle * self.whole_delay).sin_cos();
        -command * Complex::new(cos, -sin)
    }
}
