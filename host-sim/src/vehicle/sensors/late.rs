//! A quantity that arrives a fixed time late, between ticks along a straight line.
//!
//! ```text
//! y_k = (1 - s) x_(k-n) + s x_(k-n-1),   lateness / T = n + s,  0 <= s < 1
//! ```

use nalgebra::SVector;
use std::collections::VecDeque;

/// What is still under way.
#[derive(Debug, Clone)]
pub struct Late<const N: usize> {
    /// n.
    whole: usize,
    /// s.
    share: f64,
    /// The newest last.
    past: VecDeque<SVector<f64, N>>,
}

impl<const N: usize> Late<N> {
    /// By so many ticks.
    pub fn new(ticks: f64) -> Self {
        Self { whole: ticks as usize, share: ticks.fract(), past: VecDeque::new() }
    }

    /// Takes this tick's value; returns the one that arrives: the first until there are enough.
    pub fn take(&mut self, value: SVector<f64, N>) -> SVector<f64, N> {
        self.past.push_back(value);
        if self.past.len() > self.whole + 2 {
            self.past.pop_front();
        }
        let back = |ticks: usize| self.past[self.past.len().saturating_sub(1 + ticks)];
        // Without a rest the value itself, to the bit.
        if self.share == 0.0 { back(self.whole) } else { back(self.whole).lerp(&back(self.whole + 1), self.share) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector1;

    #[test]
    fn a_ramp_arrives_late_by_the_ticks_and_the_rest() {
        for ticks in [0.0, 0.3, 1.0, 1.5, 4.2] {
            let mut late = Late::new(ticks);
            let last = (0..20).map(|tick| late.take(Vector1::new(f64::from(tick))).x).last().unwrap();
            assert!((last - (19.0 - ticks)).abs() < 1e-12, "{ticks}: {last}");
        }
    }
}
