use super::*;

#[test]
fn at_any_rate_a_word_stands_for_ten_milliseconds_or_more_also_in_a_tick_that_comes_a_little_late() {
    let bench = Bench::Setting(MotorSetting { rotor: 1, setting: Setting::Reversed });
    for (period, word_lasts) in [(20_000, 20_000), (10_000, 10_000), (8_000, 16_000), (2_000, 10_000), (1_000, 10_000)]
    {
        for (begins, word) in [(0, Word::Reversed), (5 * word_lasts, Word::Save)] {
            for (tick, late) in (0..word_lasts / period).flat_map(|tick| [0, 1, period - 1].map(|late| (tick, late))) {
                let output = bench.output(begins + tick * period + late, period);
                assert_eq!(output, Output::Word { rotor: 1, word }, "tick {tick} of {period} us, {late} us late");
            }
            assert_eq!(bench.output(begins + word_lasts, period), Output::Stop, "{period} us");
        }
    }
}
