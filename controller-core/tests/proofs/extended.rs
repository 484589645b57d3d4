//! The extended law's flows: `Limiter.v`, `Envelope.v`, `Attitude.v`, `Heading.v`, `Fallback.v`.

use super::{
    TRIALS, as_f64, certificate, constants, direction, extended_law, field, near, plane, row, same, signed,
    unit_quaternion,
};
use crate::support::coq::{Proofs, Value};
use crate::support::{Random, hummingbird};
use controller_core::attitude_reference::{DesiredAttitude, DirectionMotion};
use controller_core::certificate::form::ARITHMETIC_ALLOWANCE;
use controller_core::extended::attitude::AttitudeLaw;
use controller_core::extended::direction_limiter::DirectionLimiter;
use controller_core::extended::fallback::{Fallback, PROGRESS_WINDOW_S, Slowed};
use controller_core::extended::heading::HeadingLaw;
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::extended::position::{FeedbackLimits, Filters, PositionLaw};
use controller_core::heading::Heading;
use controller_core::mrp;
use controller_core::path_lifting::switching_scalar;
use controller_core::reference::Reference;
use controller_core::state::State;
use nalgebra::{Quaternion, Vector2, Vector3};

const NOW: (&str, f64) = ("t", 0.0);

fn number(x: f32) -> Value {
    Value::Number(f64::from(x))
}

fn near_plane(found: &Vector2<f32>, proven: &Value, scale: f64, what: &str) {
    near(found.x, field(proven, "x").number(), scale, what);
    near(found.y, field(proven, "y").number(), scale, what);
}

#[test]
pub(super) fn the_limiter_is_that_of_the_proofs() {
    let p = constants();
    let (period, alpha) = (0.01_f32, 40.0_f32);
    let limit = DirectionLimiter::new(&p, alpha, period);
    let mut random = Random(3);
    let (mut cut, mut kept) = (0, 0);
    for _ in 0..TRIALS {
        let wanted = direction(&mut random).xy() * (1.5 * alpha);
        let rate = direction(&mut random).xy() * (1.2 * p.turn_rate);
        // Near the cone's edge as well.
        let tilt = random.within(0.0, 1.1) as f32 * p.tilt_max;
        let across = direction(&mut random).xy().normalize() * tilt.sin();
        let turn =
            DirectionMotion { rate, acceleration: wanted, magnitude: 9.81, radial_rate: 0.0, radial_acceleration: 0.0 };
        let found = limit.limited(&turn, &across.push(tilt.cos()));
        let proofs = Proofs::read("Limiter")
            .with(&as_f64(&[("period", period), ("alpha", alpha), ("rate_max", p.turn_rate), ("along", tilt.cos())]))
            .with(&as_f64(&[("closing", (0.5 * alpha).sqrt()), ("cosine", p.tilt_max.cos())]))
            .with_value("rate", plane(&rate))
            .with_value("wanted", plane(&wanted))
            .with_value("across", plane(&across));
        // Divided by the period, a rounding of the rate counts a hundred times.
        near_plane(&found, &proofs.value("turned", &[]), 1e3, "turned");
        let [length, most] = proofs.sides("turn_within_alpha", "<= alpha")[..] else { panic!("two sides") };
        assert!(length <= most * (1.0 + 1e-12) && found.norm() <= alpha * (1.0 + 1e-6), "{found}");
        let shortened = proofs.value("shortened", &[plane(&wanted), number(alpha)]);
        cut += usize::from(found != wanted);
        kept += usize::from(proofs.value("kept_in_cone", std::slice::from_ref(&shortened)) != shortened);
        let share = random.within(0.0, 1.0) as f32;
        near_plane(&(found * share), &proofs.value("limited", &[number(share)]), 1e3, "limited");

        // How a frame that turns about rho carries p.
        let (heading, q) = (Heading::new(Vector2::x(), signed(&mut random), 0.0).unwrap(), wanted);
        let command = Vector3::new(signed(&mut random), signed(&mut random), 9.0);
        let desired = DesiredAttitude::new(&command, &heading);
        let motion = desired.motion_of_direction(&rate, &q, &heading);
        let carried = Proofs::read("Limiter").value("quarter", &[plane(&rate)]);
        let rate_moves = Vector2::new(motion.acceleration.y, -motion.acceleration.x);
        near_plane(&((rate_moves - q) / motion.velocity.z), &carried, 1e3, "carried");
    }
    assert!(cut > TRIALS / 20 && kept > TRIALS / 20, "{cut} and {kept} of {TRIALS} limited");
}

