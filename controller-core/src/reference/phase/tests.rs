use super::*;

#[test]
fn an_angle_just_short_of_a_full_turn_wraps_to_zero() {
    assert_eq!(turns(-1e-20), 0);
    assert_eq!(turns(-0.0), 0);
    assert_eq!(turns(TAU), 0);
    assert_eq!(turns(-TAU / 4.0), 3 << 62);
}

#[test]
fn a_swing_is_the_angle_on_the_circle() {
    let mut worst: f64 = 0.0;
    for i in -1000..=1000 {
        let angle = i as f32 * 0.013;
        let difference = swing(angle).wrapping_sub(turns(f64::from(angle))) as i64;
        worst = worst.max((difference as f64 / UNITS_PER_TURN * TAU).abs());
    }
    // Two roundings of at most 2^-24 each, at 13 rad, and 2^-32 of a turn.
    assert!(worst < 13.0 * 1.2e-7 + 1.5e-9, "{worst:e}");
}
