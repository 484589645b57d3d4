//! A tick of the extended law, from its torque's parts to the rotors: `Allocation.v`, `Spending.v`.

use super::{
    TRIALS, across, as_f64, certificate, constants, direction, extended_law, field, near, plane, rotors, row, same,
    signed, unit_quaternion,
};
use crate::support::coq::{Proofs, Value};
use crate::support::{Random, hummingbird};
use controller_core::allocation::{MinimumNorm, Rotors};
use controller_core::attitude::rotate_back;
use controller_core::certificate::form::ARITHMETIC_ALLOWANCE;
use controller_core::extended::attitude::AttitudeLaw;
use controller_core::extended::budget::{BudgetRow, Spending, TickBudget, TorqueBudget};
use controller_core::extended::direction_limiter::PUSH_ACROSS_MAX_M_PER_S2;
use controller_core::extended::heading::HeadingLaw;
use controller_core::extended::thrust_range::ThrustRange;
use controller_core::heading::Heading;
use controller_core::law::Law;
use controller_core::mrp;
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};
use controller_core::vehicle::{LimitParameters, Limits};
use nalgebra::{Vector2, Vector3};

/// The rotors as the proofs have them.
fn rotors_of(rotors: &Rotors) -> Vec<Value> {
    let all = rotors.iter().zip(rotors.pseudo_inverse()).map(|(rotor, row)| {
        let ends = [rotor.thrust_min, rotor.thrust_max].map(f64::from);
        let numbers = [("b", row.x), ("beta_z", row.w / row.x), ("least", ends[0]), ("greatest", ends[1])];
        let Value::Record(mut fields) = Value::record(&numbers) else { unreachable!() };
        fields.insert("beta".to_owned(), across([row.y / row.x, row.z / row.x]));
        Value::Record(fields)
    });
    all.collect()
}

fn tilt(random: &mut Random) -> Vector2<f32> {
    direction(random).xy()
}

#[test]
pub(super) fn the_thrust_range_is_that_of_the_proofs() {
    let (rotors, p) = (rotors(), constants());
    let (thrust_max, yaw_max) = (30.0, 0.3);
    let range = ThrustRange::new(Some(&rotors), p.floor_margin, thrust_max, yaw_max);
    let allocation = MinimumNorm::new(&rotors);
    let mut random = Random(2);
    let (mut delivered, mut shared, mut cut) = (0, 0, 0);
    for _ in 0..TRIALS {
        let tau = tilt(&mut random);
        let scale = random.within(0.9, 1.15) as f32;
        let whole = Proofs::read("Allocation")
            .with(&as_f64(&[("s", scale), ("margin", p.floor_margin), ("T_max", thrust_max), ("yaw_max", yaw_max)]))
            .with_value("rotors", Value::List(rotors_of(&rotors)));
        let proofs = whole.clone().with_value("tau", plane(&tau));
        let floor = proofs.number("floor", &[]);
        near(range.min_thrust(&tau.push(0.0), scale), floor, 10.0, "floor");
        near(range.max_thrust(&tau.push(0.0), scale), proofs.number("ceiling", &[]), 10.0, "ceiling");
        let (wanted, yaw) = (40.0 * signed(&mut random), signed(&mut random));
        let braking = 0.3 * signed(&mut random);
        let [alone, beside] = [0.0, f64::from(braking)].map(|braking| proofs.number("ceiling_beside", &[braking]));
        near(range.max_thrust(&tau.push(braking), scale), beside, 10.0, "ceiling beside what brakes");
        cut += usize::from(beside < alone && beside < f64::from(wanted));
        let (found, room) = range.limited(wanted, &tau, [yaw, braking], scale);
        near(found.thrust, proofs.number("thrust", &[braking, wanted].map(f64::from)), 10.0, "thrust");
        let thrust = f64::from(found.thrust);
        near(found.torque.z, proofs.number("yaw", &[thrust, f64::from(yaw)]), 1.0, "yaw");
        let ends = ["yaw_least", "yaw_most"].map(|name| proofs.number(name, &[thrust]));
        let between = Proofs::read("Heading").number("cut", &[ends[0], ends[1], f64::from(yaw)]);
        near(found.torque.z, between, 1.0, "cut");
        near(room, ends[1].min(-ends[0]), 1.0, "what is left for yaw");

        // The turn's share, beside a torque that fits.
        let (spent, turn) = (tau * 0.1, tilt(&mut random));
        let allowed = random.within(2.0, 20.0) as f32;
        let beside = whole.with_value("tau", plane(&spent));
        let most = beside.number("floor", &[]).max(f64::from(allowed));
        let share = beside.value("floor_share", &[plane(&turn), Value::Number(most)]).number();
        shared += usize::from(share < 1.0);
        near(range.share(&spent, &turn, allowed, scale), share, 1.0, "share by the floor");

        // What a rotor is commanded.
        let wrench = Wrench { thrust: 10.0 + 5.0 * signed(&mut random), torque: (tau * 0.2).push(0.02 * yaw) };
        let asked = allocation.allocate(&wrench).unwrap();
        delivered += usize::from(!asked.clipped);
        for (rotor, thrust) in rotors_of(&rotors).into_iter().zip(asked.thrusts).filter(|_| !asked.clipped) {
            let numbers = [wrench.thrust, wrench.torque.z].map(|x| Value::Number(f64::from(x)));
            let [thrust_asked, yaw_asked] = numbers;
            let of = [rotor, thrust_asked, plane(&wrench.torque.xy()), yaw_asked];
            near(thrust, proofs.value("command", &of).number(), 10.0, "command");
        }
    }
    assert!(delivered > TRIALS / 4, "{delivered} of {TRIALS} within the rotors' ranges");
    assert!(cut > TRIALS / 100, "{cut} of {TRIALS} with less thrust for what brakes");
    assert!(shared > TRIALS / 20 && shared < TRIALS, "{shared} of {TRIALS} with a share");
}

