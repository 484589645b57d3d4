//! What whole control ticks cost: the firmware's own, from what waits in the queues to the motors' commands, and how
//! much of the processor they and the IMU's samples take.
//!
//! The vehicle stands for a while, arms, goes up and flies a circle by setpoints of position and velocity, ten a
//! second. Its IMU samples at 1 kHz, its poses come 20 ms late, a hundred a second, whatever the rate of control.

use crate::body;
use crate::count::{CLOCKS_MHZ, Cost};
use crate::counter::Counter;
use controller_core::certificate::certified::Certified;
use controller_core::governor::{GovernorLimits, HeadingSetpoint, Motion, Setpoint};
use controller_core::math;
use controller_core::reference::Trajectory;
use controller_core::state::{State, Wrench};
use controller_core::vehicle::Vehicle;
use core::hint::black_box;
use cortex_m_semihosting::hprintln;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use estimation::estimator::{Estimator, PoseMeasurement, Settings};
use estimation::imu::{Calibration, ImuParameters};
use firmware::control::Control;
use firmware::hardware::{MotorCommand, RawImu};
use firmware::imu::Flow;
use firmware::outputs::Outputs;
use firmware::replay::embedded_at;
use firmware::shared::{QueuedRequest, Shared};
use flight::{FlightSettings, Memory, Mode, Pilot, Pose, Request, Stamped, Velocity};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use static_cell::{ConstStaticCell, StaticCell};

/// The rates of control that are measured: in the table's words, and a period.
const RATES_AND_PERIODS_US: [(&str, u64); 3] = [("100 Hz", 10_000), ("500 Hz", 2_000), ("1 kHz", 1_000)];

/// How long the vehicle stands, goes up, and flies the circle that is measured.
const STANDING_US: u64 = 2_000_000;
const RISING_US: u64 = 5_000_000;
const CIRCLING_US: u64 = 10_000_000;

/// When setpoints are requested.
const SETPOINTS_FROM_US: u64 = STANDING_US + 200_000;

/// Time between samples of the IMU.
const SAMPLE_PERIOD_US: u64 = 1_000;

/// Time between poses, and between setpoints.
const POSE_INTERVAL_US: u64 = 10_000;
const SETPOINT_INTERVAL_US: u64 = 100_000;

/// How many poses have become true since the one that comes.
const POSES_LATE: usize = 2;

type Tick<'a> = fn(&mut Control<'a, NoopRawMutex>, u64) -> MotorCommand;

/// Flies at each rate, and prints what the ticks of the circle cost; whether it flew.
pub fn measure(counter: &Counter, circle: &impl Trajectory) -> bool {
    static ESTIMATORS: [StaticCell<Estimator>; RATES_AND_PERIODS_US.len()] = [const { StaticCell::new() }; _];
    static MEMORIES: [ConstStaticCell<Memory>; RATES_AND_PERIODS_US.len()] =
        [const { ConstStaticCell::new(Memory::EMPTY) }; _];
    RATES_AND_PERIODS_US.iter().zip(&ESTIMATORS).zip(&MEMORIES).all(|((&(rate, period), estimator), memory)| {
        let Some(certified) = embedded_at(period).and_then(|embedded| Certified::new(embedded).ok()) else {
            return false;
        };
        let settings = Settings::bmi088(certified.configuration().vehicle());
        let estimator = estimator.init_with(|| Estimator::new(&settings));
        let Some(flown) = fly(counter, &certified, circle, period, estimator, memory.take()) else { return false };
        flown.print(rate, period);
        true
    })
}

/// What was measured on a circle.
#[derive(Default)]
struct Flown {
    ticks: Cost,
    samples: Cost,
}

impl Flown {
    fn print(&self, rate: &str, period: u64) {
        let label = |what: &str| {
            let mut label = heapless::String::<42>::new();
            // What does not fit is cut.
            let _ = [what, ", ", rate].iter().try_for_each(|part| label.push_str(part));
            label
        };
        self.ticks.print(&label("whole control tick"));
        // Instructions a microsecond, over those that the clock has: percent, at each clock.
        let percent = |each: f64| CLOCKS_MHZ.map(|clock| 100.0 * each / clock);
        let (period, between) = (period as f64, SAMPLE_PERIOD_US as f64);
        for (what, [bolt, h743]) in [
            ("worst tick of its period, %", percent(self.ticks.worst() / period)),
            ("share of the processor, %", percent(self.ticks.mean() / period + self.samples.mean() / between)),
        ] {
            hprintln!("{:<42} {:>31.2} {:>9.2}", label(what), bolt, h743);
        }
    }
}

