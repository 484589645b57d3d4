//! Rotors out of balance: the whole pilot flies on an IMU that they shake.
//!
//! A rotor with the unbalance U (mass times distance from its axis, kg m) that turns at W pulls its axis with U W^2
//! around, and is pulled along it with U W'. So the body, of mass m and inertia J, to which the rotor is fixed at r,
//! swings to and fro, and the IMU at its origin with it:
//!
//! ```text
//! velocity   U W e(phi - 90 degrees) / m          e(phi): the direction in which the rotor's heavy side points
//! attitude   -J^-1 r x U e(phi)                   rad, about the body's axes
//! ```
//!
//! What the IMU feels is changed by their derivatives. The motion itself is left as it is: these are micrometres. A
//! frame bends, and turns a part of every pull upwards. Like the rotors of a real vehicle these turn at slightly
//! different speeds, and their pulls beat. `cargo test -p host-sim vibration -- --nocapture` prints the table that
//! stands in `docs/measured.md`.

use crate::support::extended::vehicle;
use controller_core::certificate::certified::Certified;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use estimation::estimator::PoseMeasurement;
use estimation::imu::sensor::GAIN_MAX_SHARE;
use estimation::imu::{Calibration, Conditioner, ImuParameters};
use firmware::hardware::MOTOR_COUNT;
use firmware::recorder::gyro::{self, GyroLog};
use flight::{FlightSettings, ImuSample, Inputs, Pose, Reason, Request, Stamped};
use host_sim::identification::ulog::command;
use host_sim::identification::ulog::writer::{Topic, Writer};
use host_sim::vehicle::instruments::{SAMPLE_PERIOD_US, TrueMotion};
use host_sim::vehicle::reality::RealVehicle;
use nalgebra::{UnitQuaternion, Vector3};
use scenario::Scenario;
use std::path::Path;
use verification::piloted::{Meddler, PilotedVehicle, Place};

/// Above the IMU.
const ROTOR_PLANE_HEIGHT_M: f64 = 0.02;

/// The part of a pull that the frame turns upwards.
const UPWARD_SHARE: f64 = 0.5;

/// By how much each rotor is faster than the one before it.
const ROTOR_SPEED_STEP_SHARE: f64 = 0.004;

const HOVER_HEIGHT_M: f64 = 1.5;

/// The rotors turn so fast in hover where none is said to be faster.
const HOVER_HZ: f64 = 74.7;

/// How often rotors tell their speeds, and how finely: a revolution a second.
const TELEMETRY_PERIOD_US: u64 = 10_000;
const SPEED_STEP_RAD_PER_S: f64 = std::f64::consts::TAU;

/// When noise is looked at.
const NOISE_US: std::ops::Range<u64> = 8_000_000..12_000_000;

/// What happens when, us: arming, take-off; from when on it hovers, and to when; what is then requested or lost.
const ARM_US: u64 = 2_000_000;
const TAKE_OFF: u64 = 2_600_000;
const HOVER_US: std::ops::Range<u64> = 15_000_000..30_000_000;
const END_US: u64 = 60_000_000;

/// A rotor as its unbalance has it.
struct Shaker {
    place: Vector3<f64>,
    /// About the body's z: 1 or -1.
    sense: f64,
    /// How much faster than its thrust says.
    faster: f64,
    /// rad, and rad/s.
    phase: f64,
    speed: f64,
}

