//! Smooth motions with exact sensors, estimated.

extern crate std;
use crate::estimator::{
    Accepted, Clipped, EstimatedState, Estimator, EstimatorParameters, Increment, PoseMeasurement, Rejected, Settings,
};
use crate::measurement::{Pose, Stamped, Velocity};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use std::boxed::Box;

/// True position, velocity, attitude, body rate and specific force at a time in seconds.
#[derive(Debug, Clone, Copy)]
pub struct Truth {
    pub position: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub attitude: UnitQuaternion<f64>,
    pub rate: Vector3<f64>,
    pub force: Vector3<f64>,
}

/// A motion that is known for all times.
pub type Path = fn(f64) -> Truth;

/// Standing still, level.
pub fn rest(_: f64) -> Truth {
    let zero = Vector3::zeros();
    let position = Vector3::new(1.0, -2.0, 0.5);
    let force = Vector3::new(0.0, 0.0, 9.81);
    Truth { position, velocity: zero, attitude: UnitQuaternion::identity(), rate: zero, force }
}

/// Hovering level, turning about the vertical: in motion for a gyro, and nothing else.
pub fn spin(t: f64) -> Truth {
    let rate = Vector3::z() * 0.3;
    Truth { attitude: UnitQuaternion::from_scaled_axis(rate * t), rate, ..rest(t) }
}

/// Back and forth on all axes, turning over and over: upside down every second.
pub fn tumble(t: f64) -> Truth {
    let (a, w) = (Vector3::new(1.0, 0.7, 0.5), Vector3::new(1.5, 2.0, 2.5));
    let at = |f: fn(f64) -> f64| Vector3::from_fn(|i, _| f(w[i] * t));
    let position = a.component_mul(&at(f64::sin));
    let velocity = a.component_mul(&w).component_mul(&at(f64::cos));
    let acceleration = -a.component_mul(&w).component_mul(&w).component_mul(&at(f64::sin));
    let rate = Vector3::new(std::f64::consts::TAU, 0.0, 0.0);
    let yaw = UnitQuaternion::from_scaled_axis(Vector3::new(0.2, -0.3, 0.8));
    let attitude = yaw * UnitQuaternion::from_scaled_axis(rate * t);
    let force = attitude.inverse_transform_vector(&(acceleration + Vector3::z() * 9.81));
    Truth { position, velocity, attitude, rate, force }
}

/// The increment of exact sensors between two times, us, with biases added.
pub fn increment(path: Path, start: u64, end: u64, biases: &(Vector3<f64>, Vector3<f64>)) -> Increment {
    let (from, h, steps) = (start as f64 * 1e-6, (end - start) as f64 * 1e-6, 50);
    let step = h / f64::from(steps);
    let mut turned = UnitQuaternion::identity();
    let mut velocity = Vector3::zeros();
    for n in 0..steps {
        let truth = path(from + step * (f64::from(n) + 0.5));
        let (rate, force) = (truth.rate + biases.0, truth.force + biases.1);
        velocity += (turned * UnitQuaternion::from_scaled_axis(rate * (0.5 * step))) * force * step;
        turned *= UnitQuaternion::from_scaled_axis(rate * step);
    }
    let single = |vector: &Vector3<f64>| vector.map(|x| x as f32);
    let delta_angle = single(&turned.scaled_axis());
    Increment { start, end, delta_angle, delta_velocity: single(&velocity), clipped: Clipped::NEITHER }
}

/// The exact pose at a time, us, moved by an offset (m) and a turn on the left.
pub fn pose(truth: &Truth, offset: &Vector3<f64>, turn: &UnitQuaternion<f64>) -> PoseMeasurement {
    let position = (truth.position + offset).map(|x| x as f32);
    let attitude = Quaternion::from((turn * truth.attitude).coords.map(|x| x as f32));
    let velocity = Velocity::World(truth.velocity.map(|x| x as f32));
    PoseMeasurement::with_velocity(&Pose::new(position, velocity, attitude).unwrap())
}

/// An estimator on a motion: time goes on in increments of 5 ms.
pub struct Rig {
    pub estimator: Box<Estimator>,
    pub path: Path,
    pub now: u64,
    pub biases: (Vector3<f64>, Vector3<f64>),
}

impl Rig {
    pub fn new(path: Path) -> Self {
        let settings = Settings::new(&EstimatorParameters::BMI088).unwrap();
        let zero = Vector3::zeros();
        Self { estimator: Box::new(Estimator::new(&settings)), path, now: 0, biases: (zero, zero) }
    }

    pub fn truth(&self, time: u64) -> Truth {
        (self.path)(time as f64 * 1e-6)
    }

    /// 5 ms of the IMU.
    pub fn step(&mut self) {
        let end = self.now + 5_000;
        self.estimator.imu(&increment(self.path, self.now, end, &self.biases));
        self.now = end;
    }

    /// Steps for a time, us, with the exact pose of `late` us ago every 10 ms.
    pub fn fly(&mut self, duration: u64, late: u64) {
        self.fly_with(duration, late, |rig, time| {
            pose(&rig.truth(time), &Vector3::zeros(), &UnitQuaternion::identity())
        });
    }

    /// The same with poses that somebody makes for the time at which they are true; what became of the last.
    pub fn fly_with(
        &mut self,
        duration: u64,
        late: u64,
        mut make: impl FnMut(&Self, u64) -> PoseMeasurement,
    ) -> Option<Result<Accepted, Rejected>> {
        let mut last = None;
        for n in 1..=duration / 5_000 {
            self.step();
            if n % 2 == 0 && self.now > late {
                let time = self.now - late;
                let stamped = Stamped { value: make(self, time), time };
                last = Some(self.estimator.pose(&stamped, self.now));
            }
        }
        last
    }

    /// The state now, with the true body rate.
    pub fn state(&self) -> Option<EstimatedState> {
        self.state_at(self.now)
    }

    /// The state at a time, us.
    pub fn state_at(&self, time: u64) -> Option<EstimatedState> {
        self.estimator.state(time, &(self.truth(time).rate + self.biases.0).map(|x| x as f32), None)
    }

    /// Errors of position (m), velocity (m/s) and attitude (rad) now.
    pub fn errors(&self) -> (f64, f64, f64) {
        let (state, truth) = (self.state().unwrap().state, self.truth(self.now));
        let attitude = UnitQuaternion::new_normalize(state.attitude.cast::<f64>());
        (
            (state.position.cast::<f64>() - truth.position).norm(),
            (state.velocity.cast::<f64>() - truth.velocity).norm(),
            attitude.angle_to(&truth.attitude),
        )
    }

    /// That the state is right to 1 mm, 1 cm/s and 1 mrad.
    pub fn check(&self, what: &str) {
        let (p, v, q) = self.errors();
        assert!(p < 1e-3 && v < 1e-2 && q < 1e-3, "{what}: {p:.2e} m, {v:.2e} m/s, {q:.2e} rad");
    }
}
