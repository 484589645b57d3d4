extern crate std;
use super::*;
use std::f64::consts::TAU;

/// Gain and delay (s) at a frequency, in front of ticks every `period` us, by the answer to a sine and a cosine.
fn response(frequency: f64, period: u64) -> (f64, f64) {
    let mut filter = LowPass::before_ticks(period, 1000.0);
    let (mut sine, mut cosine) = (0.0, 0.0);
    for n in 0..40_000 {
        let phase = TAU * frequency * n as f64 * 1e-3;
        let out = filter.take(&Vector3::new(phase.cos() as f32, 0.0, 0.0)).x;
        // The last 20 s, whole periods.
        if n >= 20_000 {
            cosine += f64::from(out) * phase.cos() / 10_000.0;
            sine += f64::from(out) * phase.sin() / 10_000.0;
        }
    }
    (sine.hypot(cosine), sine.atan2(cosine) / (TAU * frequency))
}

#[test]
fn it_passes_and_stops_what_the_table_says() {
    for (frequency, gain) in
        [(1.0, 1.0), (45.0, 0.707), (70.0, 0.31), (100.0, 0.0), (130.0, 0.15), (200.0, 0.275), (400.0, 0.34)]
    {
        let (found, _) = response(frequency, 10_000);
        assert!((found - gain).abs() < 0.005, "{frequency} Hz: {found}, not {gain}");
    }
}

#[test]
fn its_delay_follows_from_the_rate_of_the_ticks_and_is_what_it_says() {
    for (period, expected) in [
        (20_000, 3.706e-3),
        (10_000, 3.706e-3),
        (5_000, 1.786e-3),
        (4_000, 1.786e-3),
        (2_000, 1.786e-3),
        (1_000, 1.786e-3),
    ] {
        let said = LowPass::before_ticks(period, 1000.0).delay();
        assert!((said - expected).abs() < 1e-6, "{period} us: {said}");
        let (_, delay) = response(0.5, period);
        assert!((delay - f64::from(said)).abs() < 2e-6, "{period} us: {delay}");
    }
}

#[test]
fn a_vibration_that_ticks_would_take_for_a_constant_rate_is_stopped() {
    // 50 Hz see 100 Hz as they see 50 Hz, and rotors vibrate at no less than 70 Hz. Beyond half of 1 kHz nothing can be
    // seen, and what is just below it is hardly left.
    for (period, stopped) in [(20_000, 100.0), (12_500, 80.0), (10_000, 100.0), (5_000, 200.0), (4_000, 250.0)] {
        let (gain, _) = response(stopped, period);
        assert!(gain < 1e-4, "{period} us: {gain} of {stopped} Hz");
    }
    for period in [2_000, 1_000] {
        let (gain, _) = response(450.0, period);
        assert!(gain < 0.01, "{period} us: {gain}");
    }
}

#[test]
fn samples_slower_than_ticks_have_a_filter_all_the_same() {
    let filter = LowPass::before_ticks(1_000, 800.0);
    assert!((0.0017..0.0018).contains(&filter.delay()), "{}", filter.delay());
}

#[test]
fn a_settled_value_stays() {
    let mut filter = LowPass::before_ticks(10_000, 1000.0);
    let value = Vector3::new(1.0, -2.0, 30.0);
    filter.settle(&value);
    for _ in 0..10_000 {
        assert!((filter.take(&value) - value).norm() < 1e-4);
    }
}
