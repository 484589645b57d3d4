//! A vehicle under the core's whole pilot: supervisor, estimator, conditioner, governor, law and allocation, in closed
//! loop.
//!
//! ```text
//! Pilot::tick -> motor command -> (delay) -> rotors, air, ground -> IMU, each millisecond -> Meddler -> conditioner
//!      ^                                                        '-> poses, late ----------> Meddler
//!      '------------------------------- increments, poses <-------------------------------------'
//! ```
//!
//! It does in one call a tick what the firmware's tasks do, without their link and their clock: so hours pass in
//! seconds. An operator's requests go in with each tick; a [`Meddler`] removes or changes measurements that are to
//! fail. SI units, world z up, times in us of the vehicle's clock, which may start anywhere.

use controller_core::allocation::{Rotor, ThrustCurve};
use controller_core::certificate::certified::{Certified, Refused};
use controller_core::configuration::Configuration;
use controller_core::error::ParameterError;
use controller_core::governor::GovernorLimits;
pub use estimation::estimator::PoseMeasurement;
use estimation::estimator::{Estimator, Increment, Settings};
use estimation::imu::{Calibration, Conditioner, ImuFault, ImuParameters};
use firmware::hardware::{MOTOR_COUNT, MotorCommand};
use firmware::outputs::Outputs;
use flight::{FlightSettings, ImuSample, Inputs, Memory, Outcome, Pilot, Pose, Stamped};
use host_sim::vehicle::instruments::{Instruments, SAMPLE_PERIOD_US, TrueMotion};
use host_sim::vehicle::reality::RealVehicle;
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::body::{BodyState, attitude_from_euler};
use scenario::reality::ground::Ground;
use std::collections::VecDeque;
use std::fmt;

/// Where a pilot's estimator, governor and mixer lie.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    estimator: Estimator,
    memory: Memory,
}

impl Place {
    /// For a pilot of `configuration`, whose sensors are a BMI088 and a camera system.
    #[must_use]
    pub fn new(configuration: &Configuration) -> Box<Self> {
        let settings = Settings::bmi088(configuration.vehicle());
        Box::new(Self { estimator: Estimator::new(&settings), memory: Memory::EMPTY })
    }
}

/// Faults between the sensors and the pilot, and forces on the vehicle.
pub trait Meddler {
    /// Acts on the vehicle each millisecond, at `time`, us, before its sensors measure.
    fn act(&mut self, _vehicle: &mut RealVehicle, _time: u64) {}

    /// The IMU's input at `time`, us, from the body's motion.
    fn feel(&mut self, felt: TrueMotion, _time: u64) -> TrueMotion {
        felt
    }

    /// An IMU's sample of `time`, us, as it arrives; none: it is lost.
    fn sample(&mut self, sample: ImuSample, _time: u64) -> Option<ImuSample> {
        Some(sample)
    }

    /// The rotors' speeds as they are known at `time`, us, rad/s; none: nobody knows.
    fn rotor_speeds(&mut self, _time: u64) -> [Option<f32>; MOTOR_COUNT] {
        [None; MOTOR_COUNT]
    }

    /// A pose that arrives at `now`, us, as it is delivered; none: it is lost.
    fn pose(&mut self, pose: Stamped<Pose>, _now: u64) -> Option<Stamped<PoseMeasurement>> {
        Some(Stamped { value: PoseMeasurement::new(&pose.value), time: pose.time })
    }
}

/// No interference: sensors and vehicle as they are.
#[derive(Debug, Clone, Copy, Default)]
pub struct Undisturbed;

impl Meddler for Undisturbed {}

/// Why a vehicle cannot be flown like this, or no further.
#[derive(Debug, Clone, PartialEq)]
pub enum PilotedError {
    /// A parameter is refused.
    Parameter(ParameterError),
    /// The motion is not finite any more.
    Diverged,
}

impl fmt::Display for PilotedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameter(error) => write!(f, "{error}"),
            Self::Diverged => f.write_str("the motion is not finite"),
        }
    }
}

impl std::error::Error for PilotedError {}

