//! The position law: its envelope, its filters, and that errors fall.

use super::Random;
use crate::extended::defaults::NOTHING_GIVEN;
use crate::extended::parameters::ExtendedParameters;
use crate::extended::position::{FeedbackLimits, Filters, PositionFeedback, PositionLaw};
use crate::extended::tests::example::{self, Craft, greatest_accelerations};
use crate::heading::Heading;
use crate::reference::hover::Hover;
use crate::reference::{Reference, Trajectory};
use crate::state::State;
use nalgebra::{Quaternion, Vector3};

fn origin() -> Reference {
    Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0)
}

pub(super) fn at(position: Vector3<f32>, velocity: Vector3<f32>) -> State {
    let attitude = Quaternion::new(1.0, 0.0, 0.0, 0.0);
    State { position, velocity, attitude, angular_velocity: Vector3::zeros() }
}

/// A force as the estimate has it at most, half of the time at its level across.
pub(super) fn force(random: &mut Random, p: &ExtendedParameters) -> Vector3<f32> {
    let (sin, cos) = random.between(0.0, core::f32::consts::TAU).sin_cos();
    let across = p.force_across * random.between(0.0, 2.0).min(1.0);
    Vector3::new(across * cos, across * sin, random.between(-p.force_down, p.force_up))
}

#[test]
fn the_feedback_stays_in_its_envelope_whatever_the_errors_and_the_force() {
    // What is left to the feedback where a force takes all of the envelope, m/s^2: the law's LEVEL_MIN_M_PER_S2.
    let min = 0.3;
    let mut random = Random(61);
    for _ in 0..200 {
        let craft = Craft::random(&mut random);
        let p = craft.constants(&NOTHING_GIVEN);
        let gravity = craft.vehicle.gravity;
        let law = PositionLaw::new(&p, gravity, craft.period).unwrap();
        let [weakest, strongest] = greatest_accelerations(&craft, &p);
        for _ in 0..300 {
            let size = random.logarithmic(0.01, 1e4);
            let state = at(random.vector(size), random.vector(size));
            let [command, intermediate, smoothed] = [5.0; 3].map(|size| random.vector(size));
            let filter = Filters { command, intermediate, smoothed };
            let d = force(&mut random, &p);
            let max = random.between(weakest, strongest);
            let ubar = law.feedback(&state, &origin(), &filter, &d, max, &FeedbackLimits::UNLIMITED).feedback;
            let allowance = 1e-5 * max;
            let (lift, across, wind) = (gravity + ubar.z, ubar.xy().norm(), d.xy().norm() + min);
            assert!(ubar.z >= -p.a_down - allowance, "{ubar}");
            assert!(lift <= max.max(gravity - d.z + min) + allowance, "{ubar} {d} {max}");
            assert!(across <= p.a_across.max(wind) + allowance, "{ubar} {d}");
            // Across has what the vertical leaves of thrust and tilt, or what the force takes.
            let left = (max * max - lift * lift).max(0.0).sqrt();
            assert!(across <= (0.95 * left).min(0.95 * lift * p.tilt_max.tan()).max(wind) + 1e-3, "{ubar} {d}");
        }
    }
}

#[test]
fn the_filters_step_is_that_of_their_equations() {
    let p = example::parameters();
    let period = 0.01;
    let law = PositionLaw::new(&p, 9.81, period).unwrap();
    let mut random = Random(62);
    for _ in 0..100 {
        let [command, intermediate, smoothed] = [3.0; 3].map(|size| random.vector(size));
        let filter = Filters { command, intermediate, smoothed: Vector3::zeros() };
        let drive = random.vector(100.0);
        let found = law.advance(&filter, &smoothed, &drive, f32::MAX);
        // Midpoint steps of the equations in double precision.
        let (mut c, mut x) = (filter.command.map(f64::from), filter.intermediate.map(f64::from));
        let (steps, k_f, slope) = (1_000, f64::from(p.k_f), drive.map(f64::from));
        let step = f64::from(period) / f64::from(steps);
        for _ in 0..steps {
            let middle = c + (x - c) * (0.5 * step * k_f);
            c += (x + slope * (0.5 * step) - middle) * (k_f * step);
            x += slope * step;
        }
        assert!((found.command.map(f64::from) - c).norm() < 2e-6, "{found:?} {c}");
        assert!((found.intermediate.map(f64::from) - x).norm() < 2e-6, "{found:?} {x}");
        assert_eq!(found.smoothed, smoothed);
    }
}