#[test]
pub(super) fn what_a_command_asks_of_the_frame_is_that_of_the_proofs() {
    let (p, certificate) = (constants(), certificate());
    let configuration = extended_law();
    let bounds = configuration.bounds();
    // As the certificate has them, but for the last digit of single precision.
    let with_drag = |value: f32, below: f32| f64::from(value) + f64::from(p.drag_across) * f64::from(below);
    let slowed = Slowed::<f64>::new(&p, configuration.vehicle().gravity);
    let [slow_jerk, slow_snap] = slowed.derivatives(&p);
    let jerk = with_drag(bounds.jerk, bounds.horizontal_acceleration) + slow_jerk;
    let snap = with_drag(bounds.snap, bounds.jerk) + slow_snap;
    let [vertical, up] = [bounds.vertical_acceleration, p.force_up].map(f64::from);
    let least = f64::from(configuration.vehicle().gravity) - vertical - up - slowed.level;
    let nothing = || plane(&Vector2::zeros());
    let proofs = Proofs::read("Limiter")
        .with(&[("jerk", jerk), ("snap", snap), ("least", least), ("n", 9.81), ("radial", 0.0)])
        .with_value("u_1", nothing())
        .with_value("u_2", nothing());
    let raised = 1.0 + ARITHMETIC_ALLOWANCE;
    for (name, standing) in [("A1 turning rate", "length p <="), ("A1 turning acceleration", "length q <=")] {
        let proven = proofs.sides("turning_of_a_command", standing)[1] * raised;
        let found = row(&certificate, name).required;
        assert!((found / proven - 1.0).abs() < 1e-4, "{name}: {found}, and {proven} in the proof");
    }
    // p and q of a command that moves.
    let mut random = Random(21);
    for _ in 0..TRIALS {
        let command = Vector3::new(signed(&mut random), signed(&mut random), 9.0);
        let [u_1, u_2] = [5.0, 20.0].map(|size| direction(&mut random) * size);
        let desired = DesiredAttitude::new(&command, &Heading::FORWARD);
        let turn = desired.direction_motion(&u_1, &u_2);
        let [across_1, across_2] = [&u_1, &u_2].map(|v| desired.direction_motion(v, v).rate * desired.magnitude());
        let proofs = Proofs::read("Limiter")
            .with(&as_f64(&[("n", turn.magnitude), ("radial", turn.radial_rate)]))
            .with_value("u_1", plane(&across_1))
            .with_value("u_2", plane(&across_2));
        let lengths = [(turn.rate, "length p <="), (turn.acceleration, "length q <=")];
        for (found, standing) in lengths {
            let proofs = proofs.clone().with(&[("jerk", 1.0), ("snap", 1.0), ("least", 1.0)]);
            near(found.norm(), proofs.sides("turning_of_a_command", standing)[0], 10.0, standing);
        }
    }
}

/// y'' at the least, for y, y' and the limiter's k.
fn least(k: f32, y: f32, y_1: f32) -> f64 {
    let proofs = Proofs::read("Envelope")
        .with(&[("k", f64::from(k)), ("s", 0.0)])
        .with_value("y", number(y).moving())
        .with_value("y_1", number(y_1).moving())
        .with_value("y_2", Value::Number(0.0).moving());
    proofs.sides("stays_inside", "<= y_2 s")[0]
}

