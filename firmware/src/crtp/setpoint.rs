//! Setpoints that a client streams, turned into those of the governor.
//!
//! | port 7: kind | data | becomes |
//! |---|---|---|
//! | 0 | | stop |
//! | 1, 8 | v (m/s, world), rate of yaw | move like that |
//! | 2, 9 | roll, pitch, rate of yaw, z (m) | move as it leans, at that height |
//! | 4 | roll, pitch, rate of yaw, climb (m/s) | move as it leans, and climb |
//! | 5, 10 | v ahead and to the left (m/s), rate of yaw, z (m) | move like that, at that height |
//! | 6 | p, v, a (mm, mm/s, mm/s^2), attitude, rates (mrad/s) | follow that moving point, its x axis's heading |
//! | 7 | p (m), yaw | go there and rest |
//! | 11 | roll, pitch, rate of yaw, thrust, whether roll and pitch are rates | as port 3 |
//! | channel 1: 0 | ms (4 bytes) | no more setpoints come |
//!
//! Port 3 has roll, pitch, rate of yaw and thrust. This law flies places and velocities, no attitudes: a lean is flown
//! as the velocity that Bitcraze's position hold gives it, 1 m/s for each 30 degrees, and a thrust as the climb that
//! its altitude hold gives it, 0 at the middle of the range and 1 m/s at its ends. A thrust of 0 is a hand off the
//! stick, and no setpoint. Degrees on the line; pitch is positive with the nose up there, and the rate of yaw clockwise
//! on port 3 and in kinds 1, 2 and 5, counter-clockwise in the others. Kind 3 is another radio's channels, and refused.

use super::fields::Fields;
use super::packet::Packet;
use super::ports;
use crate::link::setpoint::Here;
use crate::words::worded;
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use nalgebra::{RealField, UnitQuaternion, Vector3};

worded! {
    /// Why a setpoint was not taken.
    pub enum SetpointRefusal {
        /// A number is NaN or infinite.
        NotFinite = "a number is not finite",
        /// It ends before its last number.
        Short = "it is cut short",
        /// A kind that is not flown.
        Kind = "of a kind that is not flown",
        /// Rates of roll and pitch.
        Rates = "no rates of roll and pitch",
        /// One that is meant from where the vehicle points, and it points straight up or down, or nobody knows.
        NotHere = "where the vehicle points is not known",
    }
}

/// What a client streams.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Streamed {
    /// Fly this.
    Setpoint(Setpoint),
    /// Stop the motors, if that is safe.
    Stop,
    /// No more setpoints come.
    End,
    /// A hand off the sticks.
    Nothing,
}

/// The velocity of a lean, m/s for each degree, and the thrust that neither climbs nor sinks, with its way to either
/// end.
const SPEED_M_PER_S_PER_DEGREE: f32 = 1.0 / 30.0;
const THRUST_MIDDLE: f32 = 32_767.0;

/// What a packet of port 3 or 7 asks for, for a vehicle that is `here`.
/// Errors: [`SetpointRefusal`] for what cannot be flown.
pub fn streamed(packet: &Packet, here: Option<&Here>) -> Result<Streamed, SetpointRefusal> {
    let mut fields = Fields::new(packet.data());
    let reader = Reader { fields: &mut fields, here };
    match (packet.port, packet.channel) {
        (ports::COMMANDER, _) => reader.sticks(-1.0),
        (ports::SETPOINT, 0) => reader.kind(),
        (ports::SETPOINT, 1) if packet.data().first() == Some(&0) => Ok(Streamed::End),
        _ => Err(SetpointRefusal::Kind),
    }
}

struct Reader<'f, 'd, 'h> {
    fields: &'f mut Fields<'d>,
    here: Option<&'h Here>,
}

