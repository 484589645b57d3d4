//! The shield: its rules as data, hand-overs both ways, the heading within its bounds.

extern crate std;
use super::heading::HeadingGenerator;
use super::settings::ROOMS_MAX;
use super::*;
use crate::extended::actuators::ActuatorParameters;
use crate::extended::tests::Random;
use crate::extended::tests::example::{self, Craft};
use crate::reference::ReferenceBounds;
use nalgebra::{Quaternion, Vector2};
use std::vec::Vec;

const PERIOD: f32 = 0.01;
const MIDDLE: Vector3<f32> = Vector3::new(0.0, 0.0, 3.0);
const HOVER: Demand = Demand::Acceleration { acceleration: Vector3::new(0.0, 0.0, 0.0), yaw_rate: 0.0 };
const NONSENSE: Demand = Demand::Acceleration { acceleration: Vector3::new(f32::NAN, 0.0, 0.0), yaw_rate: 0.0 };

const ROOM: Room = Room::new(Vector3::new(-4.0, -4.0, 0.5), Vector3::new(4.0, 4.0, 6.0));

fn settings() -> Settings {
    Settings::new(ROOM.low, ROOM.high)
}

fn bounds() -> ReferenceBounds {
    ReferenceBounds { heading_rate: 1.2, heading_second_derivative: 1.7, ..ReferenceBounds::REST }
}

/// The Hummingbird on rotors that follow at once, and a shield for it.
fn shielded(settings: &Settings) -> (Controller, Shield) {
    let actuators = ActuatorParameters { lag: 0.0, delay: 0.0 };
    let craft = Craft { actuators, ..Craft::example() };
    let parameters = example::parameters();
    let law = craft.law(&parameters);
    let controller = Controller::build(&craft.vehicle, &craft.limits, &law, Some(&craft.rotors), PERIOD).unwrap();
    let shield = Shield::new(&craft.configuration(&parameters, bounds()), settings, PERIOD).unwrap();
    (controller, shield)
}

fn resting(position: Vector3<f32>) -> State {
    let (zero, attitude) = (Vector3::zeros(), Quaternion::new(1.0, 0.0, 0.0, 0.0));
    State { position, velocity: zero, attitude, angular_velocity: zero }
}

/// The reasons, tick by tick, of a vehicle that stands still at its place whatever is commanded.
fn reasons(
    shield: &mut Shield,
    law: &mut Controller,
    ticks: u32,
    offers: impl Fn(u32) -> Option<Demand>,
) -> Vec<Option<Reason>> {
    let fly = |tick| shield.step(law, &resting(MIDDLE), offers(tick).as_ref()).unwrap().reason;
    (0..ticks).map(fly).collect()
}

/// Each rule on its own: a state, and what is said of it when a hover is demanded.
#[test]
fn every_rule_of_the_table_hands_over_with_its_own_reason() {
    let p = example::parameters();
    let inertia = example::vehicle().inertia;
    let fastest = 1.15 * p.turn_rate + (2.0 * monitor::TILT_MAX_RAD * p.m_tilt / inertia.x.max(inertia.y)).sqrt();
    let tilted = |angle: f32| Quaternion::new((0.5 * angle).cos(), (0.5 * angle).sin(), 0.0, 0.0);
    let turning = |x, z| Vector3::new(x, 0.0, z);
    let middle = resting(MIDDLE);
    for (state, reason) in [
        (middle, None),
        (State { attitude: tilted(0.99 * monitor::TILT_MAX_RAD), ..middle }, None),
        (State { attitude: tilted(1.01 * monitor::TILT_MAX_RAD), ..middle }, Some(Reason::Tilt)),
        (State { attitude: tilted(3.1), ..middle }, Some(Reason::Tilt)),
        (State { angular_velocity: turning(0.99 * fastest, 0.0), ..middle }, None),
        (State { angular_velocity: turning(1.01 * fastest, 0.0), ..middle }, Some(Reason::Rate)),
        (State { angular_velocity: turning(0.0, 2.99 * p.yaw_rate), ..middle }, None),
        (State { angular_velocity: turning(0.0, -3.01 * p.yaw_rate), ..middle }, Some(Reason::Rate)),
        (State { velocity: Vector3::new(0.0, 10.1, 0.0), ..middle }, Some(Reason::Speed)),
        (State { velocity: Vector3::new(0.0, 1.0, 0.0), ..middle }, None),
        (State { velocity: Vector3::new(0.0, 8.0, 0.0), ..middle }, Some(Reason::Stop)),
        (State { velocity: Vector3::new(0.0, 0.0, -8.0), ..resting(Vector3::new(0.0, 0.0, 1.0)) }, Some(Reason::Stop)),
        (resting(Vector3::new(0.0, 0.0, 0.4)), Some(Reason::Stop)),
        (resting(Vector3::new(0.0, -4.1, 3.0)), Some(Reason::Stop)),
    ] {
        let (mut law, mut shield) = shielded(&settings());
        let flown = shield.step(&mut law, &state, Some(&HOVER)).unwrap();
        assert_eq!(flown.reason, reason, "{state:?}");
    }
    for (offers, reason) in [(None, Reason::Silent), (Some(NONSENSE), Reason::Demand)] {
        let (mut law, mut shield) = shielded(&settings());
        assert_eq!(shield.step(&mut law, &middle, offers.as_ref()).unwrap().reason, Some(reason));
    }
}