#[test]
pub(super) fn the_ends_of_u_are_those_of_the_proofs() {
    const FAR: f32 = 1e6;
    let p = constants();
    let limit = DirectionLimiter::new(&p, 40.0, 0.01);
    let change = |magnitude, radial_rate, radial_acceleration, vertical| {
        let still = Vector2::zeros();
        let turn = DirectionMotion { rate: still, acceleration: still, magnitude, radial_rate, radial_acceleration };
        limit.change(&turn, &still, &Vector3::z(), 30.0, vertical).unwrap().z
    };
    // c_z'' as limited, for y = c_z + A_-: far below U, where n has all room. It falls without end as wanted.
    let falling = |c: f32, c_rate: f32| change(-FAR, 0.0, 0.0, [c, c_rate, -FAR]) - FAR;
    // n'' as limited, for y = U - n: c_z'' is wanted far above its end.
    let swelling = |n: f32, rate: f32| change(n, rate, FAR, [0.0, 0.0, FAR]) + FAR;
    // The theorem holds for every k. A rate of one changes the limiter's end by twice its k.
    let k = -0.5 * falling(-p.a_down, 1.0);
    let mut random = Random(10);
    for _ in 0..TRIALS {
        let (y, rate) = (random.within(0.0, 10.0) as f32, 20.0 * signed(&mut random));
        near(falling(y - p.a_down, rate), least(k, y, rate), 5e4, "c_z''");
        near(swelling(30.0 - y, rate), -least(k, y, -rate), 5e4, "n''");
    }
}

/// R^T v, axes of the body.
fn in_the_body(error: &Quaternion<f32>, v: &Vector3<f32>) -> [f64; 3] {
    (mrp::rotation(error).transpose() * v).cast().into()
}

#[test]
pub(super) fn the_tilts_error_and_its_pull_are_those_of_the_proofs() {
    let p = constants();
    let law = AttitudeLaw::new(&p, &hummingbird::vehicle().inertia);
    let switching = f64::from(switching_scalar(p.delta));
    let mut random = Random(1);
    let (mut held, mut switched) = (0, 0);
    for trial in 0..TRIALS {
        let mut error = unit_quaternion(&mut random);
        // Half of them near half a turn.
        if trial % 2 == 0 {
            let small = 3.0 * p.delta;
            let (w, k) = (small * signed(&mut random), small * signed(&mut random));
            error = Quaternion::new(w, error.i, error.j, k);
            error /= error.norm();
        }
        let half = f64::from(error.w.hypot(error.k));
        let side = direction(&mut random).xy().normalize();
        let tilt = law.tilt(&error, Some(&side));
        let [m_1, m_2, sine] = in_the_body(&error, &side.push(0.0));
        let [rho_1, rho_2, cosine] = in_the_body(&error, &Vector3::z());
        let proofs = Proofs::read("Attitude").with(&as_f64(&[("k", p.k_tilt), ("M", p.m_tilt)]));
        let beyond = proofs.number("held_half", &[sine]) <= switching;
        if (half + 2.0 * switching).abs() < 1e-4 || (proofs.number("held_half", &[sine]) - switching).abs() < 1e-4 {
            continue;
        }
        let is_held = half < -2.0 * switching && !beyond;
        held += usize::from(is_held);
        switched += usize::from(half < -2.0 * switching && beyond);
        let (name, v_1, v_2, u) = if is_held { ("held_mrp", m_1, m_2, sine) } else { ("mrp", rho_1, rho_2, cosine) };
        let given = [v_1, v_2, u].map(Value::Number);
        let vartheta = proofs.value(name, &given);
        // Near half a turn the nearest axis is not well known.
        let scale = 10.0 + 0.1 / half.max(1e-3).powi(2);
        near_plane(&tilt.mrp, &vartheta, scale, name);
        near(tilt.sine_squared, 1.0 - half * half, 1.0, "sin(theta / 2)");
        // The same by the angle.
        let by_angle = proofs.clone().with(&[("v_1", v_1), ("v_2", v_2), ("sine", u), ("cosine", u)]);
        let theorem = if is_held { "held_mrp_of_the_angle" } else { "mrp_of_the_angle" };
        for side in by_angle.sides_of(theorem, &format!("{name} v_1 v_2")) {
            near_plane(&tilt.mrp, &side, scale, theorem);
        }
        let angle = if is_held { std::f64::consts::PI - sine.asin() } else { cosine.acos() };
        let pull = law.potential(&tilt, p.m_tilt);
        near_plane(&pull, &proofs.value("pull", std::slice::from_ref(&plane(&tilt.mrp))), 1.0, "P");
        near(pull.norm(), proofs.number("strength", &[angle]), 0.1 * scale, "|P|");
        let [length, level] = proofs.with_value("v", plane(&tilt.mrp)).sides("pull_below_level", "< M")[..] else {
            panic!("two sides")
        };
        assert!(length < level, "{length} {level}");
    }
    assert!(held > TRIALS / 100 && switched > TRIALS / 100, "{held} held and {switched} beyond the switch");
}

