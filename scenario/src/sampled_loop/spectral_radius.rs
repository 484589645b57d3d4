//! The spectral radius of a small matrix by repeated squaring.
//!
//! Gelfand: rho(A) = lim |A^N|^(1/N), taken at N = 2^[`SQUARING_COUNT`] with the norm divided out after every squaring.
//! It always takes the same number of steps and cannot fail to converge, unlike an iteration for the eigenvalues. What
//! is left of |A^N| / rho^N, at most 1e100 even for coinciding eigenvalues, goes into rho as its N-th root: below 1e-9.
//!
//! Like any eigenvalue in double precision it is no better than the matrix is conditioned: several eigenvalues that
//! coincide are known to a root of 1e-16 only.

use nalgebra::DMatrix;

/// N = 2^40, about 1e12.
const SQUARING_COUNT: u32 = 40;

/// The largest magnitude of an eigenvalue of a square `matrix`.
pub(crate) fn spectral_radius(mut matrix: DMatrix<f64>) -> f64 {
    balance(&mut matrix);
    let mut square = matrix.clone();
    let mut logarithm = 0.0_f64;
    let mut weight = 1.0;
    for _ in 0..SQUARING_COUNT {
        let norm = matrix.norm();
        if norm == 0.0 {
            return 0.0;
        }
        logarithm += weight * norm.ln();
        matrix /= norm;
        matrix.mul_to(&matrix, &mut square);
        core::mem::swap(&mut matrix, &mut square);
        weight *= 0.5;
    }
    logarithm.exp()
}

/// Scales the states by powers of two, which costs no digit, until each one's row and column are about as large as each
/// other: a square's rounding is relative to its largest entries, and with fast ticks what a slow loop feeds back is
/// far below them. (nalgebra's balancing does not end where an entry is infinite.)
///
/// Returns the factors: the matrix becomes D^-1 A D.
pub(crate) fn balance(matrix: &mut DMatrix<f64>) -> Vec<f64> {
    /// Enough for any file's; each sweep takes time as one column of a square does.
    const SWEEPS_MAX: usize = 20;
    let mut factors = vec![1.0; matrix.nrows()];
    for _ in 0..SWEEPS_MAX {
        let mut scaled = false;
        for state in 0..matrix.nrows() {
            let own = matrix[(state, state)].abs();
            let row = matrix.row(state).iter().map(|entry| entry.abs()).sum::<f64>() - own;
            let column = matrix.column(state).iter().map(|entry| entry.abs()).sum::<f64>() - own;
            if row <= 0.0 || column <= 0.0 {
                continue;
            }
            let exponent = (0.5 * (row / column).log2()).round();
            if exponent != 0.0 {
                let factor = exponent.exp2();
                matrix.row_mut(state).scale_mut(1.0 / factor);
                matrix.column_mut(state).scale_mut(factor);
                factors[state] *= factor;
                scaled = true;
            }
        }
        if !scaled {
            break;
        }
    }
    factors
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scenario;

    fn radius(rows: [[f64; 2]; 2]) -> f64 {
        spectral_radius(DMatrix::from_row_slice(2, 2, rows.as_flattened()))
    }

    #[test]
    fn a_rotation_scaled_and_sheared_keeps_its_radius() {
        // S R(0.3) S^-1 times 0.97, with S a shear by 50.
        let (sin, cos) = 0.3_f64.sin_cos();
        let sheared = [[cos + 50.0 * sin, -sin * 2501.0], [sin, cos - 50.0 * sin]];
        assert!((radius(sheared.map(|row| row.map(|entry| 0.97 * entry))) - 0.97).abs() < 1e-9);
    }

    #[test]
    fn a_double_eigenvalue_and_a_dominant_negative_one_are_found() {
        assert!((radius([[1.0, 1.0], [0.0, 1.0]]) - 1.0).abs() < 1e-8);
        assert!((radius([[0.5, 3.0], [0.0, -1.25]]) - 1.25).abs() < 1e-9);
    }

    /// With the same constants small errors die out at the same rate per second, to what a sample of 0.5 ms delays,
    /// however much faster the ticks are.
    #[test]
    fn faster_ticks_do_not_change_how_fast_small_errors_die_out() {
        const HUMMINGBIRD: &str = include_str!("../../../vehicles/hummingbird.toml");
        let constants = Scenario::parse(HUMMINGBIRD, "h").unwrap().configuration;
        let decays = |rate: &str| {
            let text = HUMMINGBIRD.replace("rate = 100.0 ", &format!("rate = {rate} "));
            let text = text.replace("[plant]\nstep = 0.001 ", "")
                + "[sensors]\nvelocity = \"alpha-beta\"\nvelocity_bandwidth = 80.0\n";
            let mut scenario = Scenario::parse(&text, "h").unwrap();
            let period = scenario.timing.period();
            scenario.configuration = constants.clone();
            scenario.loops().unwrap().reports().map(|report| (report.axis, -report.spectral_radius.ln() / period))
        };
        let slow = decays("2000.0");
        for rate in ["2500.0", "4000.0"] {
            for ((axis, fast), (_, slow)) in decays(rate).into_iter().zip(slow) {
                assert!(slow > 0.1 && (fast - slow).abs() < 0.02 * slow, "{axis:?} at {rate}: {fast} and {slow}");
            }
        }
    }

    #[test]
    fn a_matrix_that_forgets_everything_has_radius_zero() {
        assert_eq!(radius([[0.0, 2.0], [0.0, 0.0]]), 0.0);
    }
}
