//! Whatever arrives: NaN in every field, and random streams. What may never happen, never does.

mod flight;

use controller_core::allocation::Rotors;
use controller_core::estimator::{Increment, PoseMeasurement};
use controller_core::flight::rules::{
    COASTING_MAX, DESCENDING_MAX, IDLING_MAX, IMU_AGE_MAX, MOTOR_TEST_LEVEL_MAX, MOTOR_TEST_MAX,
};
use controller_core::flight::{
    Mode, MotorSetting, MotorTest, Outcome, Output, PERIOD, Pilot, Pose, Request, Setting, Stamped, Velocity,
};
use controller_core::governor::{Motion, Setpoint, Turn};
use controller_core::prelude::*;
use flight::{Handed, SETTLING, at_rest, go_to, pilot, pose, resting_imu, rotors, settled};
use proptest::prelude::*;

/// The motors' share of an outcome: within their ranges in armed modes, stopped in all others.
fn check_output(outcome: &Outcome, rotors: &Rotors) {
    match &outcome.output {
        Output::Stop => {}
        Output::Idle => assert_eq!(outcome.mode, Mode::Idling),
        Output::Thrusts(thrusts) => {
            assert!(outcome.mode.flies());
            assert_eq!(thrusts.len(), rotors.len());
            for (thrust, rotor) in thrusts.iter().zip(rotors.iter()) {
                assert!((rotor.thrust_min..=rotor.thrust_max).contains(thrust), "{thrust}");
            }
        }
        Output::Test { rotor, level } => {
            assert_eq!(outcome.mode, Mode::MotorTest);
            assert!(*rotor < rotors.len() && *level > 0.0 && *level <= MOTOR_TEST_LEVEL_MAX);
        }
        Output::Tell { rotor, .. } => assert!(outcome.mode == Mode::MotorTest && *rotor < rotors.len()),
    }
}

