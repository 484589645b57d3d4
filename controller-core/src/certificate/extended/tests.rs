use super::*;
use crate::allocation::{QuadX, Rotors};
use crate::extended::attitude::AttitudeLaw;
use crate::extended::parameters::ExtendedParameters;
use crate::extended::tests::Random;
use crate::extended::tests::example::{self, Craft};
use crate::extended::turning::TURNED;
use crate::vehicle::LimitParameters;
use crate::vehicle::Limits;
use nalgebra::Vector3;

fn certificate(craft: &Craft, parameters: &ExtendedParameters, bounds: ReferenceBounds) -> ExtendedCertificate {
    let configuration = craft.configuration(parameters, bounds);
    ExtendedCertificate::new(&configuration, &craft.law(parameters)).unwrap()
}

/// The rows that fail on the example's vehicle with these constants and references.
fn failing(parameters: &ExtendedParameters, bounds: ReferenceBounds) -> Vec<&'static str, MOST> {
    failing_on(&Craft::example(), parameters, bounds)
}

fn failing_on(craft: &Craft, parameters: &ExtendedParameters, bounds: ReferenceBounds) -> Vec<&'static str, MOST> {
    let inequalities = certificate(craft, parameters, bounds).inequalities;
    collected(inequalities.iter().filter(|row| !row.holds()).map(|row| row.name))
}

#[test]
fn the_example_is_certified_with_every_row_of_the_table() {
    let certificate = certificate(&Craft::example(), &example::parameters(), example::REFERENCES);
    assert_eq!(certificate.inequalities.len(), MOST);
    assert!(certificate.inequalities.iter().all(Inequality::holds), "{:?}", certificate.inequalities);
    assert_eq!(certificate.bounds.rotors.len(), 4);
}

#[test]
fn a_reference_that_falls_as_fast_as_the_law_may_fails_t1() {
    let p = example::parameters();
    let least = example::vehicle().gravity - p.a_down;
    let rows = feasible_rows(&p, ReferenceBounds { vertical_acceleration: least.next_down(), ..example::REFERENCES });
    let [fall, ..] = rows;
    assert!(fall.available - fall.required < 1e-5 && fall.holds());
}

fn feasible_rows(parameters: &ExtendedParameters, bounds: ReferenceBounds) -> [Inequality; 6] {
    let craft = Craft::example();
    let configuration = craft.configuration(parameters, bounds);
    let budget = TorqueBudget::new(parameters, &craft.vehicle, &craft.limits, Some(&craft.rotors));
    feasibility(&configuration, &craft.law(parameters).parameters, &budget)
}

#[test]
fn a_force_across_that_thrust_does_not_hold_fails_its_row() {
    let p = example::parameters();
    let [_, across, ..] = feasible_rows(&p, example::REFERENCES);
    let thrust = across.available / 0.5;
    let most = (thrust * thrust - 9.9855_f64.powi(2)).sqrt() as f32 - 2.4675 - 0.47 * 3.0;
    let with = |force_across: f32| ExtendedParameters { force_across, a_across: 2.0 * force_across, ..p };
    assert!(failing(&with(0.99 * most), example::REFERENCES).is_empty());
    assert_eq!(failing(&with(1.01 * most), example::REFERENCES)[..], ["A1 thrust against force across"]);
}

#[test]
fn a_force_down_that_thrust_does_not_hold_fails_its_row() {
    let p = example::parameters();
    let [_, _, down, ..] = feasible_rows(&p, example::REFERENCES);
    let (thrust, across) = (down.available / 0.5, 2.4675 + 0.47 * 3.0);
    let most = (thrust * thrust - across * across).sqrt() as f32 - 9.9855;
    let with = |force_down: f32| ExtendedParameters { force_down, ..p };
    assert!(failing(&with(0.99 * most), example::REFERENCES).is_empty());
    assert_eq!(failing(&with(1.01 * most), example::REFERENCES)[..], ["A1 thrust against force down"]);
}

