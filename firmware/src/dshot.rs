//! DShot300: from motor commands to the pulse widths that timers' four channels put out.
//!
//! A frame is 16 bits, most significant first: 11 of value, one that requests telemetry (set in words alone: they are
//! ignored without), four of checksum. Value 0 is the stop command, 1 to 47 are words to a controller whose motor
//! stands still, 48 to 2047 turn the motor. A bit takes a 300,000th of a second, high for 3/8 of it if zero and for 6/8
//! if one. [`Waveform`] holds a frame for each of a timer's four channels, one row a bit, in the order in which its
//! burst transfer wants them. Channels without a motor stay low.
//!
//! *Both ways* (bidirectional DShot, [`Protocol::BothWays`]) the line rests high, pulses are low and the checksum is
//! inverted, by which a controller knows that it is to answer each frame on the same line: [`crate::esc`].

use crate::hardware::{Fault, MOTOR_COUNT, MotorCommand};
use dshot_frame::{Command, NormalFrame};
use flight::Word;

/// Bits in a second.
pub const BIT_RATE_HZ: u32 = 300_000;

/// Bits in a frame.
pub const FRAME_BITS: usize = 16;

/// Rows of a waveform: the bits, and two rows of silence. With them a waveform fills whole 16-byte blocks for 2-byte
/// and for 4-byte words, which the transfer's bursts of four need.
pub const WAVEFORM_ROWS: usize = FRAME_BITS + 2;

/// Values that turn a motor, less one: from the slowest (48 on the wire) to the fastest (2047).
const THROTTLE_STEPS: f32 = 1999.0;

/// How controllers are spoken to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Protocol {
    /// They listen.
    #[default]
    Plain,
    /// They answer each frame.
    BothWays,
}

impl Protocol {
    /// The checksum's bits that differ from a plain frame's.
    const fn inverted(self) -> u16 {
        match self {
            Self::Plain => 0,
            Self::BothWays => 0xF,
        }
    }

    /// The bits of a frame, the first to leave highest.
    fn bits(self, frame: &NormalFrame) -> u16 {
        frame.inner() ^ self.inverted()
    }

    /// The bits of the stop frame: zeros, its plain checksum included.
    pub const fn stop_bits(self) -> u16 {
        self.inverted()
    }
}

/// One frame for each motor, in the motors' order.
/// Errors: [`Fault`] if a command is not finite. A vehicle with one dead motor flies worse than it falls, so nothing
/// but stop is right for all of them.
pub fn frames(command: MotorCommand) -> Result<[NormalFrame; MOTOR_COUNT], Fault> {
    let mut frames = stop();
    match command {
        MotorCommand::Stop => {}
        MotorCommand::Run(commands) => {
            for (frame, command) in frames.iter_mut().zip(commands) {
                *frame = run(command)?;
            }
        }
        MotorCommand::One { motor, level } => *frames.get_mut(motor).ok_or(Fault)? = run(level)?,
        MotorCommand::Word { motor, word } => *frames.get_mut(motor).ok_or(Fault)? = word_frame(word),
    }
    Ok(frames)
}

/// The stop command for every motor.
pub fn stop() -> [NormalFrame; MOTOR_COUNT] {
    [(); MOTOR_COUNT].map(|()| NormalFrame::command(Command::MotorStop, false))
}

/// The frame that asks a controller for extended answers, and stops its motor.
pub fn extend() -> NormalFrame {
    NormalFrame::command(Command::ExtendedTelemetryEnable, true)
}

/// The frame of a word to a controller.
fn word_frame(word: Word) -> NormalFrame {
    let command = match word {
        Word::Beep => Command::Beep1,
        Word::Normal => Command::SpinDirectionNormal,
        Word::Reversed => Command::SpinDirectionReversed,
        Word::Save => Command::SettingsSave,
    };
    NormalFrame::command(command, true)
}

/// A frame that turns the motor: `command` 0 is the slowest speed, 1 the fastest, anything beyond is held there.
fn run(command: f32) -> Result<NormalFrame, Fault> {
    if !command.is_finite() {
        return Err(Fault);
    }
    // Saturating: below the range 0, above it the last step.
    let step = (command.clamp(0.0, 1.0) * THROTTLE_STEPS + 0.5) as u16;
    NormalFrame::new(step, false).ok_or(Fault)
}

/// Timer ticks that a zero bit is high for, of `period` ticks a bit.
pub const fn zero_width(period: u16) -> u16 {
    period / 8 * 3 + period % 8 * 3 / 8
}

/// Compare values of a timer's four channels, one row for each bit. Aligned so that no burst crosses a kilobyte.
#[repr(align(16))]
pub struct Waveform<W>([[W; MOTOR_COUNT]; WAVEFORM_ROWS]);

impl<W: From<u16>> Waveform<W> {
    /// All low.
    pub fn silent() -> Self {
        Self([(); WAVEFORM_ROWS].map(|()| [(); MOTOR_COUNT].map(|()| W::from(0))))
    }

    /// Draws `frames` at `period` ticks a bit, motor i on channel `channels[i]` (0 to 3) or on none of this timer's.
    /// Both ways the pulses are those of an output that is inverted.
    pub fn draw(
        &mut self,
        frames: &[NormalFrame; MOTOR_COUNT],
        protocol: Protocol,
        channels: &[Option<u8>; MOTOR_COUNT],
        period: u16,
    ) {
        let zero = zero_width(period);
        for (frame, &channel) in frames.iter().zip(channels) {
            let Some(channel) = channel.map(usize::from) else { continue };
            // The first to leave is the highest.
            let bits = protocol.bits(frame).reverse_bits();
            for (index, row) in self.0.iter_mut().enumerate() {
                let width = match index {
                    FRAME_BITS.. => 0,
                    _ if (bits >> index) & 1 == 1 => 2 * zero,
                    _ => zero,
                };
                if let Some(word) = row.get_mut(channel) {
                    *word = W::from(width);
                }
            }
        }
    }

    /// The words in the order of transfer.
    pub fn words(&self) -> &[W] {
        self.0.as_flattened()
    }
}

#[cfg(test)]
mod tests;
