use super::*;

/// Every answer that there is.
fn values() -> impl Iterator<Item = u16> {
    0..1 << VALUE_BITS
}

#[test]
fn every_answer_comes_back() {
    for value in values() {
        assert_eq!(decoded(encoded(value)), Some(value), "{value:#05x}");
    }
}

#[test]
fn published_answers_are_read_as_published() {
    // A motor at rest: "test_canonical_zero_rpm_telemetry" of copper-rs, components/bridges/cu_bdshot/src/decode.rs,
    // commit 5fc1c667: these levels, the quintets 01111 01111 01111 11001, the bits FFF0.
    let at_rest = 0b001010010100101010001;
    assert_eq!((at_rest ^ at_rest >> 1) & 0xF_FFFF, 0b01111_01111_01111_11001);
    assert_eq!(decoded(at_rest), Some(0xFFF));
    assert_eq!(encoded(0xFFF), at_rest);
}

/// As AM32 makes its answer, Src/dshot.c, make_dshot_package, commit 011a93c4, written anew from its description: the
/// checksum by a loop, quintets one by one, each level from the one before.
fn answer_of_am32(value: u16) -> u32 {
    let (mut sum, mut rest) = (0, value);
    for _ in 0..3 {
        sum ^= rest;
        rest >>= 4;
    }
    let bits = value << 4 | !sum & 0xF;
    // Its table, in its order.
    let table = [25, 27, 18, 19, 29, 21, 22, 23, 26, 9, 10, 11, 30, 13, 14, 15];
    let mut coded = 0;
    for nibble in [bits >> 12, bits >> 8 & 15, bits >> 4 & 15, bits & 15] {
        coded = coded << 5 | table[usize::from(nibble)];
    }
    // Its timer's output is inverted: its first level is 1, ours 0.
    let mut level = 1;
    let mut levels = level;
    for place in (0..20).rev() {
        level ^= coded >> place & 1;
        levels = levels << 1 | level;
    }
    !levels & 0x1F_FFFF
}

#[test]
fn answers_are_those_that_a_controller_makes() {
    for value in values() {
        assert_eq!(encoded(value), answer_of_am32(value), "{value:#05x}");
    }
}

#[test]
fn a_lost_or_added_edge_is_refused() {
    for value in values() {
        let levels = encoded(value);
        // From some level on everything is upside down.
        for place in 1..LEVEL_COUNT {
            assert_eq!(decoded(levels ^ ((1 << place) - 1)), None, "{value:#05x}, edge {place}");
        }
    }
}

#[test]
fn a_level_that_is_wrong_for_a_bit_hardly_ever_passes() {
    let mut passed = 0;
    for value in values() {
        let levels = encoded(value);
        passed +=
            (0..LEVEL_COUNT).filter(|place| decoded(levels ^ 1 << place).is_some_and(|read| read != value)).count();
    }
    // Of 4096 answers times 21 places. Two quintets change at once, by the same bits: 0 and 9, 4 and D after 8 and 1.
    assert_eq!(passed, 384);
    assert!(passed * 200 < 4096 * LEVEL_COUNT);
}

#[test]
fn levels_that_are_no_answer_are_refused() {
    let mut answers = 0;
    for levels in 0..1 << LEVEL_COUNT {
        answers += usize::from(decoded(levels).is_some());
    }
    assert_eq!(answers, 1 << VALUE_BITS);
    assert_eq!(decoded(u32::MAX), None);
}
