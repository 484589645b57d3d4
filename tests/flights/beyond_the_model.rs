//! The extended law where its vehicle is not what was certified: on the ground, with an emptying battery, with a rotor
//! that fails in part. `cargo test -p host-sim beyond_the_model -- --nocapture` prints the table that stands in
//! `docs/measured.md`.

use crate::support::extended::{published, vehicle};
use controller_core::certificate::certified::Certified;
use controller_core::extended::memory::Estimates;
use controller_core::governor::{GovernorLimits, HeadingSetpoint, Motion, Setpoint};
use estimation::estimator::{Clipped, Estimator, Increment, PoseMeasurement, Settings};
use flight::{FlightSettings, Inputs, Memory, Output, Pilot, Pose, Request, Stamped, Velocity};
use host_sim::flight::Flight;
use host_sim::flight::course::Course;
use host_sim::flight::tasks::hover;
use nalgebra::{Quaternion, Vector3};
use scenario::Scenario;
use scenario::reality::battery::Battery;
use scenario::reality::failure::Failure;
use scenario::reality::ground::Ground;
use scenario::reality::truth::Truth;

const ARRIVAL_DISTANCE_M: f64 = 0.1;
/// When a rotor fails, s.
const FAILS_AT: f64 = 5.0;

fn hovering(name: &str, seconds: f64, change: impl FnOnce(&mut Scenario)) -> Course {
    let mut scenario = hover(&vehicle(name), Vector3::zeros(), seconds).unwrap();
    change(&mut scenario);
    Course::fly(&scenario, Flight::new(&scenario).unwrap(), ARRIVAL_DISTANCE_M).unwrap()
}

/// Rotor 1 left with `share` of its thrust.
fn weakened(name: &str, share: f64) -> Course {
    hovering(name, 30.0, |s| s.reality.failure = Some(Failure { rotor: 0, time: FAILS_AT, thrust_left: share }))
}

#[test]
fn a_rotor_may_lose_half_of_its_thrust_or_all_of_it() {
    println!("rotor 1 left with  deepest excursion, end error [m]: Hummingbird        study");
    for share in [0.9, 0.8, 0.7, 0.5, 0.0] {
        let [first, second] = ["hummingbird", "study"].map(|name| weakened(name, share));
        let row = |course: &Course| format!("{:8.3} {:8.4}", course.excursion, course.end_error);
        println!("{share:4.1}  {}  {}", row(&first), row(&second));
        if share >= 0.5 {
            let [near, far] = if share >= 0.8 { [0.1, 0.2] } else { [0.6, 1.6] };
            assert!(first.excursion < near && first.end_error < 0.005, "{share}: {first:?}");
            assert!(second.excursion < far && second.end_error < 0.005, "{share}: {second:?}");
        }
        if share == 0.0 {
            // It turns, which takes it round on a circle of some centimetres.
            assert!(first.excursion < 1.0 && first.end_error < 0.03, "{first:?}");
            assert!(second.excursion < 2.0 && second.end_error < 0.03, "{second:?}");
        }
    }
}

/// How far off the centre of mass is, m: on small vehicles a share of the arm.
const OFF_CENTRE: f64 = 0.01;
const OFF_CENTRE_OF_ARM: f64 = 0.06;

