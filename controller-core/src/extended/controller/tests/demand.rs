//! The law on demand: the same limits, the same filters, and nothing else of the flight in the demand's hands.

use super::*;
use crate::extended::fallback::Fallback;

/// Any demand, of sizes from nothing to absurd, some of them kept for a while by their user.
pub(super) fn any(random: &mut Random) -> Demand {
    let size = random.logarithmic(0.1, 1e5);
    if random.below(2) == 0 {
        Demand::Acceleration { acceleration: random.vector(size), yaw_rate: size * random.signed() }
    } else {
        Demand::Attitude { attitude: random.attitude(), thrust: size * random.signed() }
    }
}

#[test]
fn no_sequence_of_demands_exceeds_the_limits_or_the_rotors() {
    let mut random = Random(85);
    for number in 0..60 {
        let craft = if number == 0 { Craft::example() } else { Craft::random(&mut random) };
        assert!(kept_to_its_limits(&craft, 1_500, &mut random, true), "{craft:?}");
    }
}

#[test]
fn what_feedback_would_command_is_the_same_step_on_demand() {
    let parameters = ExtendedParameters { drag_across: 0.4, ..example::parameters() };
    let (mut law, mut random) = (controller(&parameters), Random(86));
    let mut state = anywhere(&mut random);
    // A force well within its levels: at them feedback may be beyond the envelope.
    law.memory.averages.force = Vector3::new(0.5, -0.3, 0.4);
    for _ in 0..300 {
        state.velocity += random.vector(0.05);
        state.position += state.velocity * 0.01;
        state.angular_velocity = random.vector(1.0);
        law.hold_estimates();
        let mut demanding = law.clone();
        let (wrench, diagnostics) = law.step(&state, &hover()).unwrap();
        let estimated = law.estimates().force;
        let drag = Vector3::new(state.velocity.x, state.velocity.y, 0.0) * parameters.drag_across;
        let demand = Demand::Acceleration { acceleration: diagnostics.feedback + estimated - drag, yaw_rate: 0.0 };
        let (demanded, same) = demanding.step_on_demand(&state, &hover(), &demand).unwrap();
        assert!((same.feedback - diagnostics.feedback).norm() < 1e-3, "{same:?} {diagnostics:?}");
        assert!((demanded.torque - wrench.torque).norm() < 1e-3, "{demanded:?} {wrench:?}");
        assert_eq!((same.z_1, same.z_2), (diagnostics.z_1, diagnostics.z_2));
    }
}

#[test]
fn a_demand_is_cut_to_the_envelope_the_vertical_first() {
    let mut random = Random(87);
    for _ in 0..40 {
        let craft = Craft::random(&mut random);
        let p = craft.constants(&NOTHING_GIVEN);
        let mut law = build(&craft, &p);
        let gravity = craft.vehicle.gravity;
        for _ in 0..50 {
            let (_, diagnostics) = law.step_on_demand(&resting(Vector3::zeros()), &hover(), &any(&mut random)).unwrap();
            let (ubar, max) = (diagnostics.feedback, law.ceiling.at(law.thrust_scale(), &law.estimates().torque));
            let lift = gravity + ubar.z;
            assert!(ubar.z >= -p.a_down && lift <= max * (1.0 + 1e-6), "{ubar}");
            let (across, all) = (ubar.xy().norm(), ubar.xy().norm().hypot(lift));
            assert!(across <= p.a_across * (1.0 + 1e-5) && across <= lift * p.tilt_max.tan(), "{ubar}");
            assert!(all <= max * (1.0 + 1e-5), "{ubar} {max}");
        }
    }
}

#[test]
fn an_attitude_and_its_thrust_are_the_acceleration_that_they_make() {
    let (mut one, mut random) = (controller(&example::parameters()), Random(88));
    for _ in 0..50 {
        let tilted = Quaternion::new(1.0, 0.2 * random.signed(), 0.2 * random.signed(), random.signed());
        let attitude = tilted / tilted.norm();
        let thrust = 0.5 * 9.81 * random.between(0.7, 1.3);
        let mut ubar = thrust_axis(&attitude) * (thrust / 0.5);
        ubar.z -= 9.81;
        let demand = Demand::Attitude { attitude, thrust };
        let (_, diagnostics) = one.step_on_demand(&resting(Vector3::zeros()), &hover(), &demand).unwrap();
        assert!((diagnostics.feedback - ubar).norm() < 1e-5, "{} {ubar}", diagnostics.feedback);
    }
}

