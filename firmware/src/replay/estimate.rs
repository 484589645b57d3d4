//! The recovery's states once more, as an IMU and a late camera see them: the same samples, hence the same bits, of the
//! estimate.
//!
//! Between two recorded states, a control period apart, lie samples a millisecond apart: the body rate goes straight
//! from one state to the other, the force is what the change of velocity takes. Every `POSES_APART` a state is a
//! pose, handed over `LATE` poses later.

use super::{Hash, STATE_BYTES, state};
use controller_core::state::State;
use estimation::estimator::{EstimatedState, Estimator, EstimatorParameters, PoseMeasurement, Settings};
use estimation::imu::{Calibration, Conditioner, ImuParameters};
use flight::{Pose, Stamped, Velocity};
use heapless::Deque;
use nalgebra::{UnitQuaternion, Vector3};

/// Time between poses, a whole number of ticks.
const POSE_INTERVAL_US: u64 = 10_000;

/// Poses that become true from the moment that one is true to its arrival.
const POSES_LATE: usize = 3;

/// Time between samples of the IMU.
const SAMPLE_PERIOD_US: u64 = 1_000;

/// The estimate, as far as it has been replayed.
pub struct Estimate {
    conditioner: Conditioner,
    estimator: Estimator,
    gravity: f32,
    last: Option<State>,
    period: u64,
    now: u64,
    poses: Deque<Stamped<PoseMeasurement>, { POSES_LATE + 1 }>,
    hash: Hash,
}

impl Estimate {
    /// At the start, in ticks of `period` us. None where the sensors' figures are refused, which no machine that
    /// computes right sees.
    pub fn new(period: u64) -> Option<Self> {
        let parameters = EstimatorParameters::BMI088;
        Some(Self {
            conditioner: Conditioner::new(&ImuParameters::PROMPT, &Calibration::NONE, period).ok()?,
            estimator: Estimator::new(&Settings::new(&parameters).ok()?),
            gravity: parameters.gravity,
            last: None,
            period,
            now: 0,
            poses: Deque::new(),
            hash: Hash::default(),
        })
    }

    /// One tick at a recorded state.
    pub fn tick(&mut self, record: &[u8; STATE_BYTES]) {
        let state = state(record);
        if let Some(last) = self.last.replace(state) {
            self.move_on(&last, &state);
        }
        if self.now.is_multiple_of(POSE_INTERVAL_US) {
            self.look(&state);
        }
        if let Some(estimated) = self.estimated() {
            let State { position, velocity, attitude, angular_velocity } = estimated.state;
            self.hash.add(position.as_slice());
            self.hash.add(velocity.as_slice());
            self.hash.add(attitude.coords.as_slice());
            self.hash.add(angular_velocity.as_slice());
        }
        let (position, velocity, attitude) = self.estimator.health(self.now).deviations;
        self.hash.add(&[position, velocity, attitude]);
    }

    /// A pose becomes true, another arrives.
    fn look(&mut self, state: &State) {
        let still = Velocity::World(Vector3::zeros());
        if let Ok(pose) = Pose::new(state.position, still, state.attitude) {
            // There is room: one leaves for each that comes.
            let _ = self.poses.push_back(Stamped { value: PoseMeasurement::new(&pose), time: self.now });
        }
        if self.poses.is_full()
            && let Some(pose) = self.poses.pop_front()
        {
            let taken = self.estimator.pose(&pose, self.now).is_ok();
            self.hash.add_byte(taken.into());
        }
    }

    fn estimated(&self) -> Option<EstimatedState> {
        let (rate, under_way) = (self.conditioner.newest()?.value.angular_velocity, self.conditioner.under_way());
        self.estimator.state(self.now, &rate, under_way.as_ref())
    }

    /// The samples between two states.
    fn move_on(&mut self, last: &State, state: &State) {
        let (per_period, samples) = (1e6 / self.period as f32, self.period / SAMPLE_PERIOD_US);
        let mut force = (state.velocity - last.velocity) * per_period;
        force.z += self.gravity;
        let force = UnitQuaternion::new_unchecked(last.attitude).inverse_transform_vector(&force);
        let step = (state.angular_velocity - last.angular_velocity) / samples as f32;
        for sample in 1..=samples {
            self.now += SAMPLE_PERIOD_US;
            let rate = last.angular_velocity + step * sample as f32;
            if let Some(increment) = self.conditioner.sample(self.now, &rate, Some(&force)).increment {
                self.estimator.imu(&increment);
            }
        }
    }

    /// The number, as 64 hexadecimal digits; none if there has been no estimate at the end.
    pub fn digest(self) -> Option<heapless::String<64>> {
        self.estimated().map(|_| self.hash.digest())
    }
}
