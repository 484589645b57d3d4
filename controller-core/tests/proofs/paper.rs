//! The paper's law: `Filters.v`, `Mrp.v`, `Torque.v`.

use super::{TRIALS, as_f64, direction, lifted, near, same, signed, unit_quaternion};
use crate::support::coq::Proofs;
use crate::support::{Random, hummingbird};
use controller_core::attitude::AttitudeLaw;
use controller_core::certificate::Certificate;
use controller_core::certificate::form::{ARITHMETIC_ALLOWANCE, Form};
use controller_core::certificate::inequality::Inequality;
use controller_core::configuration::Configuration;
use controller_core::heading::Heading;
use controller_core::mrp;
use controller_core::path_lifting::{self, Lift};
use controller_core::position::{FilterState, FilterTransition, PositionLaw};
use controller_core::reference::Reference;
use controller_core::state::State;
use nalgebra::{Matrix3, Vector3};

#[test]
pub(super) fn the_filters_are_those_of_the_proofs() {
    let mut random = Random(4);
    for _ in 0..TRIALS {
        let (f, s, h) =
            (random.within(0.3, 20.0) as f32, random.within(0.5, 40.0) as f32, random.within(0.001, 0.02) as f32);
        let transition = FilterTransition::new(f, s, h).unwrap();
        let proofs = Proofs::read("Filters").with(&as_f64(&[("f", f), ("s", s), ("h", h)]));
        let a = proofs.bound("weights_of_the_exact_solution", "a");
        let b = proofs.bound("weights_of_the_exact_solution", "whole") - a;
        let [_, c, _] = proofs.sides("weights_of_the_exact_solution", "<= 1 - exp")[..] else { panic!("0 to 1") };
        let [u_f, u_s, ubar] = [0; 3].map(|_| 4.0 * signed(&mut random));
        let (filtered, intermediate) = transition.advance_axis(u_f, u_s, ubar);
        let [u_f, u_s, ubar] = [u_f, u_s, ubar].map(f64::from);
        near(filtered, proofs.number("filtered_next", &[a, b, u_f, u_s, ubar]), 1.0, "u_f");
        near(intermediate, proofs.number("intermediate_next", &[c, u_s, ubar]), 1.0, "u_s");

        // The rounded weights are such weights too: a, b and c are what one of u_s and ubar makes of zeros.
        let ((a, _), (b, c)) = (transition.advance_axis(0.0, 1.0, 0.0), transition.advance_axis(0.0, 0.0, 1.0));
        let proofs = proofs.with(&as_f64(&[("a", a), ("b", b), ("c", c)]));
        for premise in ["0 <= a", "0 <= b", "a + b <=", "0 <= c"] {
            assert!(proofs.sides("box_is_kept", premise).is_sorted(), "{premise}: {a} {b} {c}");
        }
    }
}

#[test]
pub(super) fn rotations_and_parameters_are_those_of_the_proofs() {
    let proofs = Proofs::read("Mrp");
    let mut random = Random(5);
    let entries = |matrix: &Matrix3<f32>, letter: &str, arguments: &[f64]| {
        for row in 1..=3 {
            for column in 1..=3 {
                let proven = proofs.number(&format!("{letter}_{row}{column}"), arguments);
                near(matrix[(row - 1, column - 1)], proven, 1.0, letter);
            }
        }
    };
    for _ in 0..TRIALS / 10 {
        let q = unit_quaternion(&mut random);
        let parts = [q.w, q.i, q.j, q.k].map(f64::from);
        entries(&mrp::rotation(&q), "R", &parts);
        let q = if q.w < 0.0 { -q } else { q };
        let theta = mrp::from_quaternion(&q);
        let phi = Proofs::read("Mrp").with(&[("a", f64::from(q.w))]);
        near(theta.x, phi.number("phi", &[f64::from(q.i)]), 1.0, "phi");
        let [x, y, z] = [theta.x, theta.y, theta.z].map(f64::from);
        entries(&mrp::to_rotation(&theta), "M", &[x, y, z]);
        let shadow = Proofs::read("Mrp").with(&[("x", x), ("y", y), ("z", z)]);
        let proven = shadow.number("shadow", &[x]);
        near(mrp::shadow(&theta).x, proven, proven.abs().max(1.0), "shadow");
    }
}

