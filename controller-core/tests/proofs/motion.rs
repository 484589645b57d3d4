//! How the desired frame moves: `DesiredFrame.v`, `ExactRates.v`, `SharpMotion.v`, and `SharpBound.v` at one state.

use super::{TRIALS, direction, near, signed};
use crate::support::Random;
use crate::support::coq::{Proofs, Value};
use controller_core::attitude_reference::{AngularMotion, DesiredAttitude, DirectionMotion, attitude_reference};
use controller_core::heading::Heading;
use nalgebra::{Vector2, Vector3};

const NOW: Value = Value::Number(0.0);

fn space(v: &Vector3<f32>) -> Value {
    let [x, y, z] = <[f32; 3]>::from(*v).map(f64::from);
    Value::record(&[("x", x), ("y", y), ("z", z)])
}

fn vector(value: &Value) -> Vector3<f64> {
    let Value::Record(fields) = value else { panic!("a vector") };
    Vector3::new(fields["x"].number(), fields["y"].number(), fields["z"].number())
}

fn all_near(found: &Vector3<f32>, proven: &Value, scale: f64, what: &str) {
    found.iter().zip(&vector(proven)).for_each(|(found, proven)| near(*found, *proven, scale, what));
}

/// A command and a heading that move, in the code and in the proofs.
struct Moving {
    command: [Vector3<f32>; 3],
    heading: Heading,
    desired: DesiredAttitude,
    turn: DirectionMotion,
    motion: AngularMotion,
    proofs: Proofs,
}

impl Moving {
    fn random(random: &mut Random) -> Self {
        let u = Vector3::new(0.0, 0.0, 9.81) + direction(random) * 6.0;
        let (u_1, u_2) = (direction(random) * 5.0, direction(random) * 20.0);
        let psi = random.within(-3.2, 3.2);
        let [rate, acceleration] = [0; 2].map(|_| 2.0 * signed(random));
        let heading = Heading::new(Vector2::new(psi.cos() as f32, psi.sin() as f32), rate, acceleration).unwrap();
        let proofs = Proofs::read("SharpMotion")
            .with(&[("t", 0.0), ("psi_2", f64::from(acceleration))])
            .with_value("psi", Value::Number(psi).moving())
            .with_value("psi_1", Value::Number(f64::from(rate)).moving())
            .with_value("u", space(&u).moving())
            .with_value("u_1", space(&u_1).moving())
            .with_value("u_2", space(&u_2));
        let [nu, nu_1, nu_2] = [proofs.value("nu", &[NOW]), proofs.value("nu_1", &[NOW]), proofs.value("nu_2", &[])];
        let proofs = proofs.with_value("nu", nu.moving()).with_value("nu_1", nu_1.moving()).with_value("nu_2", nu_2);
        let side = proofs.value("cross", &[proofs.value("rho", &[NOW]), proofs.value("upsilon", &[NOW])]);
        let desired = DesiredAttitude::new(&u, &heading);
        Self {
            command: [u, u_1, u_2],
            heading,
            desired,
            turn: desired.direction_motion(&u_1, &u_2),
            motion: desired.motion(&u_1, &u_2, &heading),
            proofs: proofs.with(&[("s", 0.0)]).with_value("side", side.moving()),
        }
    }

    /// What roundings of omega_d' are relative to.
    fn scale(&self) -> f64 {
        10.0 + 5.0 * f64::from(self.motion.acceleration.norm())
    }
}

#[test]
pub(super) fn the_desired_frame_and_its_rates_are_those_of_the_proofs() {
    let mut random = Random(14);
    for _ in 0..TRIALS / 20 {
        let moving = Moving::random(&mut random);
        let (proofs, [u, u_1, u_2]) = (&moving.proofs, &moving.command);
        let at_t = |name: &str| proofs.value(name, &[NOW]);
        let scale = moving.scale();

        // The frame, column by column, and by its three turns.
        for (axis, standing) in
            [Vector3::x(), Vector3::y(), Vector3::z()].iter().zip(["upsilon s =", "side s =", "rho s ="])
        {
            for column in proofs.sides_of("three_turns", standing) {
                all_near(&moving.desired.turned(axis), &column, 1.0, standing);
            }
        }

        // The paper's omega_d and omega_d'.
        let reference = attitude_reference(u, u_1, u_2, &moving.heading);
        all_near(&reference.angular_velocity, &at_t("omega"), 10.0, "omega_d");
        all_near(&reference.angular_acceleration, &proofs.value("omega_1", &[]), scale, "omega_d'");

        // The same by yaw, pitch and roll.
        near(moving.desired.yaw_rate(&moving.turn.rate, &moving.heading), at_t("yaw_rate").number(), 10.0, "yaw");
        let AngularMotion { velocity, acceleration } = moving.motion;
        for (found, theorem, standing) in [
            (velocity.y, "tilting_exact", "y ( omega t ) = along_x"),
            (velocity.x, "tilting_exact", "x ( omega t ) = - along_y"),
            (acceleration.x, "tilting_exact", "x omega_1 ="),
            (acceleration.y, "tilting_exact", "y omega_1 ="),
            (acceleration.z, "yaw_acceleration_exact", "z omega_1 ="),
            (velocity.z, "yaw_rate_exact", "="),
        ] {
            proofs.sides(theorem, standing).iter().for_each(|proven| near(found, *proven, scale, standing));
        }
    }
}

