//! One closed loop in samples: law, held and delayed command, lagging actuator, integrators.
//!
//! A command computed at tick k acts from k + d on, d = n + f samples late (n whole, 0 <= f < 1). So between two ticks
//! the actuator sees w_(k-n-1) for a time f and w_(k-n) for the rest: [`Arrival`].
//!
//! The state of the closed loop is (y_1 .. y_M, a = y_0, the law's states, w_(k-1), w_(k-2), ..): its matrix gives the
//! spectral radius. The same recurrence on the unit circle, without the delay line, gives the loop's frequency
//! response.

use super::compensator::{Compensator, Response};
use super::lag::{Arrival, INTEGRATORS_MAX, INVERSE_FACTORIAL};
use super::spectral_radius::spectral_radius;
use nalgebra::{Complex, DMatrix};

/// A loop whose law, lag and delay are known. All times in samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct SampledLoop<'a> {
    law: &'a Compensator,
    integrators: usize,
    lag: f64,
    arrival: Arrival,
}

impl<'a> SampledLoop<'a> {
    /// Closes `law` through an actuator of the given lag >= 0, its commands `delay` >= 0 late, and so many
    /// `integrators`.
    pub fn new(law: &'a Compensator, integrators: usize, lag: f64, delay: f64) -> Self {
        Self { law, integrators, lag, arrival: Arrival::new(lag, delay) }
    }

    /// The same loop with its commands `delay` late instead. The law knows nothing of that.
    pub fn with_delay(&self, delay: f64) -> Self {
        Self { arrival: Arrival::new(self.lag, delay), ..*self }
    }

    /// The spectral radius of the closed loop: below one, small errors die out by this factor per sample.
    pub fn spectral_radius(&self) -> f64 {
        spectral_radius(self.closed_loop())
    }

    /// The same loop whose actuator makes so much more of its commands. The law knows nothing of that either.
    pub fn with_gain(&self, gain: f64) -> Self {
        Self { arrival: self.arrival.times(gain), ..*self }
    }

    /// The places of the actuator, of the law's states and of the commands that are under way.
    pub fn places(&self) -> [usize; 3] {
        let law = self.integrators + 1;
        [self.integrators, law, law + self.law.size()]
    }

    /// How commands arrive.
    pub fn arrival(&self) -> &Arrival {
        &self.arrival
    }

    /// From one tick's state to the next.
    pub fn closed_loop(&self) -> DMatrix<f64> {
        let Arrival { whole_delay, free, newer, older } = &self.arrival;
        let integrators = self.integrators;
        let [actuator, law, held] = self.places();
        let size = held + self.arrival.earlier_commands();

        // The row of w_k, and where w_(k-j) is read: computed now, or from the delay line.
        let mut command = DMatrix::zeros(1, size);
        command.view_mut((0, 0), (1, integrators)).copy_from(&self.law.direct.columns(0, integrators));
        command.view_mut((0, law), (1, self.law.size())).copy_from(&self.law.output);
        let mut matrix = DMatrix::zeros(size, size);
        for m in 0..=integrators {
            // y_m stands in row m - 1, a = y_0 behind them.
            let row = if m == 0 { actuator } else { m - 1 };
            for j in 0..m {
                matrix[(row, m - j - 1)] += INVERSE_FACTORIAL[j];
            }
            matrix[(row, actuator)] += free[m];
            for (age, weight) in [(*whole_delay, newer[m]), (whole_delay + 1, older[m])] {
                if age == 0 {
                    for column in 0..size {
                        matrix[(row, column)] += weight * command[column];
                    }
                } else if weight != 0.0 {
                    matrix[(row, held + age - 1)] += weight;
                }
            }
        }
        matrix.view_mut((law, 0), (self.law.size(), integrators)).copy_from(&self.law.input.columns(0, integrators));
        matrix.view_mut((law, law), (self.law.size(), self.law.size())).copy_from(&self.law.transition);
        for row in held..size {
            if row == held {
                matrix.row_mut(row).copy_from(&command);
            } else {
                matrix[(row, row - 1)] = 1.0;
            }
        }
        matrix
    }

    /// The law's part of the frequency response at `angle` = omega h in (0, pi], which no delay changes.
    pub fn law_response(&self, angle: f64) -> Response {
        let (sin, cos) = angle.sin_cos();
        self.law.response(Complex::new(cos, sin))
    }

    /// The loop's frequency response L at `angle`, broken at the actuator's command, with the sign that makes -1 the
    /// critical point.
    pub fn response(&self, angle: f64) -> Complex<f64> {
        self.response_with(angle, &self.law_response(angle))
    }

    /// The same where the law's part of it is known.
    pub fn response_with(&self, angle: f64, law: &Response) -> Complex<f64> {
        let Arrival { whole_delay, free, newer, older } = &self.arrival;
        let (sin, cos) = angle.sin_cos();
        let z = Complex::new(cos, sin);
        // z - 1, exact at low frequency too.
        let half = (0.5 * angle).sin();
        let increment = Complex::new(-2.0 * half * half, sin);
        let input = |m: usize| z.conj() * older[m] + newer[m];

        let actual = input(0) / (z - free[0]);
        let mut y = [Complex::new(0.0, 0.0); INTEGRATORS_MAX + 1];
        let mut command = Complex::new(0.0, 0.0);
        for m in 1..=self.integrators {
            let mut sum = input(m) + actual * free[m];
            for j in 1..m {
                sum += y[m - j] * INVERSE_FACTORIAL[j];
            }
            y[m] = sum / increment;
            command += y[m] * law[m - 1];
        }
        let (sin, cos) = (angle * *whole_delay as f64).sin_cos();
        -command * Complex::new(cos, -sin)
    }
}
