//! Waypoint references: where they go, how smoothly, and whether their bounds are bounds.

use crate::support::{Random, bounds, demands, derivatives, psi, slope, turn};
use controller_core::error::Reason;
use controller_core::reference::Trajectory;
use controller_core::reference::waypoints::{POINTS_MAX, Waypoint, Waypoints};
use core::f64::consts::PI;

fn waypoint(time: f64, position: [f64; 3], heading_deg: f64) -> Waypoint {
    Waypoint { time, position, heading: heading_deg.to_radians() }
}

fn micros(time: f64) -> u64 {
    (time * 1e6).round() as u64
}

/// Two to sixteen points within ten metres, a tenth of a second to ten seconds apart.
fn random(generator: &mut Random) -> Vec<Waypoint> {
    let count = 2 + generator.bits() as usize % (POINTS_MAX - 1);
    let mut time = 0.0;
    (0..count)
        .map(|_| {
            let mut uniform = |size: f64| generator.within(-size, size);
            let position = [uniform(5.0), uniform(5.0), uniform(5.0)];
            let point = waypoint(time, position, uniform(400.0));
            time += generator.magnitude(0.1, 10.0);
            point
        })
        .collect()
}

/// Random references the law accepts, each path of both kinds: wild ones leave its range.
fn references(seed: u64, count: usize) -> impl Iterator<Item = (Vec<Waypoint>, Waypoints)> {
    let mut generator = Random(seed);
    std::iter::repeat_with(move || random(&mut generator))
        .flat_map(|points| [Waypoints::new(&points), Waypoints::inside(&points)].map(|path| (points.clone(), path)))
        .filter_map(|(points, path)| path.ok().map(|path| (points, path)))
        .take(count)
}

#[test]
fn passes_through_every_waypoint_pointing_its_way() {
    for (points, waypoints) in references(1, 2000) {
        for point in &points {
            let reference = waypoints.at(micros(point.time));
            assert_eq!(reference.position.as_slice(), point.position.map(|x| x as f32));
            assert!(turn(psi(&reference), point.heading).abs() < 3e-7);
        }
    }
}

#[test]
fn is_at_rest_at_both_ends_and_beyond() {
    for (points, waypoints) in references(2, 500) {
        let end = micros(points[points.len() - 1].time);
        for time in [0, end, end + 1, end + 30 * 86_400_000_000, u64::MAX] {
            let reference = waypoints.at(time);
            let point = if time == 0 { points[0] } else { points[points.len() - 1] };
            assert_eq!(reference.position.as_slice(), point.position.map(|x| x as f32));
            assert_eq!((demands(&reference), reference.velocity.norm()), ([0.0; 6], 0.0));
        }
    }
}

#[test]
fn is_continuous_to_snap_where_segments_meet() {
    for (points, waypoints) in references(3, 1000) {
        for pair in points.windows(3) {
            let joint = micros(pair[1].time);
            let shorter = (pair[1].time - pair[0].time).min(pair[2].time - pair[1].time);
            let (before, after) = (derivatives(&waypoints.at(joint - 1)), derivatives(&waypoints.at(joint)));
            // The steepest each derivative gets nearby: what a microsecond may change.
            let mut largest = [0.0_f64; 5];
            let (from, to) = (micros(pair[0].time), micros(pair[2].time));
            for i in 0..=200 {
                let found = derivatives(&waypoints.at(from + (to - from) * i / 200));
                for (largest, found) in largest.iter_mut().zip(found) {
                    *largest = found.iter().fold(*largest, |largest, x| largest.max(x.abs()));
                }
            }
            for order in 0..5 {
                // Snap has degree 5: it changes by less than 2 * 5^2 times itself over a segment (Markov).
                let steepest = if order < 4 { largest[order + 1] } else { 50.0 * largest[4] / shorter };
                // Evaluation: 3.4e-6 of the largest control point, which is a few times the largest value.
                let room = 1e-6 * steepest + 2e-5 * largest[order];
                for (before, after) in before[order].iter().zip(after[order]) {
                    assert!((before - after).abs() <= room, "order {order}: {before} to {after}, room {room:e}");
                }
            }
            let (before, after) = (waypoints.at(joint - 1), waypoints.at(joint));
            let bounds = waypoints.bounds();
            assert!(turn(psi(&before), psi(&after)).abs() < 2e-6 * f64::from(bounds.heading_rate) + 1e-5);
        }
    }
}