pub(super) fn budget() -> TorqueBudget {
    let configuration = extended_law();
    TorqueBudget::new(constants().floor_margin, configuration.limits(), configuration.rotors())
}

fn limits() -> Limits {
    let wide = LimitParameters { thrust_max: 40.0, torque_max: Vector3::new(2.5, 5.0, 2.0) };
    Limits::new(wide, &hummingbird::vehicle()).unwrap()
}

/// The same with limits so wide that the rotors' rows bind as well, and what a tick reads of it.
fn wide(rotors: Option<&Rotors>) -> (TorqueBudget, TickBudget) {
    let p = constants();
    let budget = TorqueBudget::new(p.floor_margin, &limits(), rotors);
    let tick = TickBudget::new(&budget, [p.scale_least, p.scale_greatest]);
    (budget, tick)
}

/// What a tick uses of each row.
pub(super) fn used() -> f64 {
    let (budget, tick) = wide(Some(&rotors()));
    f64::from(tick.radius(1.0)) / budget.radius(1.0)
}

/// A row as the proofs have it, with a part of its room.
fn row_of(row: &BudgetRow, part: f64) -> Value {
    let numbers = [("per_scale", part * row.per_scale), ("fixed", part * row.fixed)];
    let Value::Record(mut fields) = Value::record(&numbers) else { unreachable!() };
    fields.insert("direction".to_owned(), across(row.direction));
    Value::Record(fields)
}

/// A tick's spending, of all rows, of each this part: it leaves those out that others imply.
fn spending(budget: &TorqueBudget, part: f64, scale: f32) -> Proofs {
    let rows = budget.rows.iter().map(|row| row_of(row, part)).collect();
    let numbers = [("s", f64::from(scale)), ("above", f64::from(f32::MAX))];
    Proofs::read("Spending").with(&numbers).with_value("rows", Value::List(rows))
}

