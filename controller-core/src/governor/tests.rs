//! The governor as a whole: times, arrivals, refusals. Streams are in `following/tests.rs`, and by the thousand in
//! `tests/setpoints/governor_campaign.rs`.

extern crate std;
use super::*;
use nalgebra::Vector2;
use std::boxed::Box;
use std::string::{String, ToString};
use std::vec::Vec;
pub(super) use xorshift::Random;

#[path = "../../tests/support/xorshift.rs"]
mod xorshift;

/// Bounds a small quadrotor certifies.
pub(super) const TYPICAL: ReferenceBounds = ReferenceBounds {
    horizontal_speed: 5.0,
    horizontal_acceleration: 2.5,
    vertical_acceleration: 0.5,
    jerk: 4.0,
    snap: 10.0,
    heading_rate: 1.3,
    heading_second_derivative: 1.8,
};

pub(super) const PERIOD: f32 = 0.01;

/// Memory for one test.
fn memory() -> &'static mut Memory {
    Box::leak(Box::new(Memory::EMPTY))
}

pub(super) fn governor() -> &'static mut Governor {
    Governor::new(&TYPICAL, &GovernorLimits::default(), PERIOD, memory()).unwrap()
}

pub(super) fn go_to(x: f32, y: f32, z: f32) -> Setpoint {
    Setpoint { motion: Motion::Position(Vector3::new(x, y, z)), turn: HeadingSetpoint::Keep }
}

/// Seconds until at rest, and the last reference.
pub(super) fn run(governor: &mut Governor) -> (f32, Reference) {
    for ticks in 1..20_000 {
        let reference = governor.tick();
        assert!(TYPICAL.contain(&reference, 0.0), "{reference:?}");
        if governor.at_rest() {
            return (ticks as f32 * PERIOD, reference);
        }
    }
    panic!("no rest")
}

#[test]
fn ten_metres_take_less_than_six_and_a_half_seconds() {
    for (target, max) in [(10.0, 6.5), (1.0, 3.7), (0.1, 2.8)] {
        let governor = governor();
        governor.accept(&go_to(target, 0.0, 0.0)).unwrap();
        let (time, last) = run(governor);
        assert_eq!(last.position, Vector3::new(target, 0.0, 0.0));
        assert!(time < max, "{target} m took {time} s");
    }
}

#[test]
fn a_half_turn_takes_less_than_four_seconds_and_stays_on_its_shorter_side() {
    for (angle, side) in [(3.1, 1.0), (-3.1, -1.0), (3.3, -1.0), (-40.0 * core::f32::consts::TAU + 2.0, 1.0)] {
        let governor = governor();
        let setpoint = Setpoint { turn: HeadingSetpoint::Angle { angle, rate: 0.0 }, ..go_to(0.0, 0.0, 0.0) };
        governor.accept(&setpoint).unwrap();
        assert!((0..30).map(|_| governor.tick().heading.rate() * side).last().unwrap() > 0.1);
        let (time, last) = run(governor);
        let (sin, cos) = f64::from(angle).sin_cos();
        let miss = last.heading.direction() - Vector2::new(cos as f32, sin as f32);
        // Rounding of the components and of an angle of 250 rad (the target's own, in f32, is exact).
        assert!(miss.norm() < 5e-7 && time < 4.0, "{time} s, off by {}", miss.norm());
    }
}

#[test]
fn a_velocity_is_reached_held_and_left_when_it_is_not_renewed() {
    let governor = governor();
    let setpoint =
        Setpoint { motion: Motion::Velocity(Vector3::new(1.0, -2.0, 0.3)), turn: HeadingSetpoint::Rate(0.4) };
    for _ in 0..600 {
        governor.accept(&setpoint).unwrap();
        governor.tick();
    }
    let reference = governor.tick();
    // One unit of length a tick is the resolution of a velocity.
    assert!((reference.velocity - Vector3::new(1.0, -2.0, 0.3)).norm() < 1e-6);
    assert!((reference.heading.rate() - 0.4).abs() < 1e-6);
    let (time, last) = run(governor);
    assert!(time < 0.5 + 2.0 + 2.5 && last.velocity == Vector3::zeros(), "stopped after {time} s");
}

