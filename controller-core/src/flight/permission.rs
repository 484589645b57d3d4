//! What arming and a motor test need, and why they are refused.

use super::measurement::{ImuSample, Newest, Pose};
use super::reason::Refusal;
use super::rules::{IMU_AGE_MAX, MOTOR_TEST_LEVEL_MAX, MOTOR_TEST_MAX, Mode, POSE_AGE_MAX};
use crate::heading::Heading;
use crate::math;
use nalgebra::{Quaternion, Vector2, Vector3};

/// The cosine of the greatest tilt that arms, 30 degrees.
const TILT_COSINE: f32 = 0.866_025_4;

/// One motor to be turned slowly for a while, to see which it is and which way it turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorTest {
    /// Its index in the rotors' order.
    pub rotor: usize,
    /// Part of the command's range, in (0, [`MOTOR_TEST_LEVEL_MAX`]].
    pub level: f32,
    /// How long, us, in (0, [`MOTOR_TEST_MAX`]].
    pub duration: u64,
}

impl MotorTest {
    /// No test.
    pub(super) const NONE: Self = Self { rotor: 0, level: 0.0, duration: 0 };
}

/// Where a flight starts.
pub(super) struct Start {
    pub position: Vector3<f32>,
    pub heading: Heading,
}

/// Only a disarmed vehicle takes requests, and none against a disarm command.
pub(super) fn to_leave(mode: Mode, disarm: bool) -> Result<(), Refusal> {
    match mode {
        _ if disarm => Err(Refusal::DisarmCommanded),
        Mode::Disarmed => Ok(()),
        Mode::MotorTest => Err(Refusal::MotorTestRunning),
        Mode::Flying | Mode::Holding | Mode::Levelling => Err(Refusal::AlreadyArmed),
    }
}

/// Arming: fresh and usable measurements, nearly upright, and somebody at the other end of the link.
pub(super) fn to_arm(
    imu: &Newest<ImuSample>,
    pose: &Newest<Pose>,
    ground_station_silent: bool,
    now: u64,
) -> Result<Start, Refusal> {
    imu.unusable().or(pose.unusable()).map_or(Ok(()), |field| Err(Refusal::Unusable(field)))?;
    require(imu.within(IMU_AGE_MAX, now).is_some(), Refusal::ImuStale)?;
    let pose = &pose.within(POSE_AGE_MAX - 1, now).ok_or(Refusal::PoseStale)?.value;
    require(upright(&pose.attitude()) > TILT_COSINE, Refusal::Tilted)?;
    require(!ground_station_silent, Refusal::GroundStationSilent)?;
    let heading = heading(&pose.attitude()).ok_or(Refusal::Tilted)?;
    Ok(Start { position: pose.position(), heading })
}

/// A motor test: one rotor that exists, slowly, not for long.
pub(super) fn to_test(test: &MotorTest, rotors: usize) -> Result<(), Refusal> {
    require(test.rotor < rotors, Refusal::NoSuchRotor)?;
    require(test.level > 0.0 && test.level <= MOTOR_TEST_LEVEL_MAX, Refusal::MotorTestLevel)?;
    require(test.duration > 0 && test.duration <= MOTOR_TEST_MAX, Refusal::MotorTestDuration)
}

fn require(condition: bool, refusal: Refusal) -> Result<(), Refusal> {
    if condition { Ok(()) } else { Err(refusal) }
}

/// e3 . R e3: the cosine of the tilt.
fn upright(q: &Quaternion<f32>) -> f32 {
    1.0 - 2.0 * (q.i * q.i + q.j * q.j)
}

/// Which way body x points, seen from above; none straight up or down.
fn heading(q: &Quaternion<f32>) -> Option<Heading> {
    let forward = Vector2::new(1.0 - 2.0 * (q.j * q.j + q.k * q.k), 2.0 * (q.i * q.j + q.w * q.k));
    Heading::new(forward / math::sqrt(forward.norm_squared()), 0.0, 0.0).ok()
}
