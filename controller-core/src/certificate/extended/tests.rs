use super::*;
use crate::allocation::{QuadX, Rotors};
use crate::extended::parameters::ExtendedParameters;
use crate::extended::tests::Random;
use crate::extended::tests::example::{self, Craft};
use crate::vehicle::LimitParameters;
use crate::vehicle::Limits;
use nalgebra::Vector3;

fn certificate(craft: &Craft, parameters: &ExtendedParameters, bounds: ReferenceBounds) -> ExtendedCertificate {
    let configuration = craft.configuration(parameters, bounds);
    ExtendedCertificate::new(&configuration, &craft.law(parameters)).unwrap()
}

/// The rows that fail on the example's vehicle with these constants and references.
fn failing(parameters: &ExtendedParameters, bounds: ReferenceBounds) -> Vec<&'static str, INEQUALITIES_MAX> {
    failing_on(&Craft::example(), parameters, bounds)
}

fn failing_on(
    craft: &Craft,
    parameters: &ExtendedParameters,
    bounds: ReferenceBounds,
) -> Vec<&'static str, INEQUALITIES_MAX> {
    let inequalities = certificate(craft, parameters, bounds).inequalities;
    collected(inequalities.iter().filter(|row| !row.holds()).map(|row| row.name))
}

#[test]
fn the_example_is_certified_with_every_row_of_the_table() {
    let certificate = certificate(&Craft::example(), &example::parameters(), example::REFERENCES);
    assert_eq!(certificate.inequalities.len(), INEQUALITIES_MAX);
    assert!(certificate.inequalities.iter().all(Inequality::holds), "{:?}", certificate.inequalities);
    assert_eq!(certificate.bounds.rotors.len(), 4);
}

#[test]
fn a_reference_that_falls_as_fast_as_the_law_may_fails_t1() {
    let p = example::parameters();
    let min = example::vehicle().gravity - p.a_down;
    let rows = feasible_rows(&p, ReferenceBounds { vertical_acceleration: min.next_down(), ..example::REFERENCES });
    let [fall, ..] = rows;
    assert!(fall.available - fall.required < 1e-5 && fall.holds());
}

fn feasible_rows(parameters: &ExtendedParameters, bounds: ReferenceBounds) -> [Inequality; 5] {
    let craft = Craft::example();
    let configuration = craft.configuration(parameters, bounds);
    let budget = TorqueBudget::new(parameters.floor_margin, &craft.limits, Some(&craft.rotors));
    feasibility(&configuration, &craft.law(parameters).parameters, &budget)
}

#[test]
fn a_reference_that_thrust_does_not_hold_fails_its_row() {
    let p = example::parameters();
    let [_, thrust, ..] = feasible_rows(&p, example::REFERENCES);
    let max = ((thrust.available / 0.5).powi(2) - 9.9855_f64.powi(2)).sqrt() as f32 - 0.47 * 3.0;
    let with = |share: f32| {
        let bounds = ReferenceBounds { horizontal_acceleration: share * max, ..example::REFERENCES };
        failing(&p, bounds).contains(&"A1 thrust for the reference")
    };
    assert!(!with(0.99) && with(1.01));
}

#[test]
fn references_that_turn_the_thrust_too_fast_or_too_suddenly_fail_their_rows() {
    let p = example::parameters();
    let jerky = ReferenceBounds { jerk: 60.0, ..example::REFERENCES };
    assert!(failing(&p, jerky).contains(&"A1 turning rate for the reference"));
    let [_, _, rate, acceleration, _] = feasible_rows(&p, example::REFERENCES);
    // All there is of |u'|: the reference's with its drag, and the slowed law's across and along the vertical.
    let slow = Slowed::<f64>::new(&p, 9.81);
    let (level, [k_f, k_s]) = (2.0_f64.sqrt() * slow.level, [p.k_f, p.k_s].map(|k| slow.factor * f64::from(k)));
    let min = 9.81 - 0.1755 - f64::from(p.force_up) - slow.level;
    let expected = (3.876 + 0.47 * 2.4675 + 2.0 * k_f * level) / min;
    assert!((rate.required / expected - 1.0).abs() < 1e-4 && rate.available == f64::from(p.turn_rate), "{rate}");
    // Beside it 2 p r / n, p and r / n together as long as |u'| / n.
    let snap = 6.089 + 0.47 * 3.876 + 2.0 * k_f * (k_s + k_f) * level;
    let expected = snap / min + expected * expected;
    // The allowance for arithmetic, three times.
    assert!((acceleration.required / expected - 1.0).abs() < 3e-4, "{acceleration} {expected}");
    assert!(acceleration.available == f64::from(p.turn_reserve));
    let snappy = ReferenceBounds { snap: 6.1 + 9.81 * p.turn_reserve, ..example::REFERENCES };
    assert!(failing(&p, snappy).contains(&"A1 turning acceleration"));
}