#[test]
fn the_way_to_rest_is_how_far_a_stop_takes_the_reference() {
    for (ticks, target) in [(0, 10.0), (60, 10.0), (200, 10.0), (400, 10.0), (400, 1.0)] {
        let governor = governor();
        governor.accept(&go_to(target, 0.0, 0.5 * target)).unwrap();
        let here = (0..=ticks).map(|_| governor.tick()).last().unwrap().position;
        let way = governor.way_to_rest();
        governor.stop();
        let (_, last) = run(governor);
        let gone = (last.position - here).norm();
        assert!((gone - way).abs() < 0.02 + 0.02 * gone, "after {ticks} ticks: {gone} m, {way} m said");
    }
    let governor = governor();
    assert_eq!(governor.way_to_rest(), 0.0);
}

#[test]
fn at_any_rate_the_reference_takes_the_same_way_and_stops_as_long_after_the_last_setpoint() {
    let motion = Motion::Velocity(Vector3::new(1.0, -2.0, 0.3));
    let flown = |rate: u16| -> Vec<Reference> {
        let governor = Governor::new(&TYPICAL, &GovernorLimits::default(), 1.0 / f32::from(rate), memory()).unwrap();
        let tick = |number: u16| {
            if number.is_multiple_of(rate) && number < 3 * rate {
                governor.accept(&Setpoint { motion, turn: HeadingSetpoint::Rate(0.4) }).unwrap();
            }
            let reference = governor.tick();
            assert!(TYPICAL.contain(&reference, 0.0), "{rate} Hz: {reference:?}");
            reference
        };
        // Eight seconds; those of each hundredth.
        (0..8 * rate).map(tick).skip(usize::from(rate / 100) - 1).step_by((rate / 100).into()).collect()
    };
    let slow = flown(100);
    assert!(slow[50].velocity.norm() > 0.01 && slow[799].velocity == Vector3::zeros());
    for rate in [200, 500, 1_000] {
        for (ours, theirs) in flown(rate).iter().zip(&slow) {
            let (position, velocity) = (ours.position - theirs.position, ours.velocity - theirs.velocity);
            let turned = ours.heading.direction() - theirs.heading.direction();
            let misses = [position.norm(), velocity.norm(), turned.norm()];
            assert!(misses.iter().all(|miss| *miss < 1e-5), "{rate} Hz: {misses:?}");
        }
    }
}

#[test]
fn a_limit_on_the_speed_beyond_the_bounds_does_not_count() {
    let limits = GovernorLimits { horizontal_speed: 20.0, ..GovernorLimits::default() };
    let governor = Governor::new(&TYPICAL, &limits, PERIOD, memory()).unwrap();
    let mut fastest = 0.0_f32;
    for _ in 0..1_000 {
        let motion = Motion::Velocity(Vector3::new(6.0, -8.0, 0.0));
        governor.accept(&Setpoint { motion, turn: HeadingSetpoint::Keep }).unwrap();
        let reference = governor.tick();
        assert!(TYPICAL.contain(&reference, 0.0), "{reference:?}");
        fastest = fastest.max(reference.velocity.norm());
    }
    assert!(fastest > 0.999 * TYPICAL.horizontal_speed, "{fastest} m/s");
}

#[test]
fn position_on_some_axes_and_velocity_on_the_others_are_reached_together() {
    let governor = governor();
    let motion = Motion::Mixed { position: [None, None, Some(2.0)], velocity: Vector3::new(1.0, -0.5, 0.0) };
    for _ in 0..900 {
        governor.accept(&Setpoint { motion, turn: HeadingSetpoint::Keep }).unwrap();
        assert!(TYPICAL.contain(&governor.tick(), 0.0));
    }
    let reference = governor.tick();
    assert!((reference.velocity - Vector3::new(1.0, -0.5, 0.0)).norm() < 1e-6, "{}", reference.velocity);
    assert_eq!(reference.position.z, 2.0);
    // Not renewed: it stops across, and stays at its height.
    let (_, last) = run(governor);
    assert!(last.velocity == Vector3::zeros() && last.position.z == 2.0);
    // A place is gone to while another axis moves on.
    let motion = Motion::Mixed { position: [Some(1.0), Some(-3.0), None], velocity: Vector3::new(0.0, 0.0, 0.4) };
    for _ in 0..1_500 {
        governor.accept(&Setpoint { motion, turn: HeadingSetpoint::Keep }).unwrap();
        governor.tick();
    }
    let reference = governor.tick();
    assert_eq!((reference.position.x, reference.position.y), (1.0, -3.0));
    assert!((reference.velocity.z - 0.4).abs() < 1e-6);
}

