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
            Self::NotFinite => "a field is not finite",
            Self::Mask => "type mask not supported",
            Self::Frame => "use LOCAL_NED",
        })
    }
}

/// The bits that set a position aside, axis by axis; and those for velocity and acceleration.
const NO_POSITION: Mask = Mask::POSITION_TARGET_TYPEMASK_X_IGNORE
    .union(Mask::POSITION_TARGET_TYPEMASK_Y_IGNORE)
    .union(Mask::POSITION_TARGET_TYPEMASK_Z_IGNORE);
const NO_VELOCITY: Mask = Mask::POSITION_TARGET_TYPEMASK_VX_IGNORE
    .union(Mask::POSITION_TARGET_TYPEMASK_VY_IGNORE)
    .union(Mask::POSITION_TARGET_TYPEMASK_VZ_IGNORE);
const NO_ACCELERATION: Mask = Mask::POSITION_TARGET_TYPEMASK_AX_IGNORE
    .union(Mask::POSITION_TARGET_TYPEMASK_AY_IGNORE)
    .union(Mask::POSITION_TARGET_TYPEMASK_AZ_IGNORE);

/// What a SET_POSITION_TARGET_LOCAL_NED asks for.
///
/// # Errors
/// [`SetpointRefusal`] for what cannot be done or is not finite.
pub fn setpoint(message: &SET_POSITION_TARGET_LOCAL_NED_DATA) -> Result<Setpoint, SetpointRefusal> {
    let &SET_POSITION_TARGET_LOCAL_NED_DATA { x, y, z, vx, vy, vz, afx, afy, afz, type_mask: mask, .. } = message;
    if message.coordinate_frame != MavFrame::MAV_FRAME_LOCAL_NED {
        return Err(SetpointRefusal::Frame);
    }
    let position = used([x, y, z], mask, NO_POSITION)?;
    let velocity = used([vx, vy, vz], mask, NO_VELOCITY)?;
    let acceleration = used([afx, afy, afz], mask, NO_ACCELERATION)?;
    let motion = match (position, velocity, acceleration) {
        (_, _, Some(_)) if mask.contains(Mask::POSITION_TARGET_TYPEMASK_FORCE_SET) => {
            return Err(SetpointRefusal::Mask);
        }
        (Some(position), None, None) => Motion::Position(position),
        (None, Some(velocity), None) => Motion::Velocity(velocity),
        (Some(position), Some(velocity), acceleration) => {
            let acceleration = acceleration.unwrap_or_else(Vector3::zeros);
            Motion::PositionVelocityAcceleration { position, velocity, acceleration }
        }
        _ => return Err(SetpointRefusal::Mask),
    };
    Ok(Setpoint { motion, turn: turn(message)? })
}

/// A vector of NED in the law's world, unless the mask sets it aside. All three axes count, or none.
fn used(vector: [f32; 3], mask: Mask, ignored: Mask) -> Result<Option<Vector3<f32>>, SetpointRefusal> {
    if mask.contains(ignored) {
        return Ok(None);
    }
    if mask.intersects(ignored) {
        return Err(SetpointRefusal::Mask);
    }
    let finite = vector.iter().all(|component| component.is_finite());
    if finite { Ok(Some(frames::world(&vector.into()))) } else { Err(SetpointRefusal::NotFinite) }
}

fn turn(message: &SET_POSITION_TARGET_LOCAL_NED_DATA) -> Result<Turn, SetpointRefusal> {
    let turns = !message.type_mask.contains(Mask::POSITION_TARGET_TYPEMASK_YAW_IGNORE);
    let rotates = !message.type_mask.contains(Mask::POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE);
    if turns && !message.yaw.is_finite() || rotates && !message.yaw_rate.is_finite() {
        return Err(SetpointRefusal::NotFinite);
    }
    let (angle, rate) = (frames::heading(message.yaw), frames::heading_rate(message.yaw_rate));
    Ok(match (turns, rotates) {
        (false, false) => Turn::Keep,
        (false, true) => Turn::Rate(rate),
        (true, _) => Turn::Angle { angle, rate: if rotates { rate } else { 0.0 } },
    })
}
