//! How series go together, and when that says something.

/// Within this factor two scales are one.
pub const SCALE_FACTOR: f64 = 1.6;
/// By how much the correlations of another order of motors must be greater, in all.
pub const ORDER_BETTER_MIN: f64 = 0.3;
/// A correlation that says something.
pub const CORRELATED_MIN: f64 = 0.3;
/// By their places.
pub const AXES: [&str; 3] = ["x", "y", "z"];

/// The middle one.
pub fn median(mut numbers: Vec<f64>) -> Option<f64> {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied()
}

/// Mean squared distance from the mean.
pub fn variance(series: &[f64]) -> f64 {
    let mean = series.iter().sum::<f64>() / series.len().max(1) as f64;
    series.iter().map(|number| (number - mean).powi(2)).sum::<f64>() / series.len().max(1) as f64
}

/// How much two series go together, from -1 to 1.
pub fn correlated(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len()) as f64;
    let mean = |series: &[f64]| series.iter().sum::<f64>() / count.max(1.0);
    let (of_a, of_b) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - of_a, b - of_b);
        ab += a * b;
        aa += a * a;
        bb += b * b;
    }
    if aa > 0.0 && bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
}
