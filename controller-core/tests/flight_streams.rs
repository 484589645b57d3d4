//! Whatever arrives: NaN in every field, and random streams. What may never happen, never does.

mod flight;

use controller_core::allocation::Rotors;
use controller_core::flight::rules::{IMU_AGE_MAX, LEVELLING_MAX, MOTOR_TEST_LEVEL_MAX, MOTOR_TEST_MAX, POSE_AGE_MAX};
use controller_core::flight::{
    ImuSample, Inputs, Mode, MotorTest, Outcome, Output, PERIOD, Pilot, Pose, Request, Stamped, Velocity,
};
use controller_core::governor::{Motion, Setpoint, Turn};
use controller_core::prelude::*;
use flight::{at_rest, go_to, pilot, rotors};
use proptest::prelude::*;

/// The motors' share of an outcome: within their ranges in armed modes, stopped in all others.
fn check_output(outcome: &Outcome, rotors: &Rotors) {
    match &outcome.output {
        Output::Stop => {}
        Output::Thrusts(thrusts) => {
            assert!(outcome.mode.is_armed());
            assert_eq!(thrusts.len(), rotors.len());
            for (thrust, rotor) in thrusts.iter().zip(rotors.iter()) {
                assert!((rotor.thrust_min..=rotor.thrust_max).contains(thrust), "{thrust}");
            }
        }
        Output::Test { rotor, level } => {
            assert_eq!(outcome.mode, Mode::MotorTest);
            assert!(*rotor < rotors.len() && *level > 0.0 && *level <= MOTOR_TEST_LEVEL_MAX);
        }
    }
}

#[test]
fn no_number_in_any_field_reaches_the_motors_in_any_mode() {
    let numbers = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 1e20, 0.0, -0.0, f32::MIN_POSITIVE];
    let rotors = rotors();
    for field in 0..32 {
        for number in numbers {
            let mut pilot = pilot();
            pilot.tick(&Inputs { request: Some(Request::Arm), ..at_rest(0) });
            for tick in 1..160_u64 {
                let now = tick * PERIOD;
                let mut inputs = Inputs { setpoint: Some(go_to(1.0, 0.0, 0.0)), ..at_rest(now) };
                if (20..145).contains(&tick) {
                    spoil(&mut inputs, field, number);
                }
                let outcome = pilot.tick(&inputs);
                check_output(&outcome, &rotors);
                if let Some(Ok(flown)) = outcome.flown {
                    assert!(flown.wrench.thrust.is_finite() && flown.reference.position.iter().all(|p| p.is_finite()));
                }
            }
        }
    }
}

#[test]
fn the_ends_of_the_clock_are_times_like_any_other() {
    for start in [0, u64::MAX - 100 * PERIOD] {
        let mut pilot = pilot();
        pilot.tick(&Inputs { request: Some(Request::Arm), ..at_rest(start) });
        for tick in 1..=100 {
            let outcome = pilot.tick(&at_rest(start + tick * PERIOD));
            assert!(matches!(outcome.output, Output::Thrusts(_)) && outcome.mode == Mode::Flying);
        }
        let end = pilot.tick(&at_rest(u64::MAX));
        assert!(matches!(end.output, Output::Thrusts(_)));
        // A clock that runs back leaves measurements of a time to come, which nothing is flown by.
        assert_eq!(pilot.tick(&at_rest(0)).output, Output::Stop);
    }
}