#[test]
fn references_that_turn_the_frame_too_fast_or_too_suddenly_fail_their_rows() {
    let p = example::parameters();
    let jerky = ReferenceBounds { jerk: 40.0, ..example::REFERENCES };
    assert!(failing(&p, jerky).contains(&"A1 turning rate for the reference"));
    let [.., rate, _, _] = feasible_rows(&p, example::REFERENCES);
    // All there is of |u'|: the reference's with its drag, and the net's across and along the vertical.
    let net = 2.0_f64.sqrt() * net_level::<f64>(&p, 9.81);
    let least = 9.81 - 0.1755 - f64::from(p.force_up) - net;
    let expected = (3.876 + 0.47 * 2.4675 + 2.0 * f64::from(p.k_f) * net) / least;
    assert!((rate.required / expected - 1.0).abs() < 1e-4 && rate.available == f64::from(p.turn_rate), "{rate}");
    let snap = 6.089 + 0.47 * 3.876 + 2.0 * f64::from(p.k_f * (p.k_s + p.k_f)) * net;
    // Beside it 2 p r / n, p and r / n together as long as |u'| / n; q may take its part of alpha_0.
    let [.., acceleration, _] = feasible_rows(&p, example::REFERENCES);
    let curl = (0..=1_000).map(|part| {
        let (along, across) = (f64::from(part) * 1e-3 * core::f64::consts::FRAC_PI_2).sin_cos();
        2.0 * expected * expected * along * across
    });
    let expected = (snap / least + curl.fold(0.0, f64::max)) / f64::from(TURNED);
    // The allowance for arithmetic, three times.
    assert!((acceleration.required / expected - 1.0).abs() < 3e-4, "{acceleration} {expected}");
    assert!(acceleration.available == f64::from(p.turn_reserve));
    let snappy = ReferenceBounds { snap: 6.1 + 9.81 * p.turn_reserve, ..example::REFERENCES };
    assert!(failing(&p, snappy).contains(&"A1 turning acceleration"));
}

#[test]
fn headings_that_turn_too_fast_or_too_suddenly_fail_their_rows() {
    let p = example::parameters();
    let fast = ReferenceBounds { heading_rate: p.yaw_rate, heading_second_derivative: 10.0, ..example::REFERENCES };
    assert!(failing(&p, fast).contains(&"A1 heading rate for the reference"));
    let sudden = ReferenceBounds { heading_second_derivative: p.yaw_acceleration, ..example::REFERENCES };
    assert_eq!(failing(&p, sudden)[..], ["A1 heading acceleration"]);
    // The force in which the heading is proven to arrive tilts u: the same heading then turns faster.
    let tilted = |force_heading: f32| {
        let parameters = ExtendedParameters { force_heading, ..p };
        let craft = Craft::example();
        heading::<f64>(&craft.configuration(&parameters, example::REFERENCES), &craft.law(&parameters).parameters)
    };
    let ([rate, acceleration], [faster, sooner]) = (tilted(0.0), tilted(5.0));
    assert!(rate.required < faster.required && acceleration.required < sooner.required);
}

#[test]
fn a_floor_above_the_thrust_at_the_target_fails_its_row() {
    let p = example::parameters();
    let [.., floor] = feasible_rows(&p, example::REFERENCES);
    let spare = (floor.available - floor.required) as f32;
    let with = |share: f32| ExtendedParameters { floor_margin: p.floor_margin + share * spare, ..p };
    let name = "G floor at the target < thrust";
    assert!(!failing(&with(0.99), example::REFERENCES).contains(&name));
    assert!(failing(&with(1.01), example::REFERENCES).contains(&name));
    // The frame's reserve raises it by L alpha_0.
    let [.., raised] =
        feasible_rows(&ExtendedParameters { turn_reserve: 2.0 * p.turn_reserve, ..p }, example::REFERENCES);
    let craft = Craft::example();
    let budget = TorqueBudget::<f64>::new(&p, &craft.vehicle, &craft.limits, Some(&craft.rotors));
    let expected = budget.floor_per_acceleration * f64::from(p.turn_reserve);
    assert!(((raised.required - floor.required) / expected - 1.0).abs() < 1e-3, "{raised} {floor}");
}

