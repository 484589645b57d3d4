//! What a whole control tick costs: the firmware's own, from what waits in the queues to the motors' commands.
//!
//! The vehicle stands for a while, arms, goes up and flies a circle by setpoints of position and velocity, ten a
//! second. Its poses come 20 ms late, a hundred a second.

use crate::body;
use crate::count::Cost;
use crate::counter::Counter;
use controller_core::certificate::certified::Certified;
use controller_core::governor::{GovernorLimits, Motion, Setpoint, Turn};
use controller_core::math;
use controller_core::reference::Trajectory;
use controller_core::state::{State, Wrench};
use controller_core::vehicle::Vehicle;
use core::hint::black_box;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use estimation::estimator::{Clipped, Estimator, Increment, PoseMeasurement, Settings};
use firmware::control::Control;
use firmware::hardware::MotorCommand;
use firmware::outputs::Outputs;
use firmware::shared::{QueuedRequest, SamplesView, Shared};
use flight::{FlightSettings, ImuSample, Memory, Mode, PERIOD, Pilot, Pose, Request, Stamped, Velocity};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use static_cell::{ConstStaticCell, StaticCell};

/// Ticks of standing, of going up, and of the circle that is measured.
const STANDING: u64 = 200;
const RISING: u64 = 500;
const FLYING: u64 = STANDING + 20;
const CIRCLING: u64 = 1_000;

/// Ticks that a pose is late.
const LATE: usize = 2;

/// Increments in a tick, and how long each is, us.
const INCREMENTS: u64 = 2;
const INCREMENT: u64 = PERIOD / INCREMENTS;

type Tick<'a> = fn(&mut Control<'a, NoopRawMutex>, u64) -> MotorCommand;

/// Flies, and prints what the ticks of the circle cost; whether it flew.
pub fn measure(counter: &Counter, certified: &Certified, circle: &impl Trajectory) -> bool {
    static ESTIMATOR: StaticCell<Estimator> = StaticCell::new();
    static MEMORY: ConstStaticCell<Memory> = ConstStaticCell::new(Memory::EMPTY);
    let configuration = certified.configuration();
    let shared: Shared<NoopRawMutex> = Shared::new();
    let Some(Ok(outputs)) = configuration.rotors().map(|rotors| Outputs::new(rotors, 0.0)) else { return false };
    let estimator = ESTIMATOR.init_with(|| Estimator::new(&Settings::bmi088(configuration.vehicle())));
    let mut pilot =
        Pilot::new(Ok(certified), &GovernorLimits::default(), &FlightSettings::DEFAULT, estimator, MEMORY.take());
    let mut control = Control::new(shared.for_control(), &mut pilot, outputs);
    let tick: Tick<'_> = black_box(Control::tick);
    let link = shared.for_receive();
    let mut body = Body::standing(*configuration.vehicle());
    let mut cost = Cost::default();
    for number in 1..=STANDING + RISING + CIRCLING {
        let now = number * PERIOD;
        let wrench = link.report().get().and_then(|report| report.value.wrench);
        body.advance(wrench.as_ref(), now, shared.for_samples());
        if let Some(pose) = body.late_pose(now) {
            let _ = link.poses().put(pose);
        }
        link.ground_station().put((), now);
        let asked = match number {
            STANDING => Some(Request::Arm),
            FLYING => Some(Request::FlySetpoints),
            _ => None,
        };
        if let Some(request) = asked {
            link.request(QueuedRequest { request, order: None, setpoints: None });
        }
        let circling = number.checked_sub(STANDING + RISING);
        if number > STANDING && number % 10 == 0 {
            link.setpoint().put(setpoint(circle, circling), now);
        }
        let (instructions, _) = counter.short(|| tick(&mut control, now));
        if circling.is_some() {
            cost.add(instructions);
        }
    }
    cost.print("whole control tick, circle");
    link.report().get().is_some_and(|report| report.value.mode == Mode::Flying)
}

/// Where the circle begins, or is.
fn setpoint(circle: &impl Trajectory, circling: Option<u64>) -> Setpoint {
    let reference = circle.at(circling.unwrap_or(0) * PERIOD);
    let position = reference.position;
    let motion = match circling {
        None => Motion::Position(position),
        Some(_) => Motion::PositionVelocityAcceleration {
            position,
            velocity: reference.velocity,
            acceleration: reference.acceleration,
        },
    };
    Setpoint { motion, turn: Turn::Keep }
}

/// The vehicle, and where it was lately.
struct Body {
    vehicle: Vehicle,
    state: State,
    /// The newest last.
    past: [State; LATE + 1],
}

impl Body {
    fn standing(vehicle: Vehicle) -> Self {
        let zero = Vector3::zeros();
        let state = State { position: zero, velocity: zero, attitude: Quaternion::identity(), angular_velocity: zero };
        Self { vehicle, state, past: [state; LATE + 1] }
    }

    /// Moves on to `now`, us, under the commanded wrench; returns the IMU's sample. Without thrust it stands.
    fn advance(&mut self, wrench: Option<&Wrench>, now: u64, shared: SamplesView<'_, NoopRawMutex>) {
        let seconds = INCREMENT as f32 * 1e-6;
        for part in (0..INCREMENTS).rev() {
            let end = now - part * INCREMENT;
            let before = self.state;
            if let Some(wrench) = wrench {
                body::advance(&mut self.state, &self.vehicle, wrench, seconds);
            }
            let gained = self.state.velocity - before.velocity + Vector3::z() * (self.vehicle.gravity * seconds);
            // A stream of exactly the same numbers would be a sensor that is stuck.
            let jitter = Vector3::new((end % 7_000) as f32 * 1e-9, 0.0, 0.0);
            shared.increment(Increment {
                start: end - INCREMENT,
                end,
                delta_angle: (before.angular_velocity + self.state.angular_velocity) * (0.5 * seconds) + jitter,
                delta_velocity: UnitQuaternion::new_unchecked(before.attitude).inverse() * gained,
                clipped: Clipped::NEITHER,
            });
        }
        let sample = ImuSample { angular_velocity: self.state.angular_velocity, specific_force: Vector3::zeros() };
        shared.imu().put(sample, now);
        self.past.rotate_left(1);
        if let Some(last) = self.past.last_mut() {
            *last = self.state;
        }
    }

    /// Where it was [`LATE`] ticks ago, by a camera that is never still.
    fn late_pose(&self, now: u64) -> Option<Stamped<PoseMeasurement>> {
        let time = now.checked_sub(LATE as u64 * PERIOD)?;
        let was = self.past.first()?;
        let trembling = Vector3::repeat(math::sin_cos_turns(time << 50).0 * 1e-4);
        let pose = Pose::new(was.position + trembling, Velocity::World(Vector3::zeros()), was.attitude).ok()?;
        Some(Stamped { value: PoseMeasurement::new(&pose), time })
    }
}
