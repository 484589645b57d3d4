//! Inertial sensors that measure the test's motion, each with its own errors.

use super::Simulated;
use core::cell::Cell;
use estimation::imu::ImuParameters;
use firmware::hardware::{Clock, Fault, Imu, RawImu};
use nalgebra::Vector3;

/// What is wrong with a sensor.
#[derive(Clone, Copy)]
pub struct Wrong {
    /// Added to the rate, rad/s.
    pub bias: Vector3<f32>,
    /// Added to the force, m/s^2, after this.
    pub offset: Vector3<f32>,
    /// Multiplies the force.
    pub factor: Vector3<f32>,
}

/// Nothing.
pub const RIGHT: Wrong = Wrong {
    bias: Vector3::new(0.0, 0.0, 0.0),
    offset: Vector3::new(0.0, 0.0, 0.0),
    factor: Vector3::new(1.0, 1.0, 1.0),
};

/// How a sensor does.
#[derive(Clone, Copy, PartialEq)]
pub enum Does {
    Well,
    Faults,
    /// Its gyro repeats one value.
    Stuck,
    /// Its accelerometer does not answer.
    Forceless,
}

/// What happens to the vehicle, and to its sensors.
pub struct Body {
    pub clock: Simulated,
    /// rad/s.
    pub rate: Cell<Vector3<f32>>,
    /// The direction that is up, body axes, times g.
    pub up: Cell<Vector3<f32>>,
    /// Shaken by so much, rad/s.
    pub shaken: Cell<f32>,
    pub first: Cell<Does>,
    pub second: Cell<Does>,
}

/// A standard gravity, m/s^2.
pub const GRAVITY_M_PER_S2: f32 = 9.806_65;

impl Body {
    /// At rest, level, with sensors that work.
    pub fn new() -> Self {
        Self {
            clock: Simulated::default(),
            rate: Cell::default(),
            up: Cell::new(Vector3::z() * GRAVITY_M_PER_S2),
            shaken: Cell::default(),
            first: Cell::new(Does::Well),
            second: Cell::new(Does::Well),
        }
    }
}

/// A sensor of the body, with a sample every millisecond.
pub struct Sensor<'a> {
    pub body: &'a Body,
    pub wrong: Wrong,
    pub is_second: bool,
}

impl Imu for Sensor<'_> {
    async fn sample(&mut self) -> Result<RawImu, Fault> {
        let body = self.body;
        body.clock.until(body.clock.now() + 1_000).await;
        let does = if self.is_second { body.second.get() } else { body.first.get() };
        if does == Does::Faults {
            return Err(Fault);
        }
        let time = body.clock.now();
        let step = (time / 1_000 % 7) as f32 - 3.0;
        let jitter = if does == Does::Stuck { 0.0 } else { step * 1e-4 + step * body.shaken.get() };
        let angular_velocity = (body.rate.get() + self.wrong.bias).add_scalar(jitter);
        let force = (body.up.get().component_mul(&self.wrong.factor) + self.wrong.offset).add_scalar(step * 1e-4);
        Ok(RawImu { time, angular_velocity, specific_force: (does != Does::Forceless).then_some(force) })
    }

    fn parameters(&self) -> ImuParameters {
        ImuParameters::PROMPT
    }

    fn is_polled(&self) -> bool {
        false
    }
}
