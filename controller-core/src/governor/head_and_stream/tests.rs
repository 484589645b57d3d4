//! Streams of moving points, flown as they are sent where the bounds allow it.

extern crate std;
use super::*;
use crate::governor::tests::{PERIOD, Random, TYPICAL, go_to, governor, run};
use crate::governor::{HeadingSetpoint, Motion, Setpoint};
use crate::heading::Heading;
use nalgebra::Vector3;

/// Where a point is at a time, s, with its velocity and acceleration.
type At<'a> = &'a dyn Fn(f64) -> [Vector3<f64>; 3];

/// Round a circle about (0, 0, 1).
fn circle(rate: f64, radius: f64) -> impl Fn(f64) -> [Vector3<f64>; 3] {
    move |time| {
        let (sin, cos) = (rate * time).sin_cos();
        let (out, along) = (Vector3::new(cos, sin, 0.0) * radius, Vector3::new(-sin, cos, 0.0) * radius);
        [out + Vector3::z(), along * rate, -out * (rate * rate)]
    }
}

/// Along (1, 0, 0) once while along `across` twice.
fn eight(rate: f64, size: f64, across: Vector3<f64>) -> impl Fn(f64) -> [Vector3<f64>; 3] {
    move |time| {
        let ((sin, cos), (sin2, cos2)) = ((rate * time).sin_cos(), (2.0 * rate * time).sin_cos());
        let (along, across) = (Vector3::x() * size, across * (0.5 * size));
        let bend = along * sin + across * (4.0 * sin2);
        [along * sin + across * sin2, (along * cos + across * (2.0 * cos2)) * rate, -bend * (rate * rate)]
    }
}

/// As setpoints have it.
fn sent(at: At<'_>, time: f64) -> Setpoint {
    let [position, velocity, acceleration] = at(time).map(|vector| vector.map(|component| component as f32));
    Setpoint {
        motion: Motion::PositionVelocityAcceleration { position, velocity, acceleration },
        turn: HeadingSetpoint::Keep,
    }
}

/// Sends it every so many ticks for `duration`, s; how far off it is at worst after `settled`, s.
fn follow(governor: &mut Governor, at: At<'_>, every: u32, settled: f64, duration: f64) -> f64 {
    let mut worst: f64 = 0.0;
    for tick in 0..(duration / f64::from(PERIOD)) as u32 {
        let time = f64::from(tick) * f64::from(PERIOD);
        if tick.is_multiple_of(every) {
            governor.accept(&sent(at, time)).unwrap();
        }
        let reference = governor.tick();
        assert!(TYPICAL.contain(&reference, 0.0), "{reference:?}");
        if time > settled {
            let [there, ..] = at(time + f64::from(PERIOD));
            worst = worst.max((reference.position.map(f64::from) - there).norm());
        }
    }
    worst
}

#[test]
fn a_circle_that_takes_nearly_all_of_the_bounds_is_flown_as_it_is_sent() {
    // 0.987 of the acceleration, 0.969 of the jerk; 100, 20 and 10 times a second, in single precision.
    for every in [1, 5, 10] {
        let worst = follow(governor(), &circle(core::f64::consts::FRAC_PI_2, 1.0), every, 25.0, 60.0);
        assert!(worst < 1e-4, "every {every}: {worst} m off");
    }
}

#[test]
fn eights_and_lines_to_and_fro_are_flown_as_they_are_sent() {
    let (level, none) = (Vector3::new(0.0, 1.0, 0.0), Vector3::zeros());
    for (rate, size, across, every) in
        [(0.6, 1.0, level, 1), (0.6, 1.0, level, 5), (0.4, 2.0, none, 5), (0.8, 2.0, none, 1)]
    {
        let worst = follow(governor(), &eight(rate, size, across), every, 30.0, 90.0);
        assert!(worst < 0.01, "{size} m at {rate} rad/s, every {every}: {worst} m off");
    }
}

#[test]
fn a_circle_beyond_the_bounds_comes_out_smaller_and_round() {
    let governor = governor();
    // 1.09 of the acceleration.
    let at = circle(core::f64::consts::FRAC_PI_2, 1.1);
    follow(governor, &at, 2, 0.0, 30.0);
    let (mut min, mut max) = (f32::MAX, 0.0_f32);
    for tick in 3_000..4_000 {
        governor.accept(&sent(&at, f64::from(tick) * f64::from(PERIOD))).unwrap();
        let radius = governor.tick().position.xy().norm();
        (min, max) = (min.min(radius), max.max(radius));
    }
    assert!(min > 0.6 && max < 1.0 && max - min < 0.005, "{min} to {max} m");
}

#[test]
fn a_circle_too_fast_for_the_speed_bound_never_takes_the_reference_beyond_it() {
    // 8 m/s, with little acceleration; `follow` looks at the speed.
    follow(governor(), &circle(0.25, 32.0), 5, 0.0, 90.0);
}

