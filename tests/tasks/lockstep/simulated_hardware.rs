//! The vehicle as the firmware's peripherals meet it: rotors that lag, a body that falls, sensors and motors.

use controller_core::allocation::Rotors;
use controller_core::configuration::Configuration;
use controller_core::state::State;
use estimation::imu::ImuParameters;
use firmware::hardware::{Battery, Clock, Fault, Imu, Light, MOTOR_COUNT, MotorCommand, Motors, RawImu, Watchdog};
use host_sim::sessions::sitl::clock::SimClock;
use host_sim::vehicle::plant::Plant;
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::body::{BodyState, attitude_from_euler};
use std::cell::{Cell, RefCell};
use std::rc::Rc;

/// Of the integration; also the IMU's period.
pub const STEP_US: u64 = 1_000;

/// The file that the firmware embeds; what the firmware does not know of it is the rotors' lag.
const EMBEDDED: &str = include_str!("../../../vehicles/study.toml");

/// Everything outside the processor; clones are the same.
#[derive(Clone)]
pub struct SimulatedHardware(Rc<Inner>);

struct Inner {
    clock: SimClock,
    body: RefCell<Body>,
    /// The last command, and when it was written.
    command: Cell<(MotorCommand, u64)>,
    /// When the watchdog was last fed.
    fed: Cell<u64>,
    outputs: Cell<Health>,
    sensor: Cell<Health>,
    voltage: Cell<Option<f32>>,
}

/// How a peripheral does.
#[derive(Clone, Copy, PartialEq)]
pub enum Health {
    Works,
    Faults,
    Hangs,
}

struct Body {
    configuration: Configuration,
    plant: Plant,
    rotors: Rotors,
    /// Speed of a full command, rad/s.
    greatest: f64,
    speeds: [f64; MOTOR_COUNT],
    /// What a step leaves of a speed's error.
    left: f64,
    /// What the accelerometer says, m/s^2, body.
    force: Vector3<f64>,
    /// How fast it came down on the ground, m/s, when it was fastest.
    touchdown: Option<f64>,
}

/// The rigid body at `state`.
fn body(configuration: &Configuration, state: BodyState) -> Plant {
    Plant::new(configuration.vehicle(), configuration.limits(), STEP_US as f64 * 1e-6, state)
}

impl Health {
    async fn answer(self) -> Result<(), Fault> {
        match self {
            Self::Works => Ok(()),
            Self::Faults => Err(Fault),
            Self::Hangs => std::future::pending().await,
        }
    }
}

impl SimulatedHardware {
    /// A vehicle standing on level ground at the origin, heading along world x.
    pub fn new(clock: &SimClock, configuration: &Configuration) -> Self {
        let rotors = configuration.rotors().unwrap().clone();
        let still = Vector3::zeros();
        let attitude = attitude_from_euler(0.0, 0.0, 0.0);
        let state = BodyState { position: still, velocity: still, attitude, angular_velocity: still };
        let plant = body(configuration, state);
        let greatest = f64::from(rotors[0].speed_at(rotors[0].thrust_max));
        let lag = Scenario::parse(EMBEDDED, "vehicles/study.toml").unwrap().rotor_lag;
        let left = (-1e-6 * STEP_US as f64 / lag).exp();
        let force = Vector3::new(0.0, 0.0, f64::from(configuration.vehicle().gravity));
        let speeds = [0.0; MOTOR_COUNT];
        let configuration = configuration.clone();
        let body = Body { configuration, plant, rotors, greatest, speeds, left, force, touchdown: None };
        let command = Cell::new((MotorCommand::Stop, 0));
        Self(Rc::new(Inner {
            clock: clock.clone(),
            body: RefCell::new(body),
            command,
            fed: Cell::new(0),
            outputs: Cell::new(Health::Works),
            sensor: Cell::new(Health::Works),
            voltage: Cell::new(None),
        }))
    }

    /// Moves for ever, a step at a time.
    pub async fn run(self) {
        loop {
            let clock = &self.0.clock;
            clock.until(clock.now() + STEP_US).await;
            let command = self.command();
            self.0.body.borrow_mut().step(command);
        }
    }

    /// The state, of which a motion capture system would give position, velocity and attitude.
    pub fn pose(&self) -> State {
        self.0.body.borrow().plant.state().measured()
    }

    /// The motors' last command.
    pub fn command(&self) -> MotorCommand {
        self.0.command.get().0
    }

    /// When the watchdog was last fed, us.
    pub fn fed(&self) -> u64 {
        self.0.fed.get()
    }

    /// How the motor outputs do from now on.
    pub fn outputs(&self, health: Health) {
        self.0.outputs.set(health);
    }

    /// How the IMU does from now on.
    pub fn sensor(&self, health: Health) {
        self.0.sensor.set(health);
    }