#[test]
fn an_estimate_in_doubt_for_a_second_hands_over() {
    let (mut law, mut shield) = shielded(&settings());
    let held = |law: &mut Controller, shield: &mut Shield| {
        law.hold_estimates();
        shield.step(law, &resting(MIDDLE), Some(&HOVER)).unwrap().reason
    };
    for _ in 0..100 {
        assert_eq!(held(&mut law, &mut shield), None);
    }
    assert_eq!(held(&mut law, &mut shield), Some(Reason::Estimate));
}

#[test]
fn a_demand_is_flown_for_the_time_of_silence_and_no_longer() {
    let (mut law, mut shield) = shielded(&settings());
    let said = reasons(&mut shield, &mut law, 30, |tick| (tick == 0).then_some(HOVER));
    assert!(said[..=10].iter().all(Option::is_none));
    assert!(said[11..].iter().all(|reason| *reason == Some(Reason::Silent)));
}

#[test]
fn the_policy_waits_twice_as_long_after_each_hand_over_and_in_the_end_for_a_person() {
    let settings = Settings { patience: 0.1, patience_greatest: 0.35, hand_overs: 5, ..settings() };
    let (mut law, mut shield) = shielded(&settings);
    reasons(&mut shield, &mut law, 1, |_| Some(HOVER));
    let mut waits = Vec::new();
    for _ in 0..4 {
        let said = reasons(&mut shield, &mut law, 50, |tick| Some(if tick == 0 { NONSENSE } else { HOVER }));
        let waited = said.iter().take_while(|reason| **reason == Some(Reason::Demand)).count();
        assert!(said[waited..].iter().all(Option::is_none));
        waits.push(waited);
    }
    assert_eq!(waits, [11, 21, 35, 35]);
    let said = reasons(&mut shield, &mut law, 500, |tick| Some(if tick == 0 { NONSENSE } else { HOVER }));
    assert!(said.iter().all(|reason| *reason == Some(Reason::Demand)));
    assert_eq!(shield.hand_overs(), 5);
    shield.request_again();
    let said = reasons(&mut shield, &mut law, 1, |_| Some(HOVER));
    assert_eq!((said[0], shield.hand_overs()), (None, 0));
}

#[test]
fn a_policy_gets_nothing_back_before_it_speaks_and_the_vehicle_is_near() {
    let settings = Settings { patience: 0.1, ..settings() };
    let (mut law, mut shield) = shielded(&settings);
    let said = reasons(&mut shield, &mut law, 100, |_| None);
    assert!(said.iter().all(|reason| *reason == Some(Reason::Silent)));
    // A quarter of a metre from the refuge is not near.
    let aside = resting(MIDDLE + Vector3::new(0.25, 0.0, 0.0));
    for _ in 0..100 {
        assert_eq!(shield.step(&mut law, &aside, Some(&HOVER)).unwrap().reason, Some(Reason::Silent));
    }
}

