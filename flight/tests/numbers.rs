//! Numbers that no sensor and no clock should hand over, in every field. They never reach the motors.

use crate::support::outputs::check_output;
use crate::support::{Handed, PERIOD_US, SETTLING_TICKS, at_rest, go_to, rotors, settled};
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use controller_core::prelude::*;
use estimation::estimator::PoseMeasurement;
use flight::{Mode, MotorTest, Output, Pose, Request, Stamped, Velocity};

#[test]
fn no_number_in_any_field_reaches_the_motors_in_any_mode() {
    let numbers = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 1e20, 0.0, -0.0, f32::MIN_POSITIVE];
    let rotors = rotors();
    for field in 0..35 {
        for number in numbers {
            let mut pilot = settled(SETTLING_TICKS * PERIOD_US);
            let mut flown = 0;
            for tick in SETTLING_TICKS + 1..SETTLING_TICKS + 300 {
                let now = tick * PERIOD_US;
                let mut handed = Handed { setpoint: Some(go_to(1.0, 0.0, 0.0)), ..at_rest(now) };
                handed.request = [(1, Request::Arm), (2, Request::FlySetpoints)]
                    .into_iter()
                    .find_map(|(at, request)| (tick == SETTLING_TICKS + at).then_some(request));
                if (SETTLING_TICKS + 20..SETTLING_TICKS + 290).contains(&tick) {
                    spoil(&mut handed, field, number);
                }
                let outcome = handed.to(&mut pilot);
                check_output(&outcome, &rotors);
                if let Some(Ok(flight)) = outcome.flown {
                    flown += 1;
                    assert!(
                        flight.wrench.thrust.is_finite() && flight.reference.position.iter().all(|p| p.is_finite())
                    );
                }
            }
            assert!(flown >= 17, "field {field}: {flown} ticks");
        }
    }
}

#[test]
fn the_ends_of_the_clock_are_times_like_any_other() {
    for start in [(SETTLING_TICKS + 1) * PERIOD_US, u64::MAX - 100 * PERIOD_US] {
        let mut pilot = settled(start - PERIOD_US);
        Handed { request: Some(Request::Arm), ..at_rest(start) }.to(&mut pilot);
        Handed { request: Some(Request::TakeOff(None)), ..at_rest(start + PERIOD_US) }.to(&mut pilot);
        for tick in 2..=100 {
            let outcome = at_rest(start + tick * PERIOD_US).to(&mut pilot);
            assert!(matches!(outcome.output, Output::Thrusts(_)) && outcome.mode == Mode::TakingOff);
        }
        // A clock that runs back leaves measurements of a time to come, which nothing is flown by.
        let back = Handed { now: start, ground_station: Some(start), ..Handed::default() };
        assert_eq!(back.to(&mut pilot).output, Output::Stop);
    }
}

/// Puts `number` into one of all the fields that hold numbers.
fn spoil(handed: &mut Handed, field: usize, number: f32) {
    let (mut position, mut velocity) = (Vector3::zeros(), Vector3::zeros());
    let mut attitude = Quaternion::new(1.0, 0.0, 0.0, 0.0);
    let imu = &mut handed.increments[1];
    match field {
        0..3 => {
            let mut rate = Vector3::zeros();
            rate[field] = number;
            handed.body_rate = Some(Stamped { value: rate, time: handed.now });
        }
        3..6 => imu.delta_velocity[field - 3] = number,
        6..9 => position[field - 6] = number,
        9..12 => velocity[field - 9] = number,
        12..16 => attitude.coords[field - 12] = number,
        16..25 => {
            let mut parts = [Vector3::zeros(); 3];
            parts[(field - 16) / 3][(field - 16) % 3] = number;
            let [position, velocity, acceleration] = parts;
            let motion = Motion::PositionVelocityAcceleration { position, velocity, acceleration };
            handed.setpoint = Some(Setpoint { motion, turn: HeadingSetpoint::Keep });
        }
        25..28 => {
            let mut velocity = Vector3::zeros();
            velocity[field - 25] = number;
            handed.setpoint = Some(Setpoint { motion: Motion::Velocity(velocity), turn: HeadingSetpoint::Keep });
        }
        28 => {
            handed.setpoint =
                Some(Setpoint { turn: HeadingSetpoint::Angle { angle: number, rate: 0.0 }, ..go_to(0., 0., 1.) })
        }
        29 => {
            handed.setpoint =
                Some(Setpoint { turn: HeadingSetpoint::Angle { angle: 0.0, rate: number }, ..go_to(0., 0., 1.) })
        }
        30 => handed.setpoint = Some(Setpoint { turn: HeadingSetpoint::Rate(number), ..go_to(0., 0., 1.) }),
        31..34 => imu.delta_angle[field - 31] = number,
        _ => {
            let test = MotorTest { rotor: 0, level: number, duration: 1_000_000 };
            (handed.disarm, handed.request) = (false, Some(Request::MotorTest(test)));
        }
    }
    // Numbers that make no pose cannot be handed in.
    let pose = Pose::new(position, Velocity::World(velocity), attitude).ok();
    let made = pose.map(|pose| PoseMeasurement::with_velocity(&pose).deviations(number, number));
    handed.poses = made.into_iter().map(|value| Stamped { value, time: handed.now }).collect();
}