#[test]
fn a_circle_that_ceases_or_gives_way_to_another_setpoint_ends_exactly_where_it_should() {
    let at = circle(core::f64::consts::FRAC_PI_2, 1.0);
    let direct = || {
        let governor = governor();
        follow(governor, &at, 5, 0.0, 20.0);
        assert!(!governor.follower.is_averaged());
        governor
    };
    let [last, ..] = at(1_995.0 * f64::from(PERIOD));
    let governor = direct();
    assert_eq!(run(governor).1.position, last.map(|component| component as f32));
    assert!(governor.follower.is_averaged());
    let governor = direct();
    governor.accept(&go_to(-2.0, 3.0, 1.5)).unwrap();
    assert_eq!(run(governor).1.position, Vector3::new(-2.0, 3.0, 1.5));
    let governor = direct();
    governor.stop();
    assert_eq!(run(governor).1.velocity, Vector3::zeros());
}

#[test]
fn a_circle_with_jitter_and_lost_setpoints_is_flown_within_centimetres() {
    let (governor, mut random) = (governor(), Random::new(11));
    let at = circle(1.2, 1.2);
    let mut worst: f64 = 0.0;
    for tick in 0..8_000 {
        // What is sent is up to 3 ms old, and one in three is lost.
        let time = f64::from(tick) * f64::from(PERIOD);
        if tick % 5 == 0 && random.unit() > 0.3 {
            governor.accept(&sent(&at, time - 0.003 * f64::from(random.unit()))).unwrap();
        }
        let reference = governor.tick();
        assert!(TYPICAL.contain(&reference, 0.0), "{reference:?}");
        if tick > 4_000 {
            let [there, ..] = at(time + f64::from(PERIOD));
            worst = worst.max((reference.position.map(f64::from) - there).norm());
        }
    }
    assert!(worst < 0.02, "{worst} m off");
}

/// The eight of 2 m by 1 m in 7.4 s, which the averages never come near.
fn tight_eight() -> impl Fn(f64) -> [Vector3<f64>; 3] {
    eight(0.85, 1.0, Vector3::y())
}

#[test]
fn a_tight_eight_is_flown_as_it_is_sent_from_rest_and_from_a_flight_elsewhere() {
    for every in [1, 2, 5] {
        let worst = follow(governor(), &tight_eight(), every, 30.0, 120.0);
        assert!(worst < 0.01, "every {every}: {worst} m off");
        // In motion, 6 m away.
        let governor = governor();
        governor.accept(&go_to(-3.0, 4.0, 2.0)).unwrap();
        (0..300).for_each(|_| _ = governor.tick());
        let worst = follow(governor, &tight_eight(), every, 30.0, 120.0);
        assert!(worst < 0.01, "every {every}, from elsewhere: {worst} m off");
    }
}

#[test]
fn a_tight_eight_with_jitter_and_lost_setpoints_is_flown_within_centimetres() {
    // The last loses up to six in a row, which is 0.3 s.
    for (every, lost, max) in [(2, 0.0, 0.01), (2, 0.3, 0.015), (5, 0.1, 0.015), (5, 0.3, 0.12)] {
        let (governor, mut random) = (governor(), Random::new(12));
        let at = tight_eight();
        let mut worst: f64 = 0.0;
        for tick in 0..12_000 {
            let time = f64::from(tick) * f64::from(PERIOD);
            // What is sent is up to 1 ms old.
            if tick % every == 0 && random.unit() >= lost {
                governor.accept(&sent(&at, time - 0.001 * f64::from(random.unit()))).unwrap();
            }
            let reference = governor.tick();
            assert!(TYPICAL.contain(&reference, 0.0), "{reference:?}");
            if tick > 4_000 {
                let [there, ..] = at(time + f64::from(PERIOD));
                worst = worst.max((reference.position.map(f64::from) - there).norm());
            }
        }
        assert!(worst < max, "every {every}, {lost} lost: {worst} m off");
    }
}

/// Turns at 2, 3 and 4 times a rate, each axis its own.
fn lissajous(time: f64) -> [Vector3<f64>; 3] {
    let (turns, size) = (Vector3::new(2.0, 3.0, 4.0) * 0.3, Vector3::new(1.2, 0.6, 0.1));
    let angle = turns * time + Vector3::new(0.0, 0.7, 0.3);
    let position = size.component_mul(&angle.map(f64::sin));
    let velocity = size.component_mul(&angle.map(f64::cos)).component_mul(&turns);
    [position, velocity, -position.component_mul(&turns).component_mul(&turns)]
}

#[test]
fn a_lissajous_figure_in_three_dimensions_is_flown_as_it_is_sent() {
    for every in [1, 2, 5] {
        let worst = follow(governor(), &lissajous, every, 30.0, 120.0);
        assert!(worst < 0.002, "every {every}: {worst} m off");
    }
}

