use super::*;
use std::cell::RefCell;

#[test]
fn motors_are_stopped_before_anything_is_reported() {
    let acts = RefCell::new(Vec::new());
    StopSequence::new()
        .act(|frames| acts.borrow_mut().push(format!("stop {frames}")), || acts.borrow_mut().push("say".into()));
    assert_eq!(*acts.borrow(), ["stop 10", "say", "stop 200"]);
}

#[test]
fn a_panic_while_reporting_is_not_reported_again() {
    let (acts, ending) = (RefCell::new(Vec::new()), StopSequence::new());
    let stop = |frames| acts.borrow_mut().push(format!("stop {frames}"));
    let reported_again = || panic!("reported again");
    // As on a board: a panic in there comes back to the same acts, and a restart follows them.
    ending.act(stop, || ending.act(stop, reported_again));
    assert_eq!(*acts.borrow(), ["stop 10", "stop 200"]);
}
