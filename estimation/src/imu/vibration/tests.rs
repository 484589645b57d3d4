use super::*;

const RANGE_M_PER_S2: f32 = 235.36;
const SAMPLE_US: u64 = 1_000;

/// Two seconds of a vibration along z beside gravity.
fn shaken(amplitude: f32, frequency_hz: f32) -> VibrationReport {
    let mut vibration = Vibration::new(RANGE_M_PER_S2);
    for sample in 0..4_000 {
        let phase = TAU * frequency_hz * sample as f32 * 1e-3;
        vibration.take(&Vector3::new(0.0, 0.0, 9.81 + amplitude * phase.sin()), SAMPLE_US);
    }
    vibration.report()
}

#[test]
fn the_level_of_a_fast_vibration_is_its_root_mean_square() {
    for (amplitude, frequency_hz) in [(10.0, 80.0), (30.0, 123.0), (5.0, 211.0)] {
        let VibrationReport { level, clipped } = shaken(amplitude, frequency_hz);
        let expected = amplitude / 2.0f32.sqrt();
        assert!((level.z / expected - 1.0).abs() < 0.05, "{frequency_hz} Hz: {level:?} of {expected}");
        assert_eq!((level.x, level.y, clipped), (0.0, 0.0, 0));
    }
}

#[test]
fn gravity_and_slow_motion_are_no_vibration() {
    assert!(shaken(0.0, 1.0).level.z < 1e-3);
    assert!(shaken(2.0, 0.2).level.z < 0.1);
}

#[test]
fn samples_at_full_scale_are_counted_and_those_that_are_no_numbers_left_out() {
    let mut vibration = Vibration::new(RANGE_M_PER_S2);
    for force in [9.81, 234.0, -235.0, 200.0, f32::NAN, f32::INFINITY] {
        vibration.take(&Vector3::new(0.0, force, 0.0), SAMPLE_US);
    }
    let report = vibration.report();
    assert_eq!(report.clipped, 2);
    assert!(report.level.iter().all(|level| level.is_finite()));
}

#[test]
fn a_gap_between_samples_does_not_throw_it_off() {
    let mut vibration = Vibration::new(RANGE_M_PER_S2);
    vibration.take(&Vector3::new(0.0, 0.0, 9.81), SAMPLE_US);
    vibration.take(&Vector3::new(0.0, 0.0, 9.81), u64::MAX);
    assert!(vibration.report().level.norm() < 1e-3);
}
