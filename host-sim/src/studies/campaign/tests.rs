//! Quantiles.

use super::*;

#[test]
fn a_quantile_is_the_value_at_its_place() {
    let values = [3.0, 1.0, 2.0, f64::NAN, 4.0];
    assert_eq!([0.0, 0.25, 0.5, 0.75].map(|part| quantile(&values, part)), [1.0, 2.0, 3.0, 4.0].map(Some));
    assert!(quantile(&values, 1.0).unwrap().is_nan());
    assert_eq!(quantile(&[], 0.5), None);
}