#[test]
fn the_refuge_is_at_rest_inside_the_box() {
    let (mut law, mut shield) = shielded(&settings());
    let outside = State { velocity: Vector3::new(3.0, 0.0, 0.0), ..resting(Vector3::new(5.0, 1.0, 0.1)) };
    let flown = shield.step(&mut law, &outside, Some(&HOVER)).unwrap();
    assert_eq!(flown.reference.position, Vector3::new(3.75, 1.0, 0.75));
    assert_eq!(flown.reference.velocity, Vector3::zeros());
    let again = shield.step(&mut law, &resting(MIDDLE), Some(&HOVER)).unwrap();
    assert_eq!(again.reference.position, flown.reference.position);
}

/// A hand-over changes ubar, and through it y, whose step the thrust takes: c, x and all that depends on them go on as
/// they would have.
#[test]
fn nothing_jumps_at_a_hand_over() {
    let (mut law, mut shield) = shielded(&settings());
    let push = Demand::Acceleration { acceleration: Vector3::new(6.0, -3.0, 2.0), yaw_rate: 1.0 };
    for _ in 0..15 {
        shield.step(&mut law, &resting(MIDDLE), Some(&push)).unwrap();
    }
    let (mut flies_on, mut twin) = (law.clone(), shield);
    let policy = twin.step(&mut flies_on, &resting(MIDDLE), Some(&push)).unwrap();
    let taken = shield.step(&mut law, &resting(MIDDLE), Some(&NONSENSE)).unwrap();
    assert_eq!((policy.reason, taken.reason), (None, Some(Reason::Demand)));
    let (before, after) = (policy.diagnostics, taken.diagnostics);
    assert_eq!(before.filtered, after.filtered);
    assert_eq!(before.intermediate, after.intermediate);
    assert_eq!(before.acceleration_command, after.acceleration_command);
    let jump = (before.feedback - after.feedback).z;
    let step = 1.0 - (-PERIOD * example::parameters().k_d).exp();
    let thrust = policy.wrench.thrust - taken.wrench.thrust;
    assert!((thrust - example::vehicle().mass * step * jump).abs() < 1e-4, "{thrust}");
    assert!((before.feedback - after.feedback).norm() > 1.0);
}

#[test]
fn a_refused_state_leaves_no_trace() {
    let (mut law, mut shield) = shielded(&settings());
    shield.step(&mut law, &resting(MIDDLE), Some(&HOVER)).unwrap();
    let before = (law.clone(), shield);
    let broken = State { attitude: Quaternion::new(2.0, 0.0, 0.0, 0.0), ..resting(MIDDLE) };
    for offers in [Some(HOVER), Some(NONSENSE), None] {
        let refused = shield.step(&mut law, &broken, offers.as_ref()).unwrap_err();
        assert_eq!(refused, InputError::NotARotation { field: "state.attitude" });
        assert_eq!((&law, &shield), (&before.0, &before.1));
    }
}

#[test]
fn after_a_reset_nothing_is_left_but_the_heading() {
    let (mut law, mut shield) = shielded(&settings());
    let (_, fresh) = shielded(&settings());
    reasons(&mut shield, &mut law, 40, |tick| (tick < 5).then_some(NONSENSE));
    shield.reset(&Heading::FORWARD);
    assert_eq!(shield, fresh);
}

/// Two rooms with a wall between them and a corridor through it.
fn rooms_and_corridor() -> Settings {
    let [first, second] = [(-4.0, -0.1), (0.1, 4.0)]
        .map(|(from, to)| Room::new(Vector3::new(from, -4.0, 0.5), Vector3::new(to, 4.0, 6.0)));
    let corridor = Room::new(Vector3::new(-2.0, -0.4, 2.6), Vector3::new(2.0, 0.4, 3.4));
    Settings { rooms: [Some(first), Some(corridor), Some(second), None], ..settings() }
}

