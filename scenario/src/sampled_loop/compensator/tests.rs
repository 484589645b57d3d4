//! The matrices are those of the recurrence, and the response is that of the matrices.

use super::*;
use nalgebra::{ComplexField, DVector, SVector};

/// A system of `size` states with entries of all sizes and signs, none of it symmetric.
fn entry(i: usize, j: usize) -> f64 {
    let mixed = (i * 37 + j * 101 + 13) % 29;
    (mixed as f64 - 14.0) / 29.0
}

fn tick(x: &mut [f64], y: &[f64; INTEGRATORS_MAX]) -> f64 {
    let size = x.len();
    let row = |i: usize| -> f64 {
        let own: f64 = (0..size).map(|j| 0.4 * entry(i, j) * x[j]).sum();
        own + (0..INTEGRATORS_MAX).map(|m| entry(i + 50, m) * y[m]).sum::<f64>()
    };
    let next: Vec<f64> = (0..size).map(row).collect();
    let command = row(size + 3);
    x.copy_from_slice(&next);
    command
}

#[test]
fn the_response_is_that_of_the_recurrence_at_any_size() {
    for size in 1..13 {
        let system = Compensator::from_tick(size, tick);
        assert_eq!(system.size(), size);
        for angle in [1e-3, 0.1, 1.0, 3.0_f64] {
            let z = Complex::new(angle.cos(), angle.sin());
            let response = system.response(z);
            // Written out: the recurrence's own matrices, a general solver.
            let column = |states: &[f64], y: &[f64; INTEGRATORS_MAX]| {
                let mut x = states.to_vec();
                let command = tick(&mut x, y);
                (DVector::from_vec(x), command)
            };
            let unit = |n: usize, i: usize| (0..n).map(|j| f64::from(u8::from(i == j))).collect::<Vec<_>>();
            let states: Vec<_> = (0..size).map(|i| column(&unit(size, i), &[0.0; INTEGRATORS_MAX])).collect();
            let full = DMatrix::from_fn(size, size, |i, j| {
                Complex::new(-states[j].0[i], 0.0) + if i == j { z } else { Complex::new(0.0, 0.0) }
            });
            for (m, response) in response.iter().enumerate() {
                let y: [f64; INTEGRATORS_MAX] =
                    SVector::<f64, INTEGRATORS_MAX>::from_vec(unit(INTEGRATORS_MAX, m)).into();
                let (input, direct) = column(&vec![0.0; size], &y);
                let x = full.clone().lu().solve(&input.map(|b| Complex::new(b, 0.0))).unwrap();
                let expected = (0..size).fold(Complex::new(direct, 0.0), |sum, i| sum + x[i] * states[i].1);
                let off = (response - expected).modulus();
                assert!(off < 1e-11 * (1.0 + expected.modulus()), "{size} {angle} {m}: {response} {expected}");
            }
        }
    }
}

#[test]
fn a_column_with_a_small_diagonal_is_solved_as_well() {
    // z - A has zeros on its diagonal at z = i when A is a rotation by a right angle, twice as long.
    let system = Compensator::from_tick(2, |x, y| {
        let next = [-2.0 * x[1] + y[0], 2.0 * x[0]];
        x.copy_from_slice(&next);
        next[0]
    });
    let z = Complex::new(0.0, 1.0);
    // w = z x_1 with x_1 = z y / (z^2 + 4).
    let expected = z * z / (z * z + Complex::new(4.0, 0.0));
    assert!((system.response(z)[0] - expected).modulus() < 1e-15);
}
