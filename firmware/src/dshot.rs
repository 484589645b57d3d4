//! DShot300: from motor commands to the pulse widths that a timer's four channels put out.
//!
//! A frame is 16 bits, most significant first: 11 of value, one that asks for telemetry (never here), four of checksum.
//! Value 0 is the stop command, 1 to 47 are settings (never sent), 48 to 2047 turn the motor. A bit takes a 300,000th of a
//! second, high for 3/8 of it if zero and for 6/8 if one. [`Waveform`] holds one frame for each of the four channels, one
//! row a bit, in the order in which the timer's burst transfer wants them.

use crate::hardware::{Fault, MOTORS, MotorCommand};
use dshot_frame::{Command, NormalFrame};

/// Bits in a second.
pub const BIT_RATE: u32 = 300_000;

/// Bits in a frame.
pub const BITS: usize = 16;

/// Rows of a waveform: the bits, and two rows of silence. With them a waveform fills whole 16-byte blocks for 2-byte and for
/// 4-byte words, which the transfer's bursts of four need.
pub const ROWS: usize = BITS + 2;

/// Values that turn a motor, less one: from the slowest (48 on the wire) to the fastest (2047).
const STEPS: f32 = 1999.0;

/// One frame for each motor, in the motors' order.
///
/// # Errors
/// [`Fault`] if a command is not finite. A vehicle with one dead motor flies worse than it falls, so nothing but stop is
/// right for all of them.
pub fn frames(command: MotorCommand) -> Result<[NormalFrame; MOTORS], Fault> {
    let mut frames = stop();
    match command {
        MotorCommand::Stop => {}
        MotorCommand::Run(commands) => {
            for (frame, command) in frames.iter_mut().zip(commands) {
                *frame = run(command)?;
            }
        }
        MotorCommand::One { motor, level } => *frames.get_mut(motor).ok_or(Fault)? = run(level)?,
    }
    Ok(frames)
}

/// The stop command for every motor.
#[must_use]
pub fn stop() -> [NormalFrame; MOTORS] {
    [(); MOTORS].map(|()| NormalFrame::command(Command::MotorStop, false))
}

/// A frame that turns the motor: `command` 0 is the slowest speed, 1 the fastest, anything beyond is held there.
fn run(command: f32) -> Result<NormalFrame, Fault> {
    if !command.is_finite() {
        return Err(Fault);
    }
    // Saturating: below the range 0, above it the last step.
    let step = (command.clamp(0.0, 1.0) * STEPS + 0.5) as u16;
    NormalFrame::new(step, false).ok_or(Fault)
}

/// Timer ticks that a zero bit is high for, of `period` ticks a bit.
#[must_use]
pub const fn zero_width(period: u16) -> u16 {
    period / 8 * 3 + period % 8 * 3 / 8
}

/// Compare values of a timer's four channels, one row for each bit. Aligned so that no burst crosses a kilobyte.
#[repr(align(16))]
pub struct Waveform<W>([[W; MOTORS]; ROWS]);

impl<W: From<u16>> Waveform<W> {
    /// All low.
    #[must_use]
    pub fn silent() -> Self {
        Self([(); ROWS].map(|()| [(); MOTORS].map(|()| W::from(0))))
    }

