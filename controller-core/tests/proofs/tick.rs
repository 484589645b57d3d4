//! A tick of the extended law, from the budget to the rotors: `Allocation.v`, `Budget.v`, `Tick.v`, the budget of
//! `Limiter.v`.

use super::extended::potential;
use super::{TRIALS, constants, direction, extended_law, near, of, rotors, same, signed, torque, unit_quaternion};
use crate::support::coq::{Proofs, Value};
use crate::support::gappa::Rounding;
use crate::support::{Random, hummingbird};
use controller_core::allocation::{MinimumNorm, Rotors};
use controller_core::attitude::rotate_back;
use controller_core::certificate::Certificate;
use controller_core::certificate::extended::ExtendedCertificate;
use controller_core::certificate::form::ARITHMETIC_ALLOWANCE;
use controller_core::certificate::inequality::Inequality;
use controller_core::extended::attitude::{AttitudeFeedback, AttitudeLaw};
use controller_core::extended::budget::{RATE_BEYOND, TorqueBudget, TurningBudget};
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::extended::thrust_range::ThrustRange;
use controller_core::mrp;
use controller_core::state::Wrench;
use nalgebra::Vector3;

/// The rotors as the proofs have them.
fn rotors_of(rotors: &Rotors) -> Vec<Value> {
    let all = rotors.iter().zip(rotors.pseudo_inverse()).map(|(rotor, row)| {
        let ends = [rotor.thrust_min, rotor.thrust_max].map(f64::from);
        let numbers = Value::record(&[("b", row.x), ("least", ends[0]), ("greatest", ends[1])]);
        let Value::Record(mut fields) = numbers else { unreachable!() };
        fields.insert("beta".to_owned(), torque(&(Vector3::new(row.y, row.z, row.w) / row.x)));
        Value::Record(fields)
    });
    all.collect()
}

pub(super) fn field<'a>(record: &'a Value, name: &str) -> &'a Value {
    let Value::Record(fields) = record else { panic!("a record") };
    &fields[name]
}

#[test]
pub(super) fn the_thrust_range_is_that_of_the_proofs() {
    let (rotors, p) = (rotors(), constants());
    let thrust_max = 30.0;
    let range = ThrustRange::new(Some(&rotors), p.floor_margin, thrust_max);
    let allocation = MinimumNorm::new(&rotors);
    let mut random = Random(2);
    let mut delivered = 0;
    for _ in 0..TRIALS {
        let tau = Vector3::new(signed(&mut random), signed(&mut random), 0.1 * signed(&mut random));
        let scale = random.within(0.9, 1.15) as f32;
        let proofs = Proofs::read("Allocation")
            .with(&of(&[("s", scale), ("margin", p.floor_margin), ("T_max", thrust_max)]))
            .with_value("tau", torque(&tau.cast()))
            .with_value("rotors", Value::List(rotors_of(&rotors)));
        near(range.least(&tau, scale), proofs.number("floor", &[]), 10.0, "floor");
        near(range.greatest(&tau, scale), proofs.number("ceiling", &[]), 10.0, "ceiling");
        let wanted = 40.0 * signed(&mut random);
        near(range.admitted(wanted, &tau, scale), proofs.number("thrust", &[f64::from(wanted)]), 10.0, "thrust");

        // What a rotor is commanded.
        let wrench = Wrench { thrust: 10.0 + 5.0 * signed(&mut random), torque: tau * 0.2 };
        let asked = allocation.allocate(&wrench).unwrap();
        delivered += usize::from(!asked.clipped);
        for (rotor, thrust) in rotors_of(&rotors).into_iter().zip(asked.thrusts).filter(|_| !asked.clipped) {
            let of = [rotor, Value::Number(f64::from(wrench.thrust)), torque(&wrench.torque.cast())];
            near(thrust, proofs.value("command", &of).number(), 10.0, "command");
        }
    }
    assert!(delivered > TRIALS / 4, "{delivered} of {TRIALS} within the rotors' ranges");
}

pub(super) fn budget() -> TorqueBudget {
    let configuration = extended_law();
    TorqueBudget::new(&constants(), configuration.vehicle(), configuration.limits(), configuration.rotors())
}

pub(super) fn certificate() -> ExtendedCertificate {
    let Certificate::Extended(found) = Certificate::new(&extended_law()).unwrap() else { panic!("the extended law") };
    found
}

pub(super) fn row<'a>(certificate: &'a ExtendedCertificate, name: &str) -> &'a Inequality {
    certificate.inequalities.iter().find(|row| row.name.starts_with(name)).unwrap()
}

