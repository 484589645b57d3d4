//! A simulator in place of sensors and motors: what counts as an answer, when it takes over, and lines that fail.

mod support;

use controller_core::flight::{ImuSample, Mode, MotorTest, PERIOD, Refusal, Request};
use core::cell::{Cell, RefCell};
use core::future::pending;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embedded_io_async::{ErrorKind, ErrorType, Read, Write};
use firmware::boot::Boot;
use firmware::control::Control;
use firmware::hardware::{Clock, Fault, Imu, MotorCommand, Motors, Watchdog};
use firmware::hil::{self, SelectedMotors};
use firmware::imu;
use firmware::link::frame::Parser;
use firmware::shared::{Asked, Flag, Origin};
use mavlink::dialects::common::{
    ATT_POS_MOCAP_DATA, HIL_ACTUATOR_CONTROLS_DATA, HIL_SENSOR_DATA, HilSensorUpdatedFlags, MavFrame, MavModeFlag,
    ODOMETRY_DATA,
};
use nalgebra::Vector3;
use support::line::{Delivery, Incoming, Line, Outgoing};
use support::receiver::{Fed, Local};
use support::{Simulated, patched, v2};

type Hil = hil::Hil<NoopRawMutex>;

/// When the simulator got its command, us; it answers a few milliseconds later.
const COMMANDED: u64 = 40_000;

/// Pins that remember what they were told.
#[derive(Default)]
struct Pins(Vec<MotorCommand>);

impl Motors for &mut Pins {
    async fn write(&mut self, command: MotorCommand) -> Result<(), Fault> {
        self.0.push(command);
        Ok(())
    }
}

/// Runs a future that waits for nothing.
fn now<T>(future: impl Future<Output = T>) -> T {
    embassy_futures::block_on(future)
}

/// A simulator that has been given a command at [`COMMANDED`] and has not answered.
fn commanded() -> Hil {
    let hil = Hil::new();
    command(&hil, COMMANDED);
    hil
}

fn command(hil: &Hil, time: u64) {
    let (wanted, clock) = (Flag::new(), Simulated::default());
    wanted.raise();
    clock.0.set(time);
    now(SelectedMotors { pins: &mut Pins::default(), hil, wanted: &wanted, clock }.write(MotorCommand::Stop)).unwrap();
}

/// What is shared after the simulator has said `bytes`, 5 ms after its command.
fn said(hil: &Hil, bytes: Vec<u8>) -> Local {
    let (clock, shared, line) = (Simulated::default(), Local::new(), Line::default());
    clock.0.set(COMMANDED + 5_000);
    line.borrow_mut().push_back(Delivery::Bytes(bytes));
    clock.run(3_000, hil::receive(hil, Incoming(&line), &clock, &shared), |_| ());
    shared
}

fn sensor(time_usec: u64) -> HIL_SENSOR_DATA {
    HIL_SENSOR_DATA {
        time_usec,
        // Rolling right, nose up, turning right.
        xgyro: 0.5,
        ygyro: 0.25,
        zgyro: 0.125,
        xacc: 1.0,
        yacc: 2.0,
        zacc: -9.0,
        fields_updated: HilSensorUpdatedFlags::all(),
        ..Default::default()
    }
}

fn odometry(time_usec: u64) -> ODOMETRY_DATA {
    ODOMETRY_DATA {
        time_usec,
        // 1 m north, 2 m east, 3 m up, facing north, flying that way.
        x: 1.0,
        y: 2.0,
        z: -3.0,
        q: [1.0, 0.0, 0.0, 0.0],
        vx: 0.5,
        frame_id: MavFrame::MAV_FRAME_LOCAL_NED,
        child_frame_id: MavFrame::MAV_FRAME_BODY_FRD,
        ..Default::default()
    }
}

#[test]
fn an_answer_is_what_the_sensors_say_a_period_after_its_command() {
    let hil = commanded();
    assert!(hil.active() && hil.awaiting());
    let shared = said(&hil, [v2(1, &odometry(COMMANDED)), v2(2, &sensor(COMMANDED))].concat());
    let (imu, pose) = (shared.imu.get().unwrap(), shared.pose.get().unwrap());
    assert_eq!((imu.time, pose.time), (COMMANDED + PERIOD, COMMANDED + PERIOD));
    assert_eq!(imu.value.angular_velocity, Vector3::new(0.5, -0.25, -0.125));
    assert_eq!(imu.value.specific_force, Vector3::new(1.0, -2.0, 9.0));
    assert_eq!(pose.value.position, Vector3::new(2.0, 1.0, 3.0));
    assert!((pose.value.velocity - Vector3::new(0.0, 0.5, 0.0)).norm() < 1e-6, "{}", pose.value.velocity);
    assert!(!hil.awaiting());
}