#[test]
pub(super) fn the_budgets_rows_are_those_of_the_proofs() {
    let configuration = extended_law();
    let (p, rotors_there, limits) = (constants(), rotors(), configuration.limits());
    let rotors = rotors_of(&rotors_there);
    let ends = Proofs::read("Allocation")
        .with(&as_f64(&[("s", 1.0), ("margin", p.floor_margin), ("T_max", limits.thrust_max)]))
        .with(&[("top", 0.0), ("bottom", 0.0)]);
    let (mut top, mut bottom) = (f64::INFINITY, 0.0_f64);
    for rotor in &rotors {
        let ends = ends.clone().with_value("r", rotor.clone());
        top = top.min(ends.sides("top_least", "top <=")[1]);
        bottom = bottom.max(ends.sides("bottom_greatest", "<= bottom")[0]);
    }
    let proofs = ends.with(&[("top", top), ("bottom", bottom)]);
    let mut rows = Vec::new();
    for (place, rotor) in rotors.iter().enumerate() {
        let pairs = rotors.iter().skip(place + 1);
        rows.extend(pairs.map(|other| proofs.value("pair_row", &[rotor.clone(), other.clone()])));
        rows.push(proofs.value("floor_row", std::slice::from_ref(rotor)));
    }
    let budget = budget();
    assert_eq!(budget.rows.len(), rows.len() + 2);
    let proven_at = |row: &Value, scale: f64| proofs.value("room", &[row.clone(), Value::Number(scale)]).number();
    for (found, proven) in budget.rows.iter().skip(2).zip(&rows) {
        let Value::Record(direction) = field(proven, "direction") else { panic!("a vector") };
        for (found, axis) in found.direction.iter().zip(["x", "y"]) {
            assert!((found - direction[axis].number()).abs() < 1e-12, "{found} {direction:?}");
        }
        for scale in [0.9, 1.0, 1.15] {
            same(found.capacity(scale), proven_at(proven, scale), "R");
        }
    }
    for (found, limit) in budget.rows.iter().zip(limits.torque_max.xy().iter()) {
        same(proven_at(&row_of(found, 1.0), 1.1), f64::from(*limit), "the limit of roll or pitch");
    }
    // What every row leaves of its room is the same.
    assert!((0.998..1.0).contains(&used()), "{}", used());
    for scale in [p.scale_least, p.scale_greatest] {
        let (budget, tick) = wide(Some(&rotors_there));
        near(
            tick.radius(scale),
            spending(&budget, used(), scale).number("radius", &[]),
            1.0,
            "what fits in every direction",
        );
    }
}

#[test]
pub(super) fn the_certificates_rows_of_torque_are_those_of_the_proofs() {
    let (p, certificate) = (constants(), certificate());
    let inertia = hummingbird::vehicle().inertia;
    let kept = f64::from(inertia.x.max(inertia.y)) * f64::from(p.turn_reserve);
    let rows = budget().rows.iter().map(|row| row_of(row, 1.0)).collect();
    let none = plane(&Vector2::zeros());
    let whole = Proofs::read("Spending")
        .with(&[("above", f64::INFINITY), ("kept", kept)])
        .with_value("rows", Value::List(rows))
        .with_value("bias", none)
        .with_value("pull", plane(&Vector2::new(p.m_tilt, 0.0)));
    let at = |scale: f32| whole.clone().with(&as_f64(&[("s", scale)]));
    let ends = [p.scale_least, p.scale_greatest].map(at);
    let raised = 1.0 + ARITHMETIC_ALLOWANCE;
    let least = |sides: [Vec<f64>; 2]| sides[0][1].min(sides[1][1]);

    // The pull of the error beside the reserve, where there is no bias.
    let pull = ends.clone().map(|proofs| proofs.sides("the_pull_is_whole", "length pull <="));
    let names = ["T2 roll", "R ", "T1 thrust floor"];
    for name in names {
        same(row(&certificate, name).required, (pull[0][0] + kept) * raised, name);
    }
    let available = names.map(|name| row(&certificate, name).available).into_iter().fold(f64::INFINITY, f64::min);
    same(available, least(pull) + kept, "what fits in every direction");

    // The greatest bias, about both axes, beside the reserve.
    let bias = plane(&Vector2::repeat(p.torque_tilt));
    let bias = ends
        .map(|proofs| proofs.with_value("bias", bias.clone()).sides("the_reserve_is_kept", "length bias + kept <="));
    same(row(&certificate, "D ").required, bias[0][0] * raised, "D");
    same(row(&certificate, "D ").available, least(bias), "D");
}