/// The rotors, and what they make of the IMU.
struct Unbalanced {
    /// kg m.
    unbalance: f64,
    mass: f64,
    inertia: Vector3<f64>,
    /// N/(rad/s)^2.
    coefficient: f64,
    shakers: Vec<Shaker>,
    /// Specific force, m/s^2; body rate, rad/s; and angle, rad: of the shaking alone.
    force: Vector3<f64>,
    rate: Vector3<f64>,
    angle: Vector3<f64>,
    /// Whose gyro it is, where its own filter is to let through what its data sheet's does, and the same chain beside
    /// that in flight: of the shaking alone.
    gyro: Option<(ImuParameters, Conditioner)>,
    /// The body rate that the simulated sensor's filter is given, and that the gyro's own lets through, rad/s.
    sensed: Vector3<f64>,
    through: Vector3<f64>,
    /// Whether the rotors tell their speeds, and what they have told, rad/s.
    is_telling: bool,
    told: [Option<f32>; MOTOR_COUNT],
    /// Whether poses come.
    is_seen: bool,
    /// Sums of squares while the vehicle hovers, and of how many samples.
    squares: (f64, f64, f64),
}

impl Unbalanced {
    fn new(scenario: &Scenario, unbalance: f64, faster: f64) -> Self {
        let configuration = &scenario.configuration;
        let (model, rotors) = (configuration.vehicle(), configuration.rotors().unwrap());
        let shakers = rotors.iter().enumerate().map(|(number, rotor)| Shaker {
            place: rotor.position.map(f64::from) + Vector3::z() * ROTOR_PLANE_HEIGHT_M,
            sense: -f64::from(rotor.spin.sign()),
            faster: faster * (1.0 + ROTOR_SPEED_STEP_SHARE * number as f64),
            phase: number as f64,
            speed: 0.0,
        });
        let zero = Vector3::zeros();
        Self {
            unbalance,
            mass: model.mass.into(),
            inertia: model.inertia.map(f64::from),
            coefficient: rotors[0].thrust_coefficient.into(),
            shakers: shakers.collect(),
            force: zero,
            rate: zero,
            angle: zero,
            gyro: None,
            sensed: zero,
            through: zero,
            is_telling: false,
            told: [None; MOTOR_COUNT],
            is_seen: true,
            squares: (0.0, 0.0, 0.0),
        }
    }

    /// Standard deviations of specific force, m/s^2, and body rate, rad/s, all axes together.
    fn strength(&self) -> (f64, f64) {
        let (force, rate, samples) = self.squares;
        ((force / samples).sqrt(), (rate / samples).sqrt())
    }
}

impl Meddler for Unbalanced {
    fn act(&mut self, vehicle: &mut RealVehicle, _: u64) {
        let bent = |x: f64, y: f64| Vector3::new(x, y, UPWARD_SHARE * x);
        let seconds = SAMPLE_PERIOD_US as f64 * 1e-6;
        (self.force, self.rate, self.angle) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
        (self.sensed, self.through) = (Vector3::zeros(), Vector3::zeros());
        for (shaker, thrust) in self.shakers.iter_mut().zip(vehicle.thrusts()) {
            let speed = shaker.faster * (thrust / self.coefficient).max(0.0).sqrt();
            let quicker = (speed - shaker.speed) / seconds;
            shaker.speed = speed;
            shaker.phase = (shaker.phase + shaker.sense * speed * seconds) % std::f64::consts::TAU;
            let (sine, cosine) = shaker.phase.sin_cos();
            let (heavy, behind) =
                (bent(cosine, sine) * self.unbalance, bent(sine, -cosine) * (self.unbalance * shaker.sense));
            self.force += (heavy * (speed * speed) + behind * quicker) / self.mass;
            let rate = shaker.place.cross(&(behind * speed)).component_div(&self.inertia);
            self.rate += rate;
            let [own, simulated] = self.gyro.as_ref().map_or([1.0; 2], |(gyro, _)| gains(gyro, speed));
            self.through += rate * own;
            self.sensed += rate * (own / simulated);
            self.angle -= shaker.place.cross(&heavy).component_div(&self.inertia);
        }
    }

