//! Random streams of whatever arrives. What may never happen, never does.

use crate::support::outputs::check_output;
use crate::support::{Handed, PERIOD_US, SETTLING_TICKS, go_to, pilot, pose, resting_imu, rotors};
use controller_core::allocation::Rotors;
use controller_core::governor::HeadingSetpoint;
use controller_core::prelude::*;
use estimation::estimator::{Increment, PoseMeasurement};
use flight::rules::{COASTING_MAX_US, DESCENDING_MAX_US, IDLING_MAX_US, IMU_AGE_MAX_US, MOTOR_TEST_MAX_US};
use flight::{Leg, MissionItem, Mode, MotorSetting, MotorTest, Outcome, Output, Pilot, Request, Setting, Stamped};
use proptest::prelude::*;

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
        elapsed: PERIOD_US,
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
    let elapsed = prop_oneof![30 => Just(PERIOD_US), 1 => 0..40_000_u64];
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
        Request::FlyMission(None),
        Request::FlyMission(Some(3)),
        Request::SetMissionItem(1),
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

/// Any item, or none.
fn mission_item(&[x, y, z, kind, radius, hold]: &[f32; 6]) -> Option<MissionItem> {
    let leg = [Leg::TakeOff, Leg::Waypoint, Leg::Land, Leg::Return][(kind + 2.0) as usize % 4];
    let position = Vector3::new(100.0 * x, 100.0 * y, 10.0 * z);
    let item = MissionItem { leg, position, turn: HeadingSetpoint::Keep, radius, hold: (hold.abs() * 1e5) as u64 };
    (hold > -1.8).then_some(item)
}

/// A stretch of arrivals, of the truth or of anything, with or without poses, IMU or a ground station. Half of them
/// begin with as much rest as arming takes.
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
        let rest = std::iter::repeat_n(Arrival::REST, if rested { SETTLING_TICKS as usize } else { 0 });
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
    /// When the ground station last sent.
    last_heartbeat: Option<u64>,
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
            last_heartbeat: None,
            descending_since: None,
            idling_since: None,
            testing_since: None,
        }
    }

    fn tick(&mut self, pilot: &mut Pilot, arrival: &Arrival) -> Mode {
        self.now += arrival.elapsed;
        let before = pilot.mode();
        self.last_heartbeat = arrival.ground_station.then_some(self.now).or(self.last_heartbeat);
        let handed = Handed {
            now: self.now,
            increments: self.increments(arrival),
            body_rate: self.body_rate(arrival),
            poses: self.pose(arrival).into_iter().collect(),
            ground_station: self.last_heartbeat,
            request: arrival.request,
            disarm: arrival.disarm,
            setpoint: arrival.position.map(|x| go_to(x, 0.0, 1.0)),
            mission_item: mission_item(&arrival.numbers),
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
            let end = self.now.min(self.until + PERIOD_US / 2);
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
            assert!(age(self.imu) <= IMU_AGE_MAX_US);
            assert!(age(self.pose) <= COASTING_MAX_US || outcome.mode == Mode::Descending);
            assert!(before.is_armed());
        }
        if let Output::Idle = outcome.output {
            assert!(before == Mode::Idling || arrival.request == Some(Request::Arm));
        }
        for (mode, since, most) in [
            (Mode::Descending, &mut self.descending_since, DESCENDING_MAX_US),
            (Mode::Idling, &mut self.idling_since, IDLING_MAX_US),
            (Mode::MotorTest, &mut self.testing_since, MOTOR_TEST_MAX_US),
        ] {
            *since = (outcome.mode == mode).then(|| since.unwrap_or(now));
            assert!(since.is_none_or(|since| now - since < most), "{mode:?} for too long");
        }
        assert!(!arrival.disarm || (outcome.output == Output::Stop && !outcome.mode.is_armed()));
        assert_eq!(outcome.transition.map_or(before, |transition| transition.to), outcome.mode);
        assert_eq!(outcome.transition.is_some(), before != outcome.mode);
        assert_eq!(outcome.answer.is_some(), arrival.request.is_some());
        let judged = match outcome.mode {
            Mode::Flying => arrival.position.is_some() && !outcome.mission.1,
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
