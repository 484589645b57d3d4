//! The extended law's flows: `Limiter.v`, `Envelope.v`, `Damping.v`, `Attitude.v`, `Descent.v`.

use super::tick::{certificate, field, row};
use super::{TRIALS, constants, direction, lifted, near, of, plane, same, signed};
use crate::support::coq::{Proofs, Value};
use crate::support::{Random, hummingbird};
use controller_core::attitude_reference::Turn;
use controller_core::certificate::form::ARITHMETIC_ALLOWANCE;
use controller_core::extended::attitude::{AttitudeFeedback, AttitudeLaw};
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::extended::turning::{Circumstances, Limited, TurningLimit};
use controller_core::path_lifting::switching_magnitude;
use nalgebra::{Vector2, Vector3};

/// The potential's constants.
pub(super) fn potential(p: &ExtendedParameters) -> Vec<(&'static str, f64)> {
    of(&[("w", p.w), ("eta", p.eta), ("M_t", p.m_t), ("k_t", p.k_t), ("eta_t", p.eta_t)])
}

#[test]
pub(super) fn the_potential_and_the_share_of_damping_are_those_of_the_proofs() {
    let p = constants();
    let law = AttitudeLaw::new(&p, &hummingbird::vehicle().inertia);
    let (level, greatest) = (f64::from(p.m_all), row(&certificate(), "D potential").required);
    let mut random = Random(1);
    let mut cut = 0;
    for _ in 0..TRIALS {
        let q = lifted(&mut random);
        let rate = direction(&mut random) * 30.0;
        let feedback = law.feedback(&q, &rate);
        let [q_0, q_1, q_2, q_3] = [q.w, q.i, q.j, q.k].map(f64::from);
        let attitude = Proofs::read("Attitude").with(&potential(&p)).with(&[
            ("q_0", q_0),
            ("q_1", q_1),
            ("q_2", q_2),
            ("q_3", q_3),
        ]);
        let proven = [
            attitude.number("P_1", &[q_0, q_1, q_2, q_3]),
            attitude.number("P_2", &[q_0, q_1, q_2, q_3]),
            attitude.number("P_3", &[q_0, q_3]),
        ];
        for (found, proven) in feedback.potential.iter().zip(proven) {
            near(*found, proven, level, "potential");
        }
        let [tilt, most] = attitude.sides("tilt_level", "<= w / 2 * r")[..] else { panic!("two sides") };
        near(feedback.potential.xy().norm(), tilt, level, "|P|");
        assert!(tilt <= most && most <= greatest, "{tilt} {most} {greatest}");
        let [yaw, most] = attitude.sides("yaw_level", "<= w * eta / 2")[..] else { panic!("two sides") };
        near(feedback.potential.z.abs(), yaw, level, "|P_3|");
        assert!(yaw <= most);

        let eased = (1.0 + (q.i * q.i + q.j * q.j) / (p.r_0 * p.r_0)).powf(0.25);
        let wanted = rate.xy() * (p.k_omega_t / eased);
        let damping = Proofs::read("Damping").with(&of(&[
            ("p_1", feedback.potential.x),
            ("p_2", feedback.potential.y),
            ("d_1", wanted.x),
            ("d_2", wanted.y),
            ("level", p.m_all),
        ]));
        let share = damping.number("share", &[]);
        cut += usize::from(share < 1.0);
        near(feedback.damping.x, share * f64::from(wanted.x), level, "damping");
        near(feedback.damping.y, share * f64::from(wanted.y), level, "damping");
        let [square, _] = damping.sides("feedback_within_level", "<= level * level")[..] else { panic!("two sides") };
        near(feedback.tilt(), square.sqrt(), level, "|P + lambda D|");

        // Damping is a share of each rate that is not negative.
        let falls = Proofs::read("Descent")
            .with(&[("lambda", share), ("t", 0.0)])
            .with(&of(&[("c", p.k_omega_t / eased), ("factor", feedback.damping.z / rate.z)]))
            .with(&of(&[("d_1", feedback.damping.x), ("d_2", feedback.damping.y), ("d_3", feedback.damping.z)]))
            .with_value("e_1", Value::Number(f64::from(rate.x)).moving())
            .with_value("e_2", Value::Number(f64::from(rate.y)).moving())
            .with_value("e_3", Value::Number(f64::from(rate.z)).moving());
        for premise in ["d_1 = lambda", "d_2 = lambda", "d_3 = factor"] {
            let [found, proven] = falls.sides("no_rise", premise)[..] else { panic!("two sides") };
            near(found as f32, proven, level, premise);
        }
        for holds in ["0 <= lambda", "0 <= c", "0 <= factor", "<= 0"] {
            assert!(falls.sides("no_rise", holds).is_sorted(), "{holds}");
        }
    }
    assert!(cut > TRIALS / 20 && cut < TRIALS, "{cut} of {TRIALS} with a share");
}