impl From<ParameterError> for PilotedError {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}

/// The vehicle, its sensors and its pilot.
#[derive(Debug)]
pub struct PilotedVehicle<'m> {
    pilot: Pilot<'m>,
    vehicle: RealVehicle,
    instruments: Instruments,
    conditioner: Conditioner,
    outputs: Outputs,
    curves: [ThrustCurve; MOTOR_COUNT],
    /// Plant steps in a millisecond.
    steps: u32,
    /// From a motor command to its effect, us.
    delay: u64,
    /// us.
    now: u64,
    /// Commands on their way, with the times at which they act, us.
    waiting: VecDeque<(u64, MotorCommand)>,
    acting: MotorCommand,
    increments: Vec<Increment>,
    body_rate: Option<Stamped<Vector3<f32>>>,
    poses: Vec<Stamped<PoseMeasurement>>,
}

impl<'m> PilotedVehicle<'m> {
    /// The scenario's vehicle, standing on level ground at the origin with its rotors still, at `now`, us, of its
    /// clock. The pilot has just booted, with what the certificate said about the scenario's configuration.
    ///
    /// # Errors
    /// [`PilotedError::Parameter`]: without four rotors there is nothing to command.
    pub fn new(
        scenario: &Scenario,
        certification: Result<&Certified, &Refused>,
        settings: &FlightSettings,
        place: &'m mut Place,
        now: u64,
    ) -> Result<Self, PilotedError> {
        let configuration = &scenario.configuration;
        let rotors = configuration.rotors().ok_or(firmware::configuration::NO_ROTORS)?;
        let motor = scenario.motor();
        let outputs = Outputs::new(rotors, motor)?;
        let curve = |rotor: &Rotor| ThrustCurve::new(rotor.thrust_max, motor);
        let [a, b, c, d] = &rotors[..] else { return Err(firmware::configuration::NO_ROTORS.into()) };
        let standing = standing(scenario);
        let what = standing.reality.estimator.unwrap_or_default();
        let gravity = f64::from(configuration.vehicle().gravity);
        let Place { estimator, memory } = place;
        Ok(Self {
            pilot: Pilot::new(
                certification,
                &GovernorLimits::default(),
                settings,
                scenario.timing.period_us,
                estimator,
                memory,
            ),
            vehicle: RealVehicle::new(&standing, configuration).switched_off(),
            instruments: Instruments::new(&what, gravity, Vector3::zeros(), 0),
            conditioner: Conditioner::new(&ImuParameters::BMI088, &Calibration::NONE, scenario.timing.period_us)?,
            outputs,
            curves: [curve(a)?, curve(b)?, curve(c)?, curve(d)?],
            steps: (SAMPLE_PERIOD_US as f64 * 1e-6 / scenario.timing.step()).round() as u32,
            delay: (scenario.delay() * 1e6).round() as u64,
            now,
            waiting: VecDeque::new(),
            acting: MotorCommand::Stop,
            increments: Vec::new(),
            body_rate: None,
            poses: Vec::new(),
        })
    }

    /// The same with the gyro of another sensor than a BMI088, read each millisecond.
    ///
    /// # Errors
    /// [`PilotedError::Parameter`], as [`Self::new`].
    pub fn with_gyro_of(mut self, sensor: &ImuParameters) -> Result<Self, PilotedError> {
        let ImuParameters { gyro_bandwidth, late, .. } = *sensor;
        let read = ImuParameters { gyro_bandwidth, late, ..ImuParameters::BMI088 };
        self.conditioner = Conditioner::new(&read, &Calibration::NONE, self.pilot.period())?;
        self.instruments = self.instruments.with_gyro_of(&read);
        Ok(self)
    }

