use super::*;

const LEVEL_ATTITUDE: Quaternion<f32> = Quaternion::new(1.0, 0.0, 0.0, 0.0);

/// The angle between two attitudes, rad, where it is small.
fn angle(a: &Quaternion<f32>, b: &Quaternion<f64>) -> f64 {
    2.0 * (a.cast::<f64>().conjugate() * b).imag().norm()
}

#[test]
fn a_steady_rotation_is_followed_to_rounding_at_any_step() {
    for step in [500_u64, 10_000, 100_000, 500_000] {
        let omega = Vector3::new(3.0_f32, -2.0, 6.0);
        let mut propagated = PropagatedAttitude::new(LEVEL_ATTITUDE, omega, 0);
        (1..=1_000_000 / step).for_each(|n| propagated.advance(omega, n * step));
        let half = omega.cast::<f64>() * 0.5;
        let exact = Quaternion::from_parts(half.norm().cos(), half * (half.norm().sin() / half.norm()));
        let error = angle(&propagated.attitude(), &exact);
        assert!(error < 1e-5, "{error} rad in steps of {step} us");
    }
}

#[test]
fn a_rate_that_grows_evenly_about_an_axis_leaves_no_error() {
    let mut propagated = PropagatedAttitude::new(LEVEL_ATTITUDE, Vector3::zeros(), 0);
    for n in 1..=100 {
        propagated.advance(Vector3::new(0.05 * n as f32, 0.0, 0.0), n * 10_000);
    }
    // 5 rad/s^2 for 1 s.
    let exact = Quaternion::new(1.25_f64.cos(), 1.25_f64.sin(), 0.0, 0.0);
    let error = angle(&propagated.attitude(), &exact);
    assert!(error < 1e-5, "{error} rad");
}

#[test]
fn time_that_stands_still_or_runs_back_turns_nothing() {
    let mut propagated = PropagatedAttitude::new(LEVEL_ATTITUDE, Vector3::repeat(5.0), 1_000);
    propagated.advance(Vector3::repeat(5.0), 1_000);
    propagated.advance(Vector3::repeat(5.0), 0);
    assert_eq!(propagated.attitude(), LEVEL_ATTITUDE);
}

#[test]
fn even_an_absurd_gap_leaves_a_unit_quaternion() {
    let mut propagated = PropagatedAttitude::new(LEVEL_ATTITUDE, Vector3::repeat(100.0), 0);
    propagated.advance(Vector3::repeat(100.0), u64::MAX);
    assert!((propagated.attitude().norm() - 1.0).abs() < 1e-6);
}
