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

use super::frame::Frame;
use super::message::LOCAL_NED;
use crate::frames;
use controller_core::governor::{Motion, Setpoint, Turn};
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

impl SetpointRefusal {
    /// The reason in words, to follow "Setpoint refused: ".
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Self::NotFinite => "a field is not finite",
            Self::Mask => "type mask not supported",
            Self::Frame => "use LOCAL_NED",
        }
    }
}

/// The type mask's bit that makes the acceleration a force.
const FORCE: u16 = 1 << 9;
/// Its bit for a heading that is not to be looked at.
const NO_HEADING: u16 = 1 << 10;
/// And for the heading's rate.
const NO_HEADING_RATE: u16 = 1 << 11;

/// What a SET_POSITION_TARGET_LOCAL_NED asks for.
///
/// # Errors
/// [`SetpointRefusal`] for what cannot be done or is not finite.
pub fn setpoint(message: &Frame<'_>) -> Result<Setpoint, SetpointRefusal> {
    // Time, position, velocity, acceleration, heading, its rate, mask, addressee, frame.
    let (mask, frame) = (message.u16(48), message.byte(52));
    if frame != LOCAL_NED {
        return Err(SetpointRefusal::Frame);
    }
    let [position, velocity, acceleration] =
        [used(message, mask, 0)?, used(message, mask, 1)?, used(message, mask, 2)?];
    let motion = match (position, velocity, acceleration) {
        (_, _, Some(_)) if mask & FORCE != 0 => return Err(SetpointRefusal::Mask),
        (Some(position), None, None) => Motion::Position(position),
        (None, Some(velocity), None) => Motion::Velocity(velocity),
        (Some(position), Some(velocity), acceleration) => {
            let acceleration = acceleration.unwrap_or_default();
            Motion::PositionVelocityAcceleration { position, velocity, acceleration }
        }
        _ => return Err(SetpointRefusal::Mask),
    };
    Ok(Setpoint { motion, turn: turn(mask, message.f32(40), message.f32(44))? })
}

/// The world vector of position, velocity or acceleration, if the mask has it used. All three axes are, or none.
fn used(message: &Frame<'_>, mask: u16, quantity: usize) -> Result<Option<Vector3<f32>>, SetpointRefusal> {
    match mask >> (3 * quantity) & 0b111 {
        0b000 => {
            let offset = 4 + 12 * quantity;
            if !message.are_finite(offset, 3) {
                return Err(SetpointRefusal::NotFinite);
            }
            Ok(Some(frames::world(&message.vector(offset))))
        }
        0b111 => Ok(None),
        _ => Err(SetpointRefusal::Mask),
    }
}

fn turn(mask: u16, angle: f32, rate: f32) -> Result<Turn, SetpointRefusal> {
    let angle = (mask & NO_HEADING == 0).then_some(angle).map(finite).transpose()?;
    let rate = (mask & NO_HEADING_RATE == 0).then_some(rate).map(finite).transpose()?;
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