#[test]
fn a_pose_alone_does_not_end_the_exchange() {
    let hil = commanded();
    assert!(said(&hil, v2(1, &odometry(COMMANDED))).pose.get().is_some());
    assert!(hil.awaiting());
}

#[test]
fn no_answer_is_fresher_than_the_last_command_makes_it() {
    // One microsecond later, though that has passed by now; now; a second to come; whatever a clock of its own says.
    for time in [COMMANDED + 1, COMMANDED + 5_000, COMMANDED + 1_000_000, u64::MAX - 1, u64::MAX] {
        let hil = commanded();
        let shared = said(&hil, [v2(1, &odometry(time)), v2(2, &sensor(time))].concat());
        assert!(shared.imu.get().is_none() && shared.pose.get().is_none(), "{time}");
        assert!(hil.awaiting());
    }
}

#[test]
fn a_late_answer_keeps_its_own_time_and_is_not_the_one_awaited() {
    let hil = Hil::new();
    command(&hil, COMMANDED - PERIOD);
    command(&hil, COMMANDED);
    let late = COMMANDED - PERIOD;
    let shared = said(&hil, [v2(1, &odometry(late)), v2(2, &sensor(late))].concat());
    assert_eq!(shared.imu.get().unwrap().time, COMMANDED);
    assert_eq!(shared.pose.get().unwrap().time, COMMANDED);
    assert!(hil.awaiting());
}

#[test]
fn no_field_of_an_answer_may_be_nan_or_infinite() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        // Accelerometer and gyro; what is behind them (magnetometer, barometer) is not used.
        for field in 0..13 {
            let hil = commanded();
            let shared = said(&hil, patched(&sensor(COMMANDED), 8 + 4 * field, value));
            assert_eq!(shared.imu.get().is_none(), field < 6, "HIL_SENSOR field {field}: {value}");
            assert_eq!(hil.awaiting(), field < 6);
        }
        // Position, attitude, velocity, body rates.
        for field in 0..13 {
            let shared = said(&commanded(), patched(&odometry(COMMANDED), 8 + 4 * field, value));
            assert!(shared.pose.get().is_none(), "ODOMETRY field {field}: {value}");
        }
    }
}

#[test]
fn a_simulator_that_does_not_know_a_rate_or_a_force_has_not_answered() {
    use HilSensorUpdatedFlags as Field;
    for unknown in [
        Field::HIL_SENSOR_UPDATED_XACC,
        Field::HIL_SENSOR_UPDATED_YACC,
        Field::HIL_SENSOR_UPDATED_ZACC,
        Field::HIL_SENSOR_UPDATED_XGYRO,
        Field::HIL_SENSOR_UPDATED_YGYRO,
        Field::HIL_SENSOR_UPDATED_ZGYRO,
    ] {
        let fields_updated = Field::all().difference(unknown);
        let shared = said(&commanded(), v2(1, &HIL_SENSOR_DATA { fields_updated, ..sensor(COMMANDED) }));
        assert!(shared.imu.get().is_none(), "{unknown:?}");
    }
}

#[test]
fn a_pose_in_other_frames_or_without_a_rotation_is_refused() {
    for wrong in [
        ODOMETRY_DATA { frame_id: MavFrame::MAV_FRAME_LOCAL_ENU, ..odometry(COMMANDED) },
        ODOMETRY_DATA { child_frame_id: MavFrame::MAV_FRAME_LOCAL_FRD, ..odometry(COMMANDED) },
        ODOMETRY_DATA { q: [0.0; 4], ..odometry(COMMANDED) },
    ] {
        assert!(said(&commanded(), v2(1, &wrong)).pose.get().is_none(), "{wrong:?}");
    }
}

#[test]
fn a_simulator_that_was_given_no_command_says_nothing_that_counts() {
    let hil = Hil::new();
    let shared = said(&hil, [v2(1, &odometry(0)), v2(2, &sensor(0))].concat());
    assert!(shared.imu.get().is_none() && shared.pose.get().is_none());
    assert!(!hil.active());
}

/// A sensor with a sample every millisecond.
struct Steady<'a>(&'a Simulated);

impl Imu for Steady<'_> {
    async fn sample(&mut self) -> Result<ImuSample, Fault> {
        self.0.until(self.0.now() + 1_000).await;
        Ok(ImuSample { angular_velocity: Vector3::zeros(), specific_force: Vector3::z() })
    }
}

