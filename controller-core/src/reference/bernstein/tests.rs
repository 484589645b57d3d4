use super::*;

#[test]
fn weights_are_the_binomial_ones_and_add_up_to_one() {
    let mut weights = DEGREE_ZERO;
    for _ in 0..9 {
        raise(&mut weights, 0.75, 0.25);
    }
    let binomials = [1.0, 9.0, 36.0, 84.0, 126.0, 126.0, 84.0, 36.0, 9.0, 1.0];
    for (i, (weight, binomial)) in weights.iter().zip(binomials).enumerate() {
        let exact = binomial * 0.75_f64.powi(9 - i as i32) * 0.25_f64.powi(i as i32);
        assert!((f64::from(*weight) - exact).abs() < 1e-7);
    }
    assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
}

#[test]
fn halves_of_a_curve_are_the_curve() {
    let points = [0.0, 3.0, -2.0, 5.0_f64];
    let at = |points: &[f64; 4], s: f64| {
        let r = 1.0 - s;
        points[0] * r * r * r + 3.0 * points[1] * r * r * s + 3.0 * points[2] * r * s * s + points[3] * s * s * s
    };
    let (left, right) = split(&points);
    for i in 0..=10 {
        let s = f64::from(i) / 10.0;
        assert!((at(&left, s) - at(&points, 0.5 * s)).abs() < 1e-14);
        assert!((at(&right, s) - at(&points, 0.5 + 0.5 * s)).abs() < 1e-14);
    }
}

#[test]
fn a_supremum_is_never_below_the_curve_and_hardly_above() {
    // 4 s (1 - s) peaks at one, off every control point; its hull reaches two.
    let mut supremum = Supremum::new(|x: &f64| x * x);
    supremum.include(&[0.0, 2.0, 0.0]);
    assert!(supremum.bound() >= 1.0 && supremum.bound() < 1.0 + 1e-6, "{}", supremum.bound());
    // A smaller curve changes nothing; a larger one does.
    supremum.include(&[0.0, 0.5, 0.0]);
    assert!(supremum.bound() < 1.0 + 1e-6);
    supremum.include(&[0.0, 0.0, -3.0]);
    assert_eq!(supremum.bound(), 3.0);
}