/// What a minute of hover ends with where one rotor delivers 70 %, and where the centre of mass is off: the offset, m,
/// and the heading's, rad.
fn torque_offsets(scenario: &Scenario) -> [(&'static str, Course); 2] {
    let rotors = scenario.configuration.rotors().unwrap();
    let arm = rotors.iter().map(|rotor| rotor.position.xy().norm()).fold(0.0, f32::max);
    let off = OFF_CENTRE.min(OFF_CENTRE_OF_ARM * f64::from(arm));
    let truth = Truth::model(scenario.configuration.vehicle());
    let mut weak = vec![1.0; rotors.len()];
    weak[0] = 0.7;
    let flown = |truth| {
        let mut hovering = hover(scenario, Vector3::zeros(), 60.0).unwrap();
        hovering.reality.truth = Some(truth);
        Course::fly(&hovering, Flight::new(&hovering).unwrap(), ARRIVAL_DISTANCE_M).unwrap()
    };
    [
        ("one rotor at 70 %", flown(Truth { rotor_scales: weak, ..truth.clone() })),
        ("centre of mass off", flown(Truth { centre_of_mass: Vector3::x() * off, ..truth })),
    ]
}

#[test]
fn a_weak_rotor_or_a_centre_of_mass_that_is_off_leaves_no_offset_and_no_lag_in_heading() {
    println!("| vehicle | what | offset, mm | heading, degrees | deepest excursion, m |\n|---|---|---|---|---|");
    let own = ["hummingbird", "study"].map(vehicle);
    for scenario in own.into_iter().chain(published()) {
        let (vehicle, rotors) = (scenario.configuration.vehicle(), scenario.configuration.rotors().unwrap());
        let lift = rotors.thrust_together().1 / (vehicle.mass * vehicle.gravity);
        for (what, Course { end_error, yaw_error, excursion, .. }) in torque_offsets(&scenario) {
            let [millimetres, degrees] = [1e3 * end_error, yaw_error.to_degrees()];
            println!("| `{}` | {what} | {millimetres:.3} | {degrees:.3} | {excursion:.2} |", scenario.name);
            let there = millimetres < 5.0 && degrees < 1.0;
            assert!(there || lift < 2.0, "{}, {what}: {millimetres} mm, {degrees} degrees", scenario.name);
        }
    }
}

#[test]
fn a_battery_that_empties_within_a_minute_costs_centimetres() {
    for (name, most) in [("hummingbird", 0.02), ("study", 0.02)] {
        let course = hovering(name, 60.0, |s| {
            s.reality.battery = Some(Battery {
                full_voltage: 12.6,
                empty_voltage: 10.5,
                resistance: 0.03,
                capacity: 0.15 * 3600.0,
                charge: 1.0,
                efficiency: 0.6,
                nominal_voltage: 12.6,
            });
        });
        println!("{name}: deepest excursion {:.3} m, at the end {:.3} m", course.excursion, course.end_error);
        assert!(course.excursion < most && course.clipped == 0, "{name}: {course:?}");
    }
}

#[test]
fn what_stands_on_the_ground_learns_nothing_from_it() {
    for name in ["hummingbird", "study"] {
        let mut scenario = hover(&vehicle(name), Vector3::new(0.0, 0.0, 0.3), 5.0).unwrap();
        // It starts on the ground, to hover 0.3 m below it.
        scenario.reality.ground = Some(Ground { height: 0.3 });
        let mut flight = Flight::new(&scenario).unwrap();
        for _ in 0..500 {
            let tick = flight.tick().unwrap();
            // While the thrust still equals the weight, a rounding lifts it now and then.
            assert!(tick.surroundings.standing || tick.time_us < 500_000, "{name}: left the ground");
            let Estimates { force, torque, scale } = tick.estimates.unwrap();
            assert!((scale - 1.0).abs() < 1e-4 && force.norm() < 1e-3 && torque.norm() < 1e-6, "{name}: {tick:?}");
        }
    }
}

const TICK_PERIOD_US: u64 = 10_000;

/// The estimate takes a second and a half to prove itself.
const ARMING_TICK: u64 = 200;

const TAKEOFF_TICK: u64 = ARMING_TICK + 1;

/// The tick in which an outside force lifts the vehicle off.
const LIFTED_TICK: u64 = 700;

/// Height above the ground, m, and acceleration over the tick before, m/s^2: 12 cm up in 0.2 s.
fn lifted(tick: u64) -> (f32, f32) {
    let seconds = TICK_PERIOD_US as f32 * 1e-6;
    let (mut height, mut speed, mut acceleration) = (0.0, 0.0, 0.0);
    for tick in LIFTED_TICK..tick {
        acceleration = match tick - LIFTED_TICK {
            0..10 => 12.0,
            10..20 => -12.0,
            _ => 0.0,
        };
        height += speed * seconds + 0.5 * acceleration * seconds * seconds;
        speed += acceleration * seconds;
    }
    (height, acceleration)
}

/// What a pilot asks of the rotors over what the law asks for, from tick `from` to `to`, with a setpoint far below.
fn commanded_of_the_rotors(pilot: &mut Pilot, from: u64, to: u64) -> f32 {
    let mut share = f32::NAN;
    for tick in from..=to {
        let now = tick * TICK_PERIOD_US;
        let (height, acceleration) = lifted(tick);
        let zero = Vector3::zeros();
        let delta_velocity = Vector3::new(0.0, 0.0, (9.81 + acceleration) * TICK_PERIOD_US as f32 * 1e-6);
        let increment = Increment {
            start: now - TICK_PERIOD_US,
            end: now,
            delta_angle: zero,
            delta_velocity,
            clipped: Clipped::NEITHER,
        };
        let position = Vector3::new(0.0, 0.0, height);
        let still = Velocity::World(Vector3::zeros());
        let pose = Pose::new(position, still, Quaternion::new(1.0, 0.0, 0.0, 0.0)).unwrap();
        let setpoint = Setpoint { motion: Motion::Position(Vector3::new(0.0, 0.0, -3.0)), turn: HeadingSetpoint::Keep };
        let outcome = pilot.tick(&Inputs {
            now,
            increments: &[increment],
            body_rate: Some(Stamped { value: zero, time: now }),
            poses: &[Stamped { value: PoseMeasurement::new(&pose), time: now }],
            ground_station: Some(now),
            request: match tick {
                ARMING_TICK => Some(Request::Arm),
                TAKEOFF_TICK => Some(Request::FlySetpoints),
                _ => None,
            },
            setpoint: (tick == TAKEOFF_TICK).then_some(setpoint),
            ..Inputs::default()
        });
        if tick < TAKEOFF_TICK {
            continue;
        }
        let (Some(Ok(flown)), Output::Thrusts(thrusts)) = (outcome.flown, outcome.output) else { panic!("not flown") };
        share = thrusts.iter().sum::<f32>() / flown.wrench.thrust;
    }
    share
}

#[test]
fn what_is_armed_on_the_ground_learns_nothing_before_it_lifts_off() {
    let certified = Certified::new(vehicle("hummingbird").configuration).unwrap();
    let memory = Box::leak(Box::new(Memory::EMPTY));
    let settings = Settings::bmi088(certified.configuration().vehicle());
    let estimator = Box::leak(Box::new(Estimator::new(&settings)));
    let mut pilot = Pilot::new(
        Ok(&certified),
        &GovernorLimits::default(),
        &FlightSettings::DEFAULT,
        TICK_PERIOD_US,
        estimator,
        memory,
    );
    let standing = commanded_of_the_rotors(&mut pilot, 1, LIFTED_TICK);
    assert!((standing - 1.0).abs() < 1e-4, "the thrust scale was learnt on the ground: {}", 1.0 / standing);
    // Twelve centimetres higher it learns from how it was moved, to whatever end: that was no thrust.
    let flying = commanded_of_the_rotors(&mut pilot, LIFTED_TICK + 1, LIFTED_TICK + 120);
    assert!((flying - 1.0).abs() > 0.01, "{}", 1.0 / flying);
}
