//! Setpoints: SET_POSITION_TARGET_LOCAL_NED and its type mask, turned into what the governor understands.
//!
//! | used, of position / velocity / acceleration | becomes |
//! |---|---|
//! | position | go there and rest |
//! | velocity | move like that |
//! | position and velocity, with or without acceleration | follow that moving point |
//! | anything else: acceleration alone, single axes, forces | refused |
//!
//! The heading is kept, turned to, or turned at a rate, as its two bits say. Fields that the mask sets aside are not looked
//! at. Only LOCAL_NED is understood. Ranges are the governor's business: everything from here goes through it.

use crate::frames;
use controller_core::governor::{Motion, Setpoint, Turn};
use core::fmt;
use mavlink::dialects::common::{MavFrame, PositionTargetTypemask as Mask, SET_POSITION_TARGET_LOCAL_NED_DATA};
use nalgebra::Vector3;

/// Why a setpoint was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SetpointRefusal {
    /// A field in use is NaN or infinite.
    NotFinite,
    /// A combination of fields that says nothing the governor could do.
    Mask,
    /// Another frame than LOCAL_NED.
    Frame,
}

impl fmt::Display for SetpointRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "Setpoint refused: a field is not finite",
            Self::Mask => "Setpoint refused: type mask not supported",
            Self::Frame => "Setpoint refused: use LOCAL_NED",
        })
    }
}

/// The mask's bits for the three axes of one quantity.
const fn axes(x: Mask, y: Mask, z: Mask) -> Mask {
    x.union(y).union(z)
}

const POSITION: Mask = axes(
    Mask::POSITION_TARGET_TYPEMASK_X_IGNORE,
    Mask::POSITION_TARGET_TYPEMASK_Y_IGNORE,
    Mask::POSITION_TARGET_TYPEMASK_Z_IGNORE,
);
const VELOCITY: Mask = axes(
    Mask::POSITION_TARGET_TYPEMASK_VX_IGNORE,
    Mask::POSITION_TARGET_TYPEMASK_VY_IGNORE,
    Mask::POSITION_TARGET_TYPEMASK_VZ_IGNORE,
);
const ACCELERATION: Mask = axes(
    Mask::POSITION_TARGET_TYPEMASK_AX_IGNORE,
    Mask::POSITION_TARGET_TYPEMASK_AY_IGNORE,
    Mask::POSITION_TARGET_TYPEMASK_AZ_IGNORE,
);

/// What the message asks for.
///
/// # Errors
/// [`SetpointRefusal`] for what cannot be done or is not finite.
pub fn setpoint(message: &SET_POSITION_TARGET_LOCAL_NED_DATA) -> Result<Setpoint, SetpointRefusal> {
    if message.coordinate_frame != MavFrame::MAV_FRAME_LOCAL_NED {
        return Err(SetpointRefusal::Frame);
    }
    let mask = message.type_mask;
    let position = used(mask, POSITION, [message.x, message.y, message.z])?;
    let velocity = used(mask, VELOCITY, [message.vx, message.vy, message.vz])?;
    let acceleration = used(mask, ACCELERATION, [message.afx, message.afy, message.afz])?;
    let motion = match (position, velocity, acceleration) {
        (_, _, Some(_)) if mask.contains(Mask::POSITION_TARGET_TYPEMASK_FORCE_SET) => {
            return Err(SetpointRefusal::Mask);
        }
        (Some(position), None, None) => Motion::Position(position),
        (None, Some(velocity), None) => Motion::Velocity(velocity),
        (Some(position), Some(velocity), acceleration) => {
            let acceleration = acceleration.unwrap_or_default();
            Motion::PositionVelocityAcceleration { position, velocity, acceleration }
        }
        _ => return Err(SetpointRefusal::Mask),
    };
    Ok(Setpoint { motion, turn: turn(message)? })
}

/// The world vector of one quantity, if the mask has it used. All three axes are, or none.
fn used(mask: Mask, axes: Mask, [x, y, z]: [f32; 3]) -> Result<Option<Vector3<f32>>, SetpointRefusal> {
    if mask.contains(axes) {
        return Ok(None);
    }
    if mask.intersects(axes) {
        return Err(SetpointRefusal::Mask);
    }
    Ok(Some(frames::world(&Vector3::new(finite(x)?, finite(y)?, finite(z)?))))
}

fn turn(message: &SET_POSITION_TARGET_LOCAL_NED_DATA) -> Result<Turn, SetpointRefusal> {
    let angle = !message.type_mask.contains(Mask::POSITION_TARGET_TYPEMASK_YAW_IGNORE);
    let rate = !message.type_mask.contains(Mask::POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE);
    let (angle, rate) = (angle.then_some(message.yaw), rate.then_some(message.yaw_rate));
    let (angle, rate) = (angle.map(finite).transpose()?, rate.map(finite).transpose()?);
    let rate = rate.map(frames::heading_rate);
    Ok(match (angle.map(frames::heading), rate) {
        (None, None) => Turn::Keep,
        (None, Some(rate)) => Turn::Rate(rate),
        (Some(angle), rate) => Turn::Angle { angle, rate: rate.unwrap_or(0.0) },
    })
}

fn finite(value: f32) -> Result<f32, SetpointRefusal> {
    if value.is_finite() { Ok(value) } else { Err(SetpointRefusal::NotFinite) }
}
