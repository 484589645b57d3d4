use super::*;

#[test]
fn sin_cos_turns_is_within_its_stated_error() {
    let mut worst: f64 = 0.0;
    for i in 0..2_000_000_u64 {
        let phase = i.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let (sin, cos) = sin_cos_turns(phase);
        let angle = phase as f64 * (core::f64::consts::TAU / 18_446_744_073_709_551_616.0);
        worst = worst.max((f64::from(sin) - angle.sin()).abs()).max((f64::from(cos) - angle.cos()).abs());
    }
    assert!(worst < 1.2e-7, "worst error {worst:e}");
}

#[test]
fn sin_cos_turns_is_exact_at_quarter_turns() {
    assert_eq!(sin_cos_turns(0), (0.0, 1.0));
    assert_eq!(sin_cos_turns(1 << 62), (1.0, -0.0));
    assert_eq!(sin_cos_turns(1 << 63), (-0.0, -1.0));
    assert_eq!(sin_cos_turns(3 << 62), (-1.0, 0.0));
}

#[test]
fn tanh_is_within_its_stated_error_odd_and_bounded() {
    let mut worst: f64 = 0.0;
    for i in 0..2_000_000 {
        let z = 0.26 * i as f32 / 2_000_000.0;
        let tanh = tanh_of_scaled(z);
        assert!(tanh_of_scaled(-z) == -tanh);
        worst = worst.max((f64::from(tanh) - (f64::from(z) / TANH_SCALE).tanh()).abs());
    }
    assert!(worst < 1.97e-7, "worst error {worst:e}");
    assert_eq!((tanh_of_scaled(f32::MAX), tanh_of_scaled(f32::NEG_INFINITY)), (1.0, -1.0));
    assert!(tanh_of_scaled(f32::NAN).is_nan());
    // Below 5, tanh is 9e-5 from one. Above, every single number.
    let (five, ten) = ((5.0 * TANH_SCALE) as f32, (10.0 * TANH_SCALE) as f32);
    assert!((five.to_bits()..ten.to_bits()).all(|bits| tanh_of_scaled(f32::from_bits(bits)) <= 1.0));
}

#[test]
fn tanh_of_little_has_the_bits_of_the_whole_formula() {
    // Every 61st number from zero to twice as far as the short formula reaches, subnormal ones among them.
    let end = (2.0 * LINEAR_SQUARE_MAX.sqrt()).to_bits();
    for z in (0..end).step_by(61).flat_map(|bits| [f32::from_bits(bits), -f32::from_bits(bits)]) {
        assert_eq!(tanh_of_scaled(z).to_bits(), unsaturated(z).to_bits(), "{z:e}");
        let three = Vector3::new(z, 0.5 * z, -0.25 * z);
        assert_eq!(tanh_of_all_scaled(&three).map(f32::to_bits), three.map(unsaturated).map(f32::to_bits), "{z:e}");
    }
}

#[test]
fn three_at_once_are_the_same_three_numbers() {
    for i in 0..10_000 {
        let z = Vector3::new(i as f32 * 4e-5, i as f32 * -1e-5, 0.19);
        assert_eq!(tanh_of_all_scaled(&z), z.map(tanh_of_scaled));
        assert_eq!(tanh_of_all_scaled(&(z * 0.1)), (z * 0.1).map(tanh_of_scaled));
    }
    let mixed = tanh_of_all_scaled(&Vector3::new(f32::NAN, f32::INFINITY, 0.01));
    assert!(mixed.x.is_nan() && mixed.y == 1.0 && mixed.z == tanh_of_scaled(0.01));
}

#[test]
fn sqrt_is_correctly_rounded() {
    for i in 1..100_000_u32 {
        let x = f32::from_bits(i.wrapping_mul(21_000));
        if x.is_finite() {
            assert_eq!(sqrt(x), f64::from(x).sqrt() as f32);
        }
    }
}

#[test]
fn integers_and_their_whole_parts_convert_in_halves_as_well_as_in_one() {
    let mut worst: f64 = 0.0;
    let mut x = 1_i64;
    for step in 0..2_000_000_i64 {
        x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let integer = x >> (step % 63);
        let (found, exact) = (f64::from(i64_to_f32(integer)), integer as f64);
        worst = worst.max((found - exact).abs() / exact.abs().max(1.0));
        if integer.abs() < 1 << 24 {
            assert_eq!(found, exact);
        }
        if integer.abs() < 1 << 61 {
            let number = integer as f32 / 3.0;
            assert_eq!((f32_to_i64(number), f32_to_i64(-number)), (number as i64, -number as i64), "{number}");
        }
    }
    assert!(worst < 1.2e-7, "{worst:e}");
    assert_eq!((f32_to_i64(f32::NAN), f32_to_i64(0.99), f32_to_i64(-0.99)), (0, 0, 0));
    assert!(f32_to_i64(1e30) >= 1 << 61 && f32_to_i64(-1e30) <= -(1 << 61));
}

#[test]
fn a_nan_is_neither_greater_nor_lesser_and_stays_a_nan() {
    assert_eq!((max_f64(1.0, 2.0), max_f64(2.0, 1.0), min_f64(1.0, 2.0), min_f64(2.0, 1.0)), (2.0, 2.0, 1.0, 1.0));
    for number in [f64::NEG_INFINITY, 0.0, f64::INFINITY] {
        for of_two in [max_f64, min_f64] {
            assert!(of_two(f64::NAN, number).is_nan() && of_two(number, f64::NAN).is_nan());
        }
    }
    assert!(sqrt_of_rounded(f64::NAN).is_nan());
    assert_eq!((sqrt_of_rounded(-1e-17), sqrt_of_rounded(4.0)), (0.0, 2.0));
}
