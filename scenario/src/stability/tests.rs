//! Each margin can be lacking, and the right one is named.

use super::*;
use crate::sampled_loop::Margins;

const GOOD_MARGINS: Margins = Margins { gain_up: 1.6, gain_down: 0.6, delay: 2.5e-3, crossover: 50.0 };

fn report(axis: Axis, margins: Option<Margins>) -> LoopReport {
    LoopReport { axis, spectral_radius: if margins.is_some() { 0.9 } else { 1.02 }, margins }
}

fn lack(margins: Margins) -> Option<String> {
    LoopMargin::FLYABLE_MIN.lacking(&report(Axis::Pitch, Some(margins))).map(|lack| lack.to_string())
}

#[test]
fn each_margin_can_be_lacking_and_is_named_with_its_number() {
    assert_eq!(lack(GOOD_MARGINS), None);
    for (margins, words) in [
        (
            Margins { gain_up: 1.4, ..GOOD_MARGINS },
            "pitch: unstable at 1.40 times its gain, must be stable up to 1.50 times",
        ),
        (
            Margins { gain_down: 0.8, ..GOOD_MARGINS },
            "unstable at 0.80 times its gain, must be stable down to 0.67 times",
        ),
        (Margins { delay: 1.9e-3, ..GOOD_MARGINS }, "unstable with 1.9 ms more delay, must bear 2.0 ms"),
    ] {
        assert!(lack(margins).is_some_and(|lack| lack.ends_with(words)), "{margins:?}: {:?}", lack(margins));
    }
}

#[test]
fn the_worst_of_several_is_named() {
    let margins = Margins { gain_up: 1.4, delay: 0.2e-3, ..GOOD_MARGINS };
    assert!(lack(margins).is_some_and(|lack| lack.contains("0.2 ms")));
}

#[test]
fn an_unstable_loop_is_named_before_a_weak_one() {
    let weak = Margins { gain_up: 1.1, ..GOOD_MARGINS };
    let reports = [report(Axis::Roll, Some(weak)), report(Axis::Yaw, None)];
    let lack = LoopMargin::FLYABLE_MIN.first_lacking(&reports).unwrap();
    assert_eq!(lack.axis, Axis::Yaw);
    assert!(lack.to_string().contains("spectral radius 1.0200"), "{lack}");
    assert_eq!(LoopMargin::FLYABLE_MIN.first_lacking(&reports[..1]).map(|lack| lack.axis), Some(Axis::Roll));
    assert_eq!(LoopMargin::FLYABLE_MIN.first_lacking(&[report(Axis::Roll, Some(GOOD_MARGINS))]), None);
}