    fn feel(&mut self, felt: TrueMotion, time: u64) -> TrueMotion {
        if let Some((_, beside)) = &mut self.gyro {
            beside.follow_rotors(&self.told);
            // So that it is not stuck where nothing shakes yet.
            let jitter = Vector3::z() * (time % 3_000) as f32 * 1e-9;
            let through = self.through.map(|rate| rate as f32) + jitter;
            beside.sample(time, &through, Some(&(Vector3::z() * 9.81 + jitter)));
        }
        let (force, rate, samples) = self.squares;
        self.squares = (force + self.force.norm_squared(), rate + self.rate.norm_squared(), samples + 1.0);
        let turned = UnitQuaternion::from_scaled_axis(-self.angle);
        TrueMotion {
            angular_velocity: turned * felt.angular_velocity + self.sensed,
            specific_force: turned * (felt.specific_force + self.force),
        }
    }

    fn rotor_speeds(&mut self, time: u64) -> [Option<f32>; MOTOR_COUNT] {
        if self.is_telling && time.is_multiple_of(TELEMETRY_PERIOD_US) {
            for (told, shaker) in self.told.iter_mut().zip(&self.shakers) {
                *told = Some(((shaker.speed / SPEED_STEP_RAD_PER_S).round() * SPEED_STEP_RAD_PER_S) as f32);
            }
        }
        self.told
    }

    fn pose(&mut self, pose: Stamped<Pose>, _: u64) -> Option<Stamped<PoseMeasurement>> {
        self.is_seen.then(|| Stamped { value: PoseMeasurement::new(&pose.value), time: pose.time })
    }
}

/// What a gyro's own filter lets through at `speed`, rad/s, and what the filter of the simulated sensor does: that one is
/// sampled, and stops half the rate of the samples altogether.
fn gains(gyro: &ImuParameters, speed: f64) -> [f64; 2] {
    let (frequency, bandwidth) = (speed / std::f64::consts::TAU, f64::from(gyro.gyro_bandwidth));
    let warped = |frequency: f64| (std::f64::consts::PI * frequency * SAMPLE_PERIOD_US as f64 * 1e-6).tan();
    let gain = |ratio: f64| 1.0 / (1.0 + ratio.powi(4)).sqrt();
    [gain(frequency / bandwidth), gain(warped(frequency) / warped(bandwidth))]
}

/// What came of a flight.
#[derive(Debug)]
struct Flown {
    /// RMS of the IMU's shaking in hover, m/s^2 and rad/s.
    strength: (f64, f64),
    /// RMS and greatest distance from the hover, m.
    off: (f64, f64),
    /// Poses refused.
    refused: usize,
    /// Speed of the hardest touchdown, m/s.
    touchdown: f64,
    /// Why each mode was entered, and when, us.
    reasons: Vec<(Reason, u64)>,
}

/// Takes off, hovers, and comes down: commanded to land, or without poses. Its rotors turn so many times as fast as its
/// model's would.
fn fly(scenario: &Scenario, unbalance: f64, faster: f64, is_blinded: bool) -> Flown {
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let mut place = Place::new(&scenario.configuration);
    let settings = FlightSettings::DEFAULT;
    let mut vehicle = PilotedVehicle::new(scenario, Ok(&certified), &settings, &mut place, 0).unwrap();
    let mut shaken = Unbalanced::new(scenario, unbalance, faster);
    let (mut squares, mut greatest) = (0.0, 0.0_f64);
    let mut flown = Flown { strength: (0.0, 0.0), off: (0.0, 0.0), refused: 0, touchdown: 0.0, reasons: Vec::new() };
    let period = scenario.timing.period_us;
    for time in (period..END_US).step_by(period as usize) {
        let request = match time {
            ARM_US => Some(Request::Arm),
            TAKE_OFF => Some(Request::TakeOff(Some(HOVER_HEIGHT_M as f32))),
            time if time == HOVER_US.end && !is_blinded => Some(Request::Land),
            _ => None,
        };
        shaken.is_seen = !(is_blinded && time >= HOVER_US.end);
        if time == HOVER_US.start {
            shaken.squares = (0.0, 0.0, 0.0);
        }
        let given = Inputs { request, ground_station: Some(vehicle.now() + period), ..Inputs::default() };
        let (outcome, _) = vehicle.tick(&given, &mut shaken).unwrap();
        flown.reasons.extend(outcome.transition.map(|transition| (transition.reason, time)));
        flown.refused += usize::from(outcome.pose.is_some_and(|pose| pose.is_err()));
        if HOVER_US.contains(&time) {
            let off = (vehicle.vehicle().state().position - Vector3::z() * HOVER_HEIGHT_M).norm();
            (squares, greatest) = (squares + off * off, greatest.max(off));
        }
        if time == HOVER_US.end {
            flown.strength = shaken.strength();
        }
        if let Some(touchdown) = vehicle.vehicle_mut().take_touchdown() {
            flown.touchdown = flown.touchdown.max(touchdown.speed);
        }
    }
    let ticks = ((HOVER_US.end - HOVER_US.start) / period) as f64;
    Flown { off: ((squares / ticks).sqrt(), greatest), ..flown }
}

