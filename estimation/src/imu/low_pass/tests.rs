extern crate std;
use super::*;
use std::f64::consts::TAU;

/// Gain and delay (s) at a frequency, by the filter's answer to a sine and a cosine.
fn response(frequency: f64) -> (f64, f64) {
    let mut filter = LowPass::new(60.0, 100.0, 1000.0);
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
        let (found, _) = response(frequency);
        assert!((found - gain).abs() < 0.005, "{frequency} Hz: {found}, not {gain}");
    }
}

#[test]
fn its_delay_is_what_it_says() {
    let filter = LowPass::new(60.0, 100.0, 1000.0);
    assert!((filter.delay() - 3.706e-3).abs() < 1e-6, "{}", filter.delay());
    let (_, delay) = response(0.5);
    assert!((delay - f64::from(filter.delay())).abs() < 2e-6, "{delay}");
}

#[test]
fn a_settled_value_stays() {
    let mut filter = LowPass::new(60.0, 100.0, 1000.0);
    let value = Vector3::new(1.0, -2.0, 30.0);
    filter.settle(&value);
    for _ in 0..10_000 {
        assert!((filter.take(&value) - value).norm() < 1e-4);
    }
}
