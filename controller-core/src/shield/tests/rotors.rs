//! Demands of rotor speeds: they fly as they are, the law learns from them, and can take over at any tick.

use super::*;
use crate::allocation::{MinimumNorm, Rotor, Rotors};
use crate::extended::memory::Memory;

/// About what hovers.
const HOVERING: Demand = Demand::Rotors { speeds: [-0.47; 4] };

#[test]
fn speeds_fly_as_they_are_cut_to_the_rotors_and_are_what_flew_last() {
    let (mut law, mut shield) = shielded(&settings());
    let mixer = MinimumNorm::new(&example::rotors());
    for speeds in [[-0.4, -0.5, -0.3, -0.45], [0.6, 0.7, 0.65, 0.6], [-1.0, -1.5, -9.0, -1.0]] {
        let flown = shield.step(&mut law, &resting(MIDDLE), Some(&Demand::Rotors { speeds })).unwrap();
        assert_eq!(flown.reason, None);
        assert!(!mixer.allocate(&flown.wrench.scaled(1.0 / law.thrust_scale())).unwrap().clipped);
        for (told, wanted) in shield.rotors(&law).iter().zip(speeds) {
            // The least speed of these rotors is zero, where a little of a thrust is much of a speed.
            assert!((told - wanted.clamp(-1.0, 1.0)).abs() < 1e-2, "{told} {wanted}");
        }
    }
    // Front right and back right faster: the vehicle rolls to its left, where roll is negative. All that there is of it
    // is more than the limit.
    let flip = Demand::Rotors { speeds: [1.0, 1.0, -1.0, -1.0] };
    let torque = shield.step(&mut law, &resting(MIDDLE), Some(&flip)).unwrap().wrench.torque;
    assert!((torque - Vector3::new(-1.0, 0.0, 0.0)).norm() < 1e-3, "{torque}");
    let climb = Demand::Rotors { speeds: [9.0; 4] };
    assert!((shield.step(&mut law, &resting(MIDDLE), Some(&climb)).unwrap().wrench.thrust - 40.0).abs() < 1e-4);
    let roll = Demand::Rotors { speeds: [-0.4, -0.4, -0.5, -0.5] };
    assert!(shield.step(&mut law, &resting(MIDDLE), Some(&roll)).unwrap().wrench.torque.x < -0.05);
}

/// The thrust scale that the caller divides by is the one of after the tick: full speeds stay within the ranges while
/// it is learnt.
#[test]
fn no_rotor_leaves_its_range_while_the_thrust_scale_is_learnt() {
    let (mut law, mut shield) = shielded(&settings());
    let (mixer, mut random) = (MinimumNorm::new(&example::rotors()), Random(122));
    let mut scales = std::vec::Vec::new();
    for tick in 0..400 {
        // Velocities that no command explains move the estimate.
        let state = State { velocity: Vector3::new(0.0, 0.0, 2.0 * random.signed()), ..resting(MIDDLE) };
        shield.reset(&Heading::FORWARD);
        let speeds = core::array::from_fn(|_| if tick % 3 == 0 { 1.0 } else { random.signed() });
        let flown = shield.step(&mut law, &state, Some(&Demand::Rotors { speeds })).unwrap();
        let allocated = mixer.allocate(&flown.wrench.scaled(1.0 / law.thrust_scale())).unwrap();
        assert!(flown.reason.is_some() || !allocated.clipped, "{tick} {speeds:?}");
        scales.push(law.thrust_scale());
    }
    assert!(scales.iter().copied().fold(0.0, f32::max) - scales.iter().copied().fold(9.0, f32::min) > 0.05);
}

/// While the law flies, a policy sees what the law told the rotors.
#[test]
fn what_flew_last_is_the_laws_where_the_law_flies() {
    let (mut law, mut shield) = shielded(&settings());
    let flown = shield.step(&mut law, &resting(MIDDLE), Some(&NONSENSE)).unwrap();
    assert_eq!(flown.reason, Some(Reason::Demand));
    let seen = shield.observation(&law, &resting(MIDDLE), &MIDDLE);
    let level = example::vehicle().mass * 9.81 / 4.0;
    let [min, max] = [example::rotors()[0].thrust_min, example::rotors()[0].thrust_max].map(f32::sqrt);
    let wanted = 2.0 * (level.sqrt() - min) / (max - min) - 1.0;
    assert!(seen.rotors.iter().all(|speed| (speed - wanted).abs() < 0.02), "{:?} {wanted}", seen.rotors);
    assert_eq!((seen.goal, seen.heading), (MIDDLE, *shield.heading()));
}