/// That nothing went wrong on a flight, and that it came down as it should.
fn check(flown: &Flown, is_blinded: bool, off: f64, what: &str) {
    let begins = [Reason::Started, Reason::Ready, Reason::Armed, Reason::TakeOffCommanded, Reason::TakenOff];
    let ends = [if is_blinded { Reason::PoseLost } else { Reason::LandCommanded }, Reason::Landed];
    let reasons: Vec<Reason> = flown.reasons.iter().map(|(reason, _)| *reason).take(7).collect();
    assert_eq!(reasons, [&begins[..], &ends[..]].concat(), "{what}: {flown:?}");
    let gentle = if is_blinded { 1.0 } else { 0.6 };
    assert!(flown.off.0 < off && flown.touchdown < gentle && flown.refused <= 3, "{what}: {flown:?}");
}

#[test]
fn a_shaken_vehicle_hovers_lands_and_comes_down_blind() {
    println!("vehicle      IMU shaken by, RMS    hover off by [mm], RMS, most    landed after [s]: commanded, blind");
    for (name, limits) in [("hummingbird", [2e-3, 2e-3, 3e-3, 5e-3, 8e-3]), ("study", [2e-3, 2e-3, 3e-3, 4e-3, 6e-3])] {
        for (unbalance, limit) in [0.0, 1e-5, 2e-5, 3e-5, 4e-5].into_iter().zip(limits) {
            let [landed, blind] = [false, true].map(|is_blinded| {
                let flown = fly(&vehicle(name), unbalance, 1.0, is_blinded);
                check(&flown, is_blinded, limit, &format!("{name}, {unbalance} kg m"));
                let down = flown.reasons.iter().find(|(reason, _)| *reason == Reason::Landed).unwrap().1;
                (flown, (down - HOVER_US.end) as f64 * 1e-6)
            });
            let Flown { strength: (force, rate), off, .. } = landed.0;
            let (rms, most) = (off.0 * 1e3, off.1 * 1e3);
            println!(
                "{name:12} {force:5.1} m/s^2, {rate:.2} rad/s    {rms:5.1}, {most:5.1}    {:5.2}, {:5.2}",
                landed.1, blind.1
            );
        }
    }
}

#[test]
fn at_whatever_speed_the_rotors_turn_their_shaking_is_no_slow_motion() {
    // Of 75 Hz in hover: 66 to 269 Hz, with 100 and 200 Hz, which alias to no motion at the ticks, among them.
    for name in ["hummingbird", "study"] {
        for faster in [0.88, 0.95, 1.07, 1.2, 1.3, 1.335, 1.345, 1.4, 1.5, 1.65, 1.8, 2.2, 2.68, 2.7, 3.1, 3.6] {
            let flown = fly(&vehicle(name), 2e-5 / (faster * faster), faster, false);
            let (force, rate) = flown.strength;
            let hertz = HOVER_HZ * faster;
            println!(
                "{name:12} {hertz:5.1} Hz, {force:4.1} m/s^2, {rate:.2} rad/s    {:5.1} mm RMS",
                flown.off.0 * 1e3
            );
            check(&flown, false, 6e-3, &format!("{name}, rotors {faster} times as fast"));
        }
    }
}

