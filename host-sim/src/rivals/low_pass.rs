//! Two first-order lags in a row, with the derivative of what comes out.
//!
//! ```text
//! s_1' = b (x - s_1),  s_2' = b (s_1 - s_2)      exact for an input held over the period h, s_2 following s_1 as it stands then
//! ```

use nalgebra::Vector3;

/// A filter of vectors; it starts at its first input.
#[derive(Debug, Clone)]
pub struct LowPass {
    /// 1 - exp(-b h).
    share: f64,
    period: f64,
    state: Option<[Vector3<f64>; 2]>,
}

impl LowPass {
    /// Of `bandwidth` b, 1/s, at a `period` h, s.
    pub fn new(bandwidth: f64, period: f64) -> Self {
        Self { share: 1.0 - (-bandwidth * period).exp(), period, state: None }
    }

    /// Takes `input` in; what comes out, and how fast it changed since the last time.
    pub fn take(&mut self, input: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let [first, second] = self.state.unwrap_or([*input; 2]);
        let first = first + (input - first) * self.share;
        let moved = (first - second) * self.share;
        self.state = Some([first, second + moved]);
        (second + moved, moved / self.period)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_comes_out_at_its_rate_and_late() {
        let mut filter = LowPass::new(20.0, 0.01);
        let mut last = (Vector3::zeros(), Vector3::zeros());
        for tick in 0..500 {
            last = filter.take(&Vector3::new(0.02 * f64::from(tick), 1.0, 0.0));
        }
        assert!((last.1.x - 2.0).abs() < 1e-9 && (last.0.y - 1.0).abs() < 1e-12);
        // Two lags of 1 / 20 s each, less half a sample that each holds.
        let late = (0.02 * 499.0 - last.0.x) / 2.0;
        assert!((0.08..0.1).contains(&late), "{late}");
    }
}
