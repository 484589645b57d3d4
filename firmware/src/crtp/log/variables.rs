//! What there is to log: the names that people's scripts know, and ours beside them.
//!
//! World: x east, y north, z up, as the law's; angles in degrees, roll to the right, pitch with the nose up, yaw
//! counter-clockwise from x. A float that is not known is NaN, a whole number then 0.

use super::kind::Kind;
use crate::crtp::quaternion::packed;
use crate::esc::controller::RotorSpeeds;
use crate::hardware::MOTOR_COUNT;
use crate::shared::Report;
use crate::status::{Euler, euler};
use controller_core::reference::Reference;
use controller_core::state::State;
use flight::ImuSample;
use nalgebra::{RealField, UnitQuaternion, Vector3};

/// g, m/s^2, in which the accelerometer is logged.
const GRAVITY_M_PER_S2: f32 = 9.806_65;

/// What the values are taken from, at one time.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// What the last tick did; none before the first, and of one that is stale.
    pub report: Option<Report>,
    /// The newest inertial sample, if it is fresh.
    pub imu: Option<ImuSample>,
    /// The battery, V, if it is measured.
    pub voltage: Option<f32>,
    /// How fast the rotors turn, where their controllers say so.
    pub rotor_speeds: Option<RotorSpeeds>,
    /// What the supervisor says: [`crate::crtp::supervisor`].
    pub supervisor: u16,
    /// Below this voltage the battery is low, V; 0 where nothing watches it.
    pub battery_low: f32,
}

/// A row.
pub struct Variable {
    pub group: &'static str,
    pub name: &'static str,
    pub kind: Kind,
    pub value: fn(&View) -> f64,
}

impl View {
    fn state(&self) -> Option<&State> {
        self.report.as_ref()?.state.as_ref()
    }

    fn reference(&self) -> Option<&Reference> {
        self.report.as_ref()?.reference.as_ref()
    }

    /// By the estimate, or while there is none by gravity alone, with a yaw of 0.
    fn angles(&self) -> Option<Euler> {
        let attitude = self.state().map(|state| state.attitude);
        let lean = self.report.as_ref().and_then(|report| report.lean).map(|lean| lean.attitude);
        // Of these axes roll is to the right already, pitch has the nose down.
        attitude.or(lean).map(|attitude| euler(&attitude))
    }

    fn acceleration(&self) -> Option<Vector3<f32>> {
        let turned = UnitQuaternion::new_unchecked(self.state()?.attitude) * self.imu?.specific_force;
        Some(turned / GRAVITY_M_PER_S2 - Vector3::z())
    }

    fn supervised(&self, bit: u16) -> f64 {
        f64::from(self.supervisor >> bit & 1)
    }
}

/// A number that may be unknown.
fn known(value: Option<f32>) -> f64 {
    f64::from(value.unwrap_or(f32::NAN))
}

/// The rows of a group, all of one kind: a name, and its value.
macro_rules! variables {
    ($($group:literal $kind:ident { $($name:literal: $value:expr,)* })*) => {
        pub const VARIABLES: [Variable; [$($($name,)*)*].len()] =
            [$($(Variable { group: $group, name: $name, kind: Kind::$kind, value: $value },)*)*];
    };
}

