//! When a simulator takes over from sensors and motors, and what becomes of those.

use crate::support::PERIOD_US;
use crate::support::receiver::{Fed, Local, newest, ordered, texts};
use crate::support::simulator::{Hil, Pins, now, odometry};
use crate::support::{Simulated, v2};
use estimation::estimator::{Clipped, Increment};
use estimation::imu::ImuParameters;
use firmware::boot;
use firmware::control::Control;
use firmware::hardware::{Clock, Fault, Imu, MotorCommand, Motors, RawImu, Watchdog};
use firmware::hil::SelectedMotors;
use firmware::imu;
use firmware::link::acknowledgement::Acknowledgement;
use firmware::shared::{Flag, QueuedRequest, Reply};
use flight::{ImuSample, MotorTest, Request};
use mavlink::dialects::common::{ATT_POS_MOCAP_DATA, MavCmd, MavResult};
use nalgebra::Vector3;

/// A sensor with a sample every millisecond.
struct Steady<'a>(&'a Simulated);

impl Imu for Steady<'_> {
    async fn sample(&mut self) -> Result<RawImu, Fault> {
        let time = self.0.now() + 1_000;
        self.0.until(time).await;
        Ok(RawImu { time, angular_velocity: Vector3::zeros(), specific_force: Some(Vector3::z()) })
    }

    fn parameters(&self) -> ImuParameters {
        ImuParameters::PROMPT
    }

    fn is_polled(&self) -> bool {
        false
    }
}

#[test]
fn the_vehicles_own_sensors_count_for_nothing_while_a_simulator_is_wanted() {
    for wanted in [false, true] {
        let (clock, shared) = (Simulated::default(), Local::new());
        if wanted {
            shared.hil.raise();
        }
        clock.run(10_000, imu::run(shared.for_imu(), &clock, &mut Steady(&clock), PERIOD_US), |_| ());
        assert_eq!(shared.imu.get().is_none(), wanted);
        let mut fed = Fed::new(&shared);
        fed.message(&odometry(1_000), 10_000);
        assert_eq!(newest(&shared).is_none(), wanted);
        let mut fed = Fed::new(&shared);
        for (sequence, time_usec) in [(1, 1_000), (2, 11_000)] {
            let mocap = ATT_POS_MOCAP_DATA { time_usec, q: [1.0, 0.0, 0.0, 0.0], ..Default::default() };
            fed.bytes(&v2(sequence, &mocap), 10_000 + time_usec);
        }
        assert_eq!(newest(&shared).is_none(), wanted);
    }
}

#[test]
fn the_simulator_takes_over_at_a_stop_and_the_pins_carry_stop_from_then_on() {
    let (run, one) = (MotorCommand::Run([0.5; 4]), MotorCommand::One { motor: 1, level: 0.1 });
    let (mut pins, hil, wanted) = (Pins::default(), Hil::new(), Flag::new());
    let mut motors = SelectedMotors {
        pins: &mut pins,
        hil: &hil,
        requested: (&wanted).into(),
        clock: Simulated::default(),
        period: PERIOD_US,
    };
    for command in [MotorCommand::Stop, one, run] {
        now(motors.write(command)).unwrap();
    }
    wanted.raise();
    now(motors.write(run)).unwrap();
    assert!(!hil.active(), "taken over in flight");
    for command in [MotorCommand::Stop, run, one, MotorCommand::Stop, run] {
        now(motors.write(command)).unwrap();
        assert!(hil.active());
    }
    // Nothing gives the motors back.
    assert!(wanted.take());
    now(motors.write(run)).unwrap();
    assert_eq!(pins.0[..4], [MotorCommand::Stop, one, run, run]);
    assert_eq!(pins.0[4..], [MotorCommand::Stop; 6]);
}

/// Never hungry.
struct Bench;

impl Watchdog for Bench {
    fn feed(&mut self) {}
}

/// What the IMU of a vehicle at rest did in the 5 ms before `now`, us.
pub fn increment(now: u64) -> Increment {
    Increment {
        start: now - 5_000,
        end: now,
        delta_angle: Vector3::zeros(),
        delta_velocity: Vector3::z() * 9.81 * 0.005,
        clipped: Clipped::NEITHER,
    }
}

/// The pins' commands in 100 ms of a vehicle that may fly, the request coming at `asked` and the simulator being
/// wanted from 45 ms on; and the answer.
fn handed_over(request: Request, asked: u64) -> (Vec<MotorCommand>, MavResult, Vec<String>) {
    let (clock, shared, hil) = (Simulated::default(), Local::new(), Hil::new());
    let place = Box::leak(Box::new(boot::Place::new()));
    let (pilot, outputs) = boot::start(place, shared.for_boot()).unwrap();
    let mut pins = Pins::default();
    let mut motors = SelectedMotors {
        pins: &mut pins,
        hil: &hil,
        requested: (&shared.hil).into(),
        clock: Simulated::default(),
        period: PERIOD_US,
    };
    let still = ImuSample { angular_velocity: Vector3::zeros(), specific_force: Vector3::z() * 9.81 };
    let mut control = Control::new(shared.for_control(), pilot, outputs);
    clock.run(100_000, control.run(&clock, &mut motors, &mut Bench), |now| {
        if shared.hil.is_raised() {
            return;
        }
        shared.imu.put(still, now);
        if now > 0 && now % 5_000 == 0 {
            shared.increment(increment(now));
        }
        shared.ground_station.put((), now);
        Fed::new(&shared).message(&odometry(0), now);
        if now == asked {
            let order = ordered(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM);
            shared.request(QueuedRequest { request, order: Some(order), setpoints: None });
        }
        if now == 45_000 {
            shared.hil.raise();
        }
    });
    assert!(hil.active());
    assert!(!shared.report.get().unwrap().value.mode.is_armed());
    let Some(Reply::Command(Acknowledgement { result, .. })) = shared.answers.take() else { panic!("no answer") };
    (pins.0, result, texts(&shared))
}

#[test]
fn asking_for_the_motors_and_the_simulator_at_once_turns_no_motor() {
    // Both between the same two ticks: neither finds the other done.
    let (pins, answer, texts) = handed_over(Request::Arm, 45_000);
    assert_eq!(pins, [MotorCommand::Stop; 9]);
    assert_eq!(answer, MavResult::MAV_RESULT_DENIED);
    assert_eq!(texts, ["Refused: disarm commanded"]);
}

#[test]
fn a_motor_test_ends_when_the_simulator_is_requested() {
    let test = MotorTest { rotor: 1, level: 0.1, duration: 2_000_000 };
    let (pins, answer, _) = handed_over(Request::MotorTest(test), 15_000);
    assert_eq!(pins[1..4], [MotorCommand::One { motor: 1, level: 0.1 }; 3]);
    assert_eq!(pins[4..], [MotorCommand::Stop; 5]);
    assert_eq!(answer, MavResult::MAV_RESULT_ACCEPTED);
}