#[test]
fn a_policy_flies_where_one_room_holds_all_of_the_prospect_and_not_where_two_hold_parts() {
    let moving = |x: f32, y: f32, speed: [f32; 3]| State { velocity: speed.into(), ..resting(Vector3::new(x, y, 3.0)) };
    for (state, reason) in [
        (moving(-2.0, 1.0, [0.0, 0.0, 0.0]), None),
        (moving(2.0, 1.0, [0.0, 0.0, 0.0]), None),
        (moving(0.0, 0.0, [0.0, 0.0, 0.0]), None),
        (moving(-0.5, 0.0, [1.0, 0.0, 0.0]), None),
        // In the wall; into the wall beside the corridor; out of the corridor into the wall.
        (moving(0.0, 1.0, [0.0, 0.0, 0.0]), Some(Reason::Stop)),
        (moving(-0.5, 1.0, [2.0, 0.0, 0.0]), Some(Reason::Stop)),
        (moving(0.0, 0.3, [0.0, 1.0, 0.0]), Some(Reason::Stop)),
        // All places are in some room, yet not all in one.
        (moving(-0.3, 0.35, [2.0, 1.5, 0.0]), Some(Reason::Stop)),
    ] {
        let (mut law, mut shield) = shielded(&rooms_and_corridor());
        let flown = shield.step(&mut law, &state, Some(&HOVER)).unwrap();
        assert_eq!(flown.reason, reason, "{state:?}");
    }
}

#[test]
fn the_refuge_is_in_the_room_that_held_the_vehicle_last() {
    let (mut law, mut shield) = shielded(&rooms_and_corridor());
    let mut refuge = |x: f32, y: f32, vx: f32| {
        let state = State { velocity: Vector3::new(vx, 0.0, 0.0), ..resting(Vector3::new(x, y, 3.0)) };
        let flown = shield.step(&mut law, &state, Some(&HOVER)).unwrap();
        (flown.reason, flown.reference.position.x)
    };
    // Through the corridor, in which the first room still holds it at first and the second soon does.
    assert_eq!(refuge(-1.0, 0.0, 0.0), (None, -1.0));
    assert_eq!(refuge(0.0, 0.0, 0.0), (None, 0.0));
    assert_eq!(refuge(1.0, 0.0, 0.0), (None, 1.0));
    assert_eq!(refuge(1.5, 2.0, 0.0), (None, 1.5));
    // Back to the wall: the law stays on this side of it.
    assert_eq!(refuge(0.2, 2.0, -3.0), (Some(Reason::Stop), 0.35));
}

#[test]
fn a_margin_makes_every_room_smaller() {
    for (place, reason) in [(3.6, None), (3.8, Some(Reason::Stop))] {
        let (mut law, mut shield) = shielded(&Settings { margin: 0.3, ..settings() });
        let state = resting(Vector3::new(place, 0.0, 3.0));
        let flown = shield.step(&mut law, &state, Some(&HOVER)).unwrap();
        assert_eq!((flown.reason, flown.reference.position.x), (reason, 3.45));
    }
}

/// A vehicle that has just begun to climb with all its thrust: the later its velocity, the sooner the law takes over.
#[test]
fn a_velocity_that_is_late_stops_the_vehicle_earlier() {
    let taken = |late| {
        let (mut law, mut shield) = shielded(&Settings { late, ..settings() });
        let climb = Demand::Acceleration { acceleration: Vector3::new(0.0, 0.0, 8.0), yaw_rate: 0.0 };
        let state = |tick: u32| {
            let time = tick as f32 * PERIOD;
            State {
                velocity: Vector3::new(0.0, 0.0, 8.0 * time),
                ..resting(MIDDLE + Vector3::z() * (4.0 * time * time))
            }
        };
        let mut flies = |tick| shield.step(&mut law, &state(tick), Some(&climb)).unwrap().reason.is_none();
        (0..100).position(|tick| !flies(tick)).unwrap()
    };
    assert!(taken(0.03) < taken(0.0), "{} {}", taken(0.03), taken(0.0));
}