#[test]
fn each_derivative_is_the_slope_of_the_one_below() {
    let mut generator = Random(4);
    let mut worst = [0.0_f64; 4];
    for (points, waypoints) in references(4, 500) {
        for pair in points.windows(2) {
            let (from, to) = (micros(pair[0].time), micros(pair[1].time));
            let step = (to - from) / 64;
            let mut largest = [0.0_f64; 5];
            for i in 0..64 {
                let found = derivatives(&waypoints.at(from + step * i));
                for (largest, found) in largest.iter_mut().zip(found) {
                    *largest = found.iter().fold(*largest, |largest, x| largest.max(x.abs()));
                }
            }
            let time = from + 2 * step + generator.bits() % (to - from - 4 * step);
            for axis in 0..3 {
                for order in 0..4 {
                    let value = |order: usize, time: u64| derivatives(&waypoints.at(time))[order][axis];
                    let error = value(order + 1, time) - slope(|time| value(order, time), time, step);
                    let noise = largest[order] / (step as f64 * 1e-6);
                    worst[order] = worst[order].max(error.abs() / (1e-4 * largest[order + 1] + 1e-6 * noise));
                }
            }
            let heading = waypoints.at(time).heading;
            let bounds = waypoints.bounds();
            let (fastest, second) = (f64::from(bounds.heading_rate), f64::from(bounds.heading_second_derivative));
            // Wild ones turn many times in a segment: neighbours must be less than half a turn away.
            let (tick, span) = ((0.5 / fastest).min(step as f64 * 1e-6 / 4.0), pair[1].time - pair[0].time);
            let step = micros(tick);
            let rate = slope(|t| turn(psi(&waypoints.at(t)), psi(&waypoints.at(time))), time, step);
            let acceleration = slope(|t| f64::from(waypoints.at(t).heading.rate()), time, step);
            // psi is rounded relative to how far it turns within the segment.
            assert!((f64::from(heading.rate()) - rate).abs() < 1e-4 * fastest + 1e-6 * (fastest * span + PI) / tick);
            assert!((f64::from(heading.acceleration()) - acceleration).abs() < 1e-4 * second + 1e-6 * fastest / tick);
        }
    }
    // Truncation is step^4 / 30 times the fifth derivative; rounding a few 2^-24 of the largest value, over the step.
    assert!(worst.iter().all(|worst| *worst < 1.0), "{worst:?}");
}

#[test]
fn bounds_hold_at_every_instant_and_are_attained() {
    let mut loosest = [1.0_f64; 6];
    for (points, waypoints) in references(5, 2000) {
        let bounds = bounds(&waypoints.bounds());
        let mut largest = [0.0_f64; 6];
        for pair in points.windows(2) {
            let (from, to) = (micros(pair[0].time), micros(pair[1].time));
            for i in 0..300 {
                let found = demands(&waypoints.at(from + (to - from) * i / 300));
                largest.iter_mut().zip(found).for_each(|(largest, found)| *largest = largest.max(found));
            }
        }
        for (i, (bound, largest)) in bounds.into_iter().zip(largest).enumerate() {
            assert!(largest <= bound, "bound {i}: {largest} above {bound}, {points:?}");
            loosest[i] = loosest[i].min(largest / bound);
        }
    }
    // 300 samples miss a peak by 1/600 of a segment at most.
    assert!(loosest.iter().all(|ratio| *ratio > 0.99), "{loosest:?}");
}