#[test]
fn headings_that_turn_too_suddenly_fail_their_row() {
    let p = example::parameters();
    let sudden = ReferenceBounds { heading_second_derivative: p.yaw_acceleration, ..example::REFERENCES };
    assert_eq!(failing(&p, sudden)[..], ["A1 heading acceleration"]);
    // The force in which the heading is proven to arrive tilts u: the same heading then turns faster.
    let tilted = |force_heading: f32| {
        let parameters = ExtendedParameters { force_heading, ..p };
        let craft = Craft::example();
        heading::<f64>(&craft.configuration(&parameters, example::REFERENCES), &craft.law(&parameters).parameters)
    };
    assert!(tilted(0.0).required < tilted(5.0).required);
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
    // The reserve raises it by what its torque takes of a rotor, and the heading's likewise.
    let craft = Craft::example();
    let [tilt_reach, yaw_reach] = TorqueBudget::<f64>::new(p.floor_margin, &craft.limits, Some(&craft.rotors)).reach;
    let inertia = craft.vehicle.inertia.map(f64::from);
    for (more, expected) in [
        (ExtendedParameters { turn_reserve: p.turn_reserve + 1.0, ..p }, tilt_reach * inertia.x.max(inertia.y)),
        (ExtendedParameters { yaw_acceleration: p.yaw_acceleration + 1.0, ..p }, yaw_reach * inertia.z),
    ] {
        let [.., raised] = feasible_rows(&more, example::REFERENCES);
        assert!(((raised.required - floor.required) / expected - 1.0).abs() < 1e-3, "{raised} {floor}");
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
    let yaw = example::vehicle().inertia.z * p.yaw_acceleration;
    assert_eq!(limited(Vector3::new(1.0, 1.0, 0.99 * yaw))[..], ["T2 yaw torque"]);
    assert!(limited(Vector3::new(1.0, 1.0, 1.01 * yaw)).is_empty());
    let weak = QuadX { speed_max: 850.0, ..example::QUAD };
    let craft = Craft { rotors: Rotors::quad_x(weak).unwrap(), ..Craft::example() };
    assert!(failing_on(&craft, &p, example::REFERENCES).contains(&"R rotors' range"));
    let max = ExtendedParameters { torque_tilt: 2.0 * p.m_tilt, ..p };
    assert_eq!(failing(&max, example::REFERENCES)[..], ["D greatest torque bias"]);
    // More of the reserve, more of the feedback: each takes its part of the row.
    let left = |p: &ExtendedParameters| {
        let inequalities = certificate(&Craft::example(), p, example::REFERENCES).inequalities;
        ["R rotors' range", "T1 thrust floor at the greatest torque"].map(|name| {
            let row = inequalities.iter().find(|row| row.name == name).unwrap();
            row.available - row.required
        })
    };
    let [range, below] = left(&p);
    // What the rotors give at most is no part of the floor below T_max.
    let [weaker, as_before] = left(&ExtendedParameters { scale_least: 0.9 * p.scale_least, ..p });
    assert!(weaker < range && as_before == below);
    for more in [
        ExtendedParameters { turn_reserve: 1.1 * p.turn_reserve, ..p },
        ExtendedParameters { m_tilt: 1.1 * p.m_tilt, ..p },
    ] {
        let [less, lower] = left(&more);
        assert!(less < range && lower < below, "{more:?}");
    }
}

/// What the bounds say of a torque is what a tick could spend, and no more than a thousandth beside it.
#[test]
fn the_bounds_of_torques_are_the_rows_own() {
    let mut random = Random(92);
    for _ in 0..50 {
        let craft = Craft::random(&mut random);
        let p = craft.constants(&crate::extended::defaults::NOTHING_GIVEN);
        let found = certificate(&craft, &p, ReferenceBounds::REST).bounds.torque;
        let budget = TorqueBudget::<f64>::new(p.floor_margin, &craft.limits, Some(&craft.rotors));
        let mut max = [0.0_f64; 2];
        for scale in [p.scale_least, p.scale_greatest].map(f64::from) {
            for degrees in 0..3_600 {
                let (sin, cos) = (f64::from(degrees) * 0.1).to_radians().sin_cos();
                let along = budget
                    .rows
                    .iter()
                    .map(|row| row.capacity(scale) / (row.direction[0] * cos + row.direction[1] * sin).abs());
                let most = along.fold(f64::INFINITY, f64::min);
                max = [max[0].max(most * cos), max[1].max(most * sin)];
            }
        }
        for (bound, max) in [found.x, found.y].into_iter().zip(max) {
            assert!(max <= bound && bound < 1.01 * max, "{bound} {max}");
        }
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
    assert_eq!(certificate.inequalities.len(), 9);
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
    // Newton for newton, by the part of it that a torque takes from one rotor.
    let row = row_at(40.0);
    let reach = (row.available - row_at(39.0).available).recip();
    let min = 40.0 - ((row.available - row.required) * reach) as f32;
    assert!(row.holds() && min > 6.0 && reach > 1.0, "{row}");
    assert!(row_at(min + 0.01).holds() && !row_at(min - 0.01).holds());
    // Idling rotors take their least from it, as commanded where they deliver the most.
    let quad = QuadX { speed_min: 200.0, ..example::QUAD };
    let idling = Craft { rotors: Rotors::quad_x(quad).unwrap(), ..Craft::example() };
    let available = |craft: &Craft| {
        let limits = LimitParameters { thrust_max: 40.0, torque_max: Vector3::repeat(9.0) };
        let craft = Craft { limits: Limits::new(limits, &craft.vehicle).unwrap(), ..craft.clone() };
        let inequalities = certificate(&craft, &p, ReferenceBounds::REST).inequalities;
        inequalities.iter().find(|row| row.name == name).unwrap().available * reach
    };
    let taken = 4.0 * f64::from(p.scale_greatest * quad.thrust_coefficient * 200.0 * 200.0);
    let difference = available(&Craft::example()) - available(&idling);
    assert!((difference / taken - 1.0).abs() < 1e-4, "{difference} {taken}");
}