/// A torque's parts, long and short.
fn parts(random: &mut Random, typical: f64) -> [Vector2<f32>; 6] {
    [0; 6].map(|_| tilt(random) * (random.magnitude(0.01, 30.0) * typical) as f32)
}

#[test]
pub(super) fn a_ticks_spending_is_that_of_the_proofs() {
    let (all, part, inertia) = (rotors(), used(), hummingbird::vehicle().inertia);
    let law = AttitudeLaw::new(&constants(), &inertia);
    let mut random = Random(9);
    let (mut whole, mut cut) = (0, 0);
    let trials = TRIALS / 4;
    for trial in 0..trials {
        let scale = random.within(0.9, 1.15) as f32;
        // With rotors by row D bias and reserve fit: a row that others imply is beyond only where they are. Without,
        // no row is left out, and the bias is anything.
        let fits = trial % 2 == 0;
        let (budget, tick) = wide(fits.then_some(&all));
        let proofs = spending(&budget, part, scale);
        let radius = f64::from(tick.radius(scale));
        let kept = random.within(0.0, 0.3 * radius) as f32;
        let [bias, pull, gyro, damping, precession, turn] = parts(&mut random, 0.2 * radius);
        let bias = if fits { bias.cap_magnitude(0.999 * (radius as f32 - kept)) } else { bias };
        let mut spent = tick.spending(scale);
        let spend = |spent: &mut Spending, wanted: Vector2<f32>, kept: f32| {
            let asked = [plane(&spent.spent), plane(&wanted), Value::Number(f64::from(kept))];
            let share = spent.spend(&wanted, kept);
            // Of a row that is spent, what is left is a rounding.
            let length = wanted.norm();
            near(share * length, proofs.value("part_share", &asked).number() * f64::from(length), 10.0, "share");
            let after = proofs.value("spend", &asked);
            near(spent.spent.x, field(&after, "x").number(), 10.0, "spent");
            near(spent.spent.y, field(&after, "y").number(), 10.0, "spent");
            share
        };
        let mut shares = vec![spend(&mut spent, -bias, 0.0)];
        for part in [-pull, gyro, -damping, precession] {
            shares.push(spend(&mut spent, part, kept));
        }
        let given = [bias, pull, gyro, damping, precession].map(|part| plane(&part));
        let kept_number = Value::Number(f64::from(kept));
        let before = proofs.value("before_turning", &[&given[..], std::slice::from_ref(&kept_number)].concat());
        near(spent.spent.x, field(&before, "x").number(), 10.0, "before the turn");

        // The turn, shortened by the floor, but not below the reserve.
        let [by_floor, always] = [0; 2].map(|_| random.within(0.0, 1.2).min(1.0) as f32);
        let admitted = proofs.number("admitted", &[by_floor, always].map(f64::from));
        let asked = [by_floor, always].map(|x| Value::Number(f64::from(x)));
        let share = proofs.value("turn_share", &[&[plane(&spent.spent), plane(&turn)][..], &asked].concat()).number();
        let found = spend(&mut spent, turn * admitted as f32, 0.0);
        let length = turn.norm();
        near(found * admitted as f32 * length, share * f64::from(length), 10.0, "the turn's share");
        let tick = [&given[..], &[plane(&turn), kept_number], &asked].concat();
        let proven = proofs.value("tick_torque", &tick);
        near(spent.spent.x, field(&proven, "x").number(), 10.0, "tau");
        near(spent.spent.y, field(&proven, "y").number(), 10.0, "tau");
        whole += shares.iter().filter(|share| **share == 1.0).count();
        cut += shares.iter().filter(|share| **share < 1.0).count();

        // J times an acceleration.
        let a = direction(&mut random);
        let found = law.torque(&a);
        let lengths = Proofs::read("Spending")
            .with(&as_f64(&[("j_1", inertia.x), ("j_2", inertia.y), ("j_max", inertia.x.max(inertia.y))]))
            .with(&as_f64(&[("q", a.xy().norm())]))
            .with_value("a", plane(&a.xy()))
            .sides("torque_of_a_turn", "<= j_max * q");
        near(found.norm(), lengths[0], 1e-2, "J a");
        assert!(lengths[0] <= lengths[1] * (1.0 + 1e-6), "{lengths:?}");
    }
    assert!(whole > trials && cut > trials / 2, "{whole} and {cut} of {trials}");
}

