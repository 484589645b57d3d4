use super::super::gcr;
use super::*;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// A port's samples: the `levels` on `pin`, `late` samples after the first, each of `length` samples; noise elsewhere.
fn sampled(levels: u32, pin: u8, late: f64, length: f64, rng: &mut ChaCha8Rng) -> Vec<u16> {
    let level = |index: usize| {
        let bit = ((index as f64 - late) / length).floor();
        !(0.0..LEVEL_COUNT as f64).contains(&bit) || levels >> (LEVEL_COUNT - 1 - bit as usize) & 1 == 1
    };
    let others = |rng: &mut ChaCha8Rng| rng.random::<u16>() & !(1 << pin);
    (0..SAMPLE_COUNT).map(|index| others(rng) | u16::from(level(index)) << pin).collect()
}

#[test]
fn answers_of_fast_and_slow_clocks_are_read_on_every_pin() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for value in 0..1 << gcr::VALUE_BITS {
        let (pin, late) = (rng.random_range(0..16), rng.random_range(1.0..60.0));
        // A twelfth, less what the place of samples between edges takes of it.
        let length = SAMPLES_PER_BIT as f64 * rng.random_range(0.93..1.07);
        let levels = gcr::encoded(value);
        assert_eq!(super::levels(&sampled(levels, pin, late, length, &mut rng), pin), Some(levels), "{value:#05x}");
    }
}

#[test]
fn silence_and_answers_that_are_cut_off_are_none() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    assert_eq!(levels(&[], 3), None);
    assert_eq!(levels(&[0xFFFF; SAMPLE_COUNT], 3), None);
    assert_eq!(levels(&[0; SAMPLE_COUNT], 3), None);
    let whole = sampled(gcr::encoded(0x1A5), 3, 20.0, 4.0, &mut rng);
    for end in 0..20 + 4 * 20 {
        assert_eq!(levels(whole.get(..end).unwrap(), 3), None, "{end}");
    }
}

#[test]
fn noise_is_refused_and_never_a_panic() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut passed = 0;
    for _ in 0..100_000 {
        // A level changes as often as an answer's at the most, and half as often.
        let mut sample = 0xFFFF;
        let noise: Vec<u16> = (0..SAMPLE_COUNT)
            .map(|_| {
                if rng.random_bool(0.2) {
                    sample = rng.random();
                }
                sample
            })
            .collect();
        passed += usize::from(levels(&noise, rng.random_range(0..=255)).and_then(gcr::decoded).is_some());
    }
    // What a checksum of four bits, and quintets of which half exist, let through.
    assert!(passed < 100, "{passed} of 100,000");
}
