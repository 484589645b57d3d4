//! The attitude law: its potential, its energy whatever the vehicle does about its thrust axis, and half a turn.

use super::Random;
use crate::attitude::rotate_back;
use crate::extended::attitude::{AttitudeLaw, Tilt};
use crate::extended::tests::example;
use nalgebra::{Quaternion, Vector2, Vector3};

fn law() -> AttitudeLaw {
    AttitudeLaw::new(&example::parameters(), &example::vehicle().inertia)
}

/// The angle theta of a unit quaternion from the desired frame to the body, rad.
fn angle(q: &Quaternion<f64>) -> f64 {
    2.0 * q.i.hypot(q.j).atan2(q.w.hypot(q.k))
}

/// The integral of |P| over the angle, by Simpson's rule, in double precision.
fn potential_energy(angle: f64, level: f64) -> f64 {
    let gain = f64::from(example::parameters().k_tilt);
    let pull = |theta: f64| {
        let scaled = gain * (0.25 * theta).tan();
        level * scaled / level.hypot(scaled)
    };
    let steps = 2_000;
    let width = angle / f64::from(steps);
    (0..steps)
        .map(|i| {
            let left = width * f64::from(i);
            (pull(left) + 4.0 * pull(left + 0.5 * width) + pull(left + width)) * width / 6.0
        })
        .sum()
}

/// `q` turned in the body's axes.
fn turned(q: &Quaternion<f64>, axis: Vector3<f64>, angle: f64) -> Quaternion<f64> {
    q * Quaternion::from_parts((0.5 * angle).cos(), axis * (0.5 * angle).sin())
}

#[test]
fn the_torque_is_the_slope_of_its_potential_and_nothing_about_the_thrust_axis() {
    let (law, level) = (law(), 0.7 * example::parameters().m_tilt);
    let mut random = Random(3);
    for _ in 0..2_000 {
        let q = random.attitude();
        let double = Quaternion::from_vector(q.as_vector().map(f64::from));
        if angle(&double) > 3.0 {
            continue;
        }
        let pull = law.potential(&law.tilt(&q, None), level);
        let step = 1e-5;
        for axis in 0..3 {
            let energy = |angle_by: f64| {
                let axis = Vector3::ith(axis, 1.0);
                potential_energy(angle(&turned(&double, axis, angle_by)), f64::from(level))
            };
            let slope = (energy(step) - energy(-step)) / (2.0 * step);
            let found = [pull.x, pull.y, 0.0][axis];
            assert!((f64::from(found) - slope).abs() < 1e-5, "{q:?} axis {axis}: {pull} and {slope}");
        }
    }
}

/// V' = -omega~_12 . D with the law's own torque, from the equations of a rigid body in double precision: any moments
/// of inertia, any spin, any turning of rho.
#[test]
fn the_energy_falls_by_the_damping_alone_whatever_the_spin() {
    let mut random = Random(4);
    for _ in 0..5_000 {
        let inertia = Vector3::new(0.007, 0.007 * random.between(0.7, 1.4), 0.012 * random.between(0.7, 1.1));
        let law = AttitudeLaw::new(&example::parameters(), &inertia);
        let (velocity, yaw) = (random.vector(15.0), random.signed() * 20.0);
        let (turning, acceleration) = (random.vector(6.0), random.vector(80.0));
        let tilt = law.tilt(&random.attitude(), None);
        let rate = (velocity - turning).xy();
        let (pull, damping) = (law.potential(&tilt, 0.3), law.damping(&tilt, &rate));
        let torque = law.torque(&acceleration) + law.gyroscopic(&turning, &velocity, &rate) - pull - damping;

        let [j, omega, r, a] = [inertia, velocity, turning, acceleration].map(|v| v.map(f64::from));
        let torque = Vector3::new(f64::from(torque.x), f64::from(torque.y), f64::from(yaw));
        let accelerated = (torque - omega.cross(&j.component_mul(&omega))).component_div(&j);
        let change = accelerated - (a - omega.cross(&r));
        let error = omega - r;
        let kinetic = error.x * j.x * change.x + error.y * j.y * change.y;
        let [pull, damping, error] = [pull.map(f64::from), damping.map(f64::from), error.xy()];
        let (found, expected) = (kinetic + pull.dot(&error), -damping.dot(&error));
        assert!((found - expected).abs() < 2e-4 * (1.0 + expected.abs()), "{found} and {expected}");
    }
}

