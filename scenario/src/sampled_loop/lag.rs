//! A first-order lag followed by integrators, solved exactly over a stretch of held input.
//!
//! ```text
//! a' = (w - a) / lag,   y_1' = a,   y_2' = y_1,   y_3' = y_2,   y_4' = y_3
//! ```
//!
//! The m-fold integral of e^(-s/lag) from 0 to t is t^m phi_m(t/lag), where phi_0(x) = e^-x and
//! phi_m(x) = sum over k of (-x)^k / (k + m)!. What a held w adds to y_m is the rest: t^m (1/m! - phi_m) =
//! t^m x phi_(m+1). Those are the entries of the matrix exponential, without forming one; no step of it cancels, for
//! any ratio of t to the lag, and a lag of zero is an ordinary case.

/// The longest chain: from the torque through rate, tilt and velocity to the position.
pub(super) const INTEGRATORS: usize = 4;

/// 1/m!.
pub(super) const INVERSE_FACTORIAL: [f64; INTEGRATORS + 2] = [1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0];

/// Entry m tells about y_m (y_0 = a) at the end of a stretch.
#[derive(Debug, Clone, Copy)]
pub(super) struct LagResponse {
    /// What a unit of `a` at the start leaves in y_m.
    pub free: [f64; INTEGRATORS + 1],
    /// What a unit of held input adds to y_m.
    pub forced: [f64; INTEGRATORS + 1],
}

impl LagResponse {
    /// Over a stretch of `duration` > 0, with `lag` >= 0 in the same unit of time.
    pub fn over(duration: f64, lag: f64) -> Self {
        // Without lag the input is integrated as it stands: 1/m!.
        let mut response = Self { free: [0.0; _], forced: core::array::from_fn(|m| INVERSE_FACTORIAL[m]) };
        let x = duration / lag;
        if x.is_finite() {
            let phi = phi(x);
            for (m, (free, forced)) in response.free.iter_mut().zip(&mut response.forced).enumerate() {
                *free = phi[m];
                *forced = x * phi[m + 1];
            }
        }
        let mut power = 1.0;
        for (free, forced) in response.free.iter_mut().zip(&mut response.forced) {
            *free *= power;
            *forced *= power;
            power *= duration;
        }
        response
    }
}

/// phi_0 to phi_(INTEGRATORS + 1) at x > 0, linked by phi_m = 1/m! - x phi_(m+1).
fn phi(x: f64) -> [f64; INTEGRATORS + 2] {
    /// Terms of the series; at x = 1 the first one left out is below 1e-20 of the sum.
    const TERMS: u32 = 18;
    const LAST: usize = INTEGRATORS + 1;
    let mut phi = [0.0; INTEGRATORS + 2];
    if x <= 1.0 {
        // The series for the last one, then downwards: each step shrinks the error by x.
        let mut term = INVERSE_FACTORIAL[LAST];
        for k in 1..=TERMS {
            phi[LAST] += term;
            term *= -x / (f64::from(k) + LAST as f64);
        }
        for m in (0..LAST).rev() {
            phi[m] = INVERSE_FACTORIAL[m] - x * phi[m + 1];
        }
    } else {
        phi[0] = (-x).exp();
        for m in 0..LAST {
            phi[m + 1] = (INVERSE_FACTORIAL[m] - phi[m]) / x;
        }
    }
    phi
}

#[cfg(test)]
mod tests {
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
                for m in 1..=INTEGRATORS {
                    rates[(m, m - 1)] = 1.0;
                }
                let expected = exponential(rates * duration);
                for m in 0..=INTEGRATORS {
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
            for m in 0..=INTEGRATORS {
                assert!((none.free[m] - small.free[m]).abs() < 2e-12, "{lag:e}");
                assert!((none.forced[m] - small.forced[m]).abs() < 2e-12, "{lag:e}");
            }
        }
    }
}
