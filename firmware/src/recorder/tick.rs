//! The record of a control tick, and its ULog format.
//!
//! World frame z up, body frame x forward, y left, z up, SI units, as everywhere in the firmware; what is not known is
//! NaN.

use crate::esc::controller::RotorSpeeds;
use crate::hardware::MotorCommand;
use controller_core::reference::Reference;
use controller_core::state::{State, Wrench};
use flight::Mode;
use nalgebra::Vector3;

/// The fields of a record in the order of [`Tick::to_bytes`], in ULog's words. The longest first: ULog knows no gaps.
pub const FORMAT: &str = "tick:uint64_t timestamp;float[3] position;float[3] velocity;float[4] attitude;\
float[3] angular_velocity;float[3] reference_position;float[3] reference_velocity;float thrust;float[3] torque;\
float[4] motors;float[4] rotor_speeds;float voltage;float thrust_scale;float pose_age;uint16_t missed_ticks;uint8_t mode;uint8_t airborne;";

/// Bytes of a record.
pub const TICK_BYTES: usize = 8 + 4 * 34 + 2 + 1 + 1;

/// One control tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tick {
    /// us since the start.
    pub time: u64,
    /// The mode that the tick left the vehicle in.
    pub mode: Mode,
    /// Whether it has left the ground.
    pub is_airborne: bool,
    /// Where it is and how it moves, as it is estimated.
    pub state: Option<State>,
    /// The reference, and the commanded wrench.
    pub reference: Option<Reference>,
    /// See [`Self::reference`].
    pub wrench: Option<Wrench>,
    /// What the rotors are believed to give of it.
    pub thrust_scale: Option<f32>,
    /// The age of the last pose that was believed, us.
    pub pose_age: Option<u64>,
    /// Ticks that were missed since boot.
    pub missed: u32,
    /// The motors' command.
    pub command: MotorCommand,
    /// How fast the rotors turn, rad/s, as their controllers answered of late.
    pub rotor_speeds: RotorSpeeds,
    /// The battery, V, if it is known.
    pub voltage: Option<f32>,
}

impl Tick {
    /// The record.
    pub fn to_bytes(&self) -> [u8; TICK_BYTES] {
        let mut record = Writer { bytes: [0; TICK_BYTES], at: 0 };
        record.put(&self.time.to_le_bytes());
        let state = self.state.as_ref();
        record.vector(state.map(|state| &state.position));
        record.vector(state.map(|state| &state.velocity));
        record.floats(state.map_or([f32::NAN; 4], |state| {
            let q = &state.attitude;
            [q.w, q.i, q.j, q.k]
        }));
        record.vector(state.map(|state| &state.angular_velocity));
        record.vector(self.reference.as_ref().map(|reference| &reference.position));
        record.vector(self.reference.as_ref().map(|reference| &reference.velocity));
        record.floats([self.wrench.map_or(f32::NAN, |wrench| wrench.thrust)]);
        record.vector(self.wrench.as_ref().map(|wrench| &wrench.torque));
        record.floats(self.command.levels());
        record.floats(self.rotor_speeds.map(|speed| speed.unwrap_or(f32::NAN)));
        record.floats([
            self.voltage.unwrap_or(f32::NAN),
            self.thrust_scale.unwrap_or(f32::NAN),
            self.pose_age.map_or(f32::NAN, |age| age as f32 * 1e-6),
        ]);
        record.put(&u16::try_from(self.missed).unwrap_or(u16::MAX).to_le_bytes());
        record.put(&[self.mode as u8, u8::from(self.is_airborne)]);
        record.bytes
    }
}

/// Bytes one after the other.
struct Writer {
    bytes: [u8; TICK_BYTES],
    at: usize,
}

impl Writer {
    fn put(&mut self, bytes: &[u8]) {
        let to = self.bytes.iter_mut().skip(self.at);
        to.zip(bytes).for_each(|(to, from)| *to = *from);
        self.at += bytes.len();
    }

    fn floats<const N: usize>(&mut self, numbers: [f32; N]) {
        numbers.iter().for_each(|number| self.put(&number.to_le_bytes()));
    }

    fn vector(&mut self, vector: Option<&Vector3<f32>>) {
        self.floats(vector.map_or([f32::NAN; 3], |vector| (*vector).into()));
    }
}

#[cfg(test)]
mod tests;