#[test]
pub(super) fn the_budgets_rows_are_those_of_the_proofs() {
    let configuration = extended_law();
    let (p, rotors, limits) = (constants(), rotors_of(&rotors()), configuration.limits());
    let [j_1, j_2, j_3] = <[f64; 3]>::from(configuration.vehicle().inertia.map(f64::from));

    // What is fixed: the gyroscopic torque, yaw's feedback at its level, and A.
    let gyroscopic = Proofs::read("Budget")
        .with(&[("j_1", j_1), ("j_2", j_2), ("j_3", j_3)])
        .with(&of(&[("rate", p.turn_rate * RATE_BEYOND as f32), ("yaw_rate", p.yaw_rate)]))
        .with(&[("r_1", 0.0), ("r_2", 0.0), ("r_3", 0.0), ("across", f64::NAN)]);
    let across = ["Rabs ( j_3 - j_2 ) <=", "Rabs ( j_1 - j_3 ) <="]
        .map(|difference| gyroscopic.sides("gyroscopic_bound", difference)[0])
        .into_iter()
        .fold(0.0, f64::max);
    let gyroscopic = gyroscopic.with(&[("across", across)]);
    let gyro_tilt = gyroscopic.sides("gyroscopic_bound", "<= across * product")[1];
    let gyro_yaw = gyroscopic.sides("gyroscopic_bound", "<= Rabs ( j_1 - j_2 ) *")[1];
    let potential = Proofs::read("Attitude").with(&potential(&p)).with(&[("q_0", 1.0), ("q_3", 0.0)]);
    let damping =
        Proofs::read("Torque").with(&of(&[("M", p.m_omega_z), ("k", p.k_omega_z), ("x", 0.0), ("y", 0.0), ("z", 0.0)]));
    let feedback_yaw =
        potential.sides("yaw_level", "<= w * eta / 2")[1] + damping.sides("saturation_level", ") < M")[1];
    let acceleration = f64::from(p.yaw_acceleration);
    let fixed = Proofs::read("Budget")
        .with(&[("feedback_tilt", 0.0), ("feedback_yaw", feedback_yaw)])
        .with(&[("turning_tilt", j_1.max(j_2) * acceleration), ("turning_yaw", j_3 * acceleration)])
        .with(&[("gyro_tilt", gyro_tilt), ("gyro_yaw", gyro_yaw)])
        .with(&of(&[("bias_tilt", p.torque_tilt), ("bias_yaw", p.torque_yaw)]));

    // The right sides: of two rotors, of the floor, and the limits.
    let ends = Proofs::read("Allocation").with(&of(&[
        ("s_lo", p.scale_least),
        ("s_hi", p.scale_greatest),
        ("margin", p.floor_margin),
        ("T_max", limits.thrust_max),
    ]));
    let nothing = || torque(&Vector3::zeros());
    let (mut top, mut bottom) = (f64::INFINITY, 0.0_f64);
    let mut ends = ends.with(&[("range_top", 0.0), ("range_bottom", 0.0)]);
    for rotor in &rotors {
        ends = ends.with_value("r", rotor.clone()).with_value("r'", rotor.clone()).with_value("tau", nothing());
        top = top.min(ends.sides("range_top_least", "range_top <=")[1]);
        bottom = bottom.max(ends.sides("range_bottom_greatest", "<= range_bottom")[0]);
    }
    let ends = ends.with(&[("range_top", top), ("range_bottom", bottom)]);
    let both = ends.sides("rows_hold", "<= range_top - range_bottom")[1];
    let floor = ends.sides("rows_hold", "<= T_max - range_bottom")[1];

    let betas: Vec<Value> = rotors.iter().map(|rotor| field(rotor, "beta").clone()).collect();
    let pairs = betas.iter().flat_map(|a| betas.iter().map(move |b| [a.clone(), b.clone()]));
    let differences: Vec<Value> = pairs.map(|pair| ends.value("minus", &pair)).collect();
    let [roll, pitch, yaw] = <[f64; 3]>::from(limits.torque_max.map(f64::from));
    let axis = |axis: Vector3<f64>| vec![torque(&axis)];
    let rows = [(axis(Vector3::x()), roll.min(pitch)), (axis(Vector3::z()), yaw), (differences, both), (betas, floor)];
    let (budget, certificate) = (budget(), certificate());
    assert_eq!(budget.rows.len(), rows.len());
    for (found, name) in budget.fixed.iter().zip(["fixed_tilt", "fixed_yaw"]) {
        same(*found, of_tick(&p).number(name, &[]), name);
    }
    let mut fixed = fixed.with(&[("t", 0.0), ("y", 0.0), ("corner", 0.0)]);
    for zero in ["feedback", "turning", "gyro", "bias"] {
        fixed = fixed.with_value(zero, nothing());
    }
    let [reserve, all] = [p.turn_reserve, p.m_all].map(f64::from);
    let reserves = budget.reserves(all, reserve).zip(["T2 roll", "T2 yaw", "R ", "T1 thrust floor"]);
    for ((found, (directions, range)), (reserve_found, name)) in budget.rows.iter().zip(rows).zip(reserves) {
        let (mut t, mut y, mut corner) = (0.0_f64, 0.0_f64, 0.0_f64);
        for beta in directions {
            fixed = fixed.with_value("beta", beta);
            let left = |premise| fixed.sides("parts_add_up", premise)[0];
            t = t.max(left("tilt_length beta <= t"));
            y = y.max(left("Rabs ( about_z beta ) <= y"));
            corner = corner.max(left("<= corner"));
        }
        fixed = fixed.with(&[("t", t), ("y", y), ("corner", corner)]);
        let room = range - fixed.sides("parts_add_up", "corner * bias_tilt")[1];
        same(found.tilt, t, name);
        same(found.yaw, y, name);
        same(found.room, room, name);
        let tick = of_tick(&p).with(&[("t", t), ("y", y), ("feedback_max", all), ("reserve", reserve), ("room", room)]);
        same(found.room, tick.number("room", &[t, y, corner, range]), name);
        let sides = tick.sides("reserved", "feedback_max + inertia_tilt");
        same(reserve_found[0], sides[0], name);
        same(reserve_found[1], sides[1], name);
        // The certificate's row, with the reserve.
        let proofs = Proofs::read("Limiter")
            .with(&[("t", t), ("y", y), ("room", room), ("feedback_max", all), ("reserve", reserve)])
            .with(&[("inertia_tilt", j_1.max(j_2)), ("inertia_yaw", j_3)]);
        let sides = proofs.sides("reserve_keeps_the_row", "feedback_max + inertia_tilt");
        same(reserve_found[0], sides[0], name);
        same(reserve_found[1], sides[1], name);
        same(row(&certificate, name).required, sides[0] * (1.0 + ARITHMETIC_ALLOWANCE), name);
        same(row(&certificate, name).available, sides[1], name);
    }
}