/// Which parts the law spends, and in which order: a flight from anywhere to anywhere, tick by tick.
#[test]
pub(super) fn the_laws_parts_and_their_order_are_those_of_the_proofs() {
    let (configuration, p, inertia) = (extended_law(), constants(), hummingbird::vehicle().inertia);
    let tilting = AttitudeLaw::new(&p, &inertia);
    let mut law = Law::uncertified(&configuration, 0.01).unwrap();
    let controller = law.extended().unwrap();
    let (budget, part, mut random) = (budget(), used(), Random(27));
    let kept = inertia.x.max(inertia.y) * p.turn_reserve;
    let heading = HeadingLaw::new(&p, &inertia);
    let (mut biased, mut cut) = (0, 0);
    for _ in 0..TRIALS / 4 {
        let mut direction = |size: f64| direction(&mut random) * size as f32;
        let (position, velocity, angular_velocity) = (direction(5.0), direction(5.0), direction(20.0));
        let mut reference = Reference::resting(direction(5.0), Heading::FORWARD);
        (reference.velocity, reference.acceleration) = (direction(2.0), direction(1.0));
        (reference.jerk, reference.snap) = (direction(3.0), direction(6.0));
        let attitude = unit_quaternion(&mut random);
        let state = State { position, velocity, attitude, angular_velocity };
        let Ok((wrench, found)) = controller.step(&state, &reference) else { continue };
        let (bias, scale) = (controller.estimates().torque.xy(), controller.thrust_scale());

        // The parts, as they went in.
        let error = found.desired_attitude.conjugate() * state.attitude;
        let [omega, alpha] = [found.desired_angular_velocity, found.desired_angular_acceleration];
        let (x, y, z) = (omega.x, omega.y, omega.z);
        let r = rotate_back(&error, &Vector3::new(x, y, 0.0));
        let rate = (angular_velocity - r).xy();
        let gyro = tilting.gyroscopic(&r, &angular_velocity, &rate);
        let precession = tilting.precession(&angular_velocity, &rate);
        let tilt = tilting.tilt(&found.attitude_error, None);
        let damping = tilting.damping(&tilt, &found.angular_velocity_error.xy());
        // The frame's acceleration without what its turn about rho makes of it.
        let turn = tilting.torque(&rotate_back(&error, &Vector3::new(alpha.x - y * z, alpha.y + x * z, 0.0)));

        let proofs = spending(&budget, part, scale);
        let given = [bias, found.attitude_feedback.xy(), gyro, damping, precession].map(|part| plane(&part));
        let numbers = [kept, 1.0, 1.0].map(|x| Value::Number(f64::from(x)));
        let tick = [&given[..], &[plane(&turn)], &numbers].concat();
        let proven = proofs.value("tick_torque", &tick);
        near(wrench.torque.x, field(&proven, "x").number(), 100.0, "tau_1");
        near(wrench.torque.y, field(&proven, "y").number(), 100.0, "tau_2");
        // Then thrust, beside what brakes the heading.
        let proofs = Proofs::read("Allocation")
            .with(&as_f64(&[("s", scale), ("margin", p.floor_margin), ("T_max", configuration.limits().thrust_max)]))
            .with_value("rotors", Value::List(rotors_of(&rotors())))
            .with_value("tau", plane(&wrench.torque.xy()));
        // n* of section 1, along rho.
        let (u, y) = (found.acceleration_command, controller.memory().filters.smoothed);
        let rho = u / u.norm();
        let across = PUSH_ACROSS_MAX_M_PER_S2 / rho.xy().norm();
        let more = (y.z - found.filtered.z) / rho.z.max(p.tilt_max.cos());
        let greatest = budget.ceiling(configuration.vehicle(), configuration.limits());
        let length = (u.norm() + more.clamp(-across, across)).max(0.0);
        let length = length.min(greatest.at(scale, &controller.estimates().torque));
        let along = length * rho.dot(&(mrp::rotation(&state.attitude) * Vector3::z()));
        let brakes = heading.braking(wrench.torque.z, found.angular_velocity_error.z);
        let numbers = [brakes, hummingbird::vehicle().mass * along].map(f64::from);
        near(wrench.thrust, proofs.number("thrust", &numbers), 10.0, "thrust");
        biased += usize::from(bias.norm() > 0.1 * p.torque_tilt);
        cut += usize::from(found.rate_feedback.xy().norm() < 0.99 * damping.norm());
    }
    assert!(biased > TRIALS / 20 && cut > TRIALS / 20, "{biased} with a bias, {cut} with a share of damping");
}

