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
    let quantity = |index: usize| frames::world(&message.vector(4 + 12 * index));
    let motion = match (is_used(message, mask, 0)?, is_used(message, mask, 1)?, is_used(message, mask, 2)?) {
        (_, _, true) if mask & FORCE != 0 => return Err(SetpointRefusal::Mask),
        (true, false, false) => Motion::Position(quantity(0)),
        (false, true, false) => Motion::Velocity(quantity(1)),
        (true, true, accelerated) => Motion::PositionVelocityAcceleration {
            position: quantity(0),
            velocity: quantity(1),
            acceleration: if accelerated { quantity(2) } else { Vector3::zeros() },
        },
        _ => return Err(SetpointRefusal::Mask),
    };
    Ok(Setpoint { motion, turn: turn(message, mask)? })
}

/// Whether the mask has position (0), velocity (1) or acceleration (2) used. All three axes are, or none.
fn is_used(message: &Frame<'_>, mask: u16, index: usize) -> Result<bool, SetpointRefusal> {
    match mask >> (3 * index) & 0b111 {
        0b000 if message.are_finite(4 + 12 * index, 3) => Ok(true),
        0b000 => Err(SetpointRefusal::NotFinite),
        0b111 => Ok(false),
        _ => Err(SetpointRefusal::Mask),
    }
}

fn turn(message: &Frame<'_>, mask: u16) -> Result<Turn, SetpointRefusal> {
    let (turns, rotates) = (mask & NO_HEADING == 0, mask & NO_HEADING_RATE == 0);
    if turns && !message.are_finite(40, 1) || rotates && !message.are_finite(44, 1) {
        return Err(SetpointRefusal::NotFinite);
    }
    let (angle, rate) = (frames::heading(message.f32(40)), frames::heading_rate(message.f32(44)));
    Ok(match (turns, rotates) {
        (false, false) => Turn::Keep,
        (false, true) => Turn::Rate(rate),
        (true, _) => Turn::Angle { angle, rate: if rotates { rate } else { 0.0 } },
    })
}