#[test]
fn two_points_are_joined_by_the_minimum_snap_polynomial() {
    let waypoints = Waypoints::new(&[waypoint(0.0, [0.0; 3], 0.0), waypoint(2.0, [1.0, -2.0, 0.0], 90.0)]).unwrap();
    for i in 0..=100_u32 {
        let s = f64::from(i) / 100.0;
        let step = s.powi(5) * (126.0 - 420.0 * s + 540.0 * s * s - 315.0 * s.powi(3) + 70.0 * s.powi(4));
        let rate = 630.0 * s.powi(4) * (1.0 - s).powi(4) / 2.0;
        let reference = waypoints.at(u64::from(i) * 20_000);
        assert!((f64::from(reference.position.x) - step).abs() < 1e-6);
        assert!((f64::from(reference.position.y) + 2.0 * step).abs() < 2e-6);
        assert!((f64::from(reference.velocity.x) - rate).abs() < 3e-6);
        assert!(turn(psi(&reference), 0.5 * PI * step).abs() < 2e-6);
    }
    // 630 s^4 (1 - s)^4 / 2 at its peak, 1.230469, times the distance and a quarter turn.
    assert!((f64::from(waypoints.bounds().heading_rate) - 0.5 * PI * 1.230_468_75).abs() < 1e-4);
}

#[test]
fn the_heading_turns_the_shorter_way_and_half_a_turn_counter_clockwise() {
    for (from, to, way) in [
        (170.0, -170.0, 20.0),
        (-170.0, 170.0, -20.0),
        (350.0, 10.0, 20.0),
        (0.0, 179.0, 179.0),
        (0.0, -179.0, -179.0),
        (0.0, 180.0, 180.0),
        (0.0, -180.0, 180.0),
        (170.0, -10.0, 180.0),
        (-10.0, 170.0, 180.0),
        (33.3, -146.7, 180.0),
        (-90.0, 90.0, 180.0),
        (720.0, 90.0, 90.0),
    ] {
        let waypoints = Waypoints::new(&[waypoint(0.0, [0.0; 3], from), waypoint(1.0, [0.0; 3], to)]).unwrap();
        let mut turned = 0.0;
        for i in 0..100 {
            turned += turn(psi(&waypoints.at(i * 10_000 + 10_000)), psi(&waypoints.at(i * 10_000)));
        }
        assert!((turned.to_degrees() - way).abs() < 1e-4, "{from} to {to}: {} instead of {way}", turned.to_degrees());
    }
}

#[test]
fn two_equal_points_in_a_row_are_a_wait_and_the_legs_around_it_do_not_feel_its_length() {
    let (here, there) = ([0.0, 0.0, 1.0], [3.0, 0.0, 1.0]);
    let with_wait = |wait: f64| {
        Waypoints::new(&[
            waypoint(0.0, here, 0.0),
            waypoint(5.0, there, 90.0),
            waypoint(5.0 + wait, there, 90.0),
            waypoint(10.0 + wait, here, 0.0),
        ])
        .unwrap()
    };
    let (short, long) = (with_wait(1.0), with_wait(1e6));
    for time in [5.0, 5.3, 5.99] {
        let reference = long.at(micros(time));
        assert_eq!(reference.position.as_slice(), there.map(|x| x as f32));
        assert_eq!((reference.velocity.norm(), reference.snap.norm(), reference.heading.rate()), (0.0, 0.0, 0.0));
    }
    assert_eq!(short.at(micros(2.5)), long.at(micros(2.5)));
    assert_eq!(short.bounds(), long.bounds());
    assert!(short.bounds().horizontal_acceleration < 1.2, "{:?}", short.bounds());
}