#[test]
fn a_hysteresis_with_another_equilibrium_fails_the_rows_of_e() {
    let p = example::parameters();
    let delta = 0.5;
    let [switch, tilt, _] = attitude(&Craft::example().law(&ExtendedParameters { delta, ..p }).parameters);
    let is = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-6, "{found}, not {expected}");
    // qbar = (1.5^2 - 1) / (1.5^2 + 1).
    let qbar = 1.25 / 3.25_f64;
    let raised = 1.0 + ARITHMETIC_ALLOWANCE;
    is(switch.required, qbar * raised);
    is(switch.available, f64::from(p.eta));
    is(tilt.required, 2.0 * qbar * f64::from(p.m_t) * raised);
    is(tilt.available, f64::from(p.w * p.eta_t) * (1.0 - qbar * qbar).sqrt());
    let eta = 0.99 * switching_magnitude::<f64>(p.delta) as f32;
    assert!(failing(&ExtendedParameters { eta, ..p }, example::REFERENCES).contains(&"E switch qbar < eta"));
    let name = "E tilt 2 qbar M_t < w eta_t sqrt(1 - qbar^2)";
    let m_t = (0.5 * tilt.available / switching_magnitude::<f64>(p.delta)) as f32;
    assert!(failing(&ExtendedParameters { m_t: 1.1 * m_t, ..p }, example::REFERENCES).contains(&name));
}

#[test]
fn a_potential_that_leaves_no_damping_fails_its_row() {
    let p = example::parameters();
    let most = greatest_potential::<f64>(&Craft::example().law(&p).parameters) as f32;
    let with = |m_all: f32| failing(&ExtendedParameters { m_all, ..p }, example::REFERENCES);
    assert!(with(1.01 * most).is_empty());
    assert_eq!(with(0.99 * most)[..], ["D potential |P| < M_all"]);
}

#[test]
fn the_greatest_potential_bounds_the_laws_own_and_not_by_much() {
    let mut random = Random(91);
    for _ in 0..30 {
        let craft = Craft::random(&mut random);
        let parameters = craft.law(&craft.constants(&crate::extended::defaults::NOTHING_GIVEN)).parameters;
        let bound = greatest_potential(&parameters);
        let law = AttitudeLaw::new(&parameters, &craft.vehicle.inertia);
        let mut greatest = 0.0_f64;
        for _ in 0..5_000 {
            let q = random.attitude();
            let q = if f64::from(q.w) < -switching_magnitude::<f64>(parameters.delta) { -q } else { q };
            greatest = greatest.max(f64::from(law.feedback(&q, &Vector3::zeros()).tilt()));
        }
        // The bound takes each term where it is greatest in its cell.
        assert!(greatest <= bound && greatest > 0.93 * bound, "{greatest} of {bound}");
    }
}

#[test]
fn torques_beyond_the_limits_or_the_rotors_fail_their_rows() {
    let p = example::parameters();
    let limited = |torque_max: Vector3<f32>| {
        let craft = Craft::example();
        let limits = LimitParameters { thrust_max: 40.0, torque_max };
        let craft = Craft { limits: Limits::new(limits, &craft.vehicle).unwrap(), ..craft };
        failing_on(&craft, &p, example::REFERENCES)
    };
    assert_eq!(limited(Vector3::new(0.9, 1.0, 0.4))[..], ["T2 roll and pitch torque"]);
    assert_eq!(limited(Vector3::new(1.0, 0.9, 0.4))[..], ["T2 roll and pitch torque"]);
    assert_eq!(limited(Vector3::new(1.0, 1.0, 0.1))[..], ["T2 yaw torque"]);
    let weak = QuadX { speed_max: 1_100.0, ..example::QUAD };
    let craft = Craft { rotors: Rotors::quad_x(weak).unwrap(), ..Craft::example() };
    assert!(failing_on(&craft, &p, example::REFERENCES).contains(&"R rotors' range"));
    // More of the reserve, of the feedback, of yaw: each takes its part of the row.
    let available = |p: &ExtendedParameters| {
        let inequalities = certificate(&Craft::example(), p, example::REFERENCES).inequalities;
        ["R rotors' range", "T1 thrust floor at the greatest torque"].map(|name| {
            let row = inequalities.iter().find(|row| row.name == name).unwrap();
            row.available - row.required
        })
    };
    let [range, below] = available(&p);
    // What the rotors give at most is no part of the floor below T_max.
    let [weaker, as_before] = available(&ExtendedParameters { scale_least: 0.9 * p.scale_least, ..p });
    assert!(weaker < range && as_before == below);
    for more in [
        ExtendedParameters { turn_reserve: 1.1 * p.turn_reserve, ..p },
        ExtendedParameters { m_all: 1.1 * p.m_all, ..p },
        ExtendedParameters { yaw_acceleration: 1.1 * p.yaw_acceleration, ..p },
        ExtendedParameters { m_omega_z: 1.1 * p.m_omega_z, ..p },
        ExtendedParameters { torque_tilt: 1.1 * p.torque_tilt, ..p },
        ExtendedParameters { torque_yaw: 1.1 * p.torque_yaw, ..p },
        ExtendedParameters { turn_rate: 1.1 * p.turn_rate, ..p },
    ] {
        let [less, lower] = available(&more);
        assert!(less < range && lower < below, "{more:?}");
    }
}