#[test]
pub(super) fn the_tilts_torque_is_that_of_the_proofs() {
    let (p, inertia) = (constants(), hummingbird::vehicle().inertia);
    let law = AttitudeLaw::new(&p, &inertia);
    let mut random = Random(13);
    for _ in 0..TRIALS {
        let [omega, r, a] = [10.0, 10.0, 100.0].map(|size| direction(&mut random) * size);
        let [bias, lack] = [0; 2].map(|_| direction(&mut random).xy() * 0.1);
        let error = unit_quaternion(&mut random);
        let tilt = law.tilt(&error, None);
        let e = (omega - r).xy();
        let [gyroscopic, pull, damping] =
            [law.gyroscopic(&r, &omega, &e), law.potential(&tilt, p.m_tilt), law.damping(&tilt, &e)];
        let [lambda, nu] = [0; 2].map(|_| random.within(0.0, 1.0) as f32);
        let precession = law.precession(&omega, &e);
        let found = law.torque(&a) + gyroscopic - pull - damping * lambda + precession * nu - bias - lack;

        let angle = 4.0 * f64::from(tilt.mrp.norm()).atan();
        let mut proofs = Proofs::read("Attitude")
            .with(&as_f64(&[
                ("j_1", inertia.x),
                ("j_2", inertia.y),
                ("j_3", inertia.z),
                ("lambda", lambda),
                ("nu", nu),
            ]))
            .with(&as_f64(&[("a_1", a.x), ("a_2", a.y), ("k", p.k_tilt), ("M", p.m_tilt)]))
            .with(&[NOW])
            .with_value("angle", Value::Number(angle).moving())
            .with_value("e", plane(&(tilt.mrp / tilt.mrp.norm())))
            .with_value("bias", plane(&bias))
            .with_value("lack", plane(&lack));
        for (name, x) in ["o_1", "o_2", "o_3", "r_1", "r_2", "r_3"].into_iter().zip(omega.iter().chain(r.iter())) {
            proofs = proofs.with_value(name, number(*x).moving());
        }
        let sine = tilt.sine_squared.sqrt();
        let numbers = [p.k_omega_t, p.r_0, sine].map(number);
        let proven = proofs.value("damping", &[&numbers[..], &[plane(&e)]].concat());
        near_plane(&damping, &proven, 1.0, "D");
        let proofs = proofs.with_value("D", proven);
        near_plane(&gyroscopic, &proofs.value("g", &[]), 1.0, "g");
        near_plane(&precession, &proofs.value("h", &[]), 1.0, "h");
        near_plane(&pull, &proofs.value("P", &[]), 1.0, "P");
        for (found, name) in found.iter().zip(["tau_1", "tau_2"]) {
            near(*found, proofs.number(name, &[]), 1.0, name);
        }
    }
}

