//! What keeps a vehicle on the ground, and the tasks alone know of: a sensor that has failed, a battery without a
//! reading, motors that are not reached.

use crate::support::PERIOD_US;
use crate::support::Simulated;
use crate::support::receiver::{Local, texts};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use estimation::estimator::PoseMeasurement;
use estimation::imu::{Calibration, ImuParameters};
use firmware::boot;
use firmware::control::Control;
use firmware::hardware::{Clock, Fault, MotorCommand, Motors, RawImu, Watchdog};
use firmware::imu::Flow;
use firmware::parameters::table::Name;
use firmware::shared::QueuedRequest;
use flight::{Mode, Pose, Request, Stamped, Velocity};
use nalgebra::{Quaternion, Vector3};

/// A vehicle at rest: its accelerometer's force at a time, us, its battery's voltage, and whether its motors' frames go
/// out.
struct Vehicle {
    force: fn(u64) -> Option<Vector3<f32>>,
    voltage: fn(u64) -> Option<f32>,
    frames: fn(u64) -> Result<(), Fault>,
}

/// Everything as it should be, and no battery to measure.
const WELL: Vehicle = Vehicle { force: noisy, voltage: |_| None, frames: |_| Ok(()) };

fn noisy(time: u64) -> Option<Vector3<f32>> {
    Some(Vector3::new(0.0, 0.0, 9.81 + 1e-3 * (time / 1_000 % 2) as f32))
}

struct Frames<'a>(&'a Simulated, fn(u64) -> Result<(), Fault>);

impl Motors for Frames<'_> {
    async fn write(&mut self, _: MotorCommand) -> Result<(), Fault> {
        self.1(self.0.now())
    }
}

struct Patient;

impl Watchdog for Patient {
    fn feed(&mut self) {}
}

/// What the IMU's task and a camera put down at `now`, us.
fn sense(shared: &Local, flow: &mut Flow<'_, NoopRawMutex>, vehicle: &Vehicle, now: u64) {
    let jitter = if (now / 1_000).is_multiple_of(2) { 1e-4 } else { -1e-4 };
    let angular_velocity = Vector3::new(jitter, 0.0, 0.0);
    flow.take(&RawImu { time: now, angular_velocity, specific_force: (vehicle.force)(now) });
    if now.is_multiple_of(10_000) {
        let zero = Vector3::zeros();
        let pose = Pose::new(zero, Velocity::World(zero), Quaternion::identity()).unwrap();
        let _ = shared.poses.put(Stamped { value: PoseMeasurement::new(&pose), time: now });
        shared.ground_station.put((), now);
        if let Some(voltage) = (vehicle.voltage)(now) {
            shared.voltage.put(voltage, now);
        }
    }
}

/// Each of these is requested at its time, us, of four seconds: the mode then, and the texts since the first of them.
fn asked(shared: &Local, vehicle: &Vehicle, requests: &[(u64, Request)]) -> (Mode, Vec<String>) {
    let clock = Simulated::default();
    let (pilot, outputs) = boot::start(Box::leak(Box::new(boot::Place::new())), shared.for_boot()).unwrap();
    let mut control = Control::new(shared.for_control(), pilot, outputs);
    let mut flow = Flow::new(shared.for_samples(), &ImuParameters::BMI088, &Calibration::NONE, PERIOD_US).unwrap();
    let mut frames = Frames(&clock, vehicle.frames);
    let mut seen = Vec::new();
    clock.run(4_000_000, control.run(&clock, &mut frames, &mut Patient), |now| {
        sense(shared, &mut flow, vehicle, now);
        let words = texts(shared);
        seen.extend(words.into_iter().filter(|_| now > requests[0].0));
        if let Some(&(_, request)) = requests.iter().find(|(at, _)| *at == now) {
            shared.request(QueuedRequest { request, order: None, setpoints: None });
        }
    });
    (shared.report.get().unwrap().value.mode, seen)
}

/// QueuedRequest to arm after three seconds.
const ARM: [(u64, Request); 1] = [(3_000_000, Request::Arm)];

/// It does not arm, and announces this.
fn refuses(shared: &Local, vehicle: &Vehicle, words: &str) {
    let (mode, texts) = asked(shared, vehicle, &ARM);
    assert!(!mode.is_armed() && texts.iter().any(|text| text == words), "{mode:?} {texts:?}");
}

fn arms(shared: &Local, vehicle: &Vehicle) {
    let (mode, texts) = asked(shared, vehicle, &ARM);
    assert_eq!(mode, Mode::Idling, "{texts:?}");
}

#[test]
fn an_accelerometer_that_has_failed_does_not_arm_until_it_has_been_well_for_a_second() {
    arms(&Local::new(), &WELL);
    let silent = |time| if time < 1_800_000 { noisy(time) } else { None };
    refuses(&Local::new(), &Vehicle { force: silent, ..WELL }, "IMU: accelerometer does not answer");
    let stuck = |_| noisy(0);
    refuses(&Local::new(), &Vehicle { force: stuck, ..WELL }, "IMU: accelerometer stuck");
    let lately = |time| if (1_800_000..=2_100_000).contains(&time) { None } else { noisy(time) };
    refuses(&Local::new(), &Vehicle { force: lately, ..WELL }, "IMU: accelerometer does not answer");
    let once = |time| if (1_800_000..=1_900_000).contains(&time) { None } else { noisy(time) };
    arms(&Local::new(), &Vehicle { force: once, ..WELL });
}

const NOT_MEASURED: &str = "Refused: battery to be watched is not measured";

/// With a battery that is to be watched.
fn watching(name: Name) -> Local {
    let shared = Local::new();
    shared.parameters.set(name, 10.5).unwrap();
    shared
}

#[test]
fn a_battery_that_is_to_be_watched_does_not_arm_unless_it_is_measured() {
    for name in [Name::BatteryLow, Name::BatteryCritical] {
        refuses(&watching(name), &WELL, NOT_MEASURED);
        // Nor once the wire has come off.
        let until = |time| (time < 1_900_000).then_some(12.0);
        refuses(&watching(name), &Vehicle { voltage: until, ..WELL }, NOT_MEASURED);
        arms(&watching(name), &Vehicle { voltage: |_| Some(12.0), ..WELL });
    }
}

#[test]
fn a_battery_reading_that_ends_in_flight_is_reported_once_and_changes_nothing() {
    let wish = [(2_000_000, Request::Arm), (2_100_000, Request::TakeOff(None))];
    let words = "Battery: no reading for 1 s, nothing watches it";
    let count = |texts: &[String]| texts.iter().filter(|text| *text == words).count();
    let until = |time| (time < 2_300_000).then_some(12.0);
    for (shared, times) in [(watching(Name::BatteryLow), 1), (Local::new(), 0)] {
        let (mode, texts) = asked(&shared, &Vehicle { voltage: until, ..WELL }, &wish);
        assert_eq!((mode, count(&texts)), (Mode::TakingOff, times), "{texts:?}");
    }
}

#[test]
fn motors_whose_frames_do_not_go_out_do_not_arm() {
    let words = "Refused: the motors' frames do not go out";
    refuses(
        &Local::new(),
        &Vehicle { frames: |time| if time < 2_900_000 { Ok(()) } else { Err(Fault) }, ..WELL },
        words,
    );
    arms(&Local::new(), &Vehicle { frames: |time| if time > 2_900_000 { Ok(()) } else { Err(Fault) }, ..WELL });
}
