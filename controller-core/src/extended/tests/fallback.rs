//! The fallback.

use super::Random;
use super::position::{at, force};
use crate::attitude_reference::DesiredAttitude;
use crate::extended::defaults::NOTHING_GIVEN;
use crate::extended::direction_limiter::DirectionLimiter;
use crate::extended::fallback::{
    FIRST_STAY_S, Fallback, NEAR_DISTANCE_M, PROGRESS_STEP_MAX, PROGRESS_WINDOW_S, Slowed, slowed,
};
use crate::extended::position::{FeedbackLimits, Filters, PositionLaw};
use crate::extended::tests::example::{Craft, greatest_accelerations};
use crate::heading::Heading;
use crate::reference::Trajectory;
use crate::reference::hover::Hover;
use nalgebra::Vector3;

const PERIOD: f32 = 0.01;

/// Ticks of `seconds` with the errors that `error` has at a time, m; how often the law was slowed.
fn flown(fallback: &mut Fallback, seconds: f32, mut error: impl FnMut(f32) -> f32) -> u32 {
    let mut slowed = 0;
    for tick in 0..(seconds / PERIOD) as u32 {
        let position = Vector3::new(0.0, error(tick as f32 * PERIOD), 0.0);
        slowed += u32::from(fallback.observe(&position, &Vector3::zeros(), PERIOD));
    }
    slowed
}

#[test]
fn a_flight_that_stays_away_without_progress_is_slowed_after_two_windows() {
    let mut fallback = Fallback::FRESH;
    let limit_cycle = |time: f32| 3.0 + time.sin();
    assert_eq!(flown(&mut fallback, 1.99 * PROGRESS_WINDOW_S, limit_cycle), 0);
    assert_eq!(flown(&mut fallback, 0.02 * PROGRESS_WINDOW_S, limit_cycle), 1);
    assert!(fallback.is_slow() && fallback.times() == 1);
}

#[test]
fn neither_noise_and_gusts_nor_a_long_way_slow_a_flight() {
    let mut fallback = Fallback::FRESH;
    let mut random = Random(70);
    // Near now and then.
    assert_eq!(
        flown(&mut fallback, 40.0 * PROGRESS_WINDOW_S, |time| (1.5 * (0.3 * time).sin()).abs() + 0.1 * random.signed()),
        0
    );
    // A kilometre at the slowest approach that counts, then at a tenth of what is left.
    let slowest = 1.05 * PROGRESS_STEP_MAX / PROGRESS_WINDOW_S;
    assert_eq!(flown(&mut fallback, 1_000.0, |time| 1_000.0 - slowest * time), 0);
    let rate = 1.05 * (1.0 / 0.9_f32).ln() / PROGRESS_WINDOW_S;
    assert_eq!(flown(&mut fallback, 800.0, |time| 50.0 * (-rate * time).exp()), 0);
    assert_eq!(fallback.times(), 0);
}

#[test]
fn speed_counts_as_distance_and_a_fall_that_is_braked_as_progress() {
    let mut fallback = Fallback::FRESH;
    let (still, fast) = (Vector3::zeros(), Vector3::new(2.0, 0.0, 0.0));
    let slowed = (0..5_000).any(|_| fallback.observe(&still, &fast, PERIOD));
    assert!(slowed, "in orbit about its target it is not near");
    let mut fallback = Fallback::FRESH;
    let (mut height, mut speed, mut deepest) = (0.0_f32, 0.0, 0.0_f32);
    let slowed = (0..60_000).any(|tick| {
        // It falls, brakes, and climbs back slowly.
        speed += PERIOD
            * if tick < 1_500 {
                -9.81
            } else if speed < 3.0 {
                2.0
            } else {
                0.0
            };
        height += PERIOD * speed;
        deepest = height.min(deepest);
        fallback.observe(&Vector3::new(0.0, 0.0, height), &Vector3::new(0.0, 0.0, speed), PERIOD)
    });
    assert!(!slowed && deepest < -4_000.0 && height > deepest + 1_000.0, "{deepest} {height}");
}

#[test]
fn errors_that_take_turns_in_falling_are_no_progress_for_long() {
    let mut fallback = Fallback::FRESH;
    let slowed = (0..60_000).any(|tick| {
        let turn = (tick as f32 * PERIOD / PROGRESS_WINDOW_S) as u32 % 2;
        let [far, fast] = if turn == 0 { [4.0, 1.0] } else { [3.55, 2.0] };
        fallback.observe(&Vector3::new(far, 0.0, 0.0), &Vector3::new(fast, 0.0, 0.0), PERIOD)
    });
    assert!(slowed);
}

