//! Everything outside the processor: the vehicle as it really is, its sensors, and the camera that sends its poses.
//!
//! ```text
//! motor command -> (delay) -> rotors, air, ground -> IMU, each millisecond
//!                                                '-> poses -> (late) -> ODOMETRY, on the line into the vehicle
//! ```
//!
//! The vehicle starts on the ground below where the scenario starts, level, with its rotors standing still. Poses go
//! the way that poses of a motion capture go: as messages, from a system of their own, whose clock answers TIMESYNC.
//! Where a client sends the poses ([`PoseSource::Link`]), there is no such system: only the client sends poses. The
//! world moves when it is read: to that moment, a millisecond at a time, so no reader sees it too early or too late.

use super::clock::SimClock;
use super::faults::{Faults, FaultyPart};
use super::memory_line::MemoryLine;
use crate::sessions::answer::{Answer, MeasuredPose, controller_answer};
use crate::sessions::messages::Encoder;
use crate::vehicle::instruments::{Instruments, SAMPLE_PERIOD_US};
use crate::vehicle::plant::Diverged;
use crate::vehicle::reality::RealVehicle;
use controller_core::allocation::{Rotor, ThrustCurve};
use estimation::imu::ImuParameters;
use firmware::esc;
use firmware::hardware::{Battery, Clock, Fault, Imu, Light, MOTOR_COUNT, MotorCommand, Motors, RawImu, Watchdog};
use firmware::link::frame::Frame;
use firmware::link::signing::{Key, Stamp};
use flight::{ImuSample, Stamped};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use scenario::Scenario;
use scenario::body::{BodyState, attitude_from_euler};
use scenario::reality::ground::Ground;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

/// What the camera's clock is ahead of the vehicle's. It is never zero: an answer to TIMESYNC that says zero is a
/// question.
const CAMERA_CLOCK_OFFSET_US: u64 = 1_000_000_000;

/// Where the vehicle's poses come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PoseSource {
    /// The simulated camera.
    #[default]
    Camera,
    /// A client: there is no simulated camera.
    Link,
}

/// A person's hands on a vehicle that stands: what its sensors and the camera show of that. The vehicle itself stands
/// on: nobody flies what is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hands {
    /// How it is turned from how it stands.
    pub turn: UnitQuaternion<f32>,
    /// How fast, rad/s, body axes.
    pub rate: Vector3<f32>,
    /// How far it is carried from where it stands, m, world.
    pub carried: Vector3<f32>,
    /// Whether the camera sees it.
    pub is_seen: bool,
}

impl Hands {
    /// Nobody touches it.
    pub const OFF: Self = Self {
        turn: UnitQuaternion::new_unchecked(Quaternion::new(1.0, 0.0, 0.0, 0.0)),
        rate: Vector3::new(0.0, 0.0, 0.0),
        carried: Vector3::new(0.0, 0.0, 0.0),
        is_seen: true,
    };
}

/// The hardware of one vehicle, and all around it; clones are the same.
#[derive(Clone)]
pub struct SimulatedHardware(Rc<Inner>);

struct Inner {
    clock: SimClock,
    faults: Faults,
    body: RefCell<Body>,
}

struct Body {
    vehicle: RealVehicle,
    instruments: Instruments,
    source: PoseSource,
    /// The poses' stated deviations, m and rad.
    deviations: (f32, f32),
    /// Plant steps in a millisecond.
    steps: u32,
    /// From a motor command to its effect, us.
    delay: u64,
    curves: Vec<ThrustCurve>,
    /// The time up to which all is simulated, us.
    now: u64,
    /// Thrusts on their way, N, with the times at which they act, us.
    waiting: VecDeque<(u64, [f32; MOTOR_COUNT])>,
    /// The rotors' commanded thrusts, N.
    acting: [f32; MOTOR_COUNT],
    sample: ImuSample,
    hands: Hands,
    encoder: Encoder,
    /// The way poses take.
    line: MemoryLine,
    diverged: Option<Diverged>,
}