#[test]
pub(super) fn how_the_thrust_direction_and_the_heading_turn_is_that_of_the_proofs() {
    let mut random = Random(15);
    for _ in 0..TRIALS {
        let Moving { command: [u, u_1, _], heading, desired, turn, proofs, .. } = Moving::random(&mut random);
        let n = proofs.number("n", &[]);
        near(turn.magnitude, n, 10.0, "n");
        let at_instant = proofs.clone().with_value("rho", proofs.value("rho", &[NOW]));
        near(turn.radial_rate, at_instant.number("radial", &[]), 10.0, "r");
        let p = proofs.value("tangential", &[space(&u_1)]).number();
        near(turn.rate.norm() * turn.magnitude, p, 10.0, "p");
        let turned = proofs.value("direction_rate", &[space(&u), space(&u_1)]);
        all_near(&desired.turned(&Vector3::new(turn.rate.x, turn.rate.y, 0.0)), &turned, 10.0, "rho'");
        near(desired.up().z, proofs.number("cos_tilt", &[]), 1.0, "cos gamma");
        near(desired.up().xy().norm(), proofs.number("sin_tilt", &[]), 1.0, "sin gamma");
        let [cos_pitch, sin_pitch, sin_roll] =
            ["cos_pitch", "sin_pitch", "sin_roll"].map(|name| proofs.value(name, &[NOW]).number());
        let angles = Proofs::read("SharpBound").with(&[("cos_pitch", cos_pitch), ("sin_pitch", sin_pitch)]);
        let angles = angles.with(&[("sin_roll", sin_roll)]);
        near(desired.up().x, angles.number("uphill_x", &[]), 1.0, "uphill");
        near(desired.up().y, angles.number("uphill_y", &[]), 1.0, "uphill");

        // Formulas of nu' and nu'', in the code the other way round.
        let [nu, nu_1, nu_2] = [proofs.value("nu", &[NOW]), proofs.value("nu_1", &[NOW]), proofs.value("nu_2", &[])]
            .map(|nu| vector(&nu).xy().cast::<f32>());
        let found = Heading::from_derivatives(nu, nu_1, nu_2).unwrap();
        near(found.rate(), f64::from(heading.rate()), 10.0, "psi'");
        near(found.acceleration(), f64::from(heading.acceleration()), 10.0, "psi''");
    }
}

#[test]
pub(super) fn the_parts_of_the_sharp_bound_are_those_of_the_proofs() {
    let mut random = Random(16);
    for _ in 0..TRIALS {
        let moving = Moving::random(&mut random);
        let Moving { turn, motion, heading, proofs, .. } = &moving;
        let angles = ["cos_pitch", "sin_pitch", "cos_roll", "sin_roll"];
        let angles = angles.map(|name| (name, proofs.value(name, &[NOW]).number()));
        let tilt = ["cos_tilt", "sin_tilt"].map(|name| (name, proofs.number(name, &[])));
        let [omega_1, omega_2] = [motion.velocity.x, motion.velocity.y].map(f64::from);
        let along = f64::from(turn.radial_rate / turn.magnitude);
        // u'' and u' over n, along body x and y.
        let w = turn.acceleration + turn.rate * (2.0 * turn.radial_rate / turn.magnitude);
        let [w, p] = [w, turn.rate].map(|v| v.cast::<f64>());
        let state = Proofs::read("SharpBound").with(&angles).with(&tilt).with(&[
            ("omega_1", omega_1),
            ("omega_2", omega_2),
            ("psi_1", f64::from(heading.rate())),
            ("psi_2", f64::from(heading.acceleration())),
            ("along", along),
            ("stretch", along.abs()),
            ("w_x", w.x),
            ("w_y", w.y),
            ("v_x", p.x),
            ("v_y", p.y),
        ]);
        // The part across the slope: as long as its premise has it.
        let uphill = [state.number("uphill_x", &[]), state.number("uphill_y", &[])];
        let across = |v: &Vector2<f64>| (uphill[0] * v.y - uphill[1] * v.x).abs() / tilt[1].1;
        let state = state.with(&[("across", across(&w)), ("perp", across(&p))]);
        let [turned, most] = state.sides("mixed_bound", "Rabs ( uphill_y * v_x ) <=")[..] else { panic!("two sides") };
        assert!(turned <= most, "{turned} above {most}");
        let length = state.number("plane_length", &[omega_1, omega_2]);
        let state = state.with(&[("mixed", most / tilt[1].1), ("length", length)]);

        let scale = moving.scale();
        near(motion.velocity.z, state.number("omega_3", &[]), scale, "omega_d3");
        for (found, name) in motion.acceleration.iter().zip(["rate_1", "rate_2", "rate_3"]) {
            near(*found, state.bound("sharp_bound", name), scale, name);
        }
        let [square, _] = state.sides("sharp_rate_bound", "<=")[..] else { panic!("two sides") };
        near(motion.velocity.norm(), square.sqrt(), scale, "|omega_d|");
        let [square, _] = state.sides("sharp_bound", "<= square_of_sum")[..] else { panic!("two sides") };
        near(motion.acceleration.norm(), square.sqrt(), scale, "|omega_d'|");
        for (theorem, holds) in [
            ("sharp_bound", "<= square_of_sum"),
            ("sharp_rate_bound", "<="),
            ("yaw_rate_bound", "Rabs omega_3 <="),
            ("tilting_part", "<= tilting_bound"),
            ("yawing_part", "Rabs ( yawing along ) <="),
        ] {
            let sides = state.sides(theorem, holds);
            assert!(sides.is_sorted(), "{theorem}: {sides:?}");
        }
    }
}