#[test]
fn a_path_inside_stays_on_each_leg_in_the_box_of_its_two_points() {
    let mut generator = Random(6);
    let mut swings = 0;
    for _ in 0..500 {
        let points = random(&mut generator);
        let (Ok(inside), Ok(smooth)) = (Waypoints::inside(&points), Waypoints::new(&points)) else { continue };
        for pair in points.windows(2) {
            let (from, to) = (micros(pair[0].time), micros(pair[1].time));
            let out = |path: &Waypoints, time: u64| {
                let position = path.at(time).position;
                (0..3).any(|axis| {
                    let [a, b] = [pair[0].position[axis], pair[1].position[axis]];
                    let found = f64::from(position[axis]);
                    found < a.min(b) - 1e-5 || found > a.max(b) + 1e-5
                })
            };
            let times = || (0..=100).map(|i| from + (to - from) * i / 100);
            assert!(!times().any(|time| out(&inside, time)), "{points:?}");
            swings += u32::from(times().any(|time| out(&smooth, time)));
        }
    }
    assert!(swings > 300, "the smooth paths hardly swing: {swings}");
}

#[test]
fn a_path_inside_passes_points_in_a_line_at_a_constant_speed() {
    let points = [0.0, 1.0, 2.0, 3.0].map(|t| waypoint(2.0 * t, [3.0 * t, -t, 1.0], 0.0));
    let inside = Waypoints::inside(&points).unwrap();
    for i in 0..=20 {
        let reference = inside.at(2_000_000 + 100_000 * i);
        assert!((reference.velocity - nalgebra::Vector3::new(1.5, -0.5, 0.0)).amax() < 1e-6, "{reference:?}");
        assert!(reference.acceleration.amax() < 1e-5, "{reference:?}");
    }
}

#[test]
fn a_single_waypoint_is_a_hover() {
    let waypoints = Waypoints::new(&[waypoint(0.0, [1.0, 2.0, 3.0], -90.0)]).unwrap();
    let reference = waypoints.at(12_345);
    assert_eq!(reference.position.as_slice(), [1.0, 2.0, 3.0]);
    assert!(turn(psi(&reference), -0.5 * PI).abs() < 1e-7);
    assert_eq!((demands(&reference), bounds(&waypoints.bounds())), ([0.0; 6], [0.0; 6]));
}

/// Three points, in units of `pace` seconds, `away` from the origin.
fn path(pace: f64, away: [f64; 3]) -> Waypoints {
    let shape = [[0.0, 0.0, 1.0], [1.0, 0.5, 1.0], [2.0, 0.0, 2.0]];
    let points = [0.0, 1.0, 3.0]
        .into_iter()
        .zip(shape)
        .map(|(t, p)| waypoint(t * pace, [p[0] + away[0], p[1] + away[1], p[2] + away[2]], 30.0 * t));
    Waypoints::new(&points.collect::<Vec<_>>()).unwrap()
}

#[test]
fn kilometres_away_the_motion_is_the_same() {
    let away = [8192.0, -4096.0, 1024.0];
    let (near, distant) = (path(2.0, [0.0; 3]), path(2.0, away));
    assert_eq!(near.bounds(), distant.bounds());
    for i in 0..600 {
        let (a, b) = (near.at(i * 10_000), distant.at(i * 10_000));
        assert_eq!((a.velocity, a.acceleration, a.jerk, a.snap), (b.velocity, b.acceleration, b.jerk, b.snap));
        assert_eq!(a.heading, b.heading);
        // Only the sum is rounded, to half of 2^-10 m at eight kilometres.
        assert!((b.position - a.position - nalgebra::Vector3::from(away.map(|x| x as f32))).amax() <= 5e-4);
    }
}

#[test]
fn a_path_that_takes_thirty_days_is_as_accurate_as_one_that_takes_six_seconds() {
    let days = 10.0 * 86_400.0;
    let (fast, slow) = (path(2.0, [0.0; 3]), path(days, [0.0; 3]));
    for i in 0..600 {
        let (a, b) = (fast.at(i * 10_000), slow.at(i * 10_000 * 432_000));
        // The same place in the segment but for the roundings of 1 - s, s and the weights, 3e-6 at worst.
        assert!((a.position - b.position).norm() < 2e-6, "{i}: {a:?} {b:?}");
        assert!(turn(psi(&a), psi(&b)).abs() < 2e-6);
        assert!((a.velocity - b.velocity * 432_000.0).norm() < 5e-6);
    }
    let end = slow.at(30 * 86_400_000_000);
    assert_eq!((end.position.as_slice(), demands(&end)), ([2.0, 0.0, 2.0].as_slice(), [0.0; 6]));
}