#[test]
fn the_vehicles_own_sensors_count_for_nothing_while_a_simulator_is_wanted() {
    for wanted in [false, true] {
        let (clock, shared) = (Simulated::default(), Local::new());
        if wanted {
            shared.hil.raise();
        }
        clock.run(10_000, imu::run(&shared, &clock, &mut Steady(&clock)), |_| ());
        assert_eq!(shared.imu.get().is_none(), wanted);
        let mut fed = Fed::new(&shared);
        fed.message(&odometry(1_000), 10_000);
        assert_eq!(shared.pose.take().is_none(), wanted);
        let mut fed = Fed::new(&shared);
        for (sequence, time_usec) in [(1, 1_000), (2, 11_000)] {
            let mocap = ATT_POS_MOCAP_DATA { time_usec, q: [1.0, 0.0, 0.0, 0.0], ..Default::default() };
            fed.bytes(&v2(sequence, &mocap), 10_000 + time_usec);
        }
        assert_eq!(shared.pose.get().is_none(), wanted);
    }
}

#[test]
fn the_simulator_takes_over_at_a_stop_and_the_pins_carry_stop_from_then_on() {
    let (run, one) = (MotorCommand::Run([0.5; 4]), MotorCommand::One { motor: 1, level: 0.1 });
    let (mut pins, hil, wanted) = (Pins::default(), Hil::new(), Flag::new());
    let mut motors = SelectedMotors { pins: &mut pins, hil: &hil, wanted: &wanted, clock: Simulated::default() };
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

/// What the pins are told in 100 ms of a vehicle that may fly, the request coming at `asked` and the simulator being wanted
/// from 45 ms on; and the answer.
fn handed_over(request: Request, asked: u64) -> (Vec<MotorCommand>, Result<(), Refusal>) {
    let (clock, shared, hil) = (Simulated::default(), Local::new(), Hil::new());
    let mut boot = Boot::new(&shared.parameters).unwrap();
    let mut pins = Pins::default();
    let mut motors = SelectedMotors { pins: &mut pins, hil: &hil, wanted: &shared.hil, clock: Simulated::default() };
    let still = ImuSample { angular_velocity: Vector3::zeros(), specific_force: Vector3::z() * 9.81 };
    let mut control = Control::new(&shared, &mut boot.pilot, &boot.outputs);
    clock.run(100_000, control.run(&clock, &mut motors, &mut Bench), |now| {
        if shared.hil.is_raised() {
            return;
        }
        shared.imu.put(still, now);
        shared.ground_station.put((), now);
        Fed::new(&shared).message(&odometry(0), now);
        if now == asked {
            let origin = Origin { system: 255, component: 190, command: 400 };
            shared.request(Asked { request, origin }).unwrap();
        }
        if now == 45_000 {
            shared.hil.raise();
        }
    });
    assert!(hil.active());
    assert_eq!(shared.report.get().unwrap().value.mode, Mode::Disarmed);
    (pins.0, shared.answers.try_receive().unwrap().result)
}

#[test]
fn who_asks_for_the_motors_and_the_simulator_at_once_turns_no_motor() {
    // Both between the same two ticks: neither finds the other done.
    let (pins, answer) = handed_over(Request::Arm, 45_000);
    assert_eq!(pins, [MotorCommand::Stop; 9]);
    assert_eq!(answer, Err(Refusal::DisarmCommanded));
}

#[test]
fn a_motor_test_ends_where_the_simulator_is_asked_for() {
    let test = MotorTest { rotor: 1, level: 0.1, duration: 2_000_000 };
    let (pins, answer) = handed_over(Request::MotorTest(test), 15_000);
    assert_eq!(pins[1..4], [MotorCommand::One { motor: 1, level: 0.1 }; 3]);
    assert_eq!(pins[4..], [MotorCommand::Stop; 5]);
    assert_eq!(answer, Ok(()));
}

/// Every command in what was written.
fn sent(written: &RefCell<Vec<u8>>) -> Vec<HIL_ACTUATOR_CONTROLS_DATA> {
    let mut parser = Parser::new();
    let mut found = Vec::new();
    for &byte in written.borrow().iter() {
        found.extend(parser.push(byte, 0).and_then(|frame| frame.decode()));
    }
    found
}

/// Gives the simulator a command every period while its line is `line`.
fn transmitted(line: impl Write, commands: &[MotorCommand]) {
    let (clock, shared, hil, wanted) = (Simulated::default(), Local::new(), Hil::new(), Flag::new());
    wanted.raise();
    let mut commands = commands.iter();
    let end = PERIOD * (commands.len() as u64);
    clock.run(end, hil::transmit(&hil, line, &clock, &shared), |time| {
        if time % PERIOD == 0 {
            let board = Simulated::default();
            board.0.set(time);
            let mut motors = SelectedMotors { pins: &mut Pins::default(), hil: &hil, wanted: &wanted, clock: board };
            now(motors.write(*commands.next().unwrap())).unwrap();
        }
    });
}

#[test]
fn each_command_goes_out_once_with_its_time() {
    let written = RefCell::default();
    let one = MotorCommand::One { motor: 2, level: 0.125 };
    let commands = [MotorCommand::Stop, MotorCommand::Run([0.1, 0.2, 0.3, 0.4]), one];
    transmitted(Outgoing { written: &written, at_once: 7 }, &commands);
    let sent = sent(&written);
    let times: Vec<_> = sent.iter().map(|controls| controls.time_usec).collect();
    assert_eq!(times, [0, PERIOD, 2 * PERIOD]);
    let levels: Vec<_> = sent.iter().map(|controls| controls.controls[..5].to_vec()).collect();
    assert_eq!(levels, [[0.0; 5], [0.1, 0.2, 0.3, 0.4, 0.0], [0.0, 0.0, 0.125, 0.0, 0.0]]);
    let armed = |controls: &HIL_ACTUATOR_CONTROLS_DATA| controls.mode.contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
    assert_eq!(sent.iter().map(armed).collect::<Vec<_>>(), [false, true, true]);
}

/// What goes wrong on a line at first.
#[derive(Clone, Copy, Debug)]
enum Trouble {
    TakesNothing,
    Closed,
    Broken,
}

/// A line that is in trouble a few times and then takes everything.
struct Recovering<'a> {
    trouble: Trouble,
    times: u32,
    then: Outgoing<'a>,
}