/// Puts `number` into one of all the fields that hold numbers.
fn spoil(inputs: &mut Inputs, field: usize, number: f32) {
    let (imu, pose) = (&mut inputs.imu.as_mut().unwrap().value, inputs.pose.unwrap());
    let Stamped { value, time } = pose;
    let (mut position, mut velocity, mut attitude) = (value.position(), value.velocity(), value.attitude());
    match field {
        0..3 => imu.angular_velocity[field] = number,
        3..6 => imu.specific_force[field - 3] = number,
        6..9 => position[field - 6] = number,
        9..12 => velocity[field - 9] = number,
        12..16 => attitude.coords[field - 12] = number,
        16..25 => {
            let mut parts = [Vector3::zeros(); 3];
            parts[(field - 16) / 3][(field - 16) % 3] = number;
            let [position, velocity, acceleration] = parts;
            let motion = Motion::PositionVelocityAcceleration { position, velocity, acceleration };
            inputs.setpoint = Some(Setpoint { motion, turn: Turn::Keep });
        }
        25..28 => {
            let mut velocity = Vector3::zeros();
            velocity[field - 25] = number;
            inputs.setpoint = Some(Setpoint { motion: Motion::Velocity(velocity), turn: Turn::Keep });
        }
        28 => inputs.setpoint = Some(Setpoint { turn: Turn::Angle { angle: number, rate: 0.0 }, ..go_to(0., 0., 1.) }),
        29 => inputs.setpoint = Some(Setpoint { turn: Turn::Angle { angle: 0.0, rate: number }, ..go_to(0., 0., 1.) }),
        30 => inputs.setpoint = Some(Setpoint { turn: Turn::Rate(number), ..go_to(0., 0., 1.) }),
        _ => {
            let test = MotorTest { rotor: 0, level: number, duration: 1_000_000 };
            (inputs.disarm, inputs.request) = (false, Some(Request::MotorTest(test)));
        }
    }
    // Numbers that make no pose are none: there is no way to hand them in.
    let pose = Pose::new(position, Velocity::World(velocity), attitude);
    inputs.pose = pose.ok().map(|value| Stamped { value, time });
}

/// What arrives in one tick of a random stream.
#[derive(Debug, Clone)]
struct Arrival {
    /// us since the tick before.
    elapsed: u64,
    /// Age on arrival, us, and whether it can be used.
    imu: Option<(u64, bool)>,
    pose: Option<(u64, bool)>,
    ground_station: bool,
    request: Option<Request>,
    disarm: bool,
    position: Option<f32>,
    numbers: [f32; 6],
}

fn arrival() -> impl Strategy<Value = Arrival> {
    let elapsed = prop_oneof![30 => Just(PERIOD), 1 => 0..40_000_u64];
    let age = || prop_oneof![10 => Just(0), 3 => 0..150_000_u64];
    let usable = || prop::bool::weighted(0.95);
    let test = (0..6_usize, 0.0..0.2_f32, 0..2_100_000_u64);
    let test = test.prop_map(|(rotor, level, duration)| Request::MotorTest(MotorTest { rotor, level, duration }));
    let request = prop_oneof![20 => Just(None), 4 => Just(Some(Request::Arm)), 1 => test.prop_map(Some)];
    (
        elapsed,
        prop::option::weighted(0.97, (age(), usable())),
        prop::option::weighted(0.9, (age(), usable())),
        any::<bool>(),
        request,
        prop::bool::weighted(0.003),
        prop::option::weighted(0.1, -1e3..1e3_f32),
        prop::array::uniform6(-2.0..2.0_f32),
    )
        .prop_map(|(elapsed, imu, pose, ground_station, request, disarm, position, numbers)| Arrival {
            elapsed,
            imu,
            pose,
            ground_station,
            request,
            disarm,
            position,
            numbers,
        })
}

/// A stretch of arrivals with everything, or without a pose, a gyro or a ground station.
fn stretch() -> impl Strategy<Value = Vec<Arrival>> {
    (prop::collection::vec(arrival(), 1..250), 0..6_u8).prop_map(|(mut arrivals, missing)| {
        for arrival in &mut arrivals {
            match missing {
                0 => arrival.pose = None,
                1 => arrival.ground_station = false,
                2 => arrival.imu = None,
                3 => (arrival.imu, arrival.pose) = (Some((0, true)), None),
                _ => (arrival.imu, arrival.pose) = (Some((0, true)), Some((0, true))),
            }
        }
        arrivals
    })
}

/// What the world knows beside the pilot, to judge it by.
struct Judge {
    rotors: Rotors,
    now: u64,
    imu: Option<u64>,
    pose: Option<u64>,
    levelling_since: Option<u64>,
    testing_since: Option<u64>,
}

impl Judge {
    fn new() -> Self {
        Self { rotors: rotors(), now: 0, imu: None, pose: None, levelling_since: None, testing_since: None }
    }