/// A tick's constants.
fn of_tick(p: &ExtendedParameters) -> Proofs {
    let j = hummingbird::vehicle().inertia;
    let feedback_yaw = 0.5 * f64::from(p.w) * f64::from(p.eta) + f64::from(p.m_omega_z);
    Proofs::read("Tick")
        .with(&of(&[("j_1", j.x), ("j_2", j.y), ("j_3", j.z)]))
        .with(&of(&[("yaw_acceleration", p.yaw_acceleration), ("rate", p.turn_rate * RATE_BEYOND as f32)]))
        .with(&of(&[("yaw_rate", p.yaw_rate), ("bias_tilt", p.torque_tilt), ("bias_yaw", p.torque_yaw)]))
        .with(&[("feedback_yaw", feedback_yaw)])
}

/// R~ anywhere, and omega_d, omega_d' and the rest as great as they may be.
#[test]
pub(super) fn a_ticks_torque_is_that_of_the_proofs() {
    let (p, inertia) = (constants(), hummingbird::vehicle().inertia);
    let law = AttitudeLaw::new(&p, &inertia);
    let mut random = Random(14);
    for _ in 0..TRIALS {
        let error = unit_quaternion(&mut random);
        let mut long = |across: f32, along: f32| {
            let v = direction(&mut random).xy().normalize() * across;
            Vector3::new(v.x, v.y, along * signed(&mut random).signum())
        };
        let turn = 100.0;
        let omega = long(p.turn_rate * RATE_BEYOND as f32, p.yaw_rate);
        let omega_1 = long(turn, p.yaw_acceleration);
        let (feedback, bias) = (direction(&mut random) * 0.1, direction(&mut random) * 0.1);
        let (rate, acceleration) = (rotate_back(&error, &omega), rotate_back(&error, &omega_1));

        let columns = mrp::rotation(&error).cast::<f64>();
        let of_torque = |v: &Vector3<f32>| torque(&v.cast());
        let mut proofs = of_tick(&p).with(&of(&[("turn", turn)])).with_value("omega_1", of_torque(&omega_1));
        for (name, place) in [("c_1", 0), ("c_2", 1), ("c_3", 2)] {
            proofs = proofs.with_value(name, torque(&columns.column(place).into()));
        }
        let turned = proofs.value("turned_back", &[of_torque(&omega)]);
        let asked = [-feedback, omega, omega_1, -bias].map(|v| of_torque(&v));
        let proven = proofs.value("tick_torque", &asked);
        let parts = AttitudeFeedback { potential: feedback, damping: Vector3::zeros() };
        let found = law.torque(&parts, &rate, &acceleration) - bias;
        for (axis, name) in ["about_x", "about_y", "about_z"].into_iter().enumerate() {
            near(rate[axis], field(&turned, name).number(), 20.0, "R~^T omega_d");
            near(found[axis], field(&proven, name).number(), 10.0, "tau");
        }

        // The bounds, with the sine of the angle from b to rho.
        let sine = proofs.clone().with(&[("sine", 0.0)]).sides("torque_of_turning", "tilt_length c_3 <=")[0];
        let proofs = proofs.with(&[("sine", sine)]).with_value("omega", of_torque(&omega));
        let bounds = [
            ("torque_of_turning", "tilt_length ( with_inertia"),
            ("torque_of_turning", "Rabs ( about_z ( with_inertia"),
            ("torque_of_rates", "tilt_length ( turned_gyroscopic"),
            ("torque_of_rates", "Rabs ( about_z ( turned_gyroscopic"),
        ];
        for (theorem, bound) in bounds {
            assert!(proofs.sides(theorem, bound).is_sorted(), "{bound} {error}");
        }
        let [r_1, r_2, r_3] = <[f32; 3]>::from(rate);
        let sides = Proofs::read("Budget")
            .with(&of(&[("r_1", r_1), ("r_2", r_2), ("r_3", r_3)]))
            .with(&of(&[("rate", p.turn_rate * RATE_BEYOND as f32), ("yaw_rate", p.yaw_rate)]))
            .sides("gyroscopic_bound", "+ r_3 * r_3 <=");
        near(sides[0] as f32, sides[1], sides[1], "|omega_d|");
    }
}