#[test]
fn what_the_filter_makes_never_falls_below_its_end() {
    let p = example::parameters();
    let law = PositionLaw::new(&p, 9.81, 0.01).unwrap();
    let (zero, below) = (Vector3::zeros(), Vector3::new(1.0, 2.0, -90.0));
    let falling = Filters { command: zero, intermediate: below, smoothed: below };
    let next = law.advance(&falling, &below, &zero, 1e3);
    // x_z goes along: it would push c_z further. What is across stays.
    assert_eq!([next.command.z, next.intermediate.z], [-p.a_down; 2]);
    assert_eq!(next.intermediate.xy(), below.xy());
    // One that leads back up is not held back.
    let rising = Filters { command: Vector3::z() * (-p.a_down - 3.0), intermediate: zero, smoothed: zero };
    let next = law.advance(&rising, &zero, &zero, 1e3);
    assert_eq!([next.command.z, next.intermediate.z], [-p.a_down, 0.0]);
}

#[test]
fn no_drive_takes_the_filters_farther_than_twice_what_the_rotors_hold() {
    let p = example::parameters();
    let law = PositionLaw::new(&p, 9.81, 0.01).unwrap();
    let (zero, away) = (Vector3::zeros(), Vector3::new(1e9, -1e9, 1e9));
    let mut filter = Filters::at(zero);
    for _ in 0..1_000 {
        filter = law.advance(&filter, &zero, &away, 20.0);
        assert!(filter.command.amax() <= 40.0 && filter.intermediate.amax() <= 40.0, "{filter:?}");
    }
    assert!(filter.command.amin() > 39.9, "{filter:?}");
}

/// A point mass under the law's acceleration and a constant force D that is known, in ticks: what each tick had.
fn flown(start: State, force: Vector3<f32>, ticks: u32, mut see: impl FnMut(&PositionFeedback)) {
    let p = example::parameters();
    let (gravity, h) = (9.81, 0.002);
    let law = PositionLaw::new(&p, gravity, h).unwrap();
    let [max, _] = greatest_accelerations(&Craft::example(), &p);
    let mut state = start;
    let mut filter = Filters::at(-force);
    for _ in 0..ticks {
        let feedback = law.feedback(&state, &origin(), &filter, &force, max, &FeedbackLimits::UNLIMITED);
        see(&feedback);
        let next = law.advance(&filter, &feedback.smoothed, &feedback.drive, f32::MAX);
        // c moves nearly straight within a tick. Along the vertical y acts at once.
        let mut acceleration = (filter.command + next.command) * 0.5 + force;
        acceleration.z = feedback.smoothed.z + force.z;
        state.position += state.velocity * h + acceleration * (0.5 * h * h);
        state.velocity += acceleration * h;
        filter = next;
    }
}

const FORCES: [[f32; 3]; 3] = [[0.0; 3], [3.0, -4.0, 1.5], [-2.0, 5.0, -6.0]];

#[test]
fn the_first_error_moves_with_the_second_and_that_with_feedback_and_force() {
    let k_d = example::parameters().k_d;
    let kept = (-0.002 * k_d).exp();
    for d in FORCES.map(Vector3::from) {
        let mut before: Option<PositionFeedback> = None;
        flown(at(Vector3::new(4.0, -3.0, 2.0), Vector3::new(1.0, 2.0, -3.0)), d, 2_000, |now| {
            if let Some(before) = before.replace(*now) {
                let h = 0.002;
                let moved = (now.errors.z_1 - before.errors.z_1) / h;
                // ubar is held for a tick, and x goes to where y will be: half a tick's way of y is ahead. Beside it,
                // the square of a tick, and rounding of metres or m/s over one.
                let ahead = (before.feedback - before.smoothed) * (0.5 * (1.0 - kept) / kept);
                let expected = (before.errors.z_2 + now.errors.z_2) * 0.5 + ahead / k_d;
                assert!((moved - expected).norm() < 5e-3, "{moved} {expected}");
                let moved = (now.errors.z_2 - before.errors.z_2) / h;
                let expected = before.feedback + d + ahead;
                assert!((moved - expected).norm() < 1e-2 * (1.0 + expected.norm()), "{moved} {expected}");
            }
        });
    }
}