#[test]
fn at_any_rate_of_control_shaking_is_no_slow_motion() {
    // In hover, and where it swings as fast as control ticks, or half as fast.
    for (rate, faster) in
        [(50, [1.0, 1.34, 2.01]), (250, [1.0, 1.67, 3.35]), (500, [1.0, 3.35, 6.7]), (1_000, [1.0, 3.35, 6.7])]
    {
        let text =
            include_str!("../../vehicles/hummingbird.toml").replace("rate = 100.0 ", &format!("rate = {rate}.0 "));
        let hummingbird = Scenario::parse(&text, "vehicles/hummingbird.toml").unwrap();
        for faster in faster {
            let flown = fly(&hummingbird, 2e-5 / (faster * faster), faster, false);
            let (hertz, off) = (HOVER_HZ * faster, flown.off.0 * 1e3);
            println!("hummingbird at {rate} Hz, shaken at {hertz:5.1} Hz: {off:5.1} mm RMS");
            check(&flown, false, 6e-3, &format!("{rate} Hz, rotors {faster} times as fast"));
        }
    }
}

/// A gyro that is logged raw.
struct Logged {
    shaken: Unbalanced,
    log: GyroLog<NoopRawMutex>,
    file: Writer,
}

impl Meddler for Logged {
    fn act(&mut self, vehicle: &mut RealVehicle, time: u64) {
        self.shaken.act(vehicle, time);
    }

    fn feel(&mut self, felt: TrueMotion, time: u64) -> TrueMotion {
        self.shaken.feel(felt, time)
    }

    fn sample(&mut self, sample: ImuSample, time: u64) -> Option<ImuSample> {
        self.log.put(time, &sample.angular_velocity);
        while let Some(block) = self.log.take() {
            self.file.record(0, u64::from_le_bytes(*block.first_chunk().unwrap()), &block[8..]);
        }
        Some(sample)
    }
}

#[test]
fn the_raw_gyros_spectrum_shows_the_rotors() {
    let faster = 1.6;
    let hummingbird = vehicle("hummingbird");
    let certified = Certified::new(hummingbird.configuration.clone()).unwrap();
    let mut place = Place::new(&hummingbird.configuration);
    let settings = FlightSettings::DEFAULT;
    let mut vehicle = PilotedVehicle::new(&hummingbird, Ok(&certified), &settings, &mut place, 0).unwrap();
    let (name, fields) = gyro::FORMAT.split_once(':').unwrap();
    let mut logged = Logged {
        shaken: Unbalanced::new(&hummingbird, 2e-5 / (faster * faster), faster),
        log: GyroLog::new(),
        file: Writer::new(0, &[Topic { name, fields }], &[], &[]),
    };
    logged.log.attach(Box::leak(vec![[0; gyro::BLOCK_BYTES]; 2].into_boxed_slice()));
    let period = hummingbird.timing.period_us;
    for time in (period..NOISE_US.end).step_by(period as usize) {
        let request = match time {
            ARM_US => Some(Request::Arm),
            TAKE_OFF => Some(Request::TakeOff(Some(HOVER_HEIGHT_M as f32))),
            _ => None,
        };
        let given = Inputs { request, ground_station: Some(vehicle.now() + period), ..Inputs::default() };
        vehicle.tick(&given, &mut logged).unwrap();
    }
    // For docs/vibration.md, whose picture is this one; a folder below the project's.
    let below = |folder| Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
    let folder = std::env::var_os("LOGS").map_or_else(std::env::temp_dir, below);
    let (log, picture) = (folder.join("shaken.ulg"), folder.join("shaken.svg"));
    std::fs::write(&log, logged.file.finish()).unwrap();
    let told = command::draw(&log, &picture).unwrap();
    println!("{told}");
    let greatest: f64 = told.lines().nth(1).unwrap().trim().split(' ').next().unwrap().parse().unwrap();
    assert!((greatest - HOVER_HZ * faster).abs() < 4.0, "{told}");
    assert!(std::fs::read_to_string(&picture).unwrap().ends_with("</svg>\n"));
}