impl SimulatedHardware {
    /// The scenario's, with the poses of its camera, if it has one, on `line`.
    ///
    /// # Errors
    /// In words, if the scenario's numbers do not fit.
    pub fn new(
        scenario: &Scenario,
        source: PoseSource,
        clock: &SimClock,
        faults: Faults,
        line: MemoryLine,
    ) -> Result<Self, String> {
        let ratio = SAMPLE_PERIOD_US as f64 * 1e-6 / scenario.timing.step();
        let steps = ratio.round();
        if (ratio - steps).abs() > 1e-6 || steps < 1.0 {
            return Err("plant.step: must be 1 ms over a whole number: the IMU samples at 1 kHz".to_owned());
        }
        let configuration = &scenario.configuration;
        let rotors = configuration.rotors().ok_or("rotors: missing")?;
        let curve = |rotor: &Rotor| ThrustCurve::new(rotor.thrust_max, scenario.motor());
        let gravity = configuration.vehicle().gravity;
        let what = scenario.reality.estimator.unwrap_or_default();
        let believed = what.believed(gravity);
        let still = Vector3::zeros();
        let body = Body {
            vehicle: RealVehicle::new(&standing(scenario), configuration).switched_off(),
            instruments: Instruments::new(&what, gravity.into(), still, 0),
            source,
            deviations: (believed.position_noise, believed.attitude_noise),
            steps: steps as u32,
            delay: (scenario.delay() * 1e6).round() as u64,
            curves: rotors.iter().map(curve).collect::<Result<_, _>>().map_err(|error| error.to_string())?,
            now: 0,
            waiting: VecDeque::new(),
            acting: [0.0; MOTOR_COUNT],
            sample: ImuSample { angular_velocity: Vector3::zeros(), specific_force: Vector3::zeros() },
            hands: Hands::OFF,
            encoder: Encoder::default(),
            line,
            diverged: None,
        };
        Ok(Self(Rc::new(Inner { clock: clock.clone(), faults, body: RefCell::new(body) })))
    }

    /// Moves for ever, without readers as well.
    pub async fn run(self) {
        let clock = &self.0.clock;
        loop {
            clock.until(clock.now() + SAMPLE_PERIOD_US).await;
            self.catch_up();
        }
    }

    /// Where the vehicle really is.
    pub fn state(&self) -> BodyState {
        *self.0.body.borrow().vehicle.state()
    }

    /// Lays hands on it.
    pub fn hold(&self, hands: Hands) {
        self.0.body.borrow_mut().hands = hands;
    }

    /// Its rotors' true thrusts, N.
    pub fn thrusts(&self) -> Vec<f64> {
        self.0.body.borrow().vehicle.thrusts()
    }

    /// Whether its motion is still made of numbers.
    pub fn check(&self) -> Result<(), Diverged> {
        self.0.body.borrow().diverged.map_or(Ok(()), Err)
    }

    /// Has the camera sign what it sends.
    pub fn sign(&self, key: Key, stamp: Stamp) {
        self.0.body.borrow().encoder.signing.set(Some(key), stamp, 0);
    }

    /// The camera receives a frame of the vehicle, and signs later frames with later stamps.
    pub fn receive(&self, frame: &Frame<'_>) {
        self.0.body.borrow().encoder.signing.follow(frame, 0);
    }

    /// The camera's answer to a TIMESYNC that the vehicle sent at `sent` of its clock.
    pub fn answer_time_sync(&self, sent: i64) {
        let mut bytes = Vec::new();
        let mut body = self.0.body.borrow_mut();
        if body.source == PoseSource::Link {
            return;
        }
        body.encoder.time_sync(sent, self.0.clock.now() + CAMERA_CLOCK_OFFSET_US, &mut bytes);
        body.line.push(&bytes);
    }

    fn catch_up(&self) {
        let now = self.0.clock.now();
        let mut body = self.0.body.borrow_mut();
        while body.now + SAMPLE_PERIOD_US <= now {
            body.advance(&self.0.faults);
        }
    }

    fn command(&self, command: MotorCommand) {
        self.catch_up();
        let commands = command.levels();
        let mut body = self.0.body.borrow_mut();
        let mut thrusts = [0.0; MOTOR_COUNT];
        for ((thrust, curve), command) in thrusts.iter_mut().zip(&body.curves).zip(commands) {
            *thrust = curve.thrust(command, 1.0);
        }
        let due = self.0.clock.now() + body.delay;
        body.waiting.push_back((due, thrusts));
    }

    fn failed(&self, part: FaultyPart) -> bool {
        self.0.faults.has(part, self.0.clock.now())
    }
}