#[test]
pub(super) fn the_heading_is_that_of_the_proofs() {
    let (p, inertia) = (constants(), hummingbird::vehicle().inertia);
    let law = HeadingLaw::new(&p, &inertia);
    let [j_1, j_2, j_3] = <[f64; 3]>::from(inertia.map(f64::from));
    let mut random = Random(23);
    for _ in 0..TRIALS {
        let velocity = direction(&mut random) * 10.0;
        let (frame_rate, acceleration) = (direction(&mut random) * 3.0, 10.0 * signed(&mut random));
        let forward = law.forward(&frame_rate, acceleration, &velocity);
        let (psi, rate_error) = (2.0 * signed(&mut random), 12.0 * signed(&mut random));
        // Where nothing was left for yaw, A brakes.
        let found = law.torque(psi, rate_error, forward, &velocity, 0.0);
        let proofs = Proofs::read("Heading").with(&as_f64(&[
            ("k", p.c_1 / p.c_2),
            ("A", p.yaw_acceleration),
            ("W", p.yaw_rate),
            ("psi", psi),
        ]));
        let speed = proofs.number("speed", &[f64::from(psi)]);
        assert!(proofs.sides("speed_below", "<= W * W").is_sorted(), "{psi}");
        let feedback = f64::from(p.c_2) * (f64::from(rate_error) + speed);
        let others = (j_1 - j_2) * f64::from(velocity.x) * f64::from(velocity.y);
        let asked = proofs.number("asked", &[j_3, f64::from(forward), others, feedback]);
        near(found, asked, 1.0, "tau_3");
        let [most, fastest, wanted, error] = [p.yaw_acceleration, p.yaw_rate, found, rate_error].map(f64::from);
        let numbers = [j_3, most, fastest, wanted, error];
        near(law.braking(found, rate_error), proofs.number("braking", &numbers), 1.0, "what brakes");
        // What it makes of the rate, where the ends cut it.
        let ends = [("Y_1", random.within(0.0, 0.2)), ("Y_2", random.within(0.0, 0.2))];
        let proofs = proofs.with(&ends).with(&[("j_3", j_3), ("others", others), ("feedback", feedback)]);
        let proofs = proofs.with(&as_f64(&[("a_d", forward)]));
        let [left, right] = proofs.sides("yaw_closed_loop", "= - got")[..] else { panic!("two sides") };
        let made = f64::from(found).clamp(-ends[0].1, ends[1].1) + others;
        for side in [left, right] {
            near(side as f32, made / j_3 - f64::from(forward), 100.0, "e'");
        }
    }
}