    /// A period passes; then the pilot decides, on the vehicle's measurements and on what is `given` besides: `now`,
    /// increments, body rate and poses of that are replaced by the vehicle's own. Returns its outcome and the motors'
    /// command from now on.
    ///
    /// # Errors
    /// [`PilotedError::Diverged`].
    pub fn tick(
        &mut self,
        given: &Inputs,
        meddler: &mut impl Meddler,
    ) -> Result<(Outcome, MotorCommand), PilotedError> {
        self.increments.clear();
        self.poses.clear();
        for _ in 0..self.pilot.period() / SAMPLE_PERIOD_US {
            self.pass(meddler)?;
        }
        let inputs = Inputs {
            now: self.now,
            increments: &self.increments,
            under_way: self.conditioner.under_way(),
            body_rate: self.body_rate,
            poses: &self.poses,
            ..*given
        };
        let outcome = self.pilot.tick(&inputs);
        let command = self.outputs.command(&outcome.output, 1.0);
        self.waiting.push_back((self.now + self.delay, command));
        Ok((outcome, command))
    }

    /// A millisecond.
    fn pass(&mut self, meddler: &mut impl Meddler) -> Result<(), PilotedError> {
        while let Some((_, command)) = self.waiting.pop_front_if(|(due, _)| *due <= self.now) {
            self.acting = command;
        }
        let thrusts = self.thrusts();
        for _ in 0..self.steps {
            self.vehicle.drive(&thrusts).map_err(|_| PilotedError::Diverged)?;
        }
        self.now += SAMPLE_PERIOD_US;
        meddler.act(&mut self.vehicle, self.now);
        let sample = self.instruments.sample_of(self.vehicle.state(), self.now, |felt| meddler.feel(felt, self.now));
        if let Some(sample) = meddler.sample(sample, self.now) {
            let force = Some(&sample.specific_force);
            self.conditioner.follow_rotors(&meddler.rotor_speeds(self.now));
            let taken = self.conditioner.sample(self.now, &sample.angular_velocity, force);
            // As in the firmware's IMU task, a stuck gyro counts as missing.
            let is_stuck = taken.fault == Some(ImuFault::GyroStuck);
            if !is_stuck {
                self.increments.extend(taken.increment);
                self.body_rate = self.conditioner.newest().map(|newest| newest.map(|sample| sample.angular_velocity));
            }
        }
        while let Some(pose) = self.instruments.arrived() {
            self.poses.extend(meddler.pose(pose, self.now));
        }
        Ok(())
    }

    /// The commanded thrusts, N.
    fn thrusts(&self) -> [f32; MOTOR_COUNT] {
        let commands = self.acting.levels();
        std::array::from_fn(|rotor| self.curves[rotor].thrust(commands[rotor], 1.0))
    }

    /// The vehicle's clock, us.
    #[must_use]
    pub fn now(&self) -> u64 {
        self.now
    }

    /// The body rate that the law had last, rad/s.
    #[must_use]
    pub fn body_rate(&self) -> Option<Vector3<f32>> {
        self.body_rate.map(|newest| newest.value)
    }

    /// Other flight settings, as the firmware's control task hands them on: taken while nothing is armed.
    pub fn choose(&mut self, settings: &FlightSettings) {
        self.pilot.use_settings(settings);
    }

    /// The pilot.
    #[must_use]
    pub fn pilot(&self) -> &Pilot<'m> {
        &self.pilot
    }

    /// The vehicle as it really is.
    #[must_use]
    pub fn vehicle(&self) -> &RealVehicle {
        &self.vehicle
    }

    /// The same, to push it, pick it up or read its touchdowns.
    pub fn vehicle_mut(&mut self) -> &mut RealVehicle {
        &mut self.vehicle
    }

    /// Leaves a rotor with a part of its commanded thrust, from now on.
    pub fn weaken(&mut self, rotor: usize, left: f32) {
        self.vehicle.weaken(rotor, left.into());
    }
}

/// The scenario, begun on the ground at the origin, level and at rest.
fn standing(scenario: &Scenario) -> Scenario {
    let mut standing = scenario.clone();
    standing.reality.ground = Some(Ground { height: 0.0 });
    let still = Vector3::zeros();
    let attitude = attitude_from_euler(0.0, 0.0, 0.0);
    standing.initial = BodyState { position: still, velocity: still, attitude, angular_velocity: still };
    standing
}