/// A flight with control every `period` us; none if it did not fly.
fn fly(
    counter: &Counter,
    certified: &Certified,
    circle: &impl Trajectory,
    period: u64,
    estimator: &'static mut Estimator,
    memory: &'static mut Memory,
) -> Option<Flown> {
    let configuration = certified.configuration();
    let shared: Shared<NoopRawMutex> = Shared::new();
    let outputs = Outputs::new(configuration.rotors()?, firmware::configuration::MOTOR).ok()?;
    let limits = GovernorLimits::default();
    let mut pilot = Pilot::carrying(
        Ok(certified),
        &limits,
        &FlightSettings::DEFAULT,
        period,
        estimator,
        memory,
        firmware::configuration::policy(),
    );
    let mut control = Control::new(shared.for_control(), &mut pilot, outputs);
    let tick: Tick<'_> = black_box(Control::tick);
    let link = shared.for_receive();
    let mut flow = Flow::new(shared.for_samples(), &ImuParameters::PROMPT, &Calibration::NONE, period).ok()?;
    let mut body = Body::standing(*configuration.vehicle());
    let mut flown = Flown::default();
    for now in (SAMPLE_PERIOD_US..=STANDING_US + RISING_US + CIRCLING_US).step_by(SAMPLE_PERIOD_US as usize) {
        let wrench = link.report().get().and_then(|report| report.value.wrench);
        let sample = body.advance(wrench.as_ref(), now);
        let (instructions, ()) = counter.short(|| flow.take(&sample));
        let circling = now.checked_sub(STANDING_US + RISING_US);
        if circling.is_some() {
            flown.samples.add(instructions);
        }
        if let Some(pose) = body.late_pose(now) {
            let _ = link.poses().put(pose);
        }
        if !now.is_multiple_of(period) {
            continue;
        }
        link.ground_station().put((), now);
        let asked = match now {
            STANDING_US => Some(Request::Arm),
            SETPOINTS_FROM_US => Some(Request::FlySetpoints),
            _ => None,
        };
        if let Some(request) = asked {
            link.request(QueuedRequest { request, order: None, setpoints: None });
        }
        if now > STANDING_US && now.is_multiple_of(SETPOINT_INTERVAL_US) {
            link.setpoint().put(setpoint(circle, circling), now);
        }
        let (instructions, _) = counter.short(|| tick(&mut control, now));
        if circling.is_some() {
            flown.ticks.add(instructions);
        }
    }
    link.report().get().filter(|report| report.value.mode == Mode::Flying).map(|_| flown)
}

/// Where the circle begins, or is.
fn setpoint(circle: &impl Trajectory, circling: Option<u64>) -> Setpoint {
    let reference = circle.at(circling.unwrap_or(0));
    let position = reference.position;
    let motion = match circling {
        None => Motion::Position(position),
        Some(_) => Motion::PositionVelocityAcceleration {
            position,
            velocity: reference.velocity,
            acceleration: reference.acceleration,
        },
    };
    Setpoint { motion, turn: HeadingSetpoint::Keep }
}

/// The vehicle, and where it was lately.
struct Body {
    vehicle: Vehicle,
    state: State,
    /// At the last times of poses, the newest last.
    past: [State; POSES_LATE + 1],
}

impl Body {
    fn standing(vehicle: Vehicle) -> Self {
        let zero = Vector3::zeros();
        let state = State { position: zero, velocity: zero, attitude: Quaternion::identity(), angular_velocity: zero };
        Self { vehicle, state, past: [state; POSES_LATE + 1] }
    }

    /// Moves on to `now`, us, under the commanded wrench; returns the IMU's sample. Without thrust it stands.
    fn advance(&mut self, wrench: Option<&Wrench>, now: u64) -> RawImu {
        let seconds = SAMPLE_PERIOD_US as f32 * 1e-6;
        let before = self.state;
        if let Some(wrench) = wrench {
            body::advance(&mut self.state, &self.vehicle, wrench, seconds);
        }
        if now.is_multiple_of(POSE_INTERVAL_US) {
            self.past.rotate_left(1);
            if let Some(last) = self.past.last_mut() {
                *last = self.state;
            }
        }
        let gained = (self.state.velocity - before.velocity) / seconds + Vector3::z() * self.vehicle.gravity;
        // A stream of exactly the same numbers would be a sensor that is stuck.
        let jitter = Vector3::new((now % 7_000) as f32 * 1e-7, 0.0, 0.0);
        RawImu {
            time: now,
            angular_velocity: self.state.angular_velocity + jitter,
            specific_force: Some(UnitQuaternion::new_unchecked(before.attitude).inverse() * gained + jitter),
        }
    }

    /// Where it was [`POSES_LATE`] poses ago, by a camera that is never still, if one comes now.
    fn late_pose(&self, now: u64) -> Option<Stamped<PoseMeasurement>> {
        let time =
            now.is_multiple_of(POSE_INTERVAL_US).then_some(now)?.checked_sub(POSES_LATE as u64 * POSE_INTERVAL_US)?;
        let was = self.past.first()?;
        let trembling = Vector3::repeat(math::sin_cos_turns(time << 50).0 * 1e-4);
        let pose = Pose::new(was.position + trembling, Velocity::World(Vector3::zeros()), was.attitude).ok()?;
        Some(Stamped { value: PoseMeasurement::new(&pose), time })
    }
}