#[test]
fn a_stream_beyond_the_bounds_is_reported_with_the_factor_by_which_it_is_too_fast() {
    // By acceleration; by jerk, on a circle and an eight; by snap, on a line; by speed.
    let streams: [(At<'_>, f64); 5] = [
        (&circle(1.5, 2.0), (2.0 * 1.5_f64.powi(2) / 2.5).sqrt()),
        (&circle(2.5, 0.6), (0.6 * 2.5_f64.powi(3) / 4.0).cbrt()),
        (&eight(1.2, 1.0, Vector3::y()), (4.1 * 1.2_f64.powi(3) / 4.0).cbrt()),
        (&eight(3.5, 0.1, Vector3::zeros()), (0.1 * 3.5_f64.powi(4) / 10.0).powf(0.25)),
        (&circle(0.25, 32.0), 8.0 / 5.0),
    ];
    for (index, (at, slower)) in streams.into_iter().enumerate() {
        for every in [1, 2, 5] {
            let governor = governor();
            assert_eq!(governor.following(), None);
            follow(governor, at, every, 0.0, 30.0);
            let following = governor.following().unwrap();
            let found = f64::from(following.slower());
            assert!((found / slower - 1.0).abs() < 0.1, "stream {index}, every {every}: {found} for {slower}");
            assert!(following.off > 0.05, "stream {index}: {} m", following.off);
        }
    }
}

#[test]
fn a_stream_that_is_flown_as_it_is_sent_is_reported_so_and_one_that_ceases_not_at_all() {
    let governor = governor();
    follow(governor, &tight_eight(), 2, 0.0, 10.0);
    let following = governor.following().unwrap();
    assert!(following.off > 0.5 && following.slower() < 1.0, "{following:?}");
    follow(governor, &tight_eight(), 2, 0.0, 40.0);
    let following = governor.following().unwrap();
    assert!(following.off < 0.02 && following.slower() < 1.0, "{following:?}");
    run(governor);
    assert_eq!(governor.following(), None);
}

/// An eight that starts and ends at rest: along it by a clock that goes smoothly, to the fifth derivative, to `rate`.
fn from_rest(rate: f64, size: f64, ramp: f64) -> impl Fn(f64) -> [Vector3<f64>; 3] {
    let path = eight(1.0, size, Vector3::y());
    move |time| {
        let share = (time / ramp).clamp(0.0, 1.0);
        let powers = |degree: i32| share.powi(degree);
        // The integral of the smooth step 35 s^4 - 84 s^5 + 70 s^6 - 20 s^7.
        let gone = 7.0 * powers(5) - 14.0 * powers(6) + 10.0 * powers(7) - 2.5 * powers(8);
        let speed = 35.0 * powers(4) - 84.0 * powers(5) + 70.0 * powers(6) - 20.0 * powers(7);
        let change = (140.0 * powers(3) - 420.0 * powers(4) + 420.0 * powers(5) - 140.0 * powers(6)) / ramp;
        let [there, along, bend] = path(rate * (ramp * gone + (time - ramp).max(0.0)));
        [there, along * (rate * speed), bend * (rate * speed).powi(2) + along * (rate * change)]
    }
}

#[test]
fn a_stream_that_starts_at_rest_is_flown_as_it_is_sent_from_the_start() {
    let at = from_rest(0.7, 1.0, 4.0);
    for every in [1, 2, 5] {
        let governor = governor();
        let [there, ..] = at(0.0);
        governor.start(&there.map(|x| x as f32), &Vector3::zeros(), &Heading::FORWARD).unwrap();
        let waiting = |time: f64| at((time - 3.0).max(0.0));
        let worst = follow(governor, &waiting, every, 0.0, 30.0);
        std::println!("every {every}: {worst} m off");
        assert!(worst < 1e-2, "every {every}: {worst} m off");
    }
}

#[test]
fn setpoints_that_come_at_odd_times_are_flown_as_by_their_own_times() {
    let at = from_rest(0.7, 1.0, 4.0);
    let governor = governor();
    let [there, ..] = at(0.0);
    governor.start(&there.map(|x| x as f32), &Vector3::zeros(), &Heading::FORWARD).unwrap();
    let mut random = Random::new(7);
    let (mut worst, mut due, mut sent_at) = (0.0_f64, 0.0, 0.0);
    for tick in 0..3000 {
        let now = f64::from(tick) * f64::from(PERIOD);
        // Each 20 ms, up to 15 ms late.
        while due <= now {
            governor.accept_late(&sent(&|time| at((time - 3.0).max(0.0)), sent_at), (now - sent_at) as f32).unwrap();
            sent_at += 0.02;
            due = sent_at + 0.015 * f64::from(random.unit());
        }
        let reference = governor.tick();
        assert!(TYPICAL.contain(&reference, 0.0), "{reference:?}");
        let [there, ..] = at((now + f64::from(PERIOD) - 3.0).max(0.0));
        worst = worst.max((reference.position.map(f64::from) - there).norm());
    }
    assert!(worst < 1e-2, "{worst} m off");
}
