//! Slopes of a series that is noisy: of the parabola that fits best within 0.1 s.
//!
//! ```text
//! slope_k = sum_i i p_k+i / (T sum_i i^2),  i = -5 ... 5      = sum_j g_j (p_k+j+1 - p_k+j)/T,  j = -5 ... 4
//! ```
//!
//! So it is the true slope's mean with the weights g. What is compared with it must be softened alike.

use nalgebra::Vector3;

/// Samples to either side.
const REACH_SAMPLES: usize = 5;

/// Of each sample, one each `period`, s; zero at the ends, where there are too few.
pub fn slopes(series: &[Vector3<f64>], period: f64) -> Vec<Vector3<f64>> {
    let squares: f64 = (1..=REACH_SAMPLES).map(|i| 2.0 * (i * i) as f64).sum();
    let slope = |sample: usize| {
        let at = |place: usize| series.get(place).copied();
        let pairs = (1..=REACH_SAMPLES).map(|i| Some((at(sample + i)? - at(sample.checked_sub(i)?)?) * i as f64));
        pairs.sum::<Option<Vector3<f64>>>().unwrap_or_default() / (squares * period)
    };
    (0..series.len()).map(slope).collect()
}

/// A series as it would be if it had come from a slope's slope: softened twice with the weights g.
pub fn softened(series: &[f64]) -> Vec<f64> {
    once(&once(series))
}

fn once(series: &[f64]) -> Vec<f64> {
    let squares: f64 = (1..=REACH_SAMPLES).map(|i| 2.0 * (i * i) as f64).sum();
    let reach = REACH_SAMPLES as i64;
    // g_j: of the mean of samples j and j + 1.
    let weight = |j: i64| ((j + 1).max(-j)..=reach).map(|i| i as f64).sum::<f64>() / squares;
    let last = series.len() as i64 - 1;
    let at = |place: i64| series.get(place.clamp(0, last.max(0)) as usize).copied().unwrap_or(0.0);
    let soft = |sample: i64| (-reach..reach).map(|j| weight(j) * (at(sample + j) + at(sample + j + 1)) / 2.0).sum();
    (0..series.len() as i64).map(soft).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 0.01;

    #[test]
    fn a_slopes_slope_is_the_softened_second_derivative() {
        let wave = |k: usize| (7.0 * k as f64 * PERIOD_S).sin();
        let positions: Vec<Vector3<f64>> = (0..200).map(|k| Vector3::x() * wave(k)).collect();
        let accelerations = slopes(&slopes(&positions, PERIOD_S), PERIOD_S);
        let truth: Vec<f64> = (0..200).map(|k| -49.0 * wave(k)).collect();
        for (found, soft) in accelerations.iter().zip(softened(&truth)).skip(20).take(160) {
            assert!((found.x - soft).abs() < 0.05, "{} {soft}", found.x);
        }
    }
}