fn limited(limit: &TurningLimit, turn: &Turn, most: f32, yaw_rate: f32, vertical: [f32; 3]) -> Limited {
    limit.limited(turn, &Circumstances { budget: most, yaw_rate, up: Vector3::z(), greatest: 30.0, vertical })
}

#[test]
pub(super) fn the_limiter_is_that_of_the_proofs() {
    let p = constants();
    let (period, most) = (0.01_f32, 40.0_f32.max(p.turn_reserve));
    let limit = TurningLimit::new(&p, period);
    let mut random = Random(3);
    let mut cut = 0;
    for _ in 0..TRIALS {
        // Shorter than the first step allows, and upright: steps one and two do nothing.
        let wanted = Vector2::new(signed(&mut random), signed(&mut random)) * (0.4 * most);
        let rate = Vector2::new(signed(&mut random), signed(&mut random)) * p.turn_rate;
        let yaw_rate = signed(&mut random) * 12.0;
        let turn = Turn { rate, acceleration: wanted, magnitude: 9.81, radial_rate: 0.0, radial_acceleration: 0.0 };
        let found = limited(&limit, &turn, most, yaw_rate, [0.0; 3]);
        let proofs = Proofs::read("Limiter")
            .with(&of(&[("yaw_rate", yaw_rate), ("period", period), ("rate_max", p.turn_rate), ("most", most)]))
            .with_value("rate", plane(&rate))
            .with_value("wanted", plane(&wanted));
        let proven = proofs.value("limited", &[]);
        cut += usize::from(found.acceleration != wanted);
        // Divided by the period, a rounding of the rate counts a hundred times.
        near(found.acceleration.x, field(&proven, "x").number(), 10.0 * f64::from(most), "limited");
        near(found.acceleration.y, field(&proven, "y").number(), 10.0 * f64::from(most), "limited");
    }
    assert!(cut > TRIALS / 20, "{cut} of {TRIALS} limited");
}

/// y'' at the least, for y, y' and the limiter's k.
fn least(k: f32, y: f32, y_1: f32) -> f64 {
    let proofs = Proofs::read("Envelope")
        .with(&[("k", f64::from(k)), ("s", 0.0)])
        .with_value("y", Value::Number(f64::from(y)).moving())
        .with_value("y_1", Value::Number(f64::from(y_1)).moving())
        .with_value("y_2", Value::Number(0.0).moving());
    proofs.sides("stays_inside", "<= y_2 s")[0]
}

#[test]
pub(super) fn the_ends_of_u_are_those_of_the_proofs() {
    const FAR: f32 = 1e6;
    let p = constants();
    let limit = TurningLimit::new(&p, 0.01);
    let still = |magnitude, radial_rate, radial_acceleration| Turn {
        rate: Vector2::zeros(),
        acceleration: Vector2::zeros(),
        magnitude,
        radial_rate,
        radial_acceleration,
    };
    // c_z'' as limited, for y = c_z + A_-: far below U, where n has all room. It falls without end as wanted.
    let falling = |c: f32, c_rate: f32| {
        let found = limited(&limit, &still(-FAR, 0.0, 0.0), 40.0, 0.0, [c, c_rate, -FAR]);
        found.change.unwrap().z - FAR
    };
    // n'' as limited, for y = U - n: c_z'' is wanted far above its end.
    let swelling = |n: f32, rate: f32| {
        let found = limited(&limit, &still(n, rate, FAR), 40.0, 0.0, [0.0, 0.0, FAR]);
        found.change.unwrap().z + FAR
    };
    // The theorem holds for every k. A rate of one changes the limiter's end by twice its k.
    let k = -0.5 * falling(-p.a_down, 1.0);
    let mut random = Random(10);
    for _ in 0..TRIALS {
        let (y, rate) = (random.within(0.0, 10.0) as f32, 20.0 * signed(&mut random));
        near(falling(y - p.a_down, rate), least(k, y, rate), 5e4, "c_z''");
        near(swelling(30.0 - y, rate), -least(k, y, -rate), 5e4, "n''");
    }
}

