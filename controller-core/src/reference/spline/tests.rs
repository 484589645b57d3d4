use super::*;
use nalgebra::Vector3;

extern crate std;

/// Exact rational solutions of the minimisation (computed with fractions, then rounded): durations, points, and
/// velocity to snap at each inner point.
fn check(durations: &[f64], points: &[f64], expected: &[[f64; 4]], tolerance: f64) {
    let times = durations.iter().scan(0.0, |time, t| {
        *time += t;
        Some(*time)
    });
    let mut knots: std::vec::Vec<Knot> = core::iter::once(0.0)
        .chain(times)
        .zip(points)
        .enumerate()
        .map(|(i, (time, p))| Knot {
            // Twice as slowly, so that each time is a whole number of microseconds.
            time_us: (time * 2e6) as u64,
            position: Vector3::new(*p, 0.0, -2.0 * p),
            heading: i as f64,
            derivatives: REST,
        })
        .collect();
    let mut stages = [Stage::EMPTY; 16];
    solve(&mut knots, &mut stages);
    let derivatives: std::vec::Vec<_> = knots[1..knots.len() - 1]
        .iter()
        .map(|knot| {
            [2.0, 4.0, 8.0, 16.0]
                .into_iter()
                .zip(knot.derivatives)
                .map(|(slower, d)| d * slower)
                .collect::<std::vec::Vec<_>>()
        })
        .collect();
    assert_eq!(derivatives.len(), expected.len());
    for order in 0..4 {
        let scale = expected.iter().fold(0.0_f64, |scale, e| scale.max(e[order].abs()));
        for (found, expected) in derivatives.iter().zip(expected) {
            let error = (found[order].x - expected[order]).abs() / scale;
            assert!(error < tolerance, "order {order}: {} instead of {}", found[order].x, expected[order]);
            assert_eq!(found[order].y, 0.0);
            assert!((found[order].z + 2.0 * expected[order]).abs() / scale < 2.0 * tolerance);
        }
    }
}

#[test]
fn points_are_passed_as_the_exact_minimiser_passes_them() {
    let expected = [
        [3.370_173_374_863_138, 5.965_787_811_781_71, -6.410_942_554_137_887, -49.081_832_530_558_62],
        [-3.038_009_670_070_546, 3.620_184_111_189_116_6, 13.443_796_469_652_288, -44.750_972_712_077_31],
    ];
    check(&[1.0, 2.0, 1.0], &[0.0, 1.0, 3.0, 2.0], &expected, 1e-13);
}

#[test]
fn a_segment_a_thousand_times_shorter_than_its_neighbour_costs_little_accuracy() {
    let expected = [
        [0.499_675_896_762_667_6, 0.083_447_684_810_563_68, -0.182_935_425_086_756_4, -0.169_587_728_104_190_1],
        [0.500_322_235_593_128, 0.082_013_334_920_059_36, -0.184_257_048_054_579_24, -0.168_743_825_140_407_53],
    ];
    // Condition number 1000^2.5 = 3e7; times 2^-53 and 100 operations, 4e-7.
    check(&[8.0, 1.0 / 128.0, 4.0], &[0.0, 1.0, 257.0 / 256.0, 2.0], &expected, 4e-7);
}
