use super::*;

#[test]
fn what_comes_in_three_frames_over_60_ms_counts() {
    let mut debounced = Debounced::default();
    for (now, counts) in [(0, None), (20_000, None), (59_999, None), (60_000, Some('a'))] {
        debounced.take('a', now);
        assert_eq!(debounced.get(), counts, "{now}");
    }
    // Slow frames: the third.
    let taken = [100_000, 200_000, 300_000].map(|now| debounced.take('b', now));
    assert_eq!((taken, debounced.get()), ([false, false, true], Some('b')));
}

#[test]
fn anything_else_between_begins_it_anew() {
    let mut debounced = Debounced::default();
    for now in (0..100_000).step_by(2_000) {
        let other = if now % 58_000 == 0 { 'b' } else { 'a' };
        debounced.take(other, now);
    }
    assert_eq!(debounced.get(), None);
    for now in (100_000..200_000).step_by(2_000) {
        debounced.take('a', now);
    }
    assert_eq!(debounced.get(), Some('a'));
    // What counts already is not in doubt because of one frame.
    debounced.take('b', 200_000);
    assert_eq!(debounced.get(), Some('a'));
}