/// A body turned in steps about an axis of the desired frame, spinning about its own thrust axis meanwhile; each step's
/// angle and tilt.
fn swept(law: &AttitudeLaw, axis: Vector3<f64>, spin: f64, steps: i32, mut see: impl FnMut(f64, &Tilt, Vector2<f64>)) {
    let mut side = None;
    for step in 0..steps {
        let (theta, spun) = (0.002 * f64::from(step), 0.002 * f64::from(step) * spin);
        let about =
            |axis: Vector3<f64>, angle: f64| Quaternion::from_parts((0.5 * angle).cos(), axis * (0.5 * angle).sin());
        let twist = about(Vector3::z(), spun);
        let q = about(axis, theta) * twist;
        let tilt = law.tilt(&Quaternion::from_vector(q.as_vector().map(|x| x as f32)), side.as_ref());
        side = Some(tilt.side);
        let seen = Quaternion::from_imag(axis);
        see(theta, &tilt, (twist.conjugate() * seen * twist).imag().xy());
    }
}

#[test]
fn beyond_half_a_turn_the_way_back_stays_the_same_up_to_the_switch_and_then_is_the_other() {
    let (law, delta) = (law(), f64::from(example::parameters().delta));
    let switch = 4.0 * (1.0 + delta).atan();
    assert!(switch > core::f64::consts::PI + 0.015);
    for spin in [0.0, 1.0, -30.0] {
        for direction in 0..12 {
            let (sin, cos) = (f64::from(direction) * 30.0_f64.to_radians()).sin_cos();
            let mut before = (0.0, f64::MAX);
            swept(&law, Vector3::new(cos, sin, 0.0), spin, 1_650, |theta, tilt, axis| {
                let mrp = tilt.mrp.map(f64::from);
                let along = mrp.dot(&axis);
                assert!((mrp - axis * along).norm() < 2e-3, "{theta}: {mrp} along {axis}");
                let expected = if theta < switch { theta } else { theta - core::f64::consts::TAU };
                // Near the switch rounding decides.
                if (theta - switch).abs() > 2e-3 {
                    assert!((4.0 * along.atan() - expected).abs() < 2e-3, "{theta}: {along}");
                }
                let energy = potential_energy(4.0 * mrp.norm().atan(), 0.3);
                let jumped = along < 0.0 && before.0 > 0.0;
                assert!(!jumped || energy < before.1, "{theta}: {energy} after {}", before.1);
                before = (along, energy);
            });
            assert!(before.0 < 0.0, "it never switched");
        }
    }
}

#[test]
fn exactly_half_a_turn_at_the_start_is_turned_back_one_way_or_the_other() {
    let law = law();
    for q in [Quaternion::new(0.0, 1.0, 0.0, 0.0), Quaternion::new(0.0, 0.6, 0.8, 0.0)] {
        let tilt = law.tilt(&q, None);
        assert!((tilt.mrp.norm() - 1.0).abs() < 1e-3 && tilt.side.norm() > 0.0, "{tilt:?}");
    }
}

#[test]
fn damping_is_eased_beyond_small_angles_and_against_the_rate_error() {
    let (law, p) = (law(), example::parameters());
    let mut random = Random(5);
    for _ in 0..1_000 {
        let (q, rate) = (random.attitude(), random.vector(20.0).xy());
        let tilt = law.tilt(&q, None);
        let sine_squared = q.i * q.i + q.j * q.j;
        let eased = (1.0 + sine_squared / (p.r_0 * p.r_0)).powf(0.25);
        assert!((law.damping(&tilt, &rate) - rate * (p.k_omega_t / eased)).norm() < 1e-5 * rate.norm());
    }
}

#[test]
fn a_tilt_does_not_depend_on_the_quaternions_sign_or_length() {
    let law = law();
    let mut random = Random(6);
    for _ in 0..1_000 {
        let q = random.attitude();
        let (one, other) = (law.tilt(&q, None), law.tilt(&(q * -3.0), None));
        assert!((one.mrp - other.mrp).norm() < 1e-5 && (one.sine_squared - other.sine_squared).abs() < 1e-6);
        // It moves with the body's heading.
        let back = rotate_back(&q, &Vector3::z());
        let axis = Vector2::new(-back.y, back.x);
        assert!(axis.perp(&one.mrp).abs() < 1e-3, "{one:?} {back}");
    }
}
