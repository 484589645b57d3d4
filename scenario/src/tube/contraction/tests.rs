use super::*;
use crate::Scenario;
use crate::sampled_loop::Axis;

fn matrix<const N: usize>(rows: [[f64; N]; N]) -> DMatrix<f64> {
    DMatrix::from_row_slice(N, N, rows.as_flattened())
}

fn stretch(column: &[f64], swing: &[(usize, f64)]) -> Stretch {
    Stretch { column: DVector::from_column_slice(column), swing: swing.to_vec(), once: false }
}

fn row(entries: &[f64]) -> RowDVector<f64> {
    RowDVector::from_row_slice(entries)
}

#[test]
fn a_sum_is_bounded_from_above_and_nearly_met() {
    // Of 1, 1/2, 1/4 and so on; with a swing of a tenth each.
    let contraction = Contraction::new(&matrix([[0.5]])).unwrap();
    let peaks =
        contraction.peaks(&row(&[1.0]), &[vec![stretch(&[1.0], &[])], vec![stretch(&[1.0], &[(0, 0.1)])]]).unwrap();
    assert!(peaks[0] >= 2.0 && peaks[0] < 2.003, "{peaks:?}");
    assert!(peaks[1] >= 2.2 && peaks[1] < 2.204, "{peaks:?}");

    // A rotation that shrinks and is sheared by a thousand, beside its sum as it is added up.
    let (sin, cos) = 0.7_f64.sin_cos();
    let turning = matrix([[0.9 * cos, -0.9e3 * sin], [0.9e-3 * sin, 0.9 * cos]]);
    let (mut state, mut sum) = (DVector::from_column_slice(&[1.0_f64, 0.0]), 0.0);
    for _ in 0..1000 {
        sum += state[0].abs();
        state = &turning * state;
    }
    let contraction = Contraction::new(&turning).unwrap();
    let peaks = contraction.peaks(&row(&[1.0, 0.0]), &[vec![stretch(&[1.0, 0.0], &[])]]).unwrap();
    assert!(peaks[0] >= sum && peaks[0] < 1.003 * sum, "{peaks:?}, {sum}");
}

#[test]
fn what_is_seen_once_counts_once() {
    let contraction = Contraction::new(&matrix([[0.5]])).unwrap();
    let once = Stretch { once: true, ..stretch(&[3.0], &[]) };
    let peaks = contraction.peaks(&row(&[1.0]), &[vec![once, stretch(&[1.0], &[])]]).unwrap();
    assert!(peaks[0] >= 5.0 && peaks[0] < 5.006, "{peaks:?}");
}

#[test]
fn what_does_not_settle_has_no_coordinates() {
    assert!(Contraction::new(&matrix([[1.0]])).is_none());
    assert!(Contraction::new(&matrix([[0.9, 1.0], [0.0, 1.001]])).is_none());
}

/// The check does not trust the search: coordinates of another matrix, a rho that is too small, and an inverse that is
/// none are refused.
#[test]
fn wrong_coordinates_are_refused() {
    let slow = matrix([[0.5, 3.0], [0.0, 0.6]]);
    let to = coordinates(&(&slow / 0.9)).unwrap();
    let from = to.clone().try_inverse().unwrap();
    let moved = &to * &slow * &from;
    let check = |matrix: &DMatrix<f64>, from: &DMatrix<f64>, rho| {
        Contraction::checked(&slow, to.clone(), from.clone(), matrix.clone(), rho).is_some()
    };
    assert!(check(&moved, &from, 0.9));
    assert!(!check(&moved, &from, 0.59), "below the spectral radius");
    assert!(!check(&moved, &(&from * 2.0), 0.9), "no inverse");
    assert!(!check(&(&moved * 0.5), &from, 0.9), "of another matrix");
    let identity = DMatrix::identity(2, 2);
    assert!(Contraction::checked(&slow, identity.clone(), identity, slow.clone(), 0.9).is_none(), "longer than one");
}

/// With its sign turned round, position feedback drives the vehicle away.
#[test]
fn a_loop_whose_sign_is_turned_has_no_bounds() {
    let scenario =
        Scenario::parse(include_str!("../../../../vehicles/published/racer-pybullet.toml"), "racer").unwrap();
    let loops = scenario.loops().unwrap();
    for axis in [Axis::LateralX, Axis::Vertical] {
        assert!(norms(&loops.disturbed(axis, 1.0, 1.0).balanced()).is_some());
        let turned = loops.with_position_feedback([-1.0, 1.0]);
        assert!(norms(&turned.disturbed(axis, 1.0, 1.0).balanced()).is_none(), "{axis:?}");
    }
}