    /// Draws `frames` at `period` ticks a bit, motor i on channel `channels[i]` (0 to 3).
    pub fn draw(&mut self, frames: &[NormalFrame; MOTORS], channels: &[usize; MOTORS], period: u16) {
        let zero = zero_width(period);
        for (frame, &channel) in frames.iter().zip(channels) {
            // The first to leave is the highest.
            let bits = frame.inner().reverse_bits();
            for (index, row) in self.0.iter_mut().enumerate() {
                let width = match index {
                    BITS.. => 0,
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
    #[must_use]
    pub fn words(&self) -> &[W] {
        self.0.as_flattened()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ticks of a bit on the MicoAir: 200 MHz / 300 kHz.
    const PERIOD: u16 = 666;

    fn values(command: MotorCommand) -> [u16; MOTORS] {
        frames(command).unwrap().map(|frame| frame.inner() >> 5)
    }

    /// What a controller at the end of `channel` reads: a bit is one if it is high for more than half its time.
    fn read(waveform: &Waveform<u16>, channel: usize) -> u16 {
        let rows: &[[u16; MOTORS]] = waveform.words().as_chunks().0;
        let bit = |row: &[u16; MOTORS]| u16::from(row[channel] > PERIOD / 2);
        rows[..BITS].iter().fold(0, |frame, row| frame << 1 | bit(row))
    }

    #[test]
    fn stop_is_the_value_zero_with_the_checksum_zero() {
        assert_eq!(frames(MotorCommand::Stop).unwrap().map(|frame| frame.inner()), [0; MOTORS]);
    }

    #[test]
    fn a_motor_test_turns_one_motor_and_stops_the_others() {
        assert_eq!(values(MotorCommand::One { motor: 2, level: 0.0 }), [0, 0, 48, 0]);
        assert!(frames(MotorCommand::One { motor: 4, level: 0.1 }).is_err());
        assert!(frames(MotorCommand::One { motor: 0, level: f32::NAN }).is_err());
    }

    #[test]
    fn commands_cover_48_to_2047_and_never_the_settings_between() {
        assert_eq!(values(MotorCommand::Run([0.0, 1.0, 0.5, 0.25])), [48, 2047, 1048, 548]);
        assert_eq!(values(MotorCommand::Run([-0.0, f32::MIN_POSITIVE, 1.0 - f32::EPSILON, 1.5])), [48, 48, 2047, 2047]);
        assert_eq!(values(MotorCommand::Run([-1.0, f32::MIN, f32::MAX, 2.0])), [48, 48, 2047, 2047]);
        for step in 0..=10_000 {
            let [value, ..] = values(MotorCommand::Run([step as f32 / 10_000.0; MOTORS]));
            assert!((48..=2047).contains(&value));
        }
    }

    #[test]
    fn a_command_that_is_not_finite_is_a_fault_for_all_motors() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for motor in 0..MOTORS {
                let mut commands = [0.5; MOTORS];
                commands[motor] = bad;
                assert_eq!(frames(MotorCommand::Run(commands)).err(), Some(Fault));
            }
        }
    }

    #[test]
    fn frames_carry_value_no_telemetry_and_checksum() {
        // 1046 = 0b10000010110, telemetry 0; nibbles 1000 0010 1100, their exclusive or 0110.
        let command = (1046.0 - 48.0) / STEPS;
        let [frame, ..] = frames(MotorCommand::Run([command; MOTORS])).unwrap();
        assert_eq!(frame.inner(), 0b1000_0010_1100_0110);
    }

    #[test]
    fn each_motors_frame_comes_out_of_its_channel() {
        let frames = frames(MotorCommand::Run([0.0, 0.3, 0.7, 1.0])).unwrap();
        let channels = [3, 2, 0, 1];
        let mut waveform = Waveform::silent();
        waveform.draw(&frames, &channels, PERIOD);
        for (frame, channel) in frames.iter().zip(channels) {
            assert_eq!(read(&waveform, channel), frame.inner(), "channel {channel}");
        }
    }

    #[test]
    fn ones_are_high_for_three_quarters_and_zeros_for_three_eighths() {
        let mut waveform = Waveform::<u16>::silent();
        waveform.draw(&frames(MotorCommand::Run([1.0; MOTORS])).unwrap(), &[0, 1, 2, 3], PERIOD);
        let first = f64::from(waveform.words()[0]) / f64::from(PERIOD);
        assert!((first - 0.75).abs() < 0.003, "{first}");
        waveform.draw(&stop(), &[0, 1, 2, 3], PERIOD);
        let first = f64::from(waveform.words()[0]) / f64::from(PERIOD);
        assert!((first - 0.375).abs() < 0.003, "{first}");
        assert!(waveform.words()[0].abs_diff(zero_width(PERIOD)) <= 1);
    }

    #[test]
    fn a_waveform_ends_silent_and_fills_whole_bursts() {
        let mut waveform = Waveform::<u16>::silent();
        waveform.draw(&frames(MotorCommand::Run([1.0; MOTORS])).unwrap(), &[0, 1, 2, 3], PERIOD);
        let words = waveform.words();
        assert!(words[BITS * MOTORS..].iter().all(|word| *word == 0) && words.len() == ROWS * MOTORS);
        assert_eq!(size_of_val(words) % 16, 0);
        assert_eq!(size_of_val(Waveform::<u32>::silent().words()) % 16, 0);
        assert_eq!(align_of::<Waveform<u16>>(), 16);
    }
}
