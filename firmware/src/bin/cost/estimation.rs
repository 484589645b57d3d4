//! What the estimator costs: each sample of the IMU, each increment, and poses that come soon, late and seldom.

use crate::count::Cost;
use crate::counter::Counter;
use controller_core::math;
use core::hint::black_box;
use estimation::estimator::{
    Accepted, EstimatedState, Estimator, EstimatorParameters, Increment, PoseMeasurement, Rejected, Settings,
};
use estimation::imu::{Calibration, Conditioned, Conditioner, ImuParameters};
use flight::{Pose, Stamped, Velocity};
use nalgebra::{Quaternion, Vector3};
use static_cell::StaticCell;

/// Samples of a measured flight, one a millisecond.
const SAMPLE_COUNT: u64 = 10_000;

/// Time between control ticks: what the samples' low-pass is made for.
const PERIOD_US: u64 = 10_000;

/// The vehicle turns in place at this rate, in 2^-64 turns a microsecond: 0.5 rad/s.
const TURNS_PER_US: u64 = 1_467_934_022_605;
const RATE_RAD_PER_S: f32 = 0.5;

type Sample = fn(&mut Conditioner, u64, &Vector3<f32>, Option<&Vector3<f32>>) -> Conditioned;
type Take = fn(&mut Estimator, &Increment);
type Fuse = fn(&mut Estimator, &Stamped<PoseMeasurement>, u64) -> Result<Accepted, Rejected>;
type StateOf = fn(&Estimator, u64, &Vector3<f32>, Option<&Increment>) -> Option<EstimatedState>;

/// Every figure, as lines of the table; whether all could be measured.
pub fn measure(counter: &Counter) -> bool {
    static ESTIMATOR: StaticCell<Estimator> = StaticCell::new();
    let Ok(settings) = Settings::new(&EstimatorParameters::BMI088) else { return false };
    let estimator = ESTIMATOR.init_with(|| Estimator::new(&settings));
    let mut flight = Flight { counter, estimator, settings };
    let streams = [
        Stream { what: "pose, 100 Hz, 20 ms late", every: 10, late: 20 },
        Stream { what: "pose, 100 Hz, 150 ms late", every: 10, late: 150 },
        Stream { what: "pose, 10 Hz, 150 ms late", every: 100, late: 150 },
    ];
    streams.iter().enumerate().all(|(number, stream)| flight.fly(stream, number == 0))
}

/// Poses every so many ms, so many ms late.
struct Stream {
    what: &'static str,
    every: u64,
    late: u64,
}

struct Flight<'a> {
    counter: &'a Counter,
    estimator: &'a mut Estimator,
    settings: Settings,
}

impl Flight<'_> {
    /// Flies ten seconds, and prints what the poses cost; and with `all` the rest. False if a pose was not fused.
    fn fly(&mut self, stream: &Stream, all: bool) -> bool {
        let Ok(mut conditioner) = Conditioner::new(&ImuParameters::PROMPT, &Calibration::NONE, PERIOD_US) else {
            return false;
        };
        *self.estimator = Estimator::new(&self.settings);
        let (sample, take): (Sample, Take) = (black_box(Conditioner::sample), black_box(Estimator::imu));
        let (fuse, state_of): (Fuse, StateOf) = (black_box(Estimator::pose), black_box(Estimator::state));
        let [mut samples, mut increments, mut poses, mut states] = [(); 4].map(|()| Cost::default());
        for n in 0..SAMPLE_COUNT {
            let (now, jitter) = (n * 1_000, (n % 5) as f32 * 1e-4);
            let (rate, force) = (Vector3::new(jitter, 0.0, RATE_RAD_PER_S), Vector3::new(jitter, 0.0, 9.81));
            let (cost, conditioned) = self.counter.short(|| sample(&mut conditioner, now, &rate, Some(&force)));
            samples.add(cost);
            if let Some(increment) = conditioned.increment {
                increments.add(self.counter.short(|| take(self.estimator, &increment)).0);
            }
            if n % stream.every != 0 || n < stream.late {
                continue;
            }
            let Some(pose) = pose(now - stream.late * 1_000) else { return false };
            let (cost, verdict) = self.counter.short(|| fuse(self.estimator, &pose, now));
            match verdict {
                Ok(Accepted::Fused) => poses.add(cost),
                Ok(_) => {}
                Err(_) => return false,
            }
            states.add(self.counter.short(|| black_box(state_of(self.estimator, now, &rate, None))).0);
        }
        if all {
            samples.print("IMU sample");
            let Some(notched) = self.notched() else { return false };
            notched.print("IMU sample, with notches at four rotors");
            increments.print("estimator, IMU increment of 5 ms");
            states.print("estimator, state of now");
        }
        poses.print(stream.what);
        true
    }

    /// What samples cost where four rotors tell their speeds, and these change.
    fn notched(&self) -> Option<Cost> {
        let mut conditioner = Conditioner::new(&ImuParameters::PROMPT, &Calibration::NONE, PERIOD_US).ok()?;
        let (sample, mut cost): (Sample, _) = (black_box(Conditioner::sample), Cost::default());
        for n in 0..SAMPLE_COUNT {
            let (now, jitter) = (n * 1_000, (n % 5) as f32 * 1e-4);
            conditioner.follow_rotors(&[700.0, 710.0, 720.0, 730.0].map(|speed| Some(speed + (n % 64) as f32)));
            let (rate, force) = (Vector3::new(jitter, 0.0, RATE_RAD_PER_S), Vector3::new(jitter, 0.0, 9.81));
            cost.add(self.counter.short(|| sample(&mut conditioner, now, &rate, Some(&force))).0);
        }
        Some(cost)
    }
}

/// Where the vehicle was.
fn pose(time: u64) -> Option<Stamped<PoseMeasurement>> {
    let (sin, cos) = math::sin_cos_turns(TURNS_PER_US.wrapping_mul(time) / 2);
    let nothing = Velocity::World(Vector3::zeros());
    let pose = Pose::new(Vector3::new(1.0, 2.0, 3.0), nothing, Quaternion::new(cos, 0.0, 0.0, sin)).ok()?;
    Some(Stamped { value: PoseMeasurement::new(&pose), time })
}