impl Reader<'_, '_, '_> {
    fn number(&mut self) -> Result<f32, SetpointRefusal> {
        let number = self.fields.f32().ok_or(SetpointRefusal::Short)?;
        if number.is_finite() { Ok(number) } else { Err(SetpointRefusal::NotFinite) }
    }

    fn vector(&mut self) -> Result<Vector3<f32>, SetpointRefusal> {
        Ok(Vector3::new(self.number()?, self.number()?, self.number()?))
    }

    /// A rate of yaw, counter-clockwise with the sign that the kind has.
    fn rate(&mut self, sign: f32) -> Result<HeadingSetpoint, SetpointRefusal> {
        Ok(HeadingSetpoint::Rate(sign * self.number()?.to_radians()))
    }

    /// The velocity of a lean: to the right, and with the nose up.
    fn lean(&mut self) -> Result<Vector3<f32>, SetpointRefusal> {
        let (roll, pitch) = (self.number()?, self.number()?);
        self.turned(Vector3::new(-pitch, -roll, 0.0) * SPEED_M_PER_S_PER_DEGREE)
    }

    /// Ahead and to the left, in the world.
    fn turned(&self, level: Vector3<f32>) -> Result<Vector3<f32>, SetpointRefusal> {
        self.here.map(|here| here.turned(&level)).ok_or(SetpointRefusal::NotHere)
    }

    fn kind(mut self) -> Result<Streamed, SetpointRefusal> {
        let kind = self.fields.u8().ok_or(SetpointRefusal::Short)?;
        let sign = if matches!(kind, 1 | 2 | 5) { -1.0 } else { 1.0 };
        let (motion, turn) = match kind {
            0 => return Ok(Streamed::Stop),
            1 | 8 => (Motion::Velocity(self.vector()?), self.rate(sign)?),
            2 | 9 => {
                let (velocity, turn) = (self.lean()?, self.rate(sign)?);
                (at_height(velocity, self.number()?), turn)
            }
            4 => {
                let (velocity, turn) = (self.lean()?, self.rate(sign)?);
                (Motion::Velocity(velocity + Vector3::z() * self.number()?), turn)
            }
            5 | 10 => {
                let level = Vector3::new(self.number()?, self.number()?, 0.0);
                let (velocity, turn) = (self.turned(level)?, self.rate(sign)?);
                (at_height(velocity, self.number()?), turn)
            }
            6 => return self.full_state(),
            7 => {
                let place = self.vector()?;
                (Motion::Position(place), angle(self.number()?.to_radians(), 0.0))
            }
            11 => return self.sticks(1.0),
            _ => return Err(SetpointRefusal::Kind),
        };
        Ok(Streamed::Setpoint(Setpoint { motion, turn }))
    }

    fn full_state(self) -> Result<Streamed, SetpointRefusal> {
        let mut next = || self.fields.thousandths().ok_or(SetpointRefusal::Short);
        let (position, velocity, acceleration) = (next()?, next()?, next()?);
        let attitude = self.fields.quaternion().ok_or(SetpointRefusal::Short)?;
        let rates = self.fields.thousandths().ok_or(SetpointRefusal::Short)?;
        let ahead = UnitQuaternion::new_normalize(attitude) * Vector3::x();
        let motion = Motion::PositionVelocityAcceleration { position, velocity, acceleration };
        Ok(Streamed::Setpoint(Setpoint { motion, turn: angle(RealField::atan2(ahead.y, ahead.x), rates.z) }))
    }

    /// Roll, pitch, rate of yaw and thrust.
    fn sticks(mut self, sign: f32) -> Result<Streamed, SetpointRefusal> {
        let (roll, pitch) = (self.number()?, self.number()?);
        let turn = self.rate(sign)?;
        let thrust = self.fields.u16().ok_or(SetpointRefusal::Short)?;
        if self.fields.flag() == Some(true) {
            return Err(SetpointRefusal::Rates);
        }
        if thrust == 0 {
            return Ok(Streamed::Nothing);
        }
        let climb = (f32::from(thrust) - THRUST_MIDDLE) / THRUST_MIDDLE;
        let level = self.turned(Vector3::new(-pitch, -roll, 0.0) * SPEED_M_PER_S_PER_DEGREE)?;
        Ok(Streamed::Setpoint(Setpoint { motion: Motion::Velocity(level + Vector3::z() * climb), turn }))
    }
}

/// Across at a velocity, at a height, m.
fn at_height(velocity: Vector3<f32>, height: f32) -> Motion {
    Motion::Mixed { position: [None, None, Some(height)], velocity }
}

fn angle(angle: f32, rate: f32) -> HeadingSetpoint {
    HeadingSetpoint::Angle { angle, rate }
}

#[cfg(test)]
mod tests;