variables! {
    "stateEstimate" Float {
        "x": |view| known(view.state().map(|state| state.position.x)),
        "y": |view| known(view.state().map(|state| state.position.y)),
        "z": |view| known(view.state().map(|state| state.position.z)),
        "vx": |view| known(view.state().map(|state| state.velocity.x)),
        "vy": |view| known(view.state().map(|state| state.velocity.y)),
        "vz": |view| known(view.state().map(|state| state.velocity.z)),
        "ax": |view| known(view.acceleration().map(|acceleration| acceleration.x)),
        "ay": |view| known(view.acceleration().map(|acceleration| acceleration.y)),
        "az": |view| known(view.acceleration().map(|acceleration| acceleration.z)),
        "roll": |view| known(view.angles().map(|angles| angles.roll)),
        "pitch": |view| known(view.angles().map(|angles| -angles.pitch)),
        "yaw": |view| known(view.angles().map(|angles| angles.yaw)),
        "qx": |view| known(view.state().map(|state| state.attitude.i)),
        "qy": |view| known(view.state().map(|state| state.attitude.j)),
        "qz": |view| known(view.state().map(|state| state.attitude.k)),
        "qw": |view| known(view.state().map(|state| state.attitude.w)),
    }
    // Thousandths: mm, mm/s.
    "stateEstimateZ" I16 {
        "x": |view| 1e3 * known(view.state().map(|state| state.position.x)),
        "y": |view| 1e3 * known(view.state().map(|state| state.position.y)),
        "z": |view| 1e3 * known(view.state().map(|state| state.position.z)),
        "vx": |view| 1e3 * known(view.state().map(|state| state.velocity.x)),
        "vy": |view| 1e3 * known(view.state().map(|state| state.velocity.y)),
        "vz": |view| 1e3 * known(view.state().map(|state| state.velocity.z)),
        "ax": |view| 9806.65 * known(view.acceleration().map(|acceleration| acceleration.x)),
        "ay": |view| 9806.65 * known(view.acceleration().map(|acceleration| acceleration.y)),
        "az": |view| 9806.65 * known(view.acceleration().map(|acceleration| acceleration.z)),
        // mrad/s.
        "rateRoll": |view| 1e3 * known(view.state().map(|state| state.angular_velocity.x)),
        "ratePitch": |view| -1e3 * known(view.state().map(|state| state.angular_velocity.y)),
        "rateYaw": |view| 1e3 * known(view.state().map(|state| state.angular_velocity.z)),
    }
    "stateEstimateZ" U32 {
        "quat": |view| view.state().map_or(0.0, |state| f64::from(packed(&state.attitude))),
    }
    "stabilizer" Float {
        "roll": |view| known(view.angles().map(|angles| angles.roll)),
        "pitch": |view| known(view.angles().map(|angles| -angles.pitch)),
        "yaw": |view| known(view.angles().map(|angles| angles.yaw)),
        // The mean of the motors' commands, 65,535 for all there is.
        "thrust": |view| (0..MOTOR_COUNT).map(|motor| command(view, motor)).sum::<f64>() / MOTOR_COUNT as f64,
    }
    "ctrltarget" Float {
        "x": |view| known(view.reference().map(|reference| reference.position.x)),
        "y": |view| known(view.reference().map(|reference| reference.position.y)),
        "z": |view| known(view.reference().map(|reference| reference.position.z)),
        "vx": |view| known(view.reference().map(|reference| reference.velocity.x)),
        "vy": |view| known(view.reference().map(|reference| reference.velocity.y)),
        "vz": |view| known(view.reference().map(|reference| reference.velocity.z)),
        "ax": |view| known(view.reference().map(|reference| reference.acceleration.x)),
        "ay": |view| known(view.reference().map(|reference| reference.acceleration.y)),
        "az": |view| known(view.reference().map(|reference| reference.acceleration.z)),
        "yaw": |view| {
            let direction = view.reference().map(|reference| reference.heading.direction());
            known(direction.map(|direction| RealField::atan2(direction.y, direction.x).to_degrees()))
        },
    }
    // Degrees per second.
    "gyro" Float {
        "x": |view| known(view.imu.map(|imu| imu.angular_velocity.x.to_degrees())),
        "y": |view| known(view.imu.map(|imu| imu.angular_velocity.y.to_degrees())),
        "z": |view| known(view.imu.map(|imu| imu.angular_velocity.z.to_degrees())),
    }
    // g.
    "acc" Float {
        "x": |view| known(view.imu.map(|imu| imu.specific_force.x / GRAVITY_M_PER_S2)),
        "y": |view| known(view.imu.map(|imu| imu.specific_force.y / GRAVITY_M_PER_S2)),
        "z": |view| known(view.imu.map(|imu| imu.specific_force.z / GRAVITY_M_PER_S2)),
    }
    // m, and m^2: the trace of the covariance, a third for each axis.
    "kalman" Float {
        "stateX": |view| known(view.state().map(|state| state.position.x)),
        "stateY": |view| known(view.state().map(|state| state.position.y)),
        "stateZ": |view| known(view.state().map(|state| state.position.z)),
        "varPX": |view| variance(view),
        "varPY": |view| variance(view),
        "varPZ": |view| variance(view),
    }
    // 0 where it is not measured: clients count with a number.
    "pm" Float {
        "vbat": |view| f64::from(view.voltage.unwrap_or(0.0)),
    }
    "pm" U16 {
        "vbatMV": |view| 1e3 * known(view.voltage),
    }
    // 0 on battery, 3 low, as the parameter BAT_LOW has it.
    "pm" U8 {
        "state": |view| if view.voltage.is_some_and(|volts| volts < view.battery_low) { 3.0 } else { 0.0 },
    }
    "supervisor" U16 {
        "info": |view| f64::from(view.supervisor),
    }
    "sys" U8 {
        "armed": |view| view.supervised(1),
        "canfly": |view| view.supervised(3),
        "isFlying": |view| view.supervised(4),
        "isTumbled": |view| view.supervised(5),
    }
    // Ours: N, N m, and what the rotors are believed to give of it.
    "law" Float {
        "thrust": |view| known(view.report.and_then(|report| report.wrench).map(|wrench| wrench.thrust)),
        "torqueX": |view| known(view.report.and_then(|report| report.wrench).map(|wrench| wrench.torque.x)),
        "torqueY": |view| known(view.report.and_then(|report| report.wrench).map(|wrench| wrench.torque.y)),
        "torqueZ": |view| known(view.report.and_then(|report| report.wrench).map(|wrench| wrench.torque.z)),
        "thrustScale": |view| known(view.report.and_then(|report| report.thrust_scale)),
    }
    // The flight rules' mode, from 0 in the order of `flight::Mode`.
    "law" U8 {
        "mode": |view| view.report.map_or(0.0, |report| f64::from(report.mode as u8)),
    }
    // The command, 65,535 for all there is.
    "motor" U16 {
        "m1": |view| command(view, 0),
        "m2": |view| command(view, 1),
        "m3": |view| command(view, 2),
        "m4": |view| command(view, 3),
    }
    // rad/s, by the motors' controllers.
    "rotor" Float {
        "speed1": |view| speed(view, 0),
        "speed2": |view| speed(view, 1),
        "speed3": |view| speed(view, 2),
        "speed4": |view| speed(view, 3),
    }
    // How well the ticks keep time: us, us, and how many were missed.
    "tick" U32 {
        "worst": |view| view.report.map_or(0.0, |report| f64::from(report.timing.worst_duration)),
        "jitter": |view| view.report.map_or(0.0, |report| f64::from(report.timing.worst_jitter)),
        "missed": |view| view.report.map_or(0.0, |report| f64::from(report.timing.missed)),
    }
}

fn variance(view: &View) -> f64 {
    let (position, ..) = view.report.map_or((f32::NAN, 0.0, 0.0), |report| report.health.deviations);
    f64::from(position * position / 3.0)
}

fn command(view: &View, motor: usize) -> f64 {
    let level = view.report.and_then(|report| report.motors.get(motor).copied());
    f64::from(level.unwrap_or(0.0)) * f64::from(u16::MAX)
}

fn speed(view: &View, rotor: usize) -> f64 {
    known(view.rotor_speeds.and_then(|speeds| speeds.get(rotor).copied().flatten()))
}