#[test]
pub(super) fn the_torques_beside_the_feedback_are_those_of_the_proofs() {
    let inertia = hummingbird::vehicle().inertia;
    let law = AttitudeLaw::new(&constants(), &inertia);
    let mut random = Random(13);
    for _ in 0..TRIALS {
        let (rate, acceleration) = (direction(&mut random) * 20.0, direction(&mut random) * 100.0);
        let (potential, damping) = (direction(&mut random) * 0.1, direction(&mut random) * 0.1);
        let found = law.torque(&AttitudeFeedback { potential, damping }, &rate, &acceleration);
        let f = potential + damping;
        let proofs = Proofs::read("Attitude")
            .with(&of(&[("j_1", inertia.x), ("j_2", inertia.y), ("j_3", inertia.z)]))
            .with(&of(&[("r_1", rate.x), ("r_2", rate.y), ("r_3", rate.z)]))
            .with(&of(&[("a_1", acceleration.x), ("a_2", acceleration.y), ("a_3", acceleration.z)]))
            .with(&of(&[("f_1", f.x), ("f_2", f.y), ("f_3", f.z)]));
        for (found, name) in found.iter().zip(["tau_1", "tau_2", "tau_3"]) {
            near(*found, proofs.bound("feed_forward_cancels", name), 1.0, name);
        }
        let nothing = AttitudeFeedback { potential: Vector3::zeros(), damping: Vector3::zeros() };
        let found = law.torque(&nothing, &rate, &Vector3::zeros());
        let numbers = [inertia, rate].map(<[f32; 3]>::from).concat();
        let numbers: Vec<Value> = numbers.into_iter().map(|x| Value::Number(f64::from(x))).collect();
        let gyroscopic = Proofs::read("Budget").value("gyroscopic", &numbers);
        for (found, name) in found.iter().zip(["about_x", "about_y", "about_z"]) {
            near(*found, field(&gyroscopic, name).number(), 1.0, "gyroscopic");
        }
    }
}

#[test]
pub(super) fn the_certificates_rows_of_the_attitude_are_those_of_the_proofs() {
    let (p, certificate) = (constants(), certificate());
    let delta = Proofs::read("Mrp").with(&of(&[("delta", p.delta), ("a", 0.0)]));
    let q_bar = -delta.sides("switch_without_division", "<= a")[0];
    same(switching_magnitude::<f64>(p.delta), q_bar, "qbar");
    let proofs = Proofs::read("Attitude").with(&potential(&p)).with(&[("q_bar", q_bar)]);

    // Rows E.
    let raised = 1.0 + ARITHMETIC_ALLOWANCE;
    let [_, required, available] = proofs.sides("only_the_target", "q_bar < eta")[..] else { panic!("three sides") };
    let switch = row(&certificate, "E switch");
    same(switch.required, required * raised, "E switch");
    same(switch.available, available, "E switch");
    let [required, available] = proofs.sides("only_the_target", "2 * q_bar * M_t <")[..] else { panic!("two sides") };
    let tilt = row(&certificate, "E tilt");
    same(tilt.required, required * raised, "E tilt");
    same(tilt.available, available, "E tilt");

    // Row D: however many cells there are, the level is the greatest of theirs.
    let level = |cells: u32| {
        let cell = |near: u32| proofs.number("cell", &[near, near + 1].map(|end| f64::from(end) / f64::from(cells)));
        (0..cells).map(cell).fold(0.0, f64::max)
    };
    let row_d = row(&certificate, "D potential");
    let greatest = row_d.required / raised;
    let cells = (1..=256).find(|cells| (level(*cells) / greatest - 1.0).abs() < 1e-9);
    assert!(cells.is_some_and(|cells| cells >= 32), "{greatest} is the level of no number of cells: {cells:?}");
    let damping = Proofs::read("Damping").with(&[("p_1", greatest), ("p_2", 0.0), ("level", row_d.available)]);
    assert!(damping.sides("row_D", "0 < room").is_sorted());
    same(row_d.available, f64::from(p.m_all), "M_all");
}