impl Body {
    /// One millisecond.
    fn advance(&mut self, faults: &Faults) {
        while let Some((_, thrusts)) = self.waiting.pop_front_if(|(due, _)| *due <= self.now) {
            self.acting = thrusts;
        }
        for rotor in 0..MOTOR_COUNT {
            self.vehicle.weaken(rotor, faults.thrust_left(rotor, self.now));
        }
        for _ in 0..self.steps {
            if let Err(diverged) = self.vehicle.drive(&self.acting) {
                self.diverged = Some(diverged);
            }
        }
        self.now += SAMPLE_PERIOD_US;
        self.sample = self.instruments.sample(self.vehicle.state(), self.now);
        self.sample.angular_velocity += self.hands.rate;
        self.sample.specific_force = self.hands.turn.inverse() * self.sample.specific_force;
        while let Some(Stamped { value: pose, time }) = self.instruments.arrived() {
            if self.source == PoseSource::Link || !self.hands.is_seen || faults.has(FaultyPart::Pose, self.now) {
                continue;
            }
            let (position, attitude) = (pose.position() + self.hands.carried, pose.attitude());
            let value = MeasuredPose { position, attitude, motion: None, deviations: Some(self.deviations) };
            let mut bytes = Vec::new();
            let answer = Answer {
                poses: vec![Stamped { value, time: time + CAMERA_CLOCK_OFFSET_US }],
                rotor_speeds: None,
                samples: Vec::new(),
            };
            self.encoder.answer(&answer, &mut bytes);
            self.line.push(&bytes);
        }
    }
}

/// The scenario, begun on the ground below its start, level and at rest.
fn standing(scenario: &Scenario) -> Scenario {
    let mut standing = scenario.clone();
    let ground = scenario.reality.ground.unwrap_or(Ground { height: 0.0 });
    standing.reality.ground = Some(ground);
    let BodyState { position, .. } = scenario.initial;
    standing.initial = BodyState {
        position: Vector3::new(position.x, position.y, ground.height),
        velocity: Vector3::zeros(),
        attitude: attitude_from_euler(0.0, 0.0, scenario.initial.yaw()),
        angular_velocity: Vector3::zeros(),
    };
    standing
}

impl Imu for SimulatedHardware {
    async fn sample(&mut self) -> Result<RawImu, Fault> {
        let clock = &self.0.clock;
        let time = (clock.now() / SAMPLE_PERIOD_US + 1) * SAMPLE_PERIOD_US;
        clock.until(time).await;
        self.catch_up();
        if self.failed(FaultyPart::Gyro) {
            return Err(Fault);
        }
        let ImuSample { angular_velocity, specific_force } = self.0.body.borrow().sample;
        let specific_force = Some(specific_force).filter(|_| !self.failed(FaultyPart::Accelerometer));
        Ok(RawImu { time, angular_velocity, specific_force })
    }

    fn parameters(&self) -> ImuParameters {
        ImuParameters::BMI088
    }

    fn is_polled(&self) -> bool {
        false
    }
}

impl Motors for SimulatedHardware {
    async fn write(&mut self, command: MotorCommand) -> Result<(), Fault> {
        if self.failed(FaultyPart::Motors) {
            return Err(Fault);
        }
        self.command(command);
        Ok(())
    }

    fn answers(&mut self) -> [Option<esc::answer::Answer>; MOTOR_COUNT] {
        self.catch_up();
        let mut speeds = self.0.body.borrow().vehicle.rotor_speeds().into_iter();
        // As over the wire, in 12 bits.
        let answer = |speed| esc::answer::Answer::from_bits(controller_answer(speed).to_bits());
        std::array::from_fn(|_| speeds.next().filter(|_| !self.failed(FaultyPart::Motors)).and_then(answer))
    }
}

/// None: its time stands still while control computes.
impl Watchdog for SimulatedHardware {
    fn feed(&mut self) {}
}

impl Battery for SimulatedHardware {
    async fn voltage(&mut self) -> Option<f32> {
        let battery = self.0.body.borrow().vehicle.surroundings().battery;
        self.0.faults.voltage(self.0.clock.now()).or(battery.map(|(voltage, _)| voltage as f32))
    }
}

/// Invisible.
impl Light for SimulatedHardware {
    fn set(&mut self, _: bool) {}
}