/// The RMS of what the gyro is shaken by, and of what is left of that in the law's body rates, rad/s, all axes together.
fn noise(scenario: &Scenario, gyro: &ImuParameters, hertz: f64, is_telling: bool) -> (f64, f64) {
    let faster = hertz / HOVER_HZ;
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let mut place = Place::new(&scenario.configuration);
    let settings = FlightSettings::DEFAULT;
    let vehicle = PilotedVehicle::new(scenario, Ok(&certified), &settings, &mut place, 0).unwrap();
    let mut vehicle = vehicle.with_gyro_of(gyro).unwrap();
    let period = scenario.timing.period_us;
    let beside = ImuParameters { rate: 1e6 / SAMPLE_PERIOD_US as f32, ..*gyro };
    let unbalanced = Unbalanced::new(scenario, 2e-5 / (faster * faster), faster);
    let mut shaken = Unbalanced {
        gyro: Some((*gyro, Conditioner::new(&beside, &Calibration::NONE, period).unwrap())),
        is_telling,
        ..unbalanced
    };
    let (mut squares, mut ticks) = (0.0, 0.0);
    for time in (period..NOISE_US.end).step_by(period as usize) {
        let request = match time {
            ARM_US => Some(Request::Arm),
            TAKE_OFF => Some(Request::TakeOff(Some(HOVER_HEIGHT_M as f32))),
            _ => None,
        };
        let given = Inputs { request, ground_station: Some(vehicle.now() + period), ..Inputs::default() };
        vehicle.tick(&given, &mut shaken).unwrap();
        if time == NOISE_US.start {
            shaken.squares = (0.0, 0.0, 0.0);
        }
        if NOISE_US.contains(&time) {
            let (_, beside) = shaken.gyro.as_ref().unwrap();
            let left = beside.newest().unwrap().value.angular_velocity.map(f64::from);
            (squares, ticks) = (squares + left.norm_squared(), ticks + 1.0);
        }
    }
    let height = vehicle.vehicle().state().position.z;
    assert!((height - HOVER_HEIGHT_M).abs() < 0.1, "it hovers: {height} m");
    (shaken.strength().1, (squares / ticks).sqrt())
}

#[test]
fn each_gyros_noise_at_the_tick_with_and_without_notches() {
    /// Less is nothing.
    const FLOOR_RAD_PER_S: f64 = 0.002;
    let hummingbird = vehicle("hummingbird");
    println!("rotors  shaken by   left at the tick, without notches; with: {:?}", ImuParameters::DRIVEN.map(|s| s.0));
    for hertz in [75.0, 100.0, 150.0, 199.0, 250.0, 301.0, 400.0] {
        let mut line = String::new();
        let mut tested = None;
        for (name, gyro) in &ImuParameters::DRIVEN {
            let [(shaken, plain), (_, notched)] = [false, true].map(|tells| noise(&hummingbird, gyro, hertz, tells));
            if tested.is_none() {
                line += &format!("{hertz:3.0} Hz  {shaken:.3} rad/s");
            }
            let tested = *tested.get_or_insert(plain);
            line += &format!("  {plain:.4}; {notched:.4}");
            let what = format!("{name}, rotors at {hertz} Hz, shaken by {shaken:.3} rad/s: {plain:.4}, {notched:.4}");
            assert!(plain < f64::from(GAIN_MAX_SHARE) * tested + FLOOR_RAD_PER_S, "{what}; a BMI088 {tested:.4}");
            assert!(notched < 0.25 * plain + FLOOR_RAD_PER_S, "{what}");
        }
        println!("{line}");
    }
}
