//! A vehicle on a desk: it never moves, whatever the motors' command, and its sensors and poses show that.

use super::receiver::Local;
use crate::support::PERIOD_US;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use estimation::estimator::{Clipped, Increment, PoseMeasurement};
use firmware::boot;
use firmware::control::Control;
use firmware::hardware::MotorCommand;
use flight::{ImuSample, Mode, Pose, Stamped, Velocity};
use nalgebra::{Quaternion, Vector3};

/// Control with everything that it needs to arm but a ground station.
pub struct Desk<'a> {
    shared: &'a Local,
    control: Control<'a, NoopRawMutex>,
    /// When the last tick was, us.
    pub now: u64,
}

impl<'a> Desk<'a> {
    /// Just booted.
    pub fn new(shared: &'a Local) -> Self {
        let (pilot, outputs) = boot::start(Box::leak(Box::new(boot::Place::new())), shared.for_boot()).unwrap();
        Self { shared, control: Control::new(shared.for_control(), pilot, outputs), now: 0 }
    }

    /// One tick on, with the IMU's and a camera's measurements of a vehicle at rest.
    pub fn tick(&mut self) -> MotorCommand {
        let zero = Vector3::zeros();
        for start in [self.now, self.now + PERIOD_US / 2] {
            self.shared.increment(Increment {
                start,
                end: start + PERIOD_US / 2,
                delta_angle: zero,
                delta_velocity: Vector3::new(0.0, 0.0, 9.81 * 5e-3),
                clipped: Clipped::NEITHER,
            });
        }
        self.now += PERIOD_US;
        let sample = ImuSample { angular_velocity: zero, specific_force: Vector3::z() * 9.81 };
        self.shared.imu.put(sample, self.now);
        let pose = Pose::new(zero, Velocity::World(zero), Quaternion::identity()).unwrap();
        self.shared.poses.put(Stamped { value: PoseMeasurement::new(&pose), time: self.now }).unwrap();
        self.control.tick(self.now)
    }

    /// The mode after the last tick.
    pub fn mode(&self) -> Mode {
        self.shared.report.get().unwrap().value.mode
    }
}
