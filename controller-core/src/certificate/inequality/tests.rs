use super::*;

#[test]
fn a_strict_inequality_fails_at_equality_and_on_nan() {
    let equal = Inequality::new("x", "N", 1.0, 1.0);
    assert!(!equal.holds() && equal.or_equal().holds());
    assert!(!Inequality::new("x", "N", f64::NAN, 1.0).or_equal().holds());
}

#[test]
fn the_tightest_has_the_least_margin_and_one_that_fails_has_less_than_none() {
    let all = [(3.0, 4.0), (9.0, 10.0), (1.0, 2.0)]
        .map(|(required, available)| Inequality::new("x", "N", required, available));
    assert_eq!(tightest(&all), Some(all[1]));
    let failing = Inequality::new("x", "N", 1.0, 0.0);
    assert_eq!(tightest([&failing].into_iter().chain(&all)), Some(failing));
}

#[test]
fn the_margin_is_what_is_left_of_the_available() {
    assert!((Inequality::new("x", "N", 3.0, 4.0).margin() - 0.25).abs() < 1e-15);
    assert!(Inequality::new("x", "N", 5.0, 4.0).margin() < 0.0);
}