#[test]
pub(super) fn the_slowed_law_is_that_of_the_proofs() {
    let (p, gravity, period) = (constants(), hummingbird::vehicle().gravity, 0.01);
    let mut random = Random(24);
    for _ in 0..TRIALS {
        let [k_f, k_s] = [0; 2].map(|_| random.magnitude(1.0, 40.0) as f32);
        let parameters = ExtendedParameters { k_f, k_s, ..p };
        let found = Slowed::<f64>::new(&parameters, gravity);
        let [k_f, k_s] = [k_f, k_s].map(|bandwidth| found.factor * f64::from(bandwidth));
        // The derivatives of c, across and along the vertical at once.
        let nothing = || plane(&Vector2::zeros());
        let proofs = Proofs::read("Fallback")
            .with(&[("k_f", k_f), ("k_s", k_s), ("level", found.level)])
            .with_value("c", nothing())
            .with_value("x_", nothing())
            .with_value("y_", nothing())
            .with_value("v", nothing());
        let both = proofs.sides("both_together", "<= sqrt 2 * level")[1];
        let proofs = proofs.with(&[("M", both)]);
        let standing = ["length ( command_rate", "length ( command_acceleration"];
        for (found, standing) in found.derivatives(&parameters).into_iter().zip(standing) {
            same(found, proofs.sides("slow_derivatives", standing)[1], standing);
        }
    }

    // c' and c'' of the filters as they stand.
    let law = PositionLaw::new(&p, gravity, period).unwrap();
    let still = Vector3::zeros();
    let attitude = Quaternion::identity();
    let state = State { position: still, velocity: still, attitude, angular_velocity: still };
    let reference = Reference::resting(still, Heading::FORWARD);
    let held = (1.0 - (-f64::from(p.k_s) * f64::from(period)).exp()) / f64::from(period);
    for _ in 0..TRIALS {
        let [command, intermediate, smoothed] = [0; 3].map(|_| direction(&mut random) * 5.0);
        let filters = Filters { command, intermediate, smoothed };
        let found = law.feedback(&state, &reference, &filters, &still, 20.0, &FeedbackLimits::UNLIMITED);
        let proofs = Proofs::read("Fallback");
        let [c, x, y] = [command, intermediate, found.smoothed].map(|v| plane(&v.xy()));
        let rate = proofs.value("command_rate", &[number(p.k_f), c.clone(), x.clone()]);
        near_plane(&found.rate.xy(), &rate, 1e3, "c'");
        let k_s = Value::Number(held);
        let acceleration = proofs.value("command_acceleration", &[number(p.k_f), k_s, c, x, y]);
        near_plane(&((found.drive - found.rate) * p.k_f).xy(), &acceleration, 1e4, "c''");
    }
}

/// Flies a window from a distance to another, at a speed: whether the law is slowed at its end.
fn window(fallback: &mut Fallback, from: f32, to: f32, speed: f32) -> bool {
    let ticks = PROGRESS_WINDOW_S as usize;
    let far = |tick: usize| if to < from { to } else { from + (to - from) * (tick as f32 / ticks as f32) };
    let velocity = Vector3::new(0.0, speed, 0.0);
    let mut slow = false;
    for tick in 1..=ticks {
        slow = fallback.observe(&Vector3::new(far(tick), 0.0, 0.0), &velocity, 1.0);
    }
    slow
}

#[test]
pub(super) fn progress_is_that_of_the_proofs() {
    let mut random = Random(25);
    let (mut slower, mut nearer, mut slowed) = (0, 0, 0);
    for _ in 0..TRIALS {
        let mut fallback = Fallback::FRESH;
        let (mut distance, mut speed) = (random.magnitude(0.55, 300.0) as f32, random.magnitude(0.1, 300.0) as f32);
        // The first window makes the records.
        let mut slow = window(&mut fallback, distance, distance, speed);
        while !slow {
            let [distance_next, speed_now] = [distance, speed].map(|record| record * random.within(0.85, 1.03) as f32);
            let distance_next = distance_next.max(0.55);
            let less = |now: f32, best: f32| {
                let proofs = Proofs::read("Fallback").with(&as_f64(&[("now", now), ("best", best)]));
                let [over, under] = ["1 / 2 <", "now <"].map(|side| proofs.sides("less", side));
                let sure = (under[0] - under[1]).abs() > 1e-4 * under[1];
                sure.then_some(over[0] < over[1] && under[0] < under[1])
            };
            let [Some(is_slower), Some(is_nearer)] = [less(speed_now, speed), less(distance_next, distance)] else {
                break;
            };
            slow = window(&mut fallback, distance, distance_next, speed_now);
            assert_eq!(slow, !is_slower && !is_nearer, "{distance} {speed} {distance_next} {speed_now}");
            slower += usize::from(is_slower);
            nearer += usize::from(is_nearer && !is_slower);
            slowed += usize::from(slow);
            // Of a window that is only nearer the record of |v~| stays.
            (distance, speed) = (distance_next, if is_slower { speed_now } else { speed });
        }
    }
    let ways = [slower, nearer, slowed];
    assert!(ways.iter().all(|found| *found > TRIALS / 20), "{ways:?}");
}