#[test]
pub(super) fn the_switch_is_that_of_the_proofs() {
    let mut random = Random(6);
    for _ in 0..TRIALS / 10 {
        let delta = random.magnitude(1e-3, 0.5) as f32;
        let proofs = Proofs::read("Mrp").with(&as_f64(&[("delta", delta), ("a", 0.0)]));
        let [proven, _] = proofs.sides("switch_without_division", "<= a")[..] else { panic!("two sides") };
        let scalar = path_lifting::switching_scalar(delta);
        near(scalar, proven, 1.0, "the switching scalar");

        // On either side of it.
        let axis = direction(&mut random).normalize();
        for (w, switches) in [(scalar + 1e-4, false), (scalar - 1e-4, true)] {
            let q = nalgebra::Quaternion::from_parts(w, axis * (1.0 - w * w).sqrt());
            let found = path_lifting::lift(Some(&Lift { memory: q, sign: 1.0 }), &q, scalar, 0.1);
            assert_eq!(found.lift.sign < 0.0, switches, "{w} about {scalar}");
            if switches {
                let sides = Proofs::read("Mrp").with(&as_f64(&[("delta", delta), ("a", w)]));
                let sides = sides.sides("switch_goes_inside", "<= / ( ( 1 + delta )");
                near(found.mrp.norm_squared(), sides[0], 1.0, "|phi| after the switch");
                assert!(sides.is_sorted());
            }
        }
    }
}

fn certified() -> (Configuration, [Form; 2]) {
    let configuration = hummingbird::paper_law();
    let Certificate::Paper(found) = Certificate::new(&configuration).unwrap() else { panic!("the paper's law") };
    (configuration, [found.printed, found.sharp])
}

fn row<'a>(form: &'a Form, name: &str) -> &'a Inequality {
    form.inequalities.iter().find(|row| row.name.starts_with(name)).unwrap()
}