#[test]
fn no_number_in_any_field_reaches_the_motors_in_any_mode() {
    let numbers = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 1e20, 0.0, -0.0, f32::MIN_POSITIVE];
    let rotors = rotors();
    for field in 0..35 {
        for number in numbers {
            let mut pilot = settled(SETTLING * PERIOD);
            let mut flown = 0;
            for tick in SETTLING + 1..SETTLING + 300 {
                let now = tick * PERIOD;
                let mut handed = Handed { setpoint: Some(go_to(1.0, 0.0, 0.0)), ..at_rest(now) };
                handed.request = [(1, Request::Arm), (2, Request::FlySetpoints)]
                    .into_iter()
                    .find_map(|(at, request)| (tick == SETTLING + at).then_some(request));
                if (SETTLING + 20..SETTLING + 290).contains(&tick) {
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
    for start in [(SETTLING + 1) * PERIOD, u64::MAX - 100 * PERIOD] {
        let mut pilot = settled(start - PERIOD);
        Handed { request: Some(Request::Arm), ..at_rest(start) }.to(&mut pilot);
        Handed { request: Some(Request::TakeOff(None)), ..at_rest(start + PERIOD) }.to(&mut pilot);
        for tick in 2..=100 {
            let outcome = at_rest(start + tick * PERIOD).to(&mut pilot);
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
            handed.setpoint = Some(Setpoint { motion, turn: Turn::Keep });
        }
        25..28 => {
            let mut velocity = Vector3::zeros();
            velocity[field - 25] = number;
            handed.setpoint = Some(Setpoint { motion: Motion::Velocity(velocity), turn: Turn::Keep });
        }
        28 => handed.setpoint = Some(Setpoint { turn: Turn::Angle { angle: number, rate: 0.0 }, ..go_to(0., 0., 1.) }),
        29 => handed.setpoint = Some(Setpoint { turn: Turn::Angle { angle: 0.0, rate: number }, ..go_to(0., 0., 1.) }),
        30 => handed.setpoint = Some(Setpoint { turn: Turn::Rate(number), ..go_to(0., 0., 1.) }),
        31..34 => imu.delta_angle[field - 31] = number,
        _ => {
            let test = MotorTest { rotor: 0, level: number, duration: 1_000_000 };
            (handed.disarm, handed.request) = (false, Some(Request::MotorTest(test)));
        }
    }
    // Numbers that make no pose are none: there is no way to hand them in.
    let pose = Pose::new(position, Velocity::World(velocity), attitude).ok();
    let made = pose.map(|pose| PoseMeasurement::with_velocity(&pose).deviations(number, number));
    handed.poses = made.into_iter().map(|value| Stamped { value, time: handed.now }).collect();
}

/// What becomes of a tick's share of something measured.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fate {
    /// It arrives.
    Here,
    /// An IMU's arrives with the next; a pose's was true so long ago, us.
    Late(u64),
    /// It never comes.
    Lost,
    /// It arrives and is not the truth.
    Lies,
}

/// What arrives in one tick of a random stream, from a vehicle that stands still.
#[derive(Debug, Clone)]
struct Arrival {
    /// us since the tick before.
    elapsed: u64,
    imu: Fate,
    pose: Fate,
    ground_station: bool,
    request: Option<Request>,
    disarm: bool,
    position: Option<f32>,
    numbers: [f32; 6],
}

impl Arrival {
    /// Nothing but the truth.
    const REST: Self = Self {
        elapsed: PERIOD,
        imu: Fate::Here,
        pose: Fate::Here,
        ground_station: true,
        request: None,
        disarm: false,
        position: None,
        numbers: [0.0; 6],
    };
}

fn arrival() -> impl Strategy<Value = Arrival> {
    let elapsed = prop_oneof![30 => Just(PERIOD), 1 => 0..40_000_u64];
    let late = (0..150_000_u64).prop_map(Fate::Late);
    let imu =
        prop_oneof![200 => Just(Fate::Here), 20 => Just(Fate::Late(0)), 1 => Just(Fate::Lost), 1 => Just(Fate::Lies)];
    let pose = prop_oneof![10 => Just(Fate::Here), 3 => late, 1 => Just(Fate::Lost), 1 => Just(Fate::Lies)];
    let test = (0..6_usize, 0.0..0.2_f32, 0..2_100_000_u64);
    let test = test.prop_map(|(rotor, level, duration)| Request::MotorTest(MotorTest { rotor, level, duration }));
    let set = (0..6_usize, prop::sample::select(vec![Setting::Beep, Setting::Normal, Setting::Reversed]));
    let set = set.prop_map(|(rotor, setting)| Request::MotorSetting(MotorSetting { rotor, setting }));
    let flight = prop::sample::select(vec![
        Request::TakeOff(None),
        Request::FlySetpoints,
        Request::Hold,
        Request::GoTo(go_to(1.0, 0.0, 1.0)),
        Request::Land,
        Request::Disarm,
    ]);
    let request = prop_oneof![
        60 => Just(None),
        12 => Just(Some(Request::Arm)),
        1 => flight.prop_map(Some),
        3 => test.prop_map(Some),
        1 => set.prop_map(Some)
    ];
    (
        elapsed,
        imu,
        pose,
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

/// A stretch of arrivals, of the truth or of anything, with or without poses, IMU or a ground station. Half of them begin
/// with as much rest as arming takes.
fn stretch() -> impl Strategy<Value = Vec<Arrival>> {
    (prop::collection::vec(arrival(), 1..350), 0..8_u8, any::<bool>()).prop_map(|(mut arrivals, kind, rested)| {
        for arrival in &mut arrivals {
            match kind {
                0 => (arrival.imu, arrival.pose) = (Fate::Here, Fate::Lost),
                1 => (arrival.imu, arrival.pose) = (Fate::Here, Fate::Lies),
                2 => arrival.imu = Fate::Lost,
                3 => (arrival.imu, arrival.pose, arrival.ground_station) = (Fate::Here, Fate::Here, false),
                4 | 5 => (arrival.imu, arrival.pose) = (Fate::Here, Fate::Here),
                _ => {}
            }
        }
        let rest = std::iter::repeat_n(Arrival::REST, if rested { SETTLING as usize } else { 0 });
        let arm = rested.then_some(Arrival { request: Some(Request::Arm), ..Arrival::REST });
        let fly = [Request::TakeOff(None), Request::FlySetpoints][usize::from(kind) % 2];
        let fly = rested.then_some(Arrival { request: Some(fly), position: Some(0.0), ..Arrival::REST });
        rest.chain(arm).chain(fly).chain(arrivals).collect()
    })
}

/// What the world knows beside the pilot, to judge it by.
struct Judge {
    rotors: Rotors,
    now: u64,
    /// Up to when the IMU's increments have been handed over.
    until: u64,
    /// When the last IMU data and the last pose were true that a flight may be based on.
    imu: Option<u64>,
    pose: Option<u64>,
    body_rate: Option<Stamped<Vector3<f32>>>,
    /// When the ground station was heard last.
    heard: Option<u64>,
    descending_since: Option<u64>,
    idling_since: Option<u64>,
    testing_since: Option<u64>,
}

impl Judge {
    fn new() -> Self {
        let start = 1_000_000;
        Self {
            rotors: rotors(),
            now: start,
            until: start,
            imu: None,
            pose: None,
            body_rate: None,
            heard: None,
            descending_since: None,
            idling_since: None,
            testing_since: None,
        }
    }

    fn tick(&mut self, pilot: &mut Pilot, arrival: &Arrival) -> Mode {
        self.now += arrival.elapsed;
        let before = pilot.mode();
        self.heard = arrival.ground_station.then_some(self.now).or(self.heard);
        let handed = Handed {
            now: self.now,
            increments: self.increments(arrival),
            body_rate: self.body_rate(arrival),
            poses: self.pose(arrival).into_iter().collect(),
            ground_station: self.heard,
            request: arrival.request,
            disarm: arrival.disarm,
            setpoint: arrival.position.map(|x| go_to(x, 0.0, 1.0)),
            ..Handed::default()
        };
        let outcome = handed.to(pilot);
        check_output(&outcome, &self.rotors);
        self.check(before, &outcome, arrival);
        outcome.mode
    }

    fn increments(&mut self, arrival: &Arrival) -> Vec<Increment> {
        let level = Quaternion::new(1.0, 0.0, 0.0, 0.0);
        match arrival.imu {
            Fate::Late(_) => return vec![],
            Fate::Lost => {
                self.until = self.now;
                return vec![];
            }
            Fate::Here | Fate::Lies => {}
        }
        let mut made = vec![];
        while self.until < self.now {
            let end = self.now.min(self.until + PERIOD / 2);
            made.push(resting_imu(self.until, end, &level));
            self.until = end;
        }
        match (arrival.imu, made.last_mut()) {
            (Fate::Lies, Some(last)) => last.delta_angle.x = f32::NAN,
            (_, Some(last)) => self.imu = Some(last.end),
            _ => {}
        }
        made
    }

    /// The newest that has come.
    fn body_rate(&mut self, arrival: &Arrival) -> Option<Stamped<Vector3<f32>>> {
        let value = match arrival.imu {
            Fate::Late(_) | Fate::Lost => return self.body_rate,
            Fate::Here => Vector3::zeros(),
            Fate::Lies => Vector3::repeat(f32::NAN),
        };
        self.body_rate = Some(Stamped { value, time: self.now });
        self.body_rate
    }

    fn pose(&mut self, arrival: &Arrival) -> Option<Stamped<PoseMeasurement>> {
        let [x, y, z, roll, pitch, yaw] = arrival.numbers;
        let level = Quaternion::new(1.0, 0.0, 0.0, 0.0);
        match arrival.pose {
            Fate::Lost => None,
            Fate::Here | Fate::Late(_) => {
                let time = self.now - if let Fate::Late(age) = arrival.pose { age } else { 0 };
                self.pose = self.pose.max(Some(time));
                Some(Stamped { value: pose(Vector3::zeros(), level), time })
            }
            Fate::Lies => {
                // Further away than any coasting, at another place each time.
                let position = Vector3::new(x, y, z) * 5.0 + Vector3::new(20.0, 0.0, 0.0);
                let attitude = Quaternion::new(1.0, 0.1 * roll, 0.1 * pitch, yaw).normalize();
                Some(Stamped { value: pose(position, attitude), time: self.now })
            }
        }
    }

    fn check(&mut self, before: Mode, outcome: &Outcome, arrival: &Arrival) {
        let now = self.now;
        let age = |time: Option<u64>| time.map_or(u64::MAX, |time| now - time);
        if let Output::Thrusts(_) = outcome.output {
            assert!(age(self.imu) <= IMU_AGE_MAX);
            assert!(age(self.pose) <= COASTING_MAX || outcome.mode == Mode::Descending);
            assert!(before.is_armed());
        }
        if let Output::Idle = outcome.output {
            assert!(before == Mode::Idling || arrival.request == Some(Request::Arm));
        }
        for (mode, since, most) in [
            (Mode::Descending, &mut self.descending_since, DESCENDING_MAX),
            (Mode::Idling, &mut self.idling_since, IDLING_MAX),
            (Mode::MotorTest, &mut self.testing_since, MOTOR_TEST_MAX),
        ] {
            *since = (outcome.mode == mode).then(|| since.unwrap_or(now));
            assert!(since.is_none_or(|since| now - since < most), "{mode:?} for too long");
        }
        assert!(!arrival.disarm || (outcome.output == Output::Stop && !outcome.mode.is_armed()));
        assert_eq!(outcome.transition.map_or(before, |transition| transition.to), outcome.mode);
        assert_eq!(outcome.transition.is_some(), before != outcome.mode);
        assert_eq!(outcome.answer.is_some(), arrival.request.is_some());
        let judged = match outcome.mode {
            Mode::Flying => arrival.position.is_some(),
            // What begins no flight is refused, where one is waited for.
            Mode::Idling => arrival.position.is_some() && matches!(outcome.setpoint, Some(Err(_))),
            _ => false,
        };
        assert_eq!(outcome.setpoint.is_some(), judged);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

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
    // But for a pilot without a certificate.
    visits[Mode::Locked as usize] = u32::MAX;
    assert!(visits.iter().all(|count| *count > 4), "{visits:?}");
}