    fn tick(&mut self, pilot: &mut Pilot, arrival: &Arrival) -> Mode {
        self.now += arrival.elapsed;
        let now = self.now;
        let [x, y, z, roll, pitch, yaw] = arrival.numbers;
        let broken = |usable: bool, number: f32| if usable { number } else { f32::NAN };
        let imu = arrival.imu.map(|(age, usable)| {
            let angular_velocity = Vector3::new(broken(usable, roll), pitch, yaw);
            Stamped {
                value: ImuSample { angular_velocity, specific_force: Vector3::zeros() },
                time: now - age.min(now),
            }
        });
        let pose = arrival.pose.and_then(|(age, usable)| {
            let attitude = Quaternion::new(1.0, 0.1 * roll, 0.1 * pitch, yaw).normalize();
            let velocity = Velocity::World(Vector3::new(z, broken(usable, x), y));
            let value = Pose::new(Vector3::new(x, y, z), velocity, attitude).ok()?;
            Some(Stamped { value, time: now - age.min(now) })
        });
        // Usable ones count, from the time they were true.
        if let (Some(imu), Some((_, true))) = (&imu, arrival.imu) {
            self.imu = self.imu.max(Some(imu.time));
        }
        if let (Some(pose), Some((_, true))) = (&pose, arrival.pose) {
            self.pose = self.pose.max(Some(pose.time));
        }
        let before = pilot.mode();
        let outcome = pilot.tick(&Inputs {
            now,
            imu,
            pose,
            ground_station: arrival.ground_station.then_some(now),
            request: arrival.request,
            disarm: arrival.disarm,
            setpoint: arrival.position.map(|x| go_to(x, 0.0, 1.0)),
        });
        check_output(&outcome, &self.rotors);
        self.check(before, &outcome, arrival);
        outcome.mode
    }

    fn check(&mut self, before: Mode, outcome: &Outcome, arrival: &Arrival) {
        let now = self.now;
        let age = |time: Option<u64>| time.map_or(u64::MAX, |time| now - time);
        if let Output::Thrusts(_) = outcome.output {
            assert!(age(self.imu) <= IMU_AGE_MAX);
            assert!(age(self.pose) <= POSE_AGE_MAX || outcome.mode == Mode::Levelling);
            assert!(before.is_armed() || arrival.request == Some(Request::Arm));
        }
        for (mode, since, most) in [
            (Mode::Levelling, &mut self.levelling_since, LEVELLING_MAX),
            (Mode::MotorTest, &mut self.testing_since, MOTOR_TEST_MAX),
        ] {
            *since = (outcome.mode == mode).then(|| since.unwrap_or(now));
            assert!(since.is_none_or(|since| now - since < most), "{mode:?} for too long");
        }
        assert!(!arrival.disarm || (outcome.output == Output::Stop && outcome.mode == Mode::Disarmed));
        assert_eq!(outcome.transition.map_or(before, |transition| transition.to), outcome.mode);
        assert_eq!(outcome.transition.is_some(), before != outcome.mode);
        assert_eq!(outcome.answer.is_some(), arrival.request.is_some());
        assert_eq!(outcome.setpoint.is_some(), arrival.position.is_some());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn no_stream_makes_the_motors_turn_against_the_rules(stretches in prop::collection::vec(stretch(), 1..8)) {
        let (mut pilot, mut judge) = (pilot(), Judge::new());
        for arrival in stretches.iter().flatten() {
            judge.tick(&mut pilot, arrival);
        }
    }
}

#[test]
fn the_random_streams_visit_every_mode() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut runner = TestRunner::deterministic();
    let mut visits = [0; Mode::ALL.len()];
    for _ in 0..50 {
        let stretches = prop::collection::vec(stretch(), 1..8).new_tree(&mut runner).unwrap().current();
        let (mut pilot, mut judge) = (pilot(), Judge::new());
        for arrival in stretches.iter().flatten() {
            visits[judge.tick(&mut pilot, arrival) as usize] += 1;
        }
    }
    assert!(visits.iter().all(|count| *count > 100), "{visits:?}");
}