#[test]
pub(super) fn the_torque_is_that_of_the_proofs() {
    let (configuration, [printed, _]) = certified();
    let (gains, inertia) = (*configuration.gains().unwrap(), configuration.vehicle().inertia);
    let law = AttitudeLaw::new(&gains, &inertia);
    let mut random = Random(7);
    for _ in 0..TRIALS {
        let (q, omega) = (lifted(&mut random), direction(&mut random) * 5.0);
        let (rate, acceleration) = (direction(&mut random) * 5.0, direction(&mut random) * 30.0);
        let found = law.command(&q, 1.0, &omega, &rate, &acceleration);
        let theta = mrp::from_quaternion(&q);
        let saturated = |x: &Vector3<f32>, gain: f32, level: f32| {
            let proofs =
                Proofs::read("Torque").with(&as_f64(&[("M", level), ("k", gain), ("x", x.x), ("y", x.y), ("z", x.z)]));
            let whole = proofs.number("square", &<[f64; 3]>::from(x.map(f64::from)));
            let arguments = |component: f32| [level, gain, component].map(f64::from);
            let part = |component| {
                let [level, gain, component] = arguments(component);
                proofs.number("saturated", &[level, gain, component, whole])
            };
            (x.map(part), proofs.sides("saturation_level", ") < M"))
        };
        let (s_theta, length) = saturated(&theta, gains.k_theta, gains.m_theta);
        let (s_omega, _) = saturated(&found.angular_velocity_error, gains.k_omega, gains.m_omega);
        near(found.attitude_feedback.norm(), length[0], length[1], "the feedback's length");
        let (r, a) = (mrp::rotation(&q).transpose() * rate, mrp::rotation(&q).transpose() * acceleration);
        for axis in 0..3 {
            near(found.attitude_feedback[axis], s_theta[axis], f64::from(gains.m_theta), "s_theta");
            near(found.rate_feedback[axis], s_omega[axis], f64::from(gains.m_omega), "s_omega");
            let [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
            let numbers = as_f64(&[
                ("j", inertia[axis]),
                ("j_next", inertia[next]),
                ("j_last", inertia[last]),
                ("delta", gains.delta),
                ("M_theta", gains.m_theta),
                ("M_omega", gains.m_omega),
                ("theta_square", theta.norm_squared()),
                ("s_theta", found.attitude_feedback[axis]),
                ("s_omega", found.rate_feedback[axis]),
                ("r_2", r[next]),
                ("r_3", r[last]),
                ("a_1", a[axis]),
            ]);
            let bounds = [("U", printed.rates.angular_velocity), ("U_1", printed.rates.angular_acceleration)];
            let sides = Proofs::read("Torque").with(&numbers).with(&bounds).sides("torque_bound", "Rabs ( j * a_1");
            near(found.torque[axis].abs(), sides[0], 1.0, "|tau|");
        }
    }
}

#[test]
pub(super) fn the_certificates_thrust_and_torque_are_those_of_the_proofs() {
    let (configuration, [printed, sharp]) = certified();
    let (gains, vehicle) = (*configuration.gains().unwrap(), *configuration.vehicle());
    let raised = 1.0 + ARITHMETIC_ALLOWANCE;
    let [m_theta, m_omega, delta] = [gains.m_theta, gains.m_omega, gains.delta].map(f64::from);
    let torque = Proofs::read("Torque");
    same(printed.feedback_torque, torque.number("iota", &[m_theta, m_omega, delta]), "iota");
    assert!(sharp.feedback_torque < printed.feedback_torque);
    let j = vehicle.inertia.map(f64::from);
    for (axis, name) in ["T2 roll", "T2 pitch", "T2 yaw"].iter().enumerate() {
        let [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
        let (velocity, acceleration) = (printed.rates.angular_velocity, printed.rates.angular_acceleration);
        let arguments = [j[axis], j[next], j[last], velocity, acceleration, m_theta, m_omega, delta];
        let proven = torque.number("torque_max", &arguments) * raised;
        same(printed.torque[axis], proven, name);
        same(row(&printed, name).required, proven, name);
        assert!(sharp.torque[axis] <= proven);
    }

    let bounds = *configuration.bounds();
    let law = PositionLaw::new(&gains, vehicle.gravity);
    let levels = as_f64(&[
        ("g", vehicle.gravity),
        ("M", gains.m_p),
        ("K_12", bounds.horizontal_acceleration),
        ("K_3", bounds.vertical_acceleration),
        ("m", vehicle.mass),
    ]);
    let mut random = Random(8);
    for _ in 0..TRIALS {
        let f = direction(&mut random) * gains.m_p;
        let (across, vertical) = (bounds.horizontal_acceleration, bounds.vertical_acceleration);
        let a = direction(&mut random).component_mul(&Vector3::new(0.7 * across, 0.7 * across, vertical));
        let mut reference = Reference::resting(Vector3::zeros(), Heading::FORWARD);
        reference.acceleration = a;
        let zero = Vector3::zeros();
        let state = State {
            position: zero,
            velocity: zero,
            attitude: nalgebra::Quaternion::identity(),
            angular_velocity: zero,
        };
        let filter = FilterState { filtered: f, intermediate: f };
        let u = law.command(&state, &reference, &filter).acceleration_command;
        let proofs = Proofs::read("Filters").with(&levels).with(&as_f64(&[
            ("f_1", f.x),
            ("f_2", f.y),
            ("f_3", f.z),
            ("a_1", a.x),
            ("a_2", a.y),
            ("a_3", a.z),
        ]));
        let sides = proofs.sides("thrust_interval", "<= T <=");
        near(vehicle.mass * u.norm(), sides[1], 10.0, "T = m |u|");
        assert!(sides.is_sorted());
        same(sharp.thrust.min * raised, sides[0], "the least thrust");
        same(sharp.thrust.max / raised, sides[2], "the greatest thrust");
        let wider = proofs.sides("thrust_interval_as_printed", "<= T <=");
        assert!(sides[0] == wider[0] && sides[2] <= wider[2]);
        same(printed.thrust.min * raised, wider[0], "the least thrust as printed");
        same(printed.thrust.max / raised, wider[2], "the greatest thrust as printed");
    }
    let left = Proofs::read("Filters").with(&levels).sides("hover_is_left", "M + K_3 <");
    let level = row(&sharp, "T1 saturation level");
    same(level.available - level.required, left[1] - left[0], "what is left of g");
}