#[test]
fn settings_that_make_no_sense_are_refused_by_name() {
    let good = settings();
    let corner = |x| Vector3::new(x, 0.0, 0.0);
    let Room { low, high } = ROOM;
    let roomed = |low, high| Settings { rooms: [Some(ROOM), None, Some(Room::new(low, high)), None], ..good };
    for (settings, field) in [
        (roomed(corner(f32::NAN), high), "shield.low"),
        (roomed(low, corner(f32::INFINITY)), "shield.high"),
        (roomed(low, corner(2e5)), "shield.high"),
        (roomed(low, low + Vector3::new(5.0, 0.59, 5.0)), "shield.high - shield.low"),
        (Settings { margin: 2.5, ..good }, "shield.high - shield.low"),
        (Settings { margin: -0.1, ..good }, "shield.margin"),
        (Settings { late: -0.01, ..good }, "shield.late"),
        (Settings { late: 0.2, ..good }, "shield.late"),
        (Settings { margin: f32::NAN, ..good }, "shield.margin"),
        (Settings { rooms: [None; ROOMS_MAX], ..good }, "shield.rooms"),
        (Settings { speed: 0.0, ..good }, "shield.speed"),
        (Settings { silence: f32::NAN, ..good }, "shield.silence"),
        (Settings { patience: -1.0, ..good }, "shield.patience"),
        (Settings { patience_greatest: f32::INFINITY, ..good }, "shield.patience_greatest"),
        (Settings { hand_overs: 0, ..good }, "shield.hand_overs"),
    ] {
        assert_eq!(settings.check().unwrap_err().field, field);
    }
    assert_eq!(good.check(), Ok(()));
}

#[test]
fn the_papers_law_carries_no_policy() {
    let refused = Shield::new(&crate::hummingbird::paper_law(), &settings(), PERIOD).unwrap_err();
    assert_eq!(refused, ParameterError { field: "control.law", reason: Refused::CarriesNoPolicy });
}

fn turned(to: f32) -> Demand {
    let attitude = Quaternion::new((0.5 * to).cos(), 0.0, 0.0, (0.5 * to).sin());
    Demand::Attitude { attitude, thrust: 5.0 }
}

#[test]
fn the_heading_keeps_the_certified_bounds_whatever_is_demanded() {
    let mut random = Random(91);
    for _ in 0..50 {
        let bounds = ReferenceBounds {
            heading_rate: random.logarithmic(0.01, 10.0),
            heading_second_derivative: random.logarithmic(0.01, 100.0),
            ..ReferenceBounds::REST
        };
        let mut heading = HeadingGenerator::new(&bounds, PERIOD);
        let mut wanted = HOVER;
        for _ in 0..2_000 {
            if random.below(30) == 0 {
                let yaw_rate = random.signed() * random.logarithmic(0.01, 1e6);
                wanted = match random.below(2) {
                    0 => Demand::Acceleration { acceleration: Vector3::zeros(), yaw_rate },
                    _ => Demand::Attitude { attitude: random.attitude(), thrust: 1.0 },
                };
            }
            let before = *heading.heading();
            if random.below(10) == 0 {
                heading.come_to_rest()
            } else {
                heading.follow(&wanted)
            }
            let heading = heading.heading();
            assert!(bounds.contain(&Reference::resting(Vector3::zeros(), *heading), 1e-4), "{heading:?} {bounds:?}");
            // Its rates are those of its direction.
            let angle = before.direction().perp(&heading.direction());
            assert!((angle - 0.5 * PERIOD * (before.rate() + heading.rate())).abs() < 1e-3 * angle.abs() + 1e-6);
        }
    }
}

#[test]
fn the_heading_arrives_at_an_angle_without_going_beyond_and_stays_where_bounds_are_zero() {
    for angle in [-3.1, -1.0, -0.01, 0.3, 1.0, 2.0, 3.1] {
        let mut heading = HeadingGenerator::new(&bounds(), PERIOD);
        let target = Vector2::new(f32::cos(angle), f32::sin(angle));
        for _ in 0..1_000 {
            heading.follow(&turned(angle));
            let left = heading.heading().direction().perp(&target) * angle.signum();
            let along = heading.heading().direction().dot(&target);
            assert!(along < 0.0 || left > -0.005, "{angle}: {left}");
        }
        assert!((heading.heading().direction() - target).norm() < 1e-3, "{angle}");
        assert!(heading.heading().rate().abs() < 1e-3);
    }
    let mut still = HeadingGenerator::new(&ReferenceBounds::REST, PERIOD);
    still.follow(&turned(1.0));
    assert_eq!(*still.heading(), Heading::FORWARD);
}

mod rotors;
