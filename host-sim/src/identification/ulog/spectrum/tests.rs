use super::*;
use crate::identification::ulog::writer::{Topic, Writer};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::recorder::gyro::{self, BLOCK_BYTES, GyroLog};
use nalgebra::Vector3;

/// A log of the firmware's of `count` samples, so many us apart; where `gap` says, ten are missing.
fn log(count: u64, period: u64, gap: Option<u64>, rate: impl Fn(f64) -> [f64; 3]) -> Ulog {
    let waiting = GyroLog::<NoopRawMutex>::new();
    waiting.attach(Box::leak(vec![[0; BLOCK_BYTES]; 4].into_boxed_slice()));
    let (name, fields) = gyro::FORMAT.split_once(':').unwrap();
    let mut file = Writer::new(0, &[Topic { name, fields }], &[], &[]);
    for n in 0..count {
        let time = (n + gap.filter(|gap| n >= *gap).map_or(0, |_| 10)) * period;
        waiting.put(time, &Vector3::from(rate(time as f64 * 1e-6)).map(|rate| rate as f32));
        while let Some(block) = waiting.take() {
            file.record(0, u64::from_le_bytes(*block.first_chunk().unwrap()), &block[8..]);
        }
    }
    Ulog::read(&file.finish(), &[GYRO_TOPIC]).unwrap()
}

/// A slow turn, and vibrations of 0.5 rad/s at 97 Hz about x and of 0.2 rad/s at 194 Hz about z.
fn shaken(time: f64) -> [f64; 3] {
    [2.0 + 0.5 * (TAU * 97.0 * time).sin(), 0.3, 0.2 * (TAU * 194.0 * time).cos()]
}

#[test]
fn vibrations_are_found_with_their_frequencies_and_amplitudes() {
    for (period, gap) in [(1_000, None), (1_000, Some(2_500)), (625, None)] {
        let spectrum = Spectrum::of(&log(8_000, period, gap, shaken)).unwrap();
        let [first, second] = spectrum.peaks()[..] else { panic!("{}", spectrum.told()) };
        for (place, axis, frequency, amplitude) in [(first, 0, 97.0, 0.5), (second, 2, 194.0, 0.2)] {
            assert!((place as f64 * spectrum.step - frequency).abs() < spectrum.step, "{place}, not {frequency} Hz");
            let found = spectrum.amplitudes[axis][place];
            assert!((0.85..1.01).contains(&(found / amplitude)), "{found}, not {amplitude} rad/s");
        }
        // What does not change is no vibration, and what one axis feels no other does.
        assert!(spectrum.amplitudes[1].iter().all(|amplitude| *amplitude < 1e-3));
        assert!((spectrum.seconds - 8_000.0 * period as f64 * 1e-6).abs() < 0.1, "{}", spectrum.seconds);
        let named = format!("{:.1} Hz  {:.3} 0.000 0.000", first as f64 * spectrum.step, spectrum.amplitudes[0][first]);
        assert_eq!(spectrum.told().lines().nth(1).map(str::trim), Some(&named[..]));
        assert!(spectrum.svg().contains("97 Hz") || spectrum.svg().contains("98 Hz"), "{}", spectrum.told());
    }
}

#[test]
fn what_has_no_spectrum_is_refused_in_words() {
    let brief = Spectrum::of(&log(400, 1_000, None, shaken)).unwrap_err();
    assert_eq!(brief, "sensor_gyro_fifo: nowhere 512 samples without a gap");
    let none = Spectrum::of(&log(0, 1_000, None, shaken)).unwrap_err();
    assert_eq!(none, "has no sensor_gyro_fifo: was LOG_GYRO 1 when the vehicle booted");
}