/// The integral from 0 to z of s(k_v s(v(z); v_c); M), by Simpson's rule, v being the speed from which `braking` stops
/// a vehicle that answers after k_v / k_p.
fn potential(z: f64, [k_p, k_v, speed, braking, level]: [f64; 5]) -> f64 {
    let s = |x: f64, level: f64| level * x / level.hypot(x);
    let t = k_v / k_p;
    let v = |z: f64| braking * ((t * t + 2.0 * z.abs() / braking).sqrt() - t) * z.signum();
    let of = |z: f64| s(k_v * s(v(z), speed), level);
    let (steps, width) = (200, z / 200.0);
    (0..steps)
        .map(|i| {
            let left = width * f64::from(i);
            (of(left) + 4.0 * of(left + 0.5 * width) + of(left + width)) * width / 6.0
        })
        .sum()
}

#[test]
fn v_0_falls_along_the_vertical_and_across_while_nothing_is_limited() {
    let p = example::parameters();
    let [max, _] = greatest_accelerations(&Craft::example(), &p);
    for d in FORCES.map(Vector3::from) {
        // The vertical: its level and its approach depend on the side.
        for (height, climb) in [(5.0, 0.0), (-5.0, 2.0), (0.3, -4.0), (-30.0, -10.0)] {
            let mut before = f64::INFINITY;
            flown(at(Vector3::new(0.0, 0.0, height), Vector3::new(0.0, 0.0, climb)), d, 10_000, |now| {
                let (z_1, z_2) = (f64::from(now.errors.z_1.z), f64::from(now.errors.z_2.z));
                let down = z_1 > 0.0;
                let (push, pull) = (max - 9.81 + d.z, p.a_down - d.z);
                let (level, brakes) = if down { (pull, push) } else { (push, pull) };
                let speed = if down { p.v_down } else { p.v_up };
                let constants = [p.k_p_vertical, p.k_v_vertical, speed, p.braking_vertical * brakes, level];
                let energy = 0.5 * z_2 * z_2 + potential(z_1, constants.map(f64::from));
                // Ticks: the drive is held for one, so V_0 may rise by (z_2' h)^2 where its fall passes zero.
                assert!(energy < before + 1e-3, "{energy} after {before}");
                before = energy;
            });
            assert!(before < 1e-3, "{before}");
        }
        // Across, at rest along the vertical: its level is then constant.
        for (position, velocity) in [([6.0, 0.0, 0.0], [0.0, 3.0, 0.0]), ([-20.0, 9.0, 0.0], [5.0, -5.0, 0.0])] {
            let mut before = f64::INFINITY;
            let lift = 9.81 - d.z;
            let left = 0.95 * (max * max - lift * lift).sqrt();
            let level = p.a_across.min(0.95 * lift * p.tilt_max.tan()).min(left) - d.xy().norm();
            flown(at(Vector3::from(position), Vector3::from(velocity)), d, 10_000, |now| {
                let (z_1, z_2) = (f64::from(now.errors.z_1.xy().norm()), f64::from(now.errors.z_2.xy().norm()));
                let constants =
                    [p.k_p_across, p.k_v_across, p.v_across, p.braking_across * level, level].map(f64::from);
                let energy = 0.5 * z_2 * z_2 + potential(z_1, constants);
                assert!(energy < before + 1e-3, "{energy} after {before}");
                before = energy;
            });
            assert!(before < 1e-3, "{before}");
        }
    }
}