    /// What there is to measure at the battery from now on, V.
    pub fn voltage(&self, voltage: f32) {
        self.0.voltage.set(Some(voltage));
    }

    /// How fast it came down on the ground, m/s, when it was fastest: what lifts its weight nearly all hops.
    pub fn touchdown(&self) -> Option<f64> {
        self.0.body.borrow().touchdown
    }

    /// Puts the vehicle down where it is, turned as the angles say, rad.
    pub fn set_down(&self, roll: f64, pitch: f64, yaw: f64) {
        let mut body = self.0.body.borrow_mut();
        let Body { configuration, plant, .. } = &mut *body;
        let still = Vector3::zeros();
        let attitude = attitude_from_euler(roll, pitch, yaw);
        let position = plant.state().position;
        *plant = self::body(configuration, BodyState { position, velocity: still, attitude, angular_velocity: still });
    }

    /// The angle between body z and up, rad.
    pub fn tilt(&self) -> f32 {
        let up = nalgebra::UnitQuaternion::new_unchecked(self.pose().attitude) * Vector3::z();
        up.z.clamp(-1.0, 1.0).acos()
    }
}

impl Body {
    fn step(&mut self, command: MotorCommand) {
        let wanted = command.levels().map(|command| f64::from(command) * self.greatest);
        let (mut thrust, mut torque) = (0.0, Vector3::zeros());
        for (((speed, wanted), rotor), column) in
            self.speeds.iter_mut().zip(wanted).zip(self.rotors.iter()).zip(self.rotors.effectiveness())
        {
            *speed += (wanted - *speed) * (1.0 - self.left);
            let force = f64::from(rotor.thrust_coefficient) * *speed * *speed;
            thrust += force;
            torque += Vector3::new(column.y, column.z, column.w) * force;
        }
        // The ground holds what does not pull upwards, and stops what comes down: enough for a take-off and a fall.
        let before = *self.plant.state();
        self.plant.act(thrust, &torque);
        let after = self.plant.state();
        if after.position.z <= 0.0 && after.velocity.z <= 0.0 {
            if before.position.z > 0.0 {
                self.touchdown = Some(self.touchdown.unwrap_or(0.0).max(-after.velocity.z));
            }
            let position = Vector3::new(before.position.x, before.position.y, 0.0);
            let still = Vector3::zeros();
            let state = BodyState { position, velocity: still, attitude: before.attitude, angular_velocity: still };
            self.plant = body(&self.configuration, state);
        }
        let after = self.plant.state();
        let gravity = Vector3::new(0.0, 0.0, f64::from(self.configuration.vehicle().gravity));
        let gained = (after.velocity - before.velocity) / (STEP_US as f64 * 1e-6) + gravity;
        self.force = nalgebra::UnitQuaternion::new_normalize(after.attitude).inverse_transform_vector(&gained);
    }
}

/// The board's IMU: a sample at each step, with enough noise that it does not count as stuck.
pub struct SimImu(pub SimulatedHardware);

impl Imu for SimImu {
    async fn sample(&mut self) -> Result<RawImu, Fault> {
        let clock = &self.0.0.clock;
        let time = (clock.now() / STEP_US + 1) * STEP_US;
        clock.until(time).await;
        self.0.0.sensor.get().answer().await?;
        let jitter = (time / STEP_US % 7) as f32 * 1e-5 - 3e-5;
        let body = self.0.0.body.borrow();
        let angular_velocity = body.plant.state().measured().angular_velocity.add_scalar(jitter);
        Ok(RawImu { time, angular_velocity, specific_force: Some(body.force.cast().add_scalar(jitter)) })
    }

    fn parameters(&self) -> ImuParameters {
        ImuParameters::PROMPT
    }

    fn is_polled(&self) -> bool {
        false
    }
}

/// The board's motor outputs.
pub struct SimMotors(pub SimulatedHardware);

impl Motors for SimMotors {
    async fn write(&mut self, command: MotorCommand) -> Result<(), Fault> {
        self.0.0.outputs.get().answer().await?;
        self.0.0.command.set((command, self.0.0.clock.now()));
        Ok(())
    }
}

/// The board's watchdog.
pub struct SimWatchdog(pub SimulatedHardware);

impl Watchdog for SimWatchdog {
    fn feed(&mut self) {
        self.0.0.fed.set(self.0.0.clock.now());
    }
}

/// The board's battery.
pub struct SimBattery(pub SimulatedHardware);

impl Battery for SimBattery {
    async fn voltage(&mut self) -> Option<f32> {
        self.0.0.voltage.get()
    }
}

/// The board's light.
pub struct Dark;

impl Light for Dark {
    fn set(&mut self, _on: bool) {}
}