#[test]
fn the_slowed_law_stays_its_time_and_until_it_is_near_and_each_time_twice_as_long() {
    let mut fallback = Fallback::FRESH;
    for (time, stay) in [FIRST_STAY_S, 2.0 * FIRST_STAY_S, 4.0 * FIRST_STAY_S].into_iter().enumerate() {
        let mut waited = 0.0;
        while !fallback.is_slow() {
            flown(&mut fallback, PERIOD * 1.5, |_| 3.0);
            waited += PERIOD;
            assert!(waited < 2.1 * PROGRESS_WINDOW_S);
        }
        assert_eq!(fallback.times() as usize, time + 1);
        flown(&mut fallback, 10.0 * stay, |_| 3.0);
        assert!(fallback.is_slow(), "it goes on while it is away");
        fallback.observe(&Vector3::zeros(), &Vector3::zeros(), PERIOD);
        assert!(!fallback.is_slow());
    }
    // Near at once it still stays.
    flown(&mut fallback, 2.1 * PROGRESS_WINDOW_S, |_| 3.0);
    assert!(fallback.is_slow());
    flown(&mut fallback, 7.8 * FIRST_STAY_S - 0.1 * PROGRESS_WINDOW_S, |_| 0.9 * NEAR_DISTANCE_M);
    assert!(fallback.is_slow());
    flown(&mut fallback, 0.3 * FIRST_STAY_S, |_| 0.9 * NEAR_DISTANCE_M);
    assert!(!fallback.is_slow());
}

#[test]
fn a_reference_that_jumps_begins_a_new_window() {
    let mut fallback = Fallback::FRESH;
    // Each jump is well within a window, and none leads nearer.
    for jump in 0..40_u32 {
        let away = 10.0 + 10.0 * (jump % 2) as f32;
        assert_eq!(flown(&mut fallback, 0.9 * PROGRESS_WINDOW_S, |_| away), 0);
        assert_eq!(flown(&mut fallback, 0.9 * PROGRESS_WINDOW_S, |_| 1.0), 0);
    }
}

/// The worst feedback that M_s allows: any errors, jumping, of any size, under a constant force.
#[test]
fn the_slowed_law_is_never_limited() {
    let mut random = Random(71);
    let origin = Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0);
    for _ in 0..200 {
        let craft = Craft::random(&mut random);
        let p = craft.constants(&NOTHING_GIVEN);
        let (gravity, h) = (craft.vehicle.gravity, craft.period);
        let law = slowed(&p, gravity);
        let position = PositionLaw::new(&law, gravity, h).unwrap();
        let limit = DirectionLimiter::new(&p, p.turn_reserve, h);
        let level = Slowed::<f64>::new(&p, gravity).level as f32;
        let [max, _] = greatest_accelerations(&craft, &p);
        // One that thrust, envelope and cone hold with M_s beside it.
        let mut d = force(&mut random, &p);
        let holds = |d: &Vector3<f32>| {
            let (across, lift) = (d.xy().norm() + level, gravity - d.z - level);
            let steep = across > 0.95 * lift * p.tilt_max.tan() || across > p.a_across;
            !steep && (Vector3::z() * gravity - d).norm() + 1.5 * level <= 0.98 * max
        };
        while !holds(&d) {
            d *= 0.9;
        }
        let mut filter = Filters::at(-d);
        let mut state = at(Vector3::zeros(), Vector3::zeros());
        for tick in 0..2_000 {
            if random.below(20) == 0 {
                state = at(random.vector(1e3), random.vector(1e3));
            }
            let feedback = position.feedback(&state, &origin, &filter, &d, max, &FeedbackLimits::each(level));
            let wanted = (feedback.drive - feedback.rate) * position.k_f();
            let c = filter.command;
            let desired = DesiredAttitude::new(&Vector3::new(c.x, c.y, c.z + gravity), &Heading::FORWARD);
            let (turn, up) = (desired.direction_motion(&feedback.rate, &wanted), desired.up());
            let q = limit.limited(&turn, &up);
            assert_eq!(q, turn.acceleration, "{craft:?} {d} tick {tick}");
            let change = limit.change(&turn, &q, &up, max, [c.z, feedback.rate.z, wanted.z]);
            assert_eq!(change, None, "{craft:?} {d} tick {tick}");
            filter = position.advance(&filter, &feedback.smoothed, &feedback.drive, f32::MAX);
        }
    }
}

#[test]
fn the_slowed_law_keeps_the_form_of_the_law() {
    let craft = Craft::example();
    let p = craft.constants(&NOTHING_GIVEN);
    let (by, slow) = (Slowed::<f64>::new(&p, 9.81).factor as f32, slowed(&p, 9.81));
    assert!(by < 0.5, "{by}");
    for (found, own, power) in [
        (slow.k_f, p.k_f, 1),
        (slow.k_s, p.k_s, 1),
        (slow.k_d, p.k_d, 1),
        (slow.k_v_across, p.k_v_across, 1),
        (slow.k_p_vertical, p.k_p_vertical, 2),
    ] {
        assert!((found / (by.powi(power) * own) - 1.0).abs() < 1e-5);
    }
    assert_eq!((slow.k_tilt, slow.m_tilt, slow.c_1), (p.k_tilt, p.m_tilt, p.c_1));
}
