//! The response against a matrix exponential that shares no code with it.

use super::*;
use nalgebra::SMatrix;

/// e^matrix: the series of matrix / 2^12, squared twelve times.
fn exponential(matrix: SMatrix<f64, 6, 6>) -> SMatrix<f64, 6, 6> {
    let small = matrix / 4096.0;
    let (mut sum, mut term) = (SMatrix::identity(), SMatrix::identity());
    for k in 1..20 {
        term = term * small / f64::from(k);
        sum += term;
    }
    (0..12).fold(sum, |power, _| power * power)
}

#[test]
fn the_response_is_the_matrix_exponential() {
    for lag in [1e-3, 0.05, 0.3, 0.999, 1.0, 1.001, 4.0, 300.0] {
        for duration in [0.25, 1.0] {
            let response = LagResponse::over(duration, lag);
            // Order a, y_1 .. y_4, w.
            let mut rates = SMatrix::<f64, 6, 6>::zeros();
            (rates[(0, 0)], rates[(0, 5)]) = (-1.0 / lag, 1.0 / lag);
            for m in 1..=INTEGRATORS_MAX {
                rates[(m, m - 1)] = 1.0;
            }
            let expected = exponential(rates * duration);
            for m in 0..=INTEGRATORS_MAX {
                // Squaring twelve times costs the exponential 4096 roundings.
                let tolerance = 1e-12;
                assert!((response.free[m] - expected[(m, 0)]).abs() < tolerance, "free, lag {lag}, m {m}");
                assert!((response.forced[m] - expected[(m, 5)]).abs() < tolerance, "forced, lag {lag}, m {m}");
            }
        }
    }
}

#[test]
fn no_lag_is_the_limit_of_a_small_one() {
    let none = LagResponse::over(1.0, 0.0);
    for lag in [1e-12, 1e-300, 1e-320] {
        let small = LagResponse::over(1.0, lag);
        for m in 0..=INTEGRATORS_MAX {
            assert!((none.free[m] - small.free[m]).abs() < 2e-12, "{lag:e}");
            assert!((none.forced[m] - small.forced[m]).abs() < 2e-12, "{lag:e}");
        }
    }
}