#[test]
fn a_vehicle_that_is_no_x_takes_a_demand_of_speeds_for_unusable() {
    let craft = Craft::example();
    let one_way: std::vec::Vec<Rotor> = craft.rotors.iter().rev().copied().collect();
    let mirrored: std::vec::Vec<Rotor> = one_way
        .iter()
        .map(|rotor| Rotor { position: Vector3::new(rotor.position.x, -rotor.position.y, 0.0), ..*rotor })
        .collect();
    for (rotors, flies) in [(one_way, true), (mirrored, false)] {
        let craft = Craft { rotors: Rotors::new(&rotors).unwrap(), ..craft.clone() };
        let parameters = example::parameters();
        let law = craft.law(&parameters);
        let mut law = Controller::build(&craft.vehicle, &craft.limits, &law, Some(&craft.rotors), PERIOD).unwrap();
        let mut shield = Shield::new(&craft.configuration(&parameters, bounds()), &settings(), PERIOD).unwrap();
        assert_eq!(shield.flies_rotors(), flies);
        let reason = shield.step(&mut law, &resting(MIDDLE), Some(&HOVERING)).unwrap().reason;
        assert_eq!(reason, if flies { None } else { Some(Reason::Demand) });
        assert!(flies || shield.rotors(&law) == [0.0; 4]);
    }
    // The law by itself flies none.
    let (mut law, _) = shielded(&settings());
    let refused = law.step_on_demand(&resting(MIDDLE), &Reference::resting(MIDDLE, Heading::FORWARD), &HOVERING);
    assert_eq!(refused.unwrap_err(), InputError::OutOfRange { field: "demand.speeds" });
}

/// Beside whatever speeds, c and x are in the envelope, where the law's own feedback takes them: the cone, the ceiling
/// and the floor hold for both.
#[test]
fn the_memory_beside_speeds_is_one_that_the_laws_own_flights_could_have() {
    let (parameters, gravity) = (example::parameters(), 9.81);
    let mut random = Random(121);
    let (mut law, mut shield) = shielded(&settings());
    let tangent = parameters.tilt_max.tan();
    let mut flown = 0;
    for _ in 0..5_000 {
        let speeds = core::array::from_fn(|_| 1.5 * random.signed());
        let attitude = Quaternion::new(1.0, 0.6 * random.signed(), 0.6 * random.signed(), random.signed()).normalize();
        let state = State {
            velocity: random.vector(2.0),
            attitude,
            angular_velocity: random.vector(5.0),
            ..resting(MIDDLE + random.vector(0.5))
        };
        shield.reset(&Heading::FORWARD);
        let step = shield.step(&mut law, &state, Some(&Demand::Rotors { speeds })).unwrap();
        if step.reason.is_some() {
            continue;
        }
        flown += 1;
        let Memory { filters, .. } = law.memory();
        for u in [filters.command, filters.intermediate] {
            let lift = gravity + u.z;
            let across = u.xy().norm();
            assert!(u.z >= -parameters.a_down - 1e-4 && across <= parameters.a_across + 1e-4, "{u:?}");
            assert!(across <= lift * tangent + 1e-3, "{u:?}");
        }
    }
    assert!(flown > 500, "{flown}");
}

/// At a hand-over the law starts from where the thrust points, its frame turning as the vehicle does, with the lift
/// that holds the height: whatever thrust flew before is gone at once.
#[test]
fn the_law_takes_over_from_where_the_thrust_points() {
    let (mut law, mut shield) = shielded(&settings());
    let tilted = Quaternion::new(0.2_f32.cos(), 0.2_f32.sin(), 0.0, 0.0);
    let state = State { attitude: tilted, angular_velocity: Vector3::new(0.5, 0.0, 0.0), ..resting(MIDDLE) };
    let flown = shield.step(&mut law, &state, Some(&Demand::Rotors { speeds: [0.3; 4] })).unwrap();
    let taken = shield.step(&mut law, &state, Some(&NONSENSE)).unwrap();
    assert_eq!((flown.reason, taken.reason), (None, Some(Reason::Demand)));
    let axis = Vector3::new(0.0, -0.4_f32.sin(), 0.4_f32.cos());
    let command = taken.diagnostics.acceleration_command;
    assert!((command.normalize() - axis).norm() < 0.02, "{command:?}");
    assert!(flown.wrench.thrust > 20.0 && taken.wrench.thrust < 7.0, "{} {}", flown.wrench.thrust, taken.wrench.thrust);
    let rate = taken.diagnostics.desired_angular_velocity;
    assert!((rate.x - 0.5).abs() < 0.1 && rate.y.abs() < 0.05, "{rate:?}");
}
