//! The firmware's side of a simulator: commands it was given, pins beside it, what it may answer.

use super::Simulated;
use crate::support::PERIOD_US;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::hardware::{Fault, MotorCommand, Motors};
use firmware::hil::{self, SelectedMotors};
use firmware::shared::Flag;
use mavlink::dialects::common::{HIL_SENSOR_DATA, HilSensorUpdatedFlags, MavFrame, ODOMETRY_DATA};

/// What a single-threaded test exchanges with a simulator.
pub type Hil = hil::Hil<NoopRawMutex>;

/// When the simulator got its command, us; it answers a few milliseconds later, of the period that follows.
pub const COMMANDED_US: u64 = 40_000;

/// Pins that record their commands.
#[derive(Default)]
pub struct Pins(pub Vec<MotorCommand>);

impl Motors for &mut Pins {
    async fn write(&mut self, command: MotorCommand) -> Result<(), Fault> {
        self.0.push(command);
        Ok(())
    }
}

/// Runs a future that waits for nothing.
pub fn now<T>(future: impl Future<Output = T>) -> T {
    embassy_futures::block_on(future)
}

/// A simulator that has been given a command at [`COMMANDED_US`] and has not answered.
pub fn commanded() -> Hil {
    let hil = Hil::new();
    command(&hil, COMMANDED_US);
    hil
}

/// Gives the simulator a command at `time`, us.
pub fn command(hil: &Hil, time: u64) {
    let (wanted, clock) = (Flag::new(), Simulated::default());
    wanted.raise();
    clock.0.set(time);
    now(SelectedMotors { pins: &mut Pins::default(), hil, requested: (&wanted).into(), clock, period: PERIOD_US }
        .write(MotorCommand::Stop))
    .unwrap();
}

/// The sensors' message at `time_usec`.
pub fn sensor(time_usec: u64) -> HIL_SENSOR_DATA {
    HIL_SENSOR_DATA {
        time_usec,
        // Rolling right, nose up, turning right.
        xgyro: 0.5,
        ygyro: 0.25,
        zgyro: 0.125,
        xacc: 1.0,
        yacc: 2.0,
        zacc: -9.0,
        fields_updated: HilSensorUpdatedFlags::all(),
        ..Default::default()
    }
}

/// The pose source's message of `time_usec`.
pub fn odometry(time_usec: u64) -> ODOMETRY_DATA {
    ODOMETRY_DATA {
        time_usec,
        // 1 m north, 2 m east, 3 m up, facing north, flying that way.
        x: 1.0,
        y: 2.0,
        z: -3.0,
        q: [1.0, 0.0, 0.0, 0.0],
        vx: 0.5,
        frame_id: MavFrame::MAV_FRAME_LOCAL_NED,
        child_frame_id: MavFrame::MAV_FRAME_BODY_FRD,
        ..Default::default()
    }
}