#[test]
fn a_reference_is_feasible_with_its_drag_or_not_at_all() {
    let with = |drag_across: f32| ExtendedParameters { drag_across, ..example::parameters() };
    let drag = 0.5;
    let with_drag = ReferenceBounds {
        horizontal_acceleration: 2.4675 + drag * 3.0,
        jerk: 3.876 + drag * 2.4675,
        snap: 6.089 + drag * 3.876,
        ..example::REFERENCES
    };
    let undragged = feasible_rows(&with(0.0), with_drag);
    for (row, other) in feasible_rows(&with(drag), example::REFERENCES).iter().zip(undragged) {
        assert!((row.required - other.required).abs() < 1e-5 && row.available == other.available, "{}", row.name);
    }
}

#[test]
fn without_rotors_the_limits_alone_bound_torques_and_thrust() {
    let craft = Craft::example();
    let law = craft.law(&example::parameters());
    let configuration = Configuration::extended(craft.vehicle, craft.limits, law, example::REFERENCES).unwrap();
    let certificate = ExtendedCertificate::new(&configuration, &law).unwrap();
    assert_eq!(certificate.inequalities.len(), 13);
    assert!(certificate.bounds.rotors.is_empty());
    let limits = craft.limits.torque_max.map(f64::from);
    assert!((certificate.bounds.torque - limits).max() < 1e-4, "{}", certificate.bounds.torque);
}

#[test]
fn a_thrust_limit_below_what_torques_raise_the_floor_to_fails_its_row() {
    let name = "T1 thrust floor at the greatest torque";
    let p = example::parameters();
    let row_at = |thrust_max: f32| {
        let craft = Craft::example();
        let limits = LimitParameters { thrust_max, torque_max: Vector3::repeat(9.0) };
        let craft = Craft { limits: Limits::new(limits, &craft.vehicle).unwrap(), ..craft };
        let inequalities = certificate(&craft, &p, ReferenceBounds::REST).inequalities;
        inequalities.into_iter().find(|row| row.name == name).unwrap()
    };
    // Newton for newton.
    let row = row_at(40.0);
    let least = 40.0 - (row.available - row.required) as f32;
    assert!(row.holds() && least > 6.0, "{row}");
    assert!(row_at(least + 0.01).holds() && !row_at(least - 0.01).holds());
    // Idling rotors take their least from it, as commanded where they deliver the most.
    let quad = QuadX { speed_min: 200.0, ..example::QUAD };
    let idling = Craft { rotors: Rotors::quad_x(quad).unwrap(), ..Craft::example() };
    let available = |craft: &Craft| {
        let inequalities = certificate(craft, &p, ReferenceBounds::REST).inequalities;
        inequalities.iter().find(|row| row.name == name).unwrap().available
    };
    let taken = 4.0 * f64::from(p.scale_greatest * quad.thrust_coefficient * 200.0 * 200.0);
    let difference = available(&Craft::example()) - available(&idling);
    assert!((difference / taken - 1.0).abs() < 1e-4, "{difference} {taken}");
}
