use super::*;

#[test]
fn a_break_begins_it_anew() {
    let mut debounce = Debounce::default();
    assert!(
        !debounce.holds_for(true, 20, 100) && !debounce.holds_for(true, 20, 119) && debounce.holds_for(true, 20, 120)
    );
    assert!(!debounce.holds_for(false, 0, 121));
    assert!(!debounce.holds_for(true, 20, 130) && debounce.holds_for(true, 20, 150));
    assert!(Debounce::default().holds_for(true, 0, 5));
}
