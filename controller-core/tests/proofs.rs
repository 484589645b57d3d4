//! What `proofs/` proves is what the code computes: each definition there against the function here, at random points.
//!
//! The definitions are read from the proofs themselves, so none is typed a second time.

use crate::support::coq::{Proofs, Value};
use crate::support::{Random, hummingbird};
use controller_core::attitude_reference::Turn;
use controller_core::configuration::LawParameters;
use controller_core::extended::attitude::AttitudeLaw;
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::extended::thrust_range::ThrustRange;
use controller_core::extended::turning::{Circumstances, TurningLimit};
use controller_core::mrp;
use controller_core::position::FilterTransition;
use nalgebra::{Matrix3, Quaternion, Vector2, Vector3};

const TRIALS: usize = 2_000;

fn constants() -> ExtendedParameters {
    let LawParameters::Extended(law) = *hummingbird::extended_law().law() else { panic!("the extended law") };
    *law.parameters
}

/// In [-1, 1).
fn signed(random: &mut Random) -> f32 {
    random.within(-1.0, 1.0) as f32
}

fn of(numbers: &[(&'static str, f32)]) -> Vec<(&'static str, f64)> {
    numbers.iter().map(|(name, x)| (*name, f64::from(*x))).collect()
}

fn unit_quaternion(random: &mut Random) -> Quaternion<f32> {
    let q = Quaternion::new(signed(random), signed(random), signed(random), signed(random));
    q / q.norm()
}

fn near(found: f32, proven: f64, scale: f64, what: &str) {
    assert!((f64::from(found) - proven).abs() <= 2e-5 * scale, "{what}: {found}, and {proven} in the proof");
}

#[test]
fn the_potential_and_the_share_of_damping_are_those_of_the_proofs() {
    let p = constants();
    let law = AttitudeLaw::new(&p, &hummingbird::vehicle().inertia);
    let attitude = Proofs::read("Attitude").with(&of(&[
        ("w", p.w),
        ("eta", p.eta),
        ("M_t", p.m_t),
        ("k_t", p.k_t),
        ("eta_t", p.eta_t),
    ]));
    let mut random = Random(1);
    let mut cut = 0;
    for _ in 0..TRIALS {
        let q = unit_quaternion(&mut random);
        // The lift keeps q_0 above the switching scalar.
        let q = if q.w < 0.0 { -q } else { q };
        let rate = Vector3::new(signed(&mut random), signed(&mut random), signed(&mut random)) * 30.0;
        let feedback = law.feedback(&q, &rate);
        let [q_0, q_1, q_2, q_3] = [q.w, q.i, q.j, q.k].map(f64::from);
        let proven = [
            attitude.number("P_1", &[q_0, q_1, q_2, q_3]),
            attitude.number("P_2", &[q_0, q_1, q_2, q_3]),
            attitude.number("P_3", &[q_0, q_3]),
        ];
        for (found, proven) in feedback.potential.iter().zip(proven) {
            near(*found, proven, f64::from(p.m_all), "potential");
        }
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
        near(feedback.damping.x, share * f64::from(wanted.x), f64::from(p.m_all), "damping");
        near(feedback.damping.y, share * f64::from(wanted.y), f64::from(p.m_all), "damping");
    }
    assert!(cut > TRIALS / 20 && cut < TRIALS, "{cut} of {TRIALS} with a share");
}

#[test]
fn the_thrust_range_is_that_of_the_proofs() {
    let (rotors, p) = (hummingbird::rotors(), constants());
    let thrust_max = 30.0;
    let range = ThrustRange::new(Some(&rotors), p.floor_margin, thrust_max);
    let mut random = Random(2);
    let record = |v: &Vector3<f64>| Value::record(&[("about_x", v.x), ("about_y", v.y), ("about_z", v.z)]);
    for _ in 0..TRIALS {
        let torque = Vector3::new(signed(&mut random), signed(&mut random), 0.1 * signed(&mut random));
        let scale = random.within(0.9, 1.15) as f32;
        let proofs = Proofs::read("Allocation")
            .with(&[("s", f64::from(scale)), ("margin", f64::from(p.floor_margin))])
            .with_record("tau", record(&torque.cast()));
        let (mut floor, mut ceiling) = (f64::from(p.floor_margin), f64::from(thrust_max));
        for (rotor, row) in rotors.iter().zip(rotors.pseudo_inverse()) {
            let beta = Vector3::new(row.y, row.z, row.w) / row.x;
            let Value::Record(mut fields) = Value::record(&[
                ("b", row.x),
                ("least", f64::from(rotor.thrust_min)),
                ("greatest", f64::from(rotor.thrust_max)),
            ]) else {
                unreachable!()
            };
            fields.insert("beta".to_owned(), record(&beta));
            let rotor = Value::Record(fields);
            floor = floor.max(proofs.value("needs", std::slice::from_ref(&rotor)).number());
            ceiling = ceiling.min(proofs.value("gives", std::slice::from_ref(&rotor)).number());
        }
        near(range.least(&torque, scale), floor, 10.0, "floor");
        near(range.greatest(&torque, scale), ceiling, 10.0, "ceiling");
    }
}

#[test]
fn the_limiter_is_that_of_the_proofs() {
    let p = constants();
    let (period, most) = (0.01_f32, 40.0_f32.max(p.turn_reserve));
    let limit = TurningLimit::new(&p, period);
    let mut random = Random(3);
    let record = |v: &Vector2<f32>| Value::record(&[("x", f64::from(v.x)), ("y", f64::from(v.y))]);
    let mut limited = 0;
    for _ in 0..TRIALS {
        // Shorter than the first step allows, and upright: steps one and two do nothing.
        let wanted = Vector2::new(signed(&mut random), signed(&mut random)) * (0.4 * most);
        let rate = Vector2::new(signed(&mut random), signed(&mut random)) * p.turn_rate;
        let yaw_rate = signed(&mut random) * 12.0;
        let turn = Turn { rate, acceleration: wanted, magnitude: 9.81, radial_rate: 0.0, radial_acceleration: 0.0 };
        let found = limit.limited(
            &turn,
            &Circumstances { budget: most, yaw_rate, up: Vector3::z(), greatest: 30.0, vertical: [0.0; 3] },
        );
        let proofs = Proofs::read("Limiter")
            .with(
                &[("yaw_rate", yaw_rate), ("period", period), ("rate_max", p.turn_rate), ("most", most)]
                    .map(|(name, x)| (name, f64::from(x))),
            )
            .with_record("rate", record(&rate))
            .with_record("wanted", record(&wanted));
        let Value::Record(fields) = proofs.value("limited", &[]) else { panic!("a plane vector") };
        limited += usize::from(found.acceleration != wanted);
        // Divided by the period, a rounding of the rate counts a hundred times.
        near(found.acceleration.x, fields["x"].number(), 10.0 * f64::from(most), "limited");
        near(found.acceleration.y, fields["y"].number(), 10.0 * f64::from(most), "limited");
    }
    assert!(limited > TRIALS / 20, "{limited} of {TRIALS} limited");
}

#[test]
fn the_filters_are_those_of_the_proofs() {
    let proofs = Proofs::read("Filters");
    let mut random = Random(4);
    for _ in 0..TRIALS {
        let (f, s, h) =
            (random.within(0.3, 20.0) as f32, random.within(0.5, 40.0) as f32, random.within(0.001, 0.02) as f32);
        let transition = FilterTransition::new(f, s, h).unwrap();
        let [f, s, h] = [f, s, h].map(f64::from);
        let a = f * ((-f * h).exp() - (-s * h).exp()) / (s - f);
        let [u_f, u_s, ubar] = [0; 3].map(|_| 4.0 * signed(&mut random));
        let (filtered, intermediate) = transition.advance_axis(u_f, u_s, ubar);
        let [u_f, u_s, ubar] = [u_f, u_s, ubar].map(f64::from);
        let weight = 1.0 - (-f * h).exp() - a;
        near(filtered, proofs.number("filtered_next", &[a, weight, u_f, u_s, ubar]), 1.0, "u_f");
        near(intermediate, proofs.number("intermediate_next", &[1.0 - (-s * h).exp(), u_s, ubar]), 1.0, "u_s");
    }
}

#[test]
fn rotations_and_parameters_are_those_of_the_proofs() {
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