#[test]
pub(super) fn the_budget_of_a_tick_is_that_of_the_proofs() {
    let (budget, mass, p) = (budget(), hummingbird::vehicle().mass, constants());
    // Thrust enough for any turn: the rows decide.
    let turning = TurningBudget::new(&budget, mass, f32::MAX);
    let spent = |feedback: f32, sine: f32| f64::from(turning.acceleration(1e6, feedback, sine));
    let sides = |feedback: f32, sine: f32, left: f64, alpha: f64, holds: &str| {
        let [inertia_tilt, inertia_yaw] = budget.inertia;
        let sides = budget.rows.iter().map(|row| {
            let proofs = Proofs::read("Limiter")
                .with(&[("t", row.tilt), ("y", row.yaw), ("room", left * row.room), ("alpha", alpha)])
                .with(&[("inertia_tilt", inertia_tilt), ("inertia_yaw", inertia_yaw)])
                .with(&of(&[("feedback", feedback), ("sine", sine)]));
            proofs.sides("budget_keeps_the_row", holds)
        });
        sides.collect::<Vec<_>>()
    };
    // The sides at alpha = 1 are a row's cost and what is left of its room.
    let least = |sides: Vec<Vec<f64>>| sides.into_iter().map(|sides| sides[1] / sides[0]).fold(f64::INFINITY, f64::min);
    // What a tick leaves unused of a row takes up the rounding of the limiter.
    let left = spent(0.0, 0.5) / least(sides(0.0, 0.5, 1.0, 1.0, "alpha * ("));
    let [_, rounding] = Rounding::read("limiter.gappa").interval("|shortened -/ EXACT|");
    assert!(left < 1.0 - 1000.0 * rounding && left > 0.98, "{left}");
    let mut random = Random(9);
    for _ in 0..TRIALS {
        let (feedback, sine) = (random.within(0.0, f64::from(p.m_all)) as f32, random.within(0.0, 1.0) as f32);
        let alpha = spent(feedback, sine);
        near(alpha as f32, least(sides(feedback, sine, left, 1.0, "alpha * (")), 10.0 * alpha.abs(), "alpha");
        for kept in sides(feedback, sine, 1.0, alpha, "t * ( feedback + inertia_tilt * alpha )") {
            assert!(kept.is_sorted(), "{kept:?}");
        }
        for row in &budget.rows {
            let proofs = of_tick(&p)
                .with(&[("t", row.tilt), ("y", row.yaw), ("spent", row.room), ("alpha", alpha)])
                .with(&of(&[("feedback_tilt", feedback), ("sine", sine)]));
            assert!(proofs.sides("within_budget", "alpha * (").is_sorted(), "{feedback} {sine}");
        }
    }
}
