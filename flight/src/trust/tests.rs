use super::*;

const TICK_US: u64 = 10_000;

/// The same verdict on poses for some seconds.
fn judge(trust: &mut Trust, now: &mut u64, pose: Result<Accepted, Rejected>, seconds: f32) {
    for _ in 0..(seconds * 100.0) as u32 {
        *now += TICK_US;
        trust.judge(Some(pose), true, *now);
    }
}

#[test]
fn a_source_that_is_refused_and_found_again_over_and_over_is_given_up() {
    let (mut trust, mut now, mut cycles) = (Trust::default(), 0, 0);
    while !trust.is_given_up() && cycles < 100 {
        judge(&mut trust, &mut now, Ok(Accepted::Fused), 5.0);
        judge(&mut trust, &mut now, Err(Rejected::Position), 0.5);
        judge(&mut trust, &mut now, Ok(Accepted::Refound), 0.01);
        cycles += 1;
    }
    assert!((2..=3).contains(&cycles), "{cycles}");
    // For good.
    judge(&mut trust, &mut now, Ok(Accepted::Fused), 1_000.0);
    assert!(trust.is_given_up());
}

#[test]
fn one_that_is_lost_once_a_minute_and_found_again_is_kept() {
    let (mut trust, mut now) = (Trust::default(), 0);
    for _ in 0..60 {
        judge(&mut trust, &mut now, Ok(Accepted::Fused), 60.0);
        judge(&mut trust, &mut now, Err(Rejected::Position), 0.6);
        judge(&mut trust, &mut now, Ok(Accepted::Refound), 0.01);
    }
    assert!(!trust.is_given_up());
}

#[test]
fn a_few_refused_poses_among_many_do_no_harm_and_every_second_one_does() {
    for (good, refused, given_up) in [(99, 1, false), (1, 1, true)] {
        let (mut trust, mut now) = (Trust::default(), 0);
        for _ in 0..100 {
            judge(&mut trust, &mut now, Ok(Accepted::Fused), good as f32 * 0.0101);
            judge(&mut trust, &mut now, Err(Rejected::Position), refused as f32 * 0.0101);
        }
        if given_up {
            judge(&mut trust, &mut now, Err(Rejected::Position), 2.6);
        }
        assert_eq!(trust.is_given_up(), given_up, "{good} {refused}");
    }
}

#[test]
fn poses_that_come_and_go_are_flown_again_twice_and_by_a_landing_once() {
    for (landing, times) in [(false, 2), (true, 1)] {
        let mut trust = Trust::default();
        let flown = (0..10).take_while(|_| trust.regain(landing));
        assert_eq!(flown.count(), times);
    }
}

#[test]
fn what_is_refused_for_its_time_or_its_quality_is_no_lie() {
    let (mut trust, mut now) = (Trust::default(), 0);
    for why in [Rejected::Quality, Rejected::Repeated, Rejected::TooOld, Rejected::Future, Rejected::NoImu] {
        judge(&mut trust, &mut now, Err(why), 100.0);
    }
    assert!(!trust.is_given_up());
}

#[test]
fn poses_that_imply_an_implausible_gyro_bias_are_given_up() {
    let mut trust = Trust::default();
    (1..=310).for_each(|tick| trust.judge(Some(Ok(Accepted::Fused)), false, tick * TICK_US));
    assert!(trust.is_given_up());
}