/// Whatever is spent and wanted, however long: every rotor is within its range, and no rounding clips it.
#[test]
pub(super) fn no_tick_takes_a_rotor_out_of_its_range() {
    let (rotors, p, limits) = (rotors(), constants(), limits());
    let range = ThrustRange::new(Some(&rotors), p.floor_margin, limits.thrust_max, limits.torque_max.z);
    let ((rows, budget), allocation, mut random) = (wide(Some(&rotors)), MinimumNorm::new(&rotors), Random(14));
    let (numbers, rest) = ([("above", f64::INFINITY), ("margin", p.floor_margin.into())], 1.0 - used());
    for _ in 0..TRIALS {
        let scale = random.within(p.scale_least.into(), p.scale_greatest.into()) as f32;
        let mut spending = budget.spending(scale);
        let kept = random.within(0.0, 0.3) as f32 * spending.radius();
        for (part, kept) in parts(&mut random, 1.0).into_iter().zip([0.0, kept, kept, kept, kept, 0.0]) {
            spending.spend(&part, kept);
        }
        let [thrust, yaw, braking] = [100.0, 2.0, 2.0].map(|most| most * signed(&mut random));
        let (found, _) = range.limited(thrust, &spending.spent, [yaw, braking], scale);
        let Wrench { thrust, torque } = found;
        let proofs = Proofs::read("Spending")
            .with(&numbers)
            .with(&as_f64(&[("s", scale), ("T_max", limits.thrust_max), ("yaw_max", limits.torque_max.z)]))
            .with(&as_f64(&[("T", thrust), ("tau_z", torque.z)]))
            .with_value("tau", plane(&spending.spent));
        for row in &rows.rows {
            let proofs = proofs.clone().with_value("w", row_of(row, 1.0));
            let [spent, room] = proofs.sides("holds", "<= room")[..] else { panic!("two sides") };
            assert!(spent <= room * (1.0 - 0.5 * rest), "{row:?} {spent} {room}");
        }
        for rotor in rotors_of(&rotors) {
            let proofs = proofs.clone().with_value("r", rotor);
            let sides = proofs.sides("rotors_within_range", "<= command r T tau tau_z <=");
            assert!(sides[0] - 1e-5 <= sides[1] && sides[1] <= sides[2] + 1e-5, "{sides:?}");
        }
        assert!(thrust <= limits.thrust_max && torque.z.abs() <= limits.torque_max.z);
        assert!(!allocation.allocate(&found.scaled(1.0 / scale)).unwrap().clipped, "{found:?} {scale}");
    }
}
