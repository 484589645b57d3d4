//! The saturation that feedback passes.

use super::Random;
use crate::extended::saturation::Saturation;

#[test]
fn a_saturation_is_monotone_shorter_than_its_level_and_never_steeper_than_its_gain() {
    let mut random = Random(1);
    for _ in 0..100_000 {
        let (a, b) = (random.vector(9.0).xy(), random.vector(9.0).xy());
        let saturation = Saturation::new(1.5, 2.0);
        let (s, t) = (a * saturation.factor(a.norm_squared()), b * saturation.factor(b.norm_squared()));
        assert!(
            (s - t).dot(&(a - b)) >= 0.0 && s.norm() < 2.0 && (s - t).norm() <= 1.5 * (a - b).norm() * (1.0 + 1e-5)
        );
    }
}