#[test]
fn a_moving_point_is_followed_without_lag() {
    let governor = governor();
    let (velocity, acceleration) = (Vector3::new(0.5, -0.2, 0.1), Vector3::new(0.1, -0.04, 0.0));
    let mut worst: f32 = 0.0;
    for tick in 0..1_500 {
        let time = tick as f32 * PERIOD;
        if tick % 2 == 0 {
            let position = velocity * time + acceleration * (0.5 * time * time);
            let velocity = velocity + acceleration * time;
            let motion = Motion::PositionVelocityAcceleration { position, velocity, acceleration };
            governor
                .accept(&Setpoint { motion, turn: HeadingSetpoint::Angle { angle: 0.3 * time, rate: 0.3 } })
                .unwrap();
        }
        let reference = governor.tick();
        let time = time + PERIOD;
        if tick > 1_000 {
            let expected = velocity * time + acceleration * (0.5 * time * time);
            worst = worst.max((reference.position - expected).norm());
            let (sin, cos) = (0.3 * time).sin_cos();
            worst = worst.max((reference.heading.direction() - Vector2::new(cos, sin)).norm());
        }
    }
    assert!(worst < 2e-5, "lags by {worst}");
}

#[test]
fn a_setpoint_that_is_not_a_number_is_refused_by_name_and_changes_nothing() {
    let governor = governor();
    governor.accept(&go_to(1.0, 2.0, 3.0)).unwrap();
    governor.tick();
    let before = governor.clone();
    let nan = f32::NAN;
    for (setpoint, field) in [
        (go_to(0.0, nan, 0.0), "setpoint.position"),
        (
            Setpoint {
                motion: Motion::Mixed { position: [None, None, Some(nan)], velocity: Vector3::zeros() },
                turn: HeadingSetpoint::Keep,
            },
            "setpoint.position",
        ),
        (
            Setpoint { motion: Motion::Velocity(Vector3::new(nan, 0.0, 0.0)), turn: HeadingSetpoint::Keep },
            "setpoint.velocity",
        ),
        (Setpoint { turn: HeadingSetpoint::Angle { angle: nan, rate: 0.0 }, ..go_to(0.0, 0.0, 0.0) }, "setpoint.yaw"),
        (Setpoint { turn: HeadingSetpoint::Rate(f32::INFINITY), ..go_to(0.0, 0.0, 0.0) }, "setpoint.yaw_rate"),
    ] {
        assert_eq!(governor.accept(&setpoint), Err(InputError::NotFinite { field }));
    }
    let far = Err(InputError::OutOfRange { field: "setpoint.position" });
    assert_eq!(governor.accept(&go_to(2e7, 0.0, 0.0)), far);
    assert_eq!(*governor, before);
}

#[test]
fn a_flight_starts_anew_at_the_given_state_and_keeps_nothing_of_the_last() {
    let start = Vector3::new(3.0, -2.0, 7.0);
    for turn in 0..48 {
        let (sin, cos) = (core::f32::consts::TAU * turn as f32 / 48.0).sin_cos();
        let heading = Heading::new(Vector2::new(cos, sin), 0.3, -0.2).unwrap();
        let (governor, fresh) = (governor(), governor());
        governor
            .accept(&Setpoint { turn: HeadingSetpoint::Angle { angle: 1.0, rate: 0.0 }, ..go_to(9.0, 0.0, 0.0) })
            .unwrap();
        (0..100).for_each(|_| _ = governor.tick());
        governor.start(&start, &Vector3::zeros(), &heading).unwrap();
        fresh.start(&start, &Vector3::zeros(), &heading).unwrap();
        for _ in 0..600 {
            let reference = governor.tick();
            assert_eq!(reference, fresh.tick());
            assert!(reference.position == start && reference.velocity == Vector3::zeros() && governor.at_rest());
            // What single precision makes of a direction and back.
            let miss = reference.heading.direction() - heading.direction();
            assert!(miss.norm() < 3e-7 && reference.heading.rate() == 0.0, "turn {turn}: {miss}");
        }
    }
}