#[test]
fn a_demand_that_cannot_be_used_is_refused_by_name_and_leaves_no_trace() {
    let mut law = controller(&example::parameters());
    law.step(&resting(Vector3::zeros()), &hover()).unwrap();
    let before = law.clone();
    let level = Quaternion::new(1.0, 0.0, 0.0, 0.0);
    let still = Vector3::zeros();
    let not_finite = |field| InputError::NotFinite { field };
    for (demand, error) in [
        (
            Demand::Acceleration { acceleration: Vector3::new(0.0, f32::NAN, 0.0), yaw_rate: 0.0 },
            not_finite("demand.acceleration"),
        ),
        (
            Demand::Acceleration { acceleration: Vector3::new(0.0, 0.0, -1e7), yaw_rate: 0.0 },
            InputError::OutOfRange { field: "demand.acceleration" },
        ),
        (Demand::Acceleration { acceleration: still, yaw_rate: f32::INFINITY }, not_finite("demand.yaw_rate")),
        (Demand::Attitude { attitude: level, thrust: f32::NAN }, not_finite("demand.thrust")),
        (
            Demand::Attitude { attitude: Quaternion::new(f32::NAN, 0.0, 0.0, 0.0), thrust: 1.0 },
            not_finite("demand.attitude"),
        ),
        (
            Demand::Attitude { attitude: level * 0.9, thrust: 1.0 },
            InputError::NotARotation { field: "demand.attitude" },
        ),
    ] {
        assert_eq!(law.step_on_demand(&resting(still), &hover(), &demand).unwrap_err(), error);
        assert_eq!(law, before);
    }
    let demand = Demand::Acceleration { acceleration: still, yaw_rate: 0.0 };
    let broken = State { velocity: Vector3::repeat(f32::NAN), ..resting(still) };
    assert!(law.step_on_demand(&broken, &hover(), &demand).is_err());
    assert_eq!(law, before);
}

#[test]
fn the_fallback_counts_nothing_while_a_policy_flies() {
    let mut law = controller(&example::parameters());
    let demand = |random: &mut Random| Demand::Acceleration { acceleration: random.vector(30.0), yaw_rate: 0.0 };
    let mut random = Random(89);
    for _ in 0..10_000 {
        law.hold_estimates();
        let state = State { position: random.vector(50.0), ..anywhere(&mut random) };
        law.step_on_demand(&state, &hover(), &demand(&mut random)).unwrap();
    }
    assert_eq!(law.memory().fallback, Fallback::FRESH);
}

/// Random filters and motions, stopped by feedback alone through the filters, in small steps.
#[test]
fn a_vehicle_that_is_not_limited_stops_where_the_prospect_has_it() {
    let mut random = Random(90);
    let h = 1e-4;
    for _ in 0..60 {
        let craft = Craft::random(&mut random);
        let p = craft.constants(&NOTHING_GIVEN);
        let law = PositionLaw::new(&p, craft.vehicle.gravity, h).unwrap();
        let max = build(&craft, &p).ceiling.at(1.0, &Vector3::zeros());
        let force =
            Vector3::new(random.signed(), random.signed(), random.signed()) * (0.2 * p.force_down.min(p.force_up));
        let levels =
            FeedbackLimits { up: f32::MAX, down: 0.4 * craft.vehicle.gravity, across: 0.8 * craft.vehicle.gravity };
        let mut filters =
            Filters { command: random.vector(4.0), intermediate: random.vector(4.0), smoothed: random.vector(4.0) };
        let mut state = State { velocity: random.vector(4.0), ..resting(random.vector(2.0)) };
        let origin = Reference::resting(Vector3::zeros(), Heading::FORWARD);
        let errors = law.errors(&state, &origin, &filters, &force);
        let stop = errors.z_1 + law.stopping_way(&errors.z_2, &law.stopping_levels(&errors.z_2, &force, max, &levels));
        let [first, second] = law.stages(&state, &filters, &force);
        let places = [state.position, first, second, errors.z_1, stop];
        let low = places.iter().fold(places[0], |low, place| low.inf(place));
        let high = places.iter().fold(places[0], |high, place| high.sup(place));
        let refuge = Reference::resting(errors.z_1, Heading::FORWARD);
        let mut stopped = false;
        for _ in 0..100_000 {
            let feedback = law.feedback(&state, &refuge, &filters, &force, max, &levels);
            stopped |= feedback.errors.z_2.norm() < 0.05;
            if stopped {
                break;
            }
            let mut acceleration = filters.command + force;
            acceleration.z = feedback.smoothed.z + force.z;
            filters = law.advance(&filters, &feedback.smoothed, &feedback.drive, f32::MAX);
            state.position += (state.velocity + acceleration * (0.5 * h)) * h;
            state.velocity += acceleration * h;
            let room = Vector3::repeat(0.01);
            assert!(state.position >= low - room && state.position <= high + room, "{state:?} {low} {high}");
        }
        assert!(stopped);
    }
}
