use super::*;

const NOBODY: [bool; MOTOR_COUNT] = [false; MOTOR_COUNT];

#[test]
fn stopped_motors_are_asked_once_a_second_ten_times_in_a_row() {
    let mut request = Request::default();
    let asked: Vec<bool> = (0..3 * INTERVAL_FRAMES).map(|_| request.next(true) != NOBODY).collect();
    let begins = (1..asked.len()).filter(|&frame| asked[frame] && !asked[frame - 1]).count();
    assert_eq!((begins, asked.iter().filter(|asked| **asked).count()), (3, 30));
    assert!(!asked[0] && asked[usize::from(INTERVAL_FRAMES) - 2]);
}

#[test]
fn a_motor_that_turns_is_never_asked_and_ends_the_row() {
    let mut request = Request::default();
    for _ in 0..INTERVAL_FRAMES - 2 {
        request.next(true);
    }
    assert_eq!(request.next(false), NOBODY);
    for _ in 0..INTERVAL_FRAMES - REQUEST_FRAMES - 1 {
        assert_eq!(request.next(true), NOBODY);
    }
    assert_eq!(request.next(true), [true; MOTOR_COUNT]);
}

#[test]
fn who_has_answered_at_length_is_asked_no_more() {
    let mut request = Request::default();
    request.note(&[Some(Answer::Temperature(20)), Some(Answer::Period(900)), None, Some(Answer::AtRest)]);
    for _ in 0..INTERVAL_FRAMES - 2 {
        request.next(true);
    }
    assert_eq!(request.next(true), [false, true, true, true]);
}