#[test]
fn a_steady_velocity_is_carried_on_and_stopped() {
    let governor = governor();
    let velocity = Vector3::new(1.5, -0.5, 0.25);
    governor.start(&Vector3::zeros(), &velocity, &Heading::FORWARD).unwrap();
    let first = governor.tick();
    assert!((first.velocity - velocity).norm() < 1e-4 && (first.position - velocity * PERIOD).norm() < 1e-5);
    let (time, last) = run(governor);
    assert!(time < 4.0 && last.position.xy().dot(&velocity.xy()) > 0.0);
}

#[test]
fn a_start_out_of_range_is_refused_by_name_and_the_governor_goes_on() {
    let (governor, untouched) = (governor(), governor());
    let zero = Vector3::zeros();
    let far = governor.start(&Vector3::repeat(1e8), &zero, &Heading::FORWARD);
    assert_eq!(far, Err(InputError::OutOfRange { field: "initial.position" }));
    let unknown = governor.start(&zero, &Vector3::repeat(f32::NAN), &Heading::FORWARD);
    assert_eq!(unknown, Err(InputError::NotFinite { field: "initial.velocity" }));
    assert_eq!(governor, untouched);
}

#[test]
fn a_bound_or_a_limit_of_zero_is_refused_by_name() {
    let refused = |bounds: ReferenceBounds, limits: GovernorLimits, period: f32| {
        Governor::new(&bounds, &limits, period, memory()).unwrap_err().field
    };
    let limits = GovernorLimits::default();
    let zero = ReferenceBounds { vertical_acceleration: 0.0, ..TYPICAL };
    assert_eq!(refused(zero, limits, PERIOD), "reference_bounds.vertical_acceleration");
    let zero = ReferenceBounds { heading_second_derivative: 0.0, ..TYPICAL };
    assert_eq!(refused(zero, limits, PERIOD), "reference_bounds.heading_second_derivative");
    let unknown = ReferenceBounds { snap: f32::NAN, ..TYPICAL };
    assert_eq!(refused(unknown, limits, PERIOD), "reference_bounds.snap");
    assert_eq!(refused(TYPICAL, GovernorLimits { timeout: 61.0, ..limits }, PERIOD), "governor.timeout");
    assert_eq!(refused(TYPICAL, limits, 0.2), "governor.period");
    let fast = GovernorLimits { vertical_speed: 256.1, ..limits };
    assert_eq!(refused(TYPICAL, fast, PERIOD), "governor.vertical_speed");
    assert_eq!(
        refused(TYPICAL, GovernorLimits { horizontal_speed: 256.1, ..limits }, PERIOD),
        "governor.horizontal_speed"
    );
}

#[test]
fn a_limit_that_is_too_great_is_refused_as_such() {
    let said = |limits: GovernorLimits| -> String {
        Governor::new(&TYPICAL, &limits, PERIOD, memory()).unwrap_err().to_string()
    };
    let limits = GovernorLimits::default();
    assert_eq!(said(GovernorLimits { timeout: 61.0, ..limits }), "governor.timeout: must be at most 60");
    assert!(said(GovernorLimits { snap_ramp: 59.0, ..limits }).starts_with("governor.snap_ramp: must be at most"));
    assert!(
        said(GovernorLimits { heading_ramp: 59.0, ..limits }).starts_with("governor.heading_ramp: must be at most")
    );
}

#[test]
fn the_farthest_targets_in_the_finest_units_stay_within_the_integers() {
    // Weak bounds on acceleration and wide ones on its derivatives make short averages and fine units.
    let weak =
        ReferenceBounds { horizontal_acceleration: 0.01, vertical_acceleration: 0.01, jerk: 1e3, snap: 1e5, ..TYPICAL };
    let patient = GovernorLimits { timeout: 60.0, ..GovernorLimits::default() };
    for sign in [1.0, -1.0] {
        let governor = Governor::new(&weak, &patient, PERIOD, memory()).unwrap();
        let all = |range: f32| Vector3::repeat(sign * range);
        let motion = Motion::PositionVelocityAcceleration {
            position: all(0.99 * POSITION_RANGE_M),
            velocity: all(0.0),
            acceleration: all(0.99 * crate::reference::DERIVATIVE_RANGE),
        };
        governor.accept(&Setpoint { motion, turn: HeadingSetpoint::Keep }).unwrap();
        for _ in 0..7_000 {
            let reference = governor.tick();
            assert!(weak.contain(&reference, 1e-5) && reference.position.x * sign >= 0.0, "{reference:?}");
        }
    }
}