impl ErrorType for Recovering<'_> {
    type Error = ErrorKind;
}

impl Write for Recovering<'_> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        if self.times == 0 {
            return self.then.write(bytes).await;
        }
        self.times -= 1;
        match self.trouble {
            Trouble::TakesNothing => pending().await,
            Trouble::Closed => Ok(0),
            Trouble::Broken => Err(ErrorKind::Other),
        }
    }

    async fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

#[test]
fn a_line_in_trouble_loses_that_command_and_no_later_one() {
    for trouble in [Trouble::TakesNothing, Trouble::Closed, Trouble::Broken] {
        let written = RefCell::default();
        let then = Outgoing { written: &written, at_once: 1_000 };
        transmitted(Recovering { trouble, times: 2, then }, &[MotorCommand::Stop; 4]);
        let times: Vec<_> = sent(&written).iter().map(|controls| controls.time_usec).collect();
        assert_eq!(times, [2 * PERIOD, 3 * PERIOD], "{trouble:?}");
    }
}

/// A line that never delivers, and counts how often it is asked.
struct Mute<'a>(&'a Cell<u32>, Trouble);

impl ErrorType for Mute<'_> {
    type Error = ErrorKind;
}

impl Read for Mute<'_> {
    async fn read(&mut self, _: &mut [u8]) -> Result<usize, ErrorKind> {
        self.0.set(self.0.get() + 1);
        assert!(self.0.get() < 2_000, "it takes all the time there is");
        match self.1 {
            Trouble::TakesNothing => pending().await,
            Trouble::Closed => Ok(0),
            Trouble::Broken => Err(ErrorKind::Other),
        }
    }
}

#[test]
fn a_line_that_delivers_nothing_is_asked_again_but_not_all_the_time() {
    for (trouble, attempts) in
        [(Trouble::TakesNothing, 8..=11), (Trouble::Closed, 300..=1_000), (Trouble::Broken, 300..=1_000)]
    {
        let (clock, shared, asked) = (Simulated::default(), Local::new(), Cell::new(0));
        clock.run(1_000_000, hil::receive(&commanded(), Mute(&asked, trouble), &clock, &shared), |_| ());
        assert!(attempts.contains(&asked.get()), "{trouble:?}: {}", asked.get());
    }
}

#[test]
fn an_answer_in_pieces_between_faults_is_taken() {
    let (clock, shared, hil, line) = (Simulated::default(), Local::new(), commanded(), Line::default());
    clock.0.set(COMMANDED);
    for piece in v2(1, &sensor(COMMANDED)).chunks(9) {
        line.borrow_mut().extend([Delivery::Bytes(piece.to_vec()), Delivery::Fault, Delivery::End]);
    }
    clock.run(50_000, hil::receive(&hil, Incoming(&line), &clock, &shared), |_| ());
    assert_eq!(shared.imu.get().unwrap().time, COMMANDED + PERIOD);
}