#[test]
fn very_unequal_segments_stay_within_their_bounds_and_smooth() {
    for short in [1.0, 0.1, 0.01, 0.001] {
        // The short step is in proportion, as a path sampled unevenly would have it.
        let points = [
            waypoint(0.0, [0.0; 3], 0.0),
            waypoint(10.0, [5.0, 1.0, 0.0], 90.0),
            waypoint(10.0 + short, [5.0 + 0.5 * short, 1.0, 0.0], 90.0),
            waypoint(20.0 + short, [10.0, 0.0, 0.0], 180.0),
        ];
        let waypoints = Waypoints::new(&points).unwrap();
        let bounds = waypoints.bounds();
        // This path needs no more than a few m/s^2; a solver that lost its digits would.
        assert!(bounds.horizontal_acceleration < 3.0 && bounds.snap < 30.0, "{bounds:?}");
        for i in 0..20_000 {
            assert!(bounds.contain(&waypoints.at(i * 1_000), 0.0));
        }
    }
}

#[test]
fn malformed_points_are_refused_by_name() {
    let good = |i: usize| waypoint(i as f64, [0.0; 3], 0.0);
    let refusal = |points: &[Waypoint]| {
        let error = Waypoints::new(points).unwrap_err();
        (error.field, error.reason)
    };
    assert_eq!(refusal(&[]), ("reference.points", Reason::TooFew(1)));
    let many: Vec<_> = (0..=POINTS_MAX).map(good).collect();
    assert_eq!(refusal(&many), ("reference.points", Reason::TooMany(16)));
    assert!(Waypoints::new(&many[..POINTS_MAX]).is_ok());

    let with = |i: usize, change: fn(&mut Waypoint)| {
        let mut points: Vec<_> = (0..POINTS_MAX).map(good).collect();
        change(&mut points[i]);
        refusal(&points)
    };
    assert_eq!(with(0, |p| p.time = 0.5), ("reference.points[0].t", Reason::NotZero));
    assert_eq!(with(0, |p| p.time = -1.0), ("reference.points[0].t", Reason::NotZero));
    assert_eq!(with(3, |p| p.time = 2.0), ("reference.points[3].t", Reason::NotIncreasing));
    assert_eq!(with(3, |p| p.time = 2.0000004), ("reference.points[3].t", Reason::NotIncreasing));
    assert_eq!(with(3, |p| p.time = -3.0), ("reference.points[3].t", Reason::NotIncreasing));
    assert_eq!(with(15, |p| p.time = f64::NAN), ("reference.points[15].t", Reason::NotFinite));
    assert_eq!(with(15, |p| p.time = 1e10), ("reference.points[15].t", Reason::NotBelow(9e9)));
    assert_eq!(with(7, |p| p.position[2] = f64::INFINITY), ("reference.points[7].position", Reason::NotFinite));
    assert_eq!(with(7, |p| p.position[2] = -1e16), ("reference.points[7].position", Reason::NotBelow(1e15)));
    assert_eq!(with(9, |p| p.heading = f64::NAN), ("reference.points[9].heading_deg", Reason::NotFinite));
    // A metre in ten milliseconds.
    let fast = refusal(&[good(0), waypoint(0.01, [1.0, 0.0, 0.0], 0.0)]);
    assert_eq!(fast, ("reference (jerk)", Reason::NotBelow(1e6)));
}

#[test]
fn a_time_is_rounded_to_the_nearest_microsecond() {
    let waypoints = Waypoints::new(&[waypoint(0.0, [0.0; 3], 0.0), waypoint(1.000_000_6, [1.0; 3], 0.0)]).unwrap();
    assert_ne!(waypoints.at(1_000_000), waypoints.at(1_000_001));
    assert_eq!(waypoints.at(1_000_001), waypoints.at(1_000_002));
}
