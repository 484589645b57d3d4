//! What arming, turning a motor and the ways of flying need, and why they are refused.

use super::estimate::Estimate;
use super::policy::Aboard;
use super::refusal::Refusal;
use super::rules::Mode;
use super::tilt::{heading, tilt_cosine};
use controller_core::heading::Heading;
use estimation::estimator::{EstimatedState, Fault};
use nalgebra::Vector3;

/// 30 degrees.
const ARMING_TILT_COSINE: f32 = 0.866_025_4;

/// The acceleration beyond which the accelerometer and the estimate do not agree on gravity: 2 g sin 5 degrees, for two
/// vertical directions 10 degrees apart. A vehicle at rest has none.
const GRAVITY_ERROR_MAX_M_PER_S2: f32 = 1.71;

const ARMING_SPEED_MAX_M_PER_S: f32 = 0.2;
const ARMING_RATE_MAX_RAD_PER_S: f32 = 0.2;

/// Where a flight starts.
pub(super) struct Start {
    pub position: Vector3<f32>,
    pub heading: Heading,
}

/// A motor may begin to turn where none does, and where the vehicle needs no inspection first.
pub(super) fn to_turn_motors(mode: Mode) -> Result<(), Refusal> {
    match mode {
        Mode::Checks | Mode::Ready | Mode::Locked => Ok(()),
        // There no IMU sample has come.
        Mode::Boot => Err(Refusal::ImuStale),
        Mode::MotorTest => Err(Refusal::MotorTestRunning),
        Mode::Stopped => Err(Refusal::Stopped),
        Mode::Idling | Mode::TakingOff | Mode::Flying | Mode::Holding | Mode::Landing | Mode::Descending => {
            Err(Refusal::AlreadyArmed)
        }
    }
}

/// Taking off: from the ground, with motors that idle.
pub(super) fn to_take_off(mode: Mode) -> Result<(), Refusal> {
    match mode {
        Mode::Idling => Ok(()),
        Mode::TakingOff => Err(Refusal::TakingOff),
        _ => Err(if mode.flies() { Refusal::Flies } else { Refusal::NotIdling }),
    }
}

/// Holding, or flying to a point: in the air, with an estimate, unless the vehicle must land.
pub(super) fn to_hold(mode: Mode, must_land: bool) -> Result<(), Refusal> {
    match mode {
        Mode::Landing if must_land => Err(Refusal::MustLand),
        Mode::Descending => Err(Refusal::WithoutPose),
        _ => require(mode.is_guided(), Refusal::NotInTheAir),
    }
}

/// Flying setpoints: from now on, or from arming on; not in place of a landing, which a request has to end first.
pub(super) fn to_fly_setpoints(mode: Mode) -> Result<(), Refusal> {
    match mode {
        Mode::Landing => Err(Refusal::Landing),
        Mode::Descending => Err(Refusal::WithoutPose),
        _ => require(mode.may_arm() || mode == Mode::Idling || mode.is_guided(), Refusal::NotInTheAir),
    }
}

/// Letting a policy fly: in the air, where the vehicle holds or flies already.
pub(super) fn to_fly_policy<P: Aboard>(mode: Mode, airborne: bool) -> Result<(), Refusal> {
    require(P::EXISTS, Refusal::NoPolicy)?;
    match mode {
        Mode::Landing => Err(Refusal::Landing),
        Mode::Descending => Err(Refusal::WithoutPose),
        _ => require(airborne && matches!(mode, Mode::Flying | Mode::Holding), Refusal::NotInTheAir),
    }
}

/// Flying a mission: with motors that idle, or in the air, where setpoints may be flown.
pub(super) fn to_fly_mission(mode: Mode) -> Result<(), Refusal> {
    match mode {
        Mode::Idling => Ok(()),
        _ if !mode.flies() => Err(Refusal::NotIdling),
        _ => to_fly_setpoints(mode),
    }
}

/// Arming: an estimate that is healthy and has been for a while, of a vehicle that stands nearly upright, and a ground
/// station on the link.
pub(super) fn to_arm(estimate: &Estimate, ground_station_silent: bool) -> Result<Start, Refusal> {
    let faults = estimate.health.faults;
    // First, because every other check needs an IMU.
    require(!faults.contain(Fault::ImuStale), Refusal::ImuStale)?;
    faults.worst().map_or(Ok(()), |fault| Err(Refusal::Estimator(fault)))?;
    // With an estimate it is the body rate that is missing.
    let EstimatedState { state, acceleration, .. } = estimate.state.ok_or(Refusal::ImuStale)?;
    let (speed, rate) = (ARMING_SPEED_MAX_M_PER_S, ARMING_RATE_MAX_RAD_PER_S);
    // Written so that NaN is refused.
    let still = state.velocity.norm_squared() < speed * speed && state.angular_velocity.norm_squared() < rate * rate;
    require(still, Refusal::Moving)?;
    require(acceleration.norm_squared() < GRAVITY_ERROR_MAX_M_PER_S2 * GRAVITY_ERROR_MAX_M_PER_S2, Refusal::Gravity)?;
    require(estimate.settled, Refusal::PosesUnsettled)?;
    require(tilt_cosine(&state.attitude) > ARMING_TILT_COSINE, Refusal::Tilted)?;
    require(!ground_station_silent, Refusal::GroundStationSilent)?;
    let heading = heading(&state.attitude).ok_or(Refusal::Tilted)?;
    Ok(Start { position: state.position, heading })
}

pub(super) fn require(condition: bool, refusal: Refusal) -> Result<(), Refusal> {
    if condition { Ok(()) } else { Err(refusal) }
}
