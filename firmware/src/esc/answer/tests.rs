use super::*;

#[test]
fn every_answer_that_is_read_is_written_as_it_was() {
    let mut read = 0;
    for bits in 0..1 << 12 {
        let Some(answer) = Answer::from_bits(bits) else {
            assert_eq!(bits, 0);
            continue;
        };
        assert_eq!(answer.to_bits(), bits, "{answer:?}");
        read += 1;
    }
    assert_eq!(read, 4095);
}

#[test]
fn periods_lose_less_than_a_256th() {
    for period in 1..65_408_u32 {
        let Some(Answer::Period(read)) = Answer::from_bits(Answer::Period(period).to_bits()) else {
            panic!("{period} us is no period any more");
        };
        assert!(read <= period && (period - read) * 256 <= period, "{period} {read}");
    }
    assert_eq!(Answer::Period(65_535).to_bits(), AT_REST);
    assert_eq!(Answer::Period(u32::MAX).to_bits(), AT_REST);
}

#[test]
fn answers_are_read_as_published() {
    let bits = |text: &str| u16::from_str_radix(&text.replace(' ', ""), 2).unwrap();
    // The table of the EDT specification, bird-sanctuary/extended-dshot-telemetry, README.md, commit 0c163f82.
    for (text, answer) in [
        ("000 0 0000 1000", Answer::Period(8)),
        ("000 1 0000 0000", Answer::Period(256)),
        ("000 1 1111 1111", Answer::Period(511)),
        ("001 1 0000 0001", Answer::Period(514)),
        ("010 1 1111 1111", Answer::Period(2044)),
        ("011 1 0000 0000", Answer::Period(2048)),
        ("100 1 1111 1111", Answer::Period(8176)),
        ("101 1 0000 0010", Answer::Period(8256)),
        ("110 1 0000 0001", Answer::Period(16448)),
        ("111 1 0000 0000", Answer::Period(32768)),
        ("001 0 0001 1001", Answer::Temperature(25)),
        ("010 0 1111 1111", Answer::Voltage(63.75)),
        ("011 0 0001 0000", Answer::Current(16)),
        ("100 0 0000 0111", Answer::Debug(0, 7)),
        ("101 0 0000 0111", Answer::Debug(1, 7)),
        ("110 0 0000 1111", Answer::Stress(15)),
        ("111 0 0100 0000", Answer::Status(Answer::DESYNCHRONISED)),
    ] {
        assert_eq!(Answer::from_bits(bits(text)), Some(answer), "{text}");
    }
    // AM32, Src/dshot.c, commit 011a93c4: a motor that does not run is a turn of 65,535 us.
    assert_eq!(Answer::from_bits(7 << 9 | 65_535_u32.wrapping_shr(7) as u16), Some(Answer::AtRest));
}

#[test]
fn speeds_are_the_motors() {
    // 1000 us an electrical turn are 60,000 a minute, and of 14 poles 60,000 / 7 mechanical ones.
    let speed = Answer::Period(1000).speed(14.0).unwrap();
    assert!((speed - 60_000.0 / 7.0 * core::f32::consts::TAU / 60.0).abs() < 1e-2, "{speed}");
    assert_eq!(Answer::AtRest.speed(14.0), Some(0.0));
    assert_eq!(Answer::Current(3).speed(14.0), None);
}

#[test]
fn a_motors_speed_comes_back_within_a_percent() {
    for poles in [2.0, 12.0, 14.0, 36.0] {
        for step in 30..=300 {
            let speed = 10.0 * step as f32;
            let read = Answer::from_bits(Answer::of_speed(speed, poles).to_bits()).unwrap().speed(poles).unwrap();
            // The period is in whole us as well.
            let bound = 1.0 / 256.0 + speed * poles / (4e6 * core::f32::consts::PI);
            assert!((0.0..=speed * 1.02 * bound).contains(&(read - speed)), "{speed} rad/s, {poles} poles: {read}");
        }
    }
    for speed in [0.0, -3.0, 1e-3, f32::NAN] {
        assert_eq!(Answer::of_speed(speed, 14.0), Answer::AtRest, "{speed}");
    }
    assert_eq!(Answer::of_speed(f32::INFINITY, 14.0), Answer::AtRest);
    assert_eq!(Answer::of_speed(1e9, 14.0), Answer::Period(1));
}
