//! A board's peripherals: narrow traits, one for each part that can fail on its own.
//!
//! Boards hold pins, clocks and registers behind these and decide nothing. Times are microseconds of the board's own
//! clock since boot. The byte link is `embedded-io-async`'s `Read` and `Write`.

use crate::esc::answer::Answer;
use core::future::{Future, ready};
use estimation::imu::ImuParameters;
use flight::Word;
use nalgebra::Vector3;

/// Rotors that a board drives.
pub const MOTOR_COUNT: usize = 4;

/// The board's time.
pub trait Clock {
    /// Microseconds since boot.
    fn now(&self) -> u64;

    /// Resolves at `time` (or at once if that has passed).
    fn until(&self, time: u64) -> impl Future<Output = ()>;
}

impl<C: Clock> Clock for &C {
    fn now(&self) -> u64 {
        (*self).now()
    }

    fn until(&self, time: u64) -> impl Future<Output = ()> {
        (*self).until(time)
    }
}

/// A peripheral that did not do what it was asked to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Fault;

/// One reading of an inertial measurement unit, in body axes (x forward, y left, z up), before calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RawImu {
    /// When it was taken, us: when the sensor raised data-ready.
    pub time: u64,
    /// omega, rad/s.
    pub angular_velocity: Vector3<f32>,
    /// Specific force, m/s^2; none where the accelerometer does not answer.
    pub specific_force: Option<Vector3<f32>>,
}

/// Which of a board's sensors: each has a calibration of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// The one that flies.
    First,
    /// The one that stands by.
    Second,
}

/// An inertial measurement unit. Where a board has two, this is both of them: see [`crate::redundant`].
pub trait Imu {
    /// Waits for the next sample (about 1 kHz) and reads it.
    /// Errors: [`Fault`] if the gyro does not answer as it should; the next call tries again.
    fn sample(&mut self) -> impl Future<Output = Result<RawImu, Fault>>;

    /// What the samples are like.
    fn parameters(&self) -> ImuParameters;

    /// Whether samples are read by the clock because the sensor's data-ready edges stay away.
    fn is_polled(&self) -> bool;

    /// Whose samples these are. Once it is the second's, it stays so.
    fn unit(&self) -> Unit {
        Unit::First
    }

    /// The next sample of the sensor that stands by, if there is one. For a vehicle on the ground: it delays the
    /// other's.
    fn standby(&mut self) -> impl Future<Output = Option<Result<RawImu, Fault>>> {
        ready(None)
    }
}

/// A sensor's data-ready pin.
pub trait DataReady {
    /// Waits until it rises; when it did, us of the board's clock, however late the waiting task wakes up.
    /// Errors: [`Fault`] if the pin cannot be read.
    fn rise(&mut self) -> impl Future<Output = Result<u64, Fault>>;
}

/// The motors' command, once per control tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MotorCommand {
    /// The stop command: the only frame that a disarmed vehicle sends.
    Stop,
    /// Command of each motor, 0 (slowest) to 1 (full), in the rotors' order.
    Run([f32; MOTOR_COUNT]),
    /// One motor turns at a command from 0 to 1; the others get the stop command.
    One {
        /// Its index in the rotors' order.
        motor: usize,
        /// Its command.
        level: f32,
    },
    /// One motor's controller gets a word; the others get the stop command.
    Word {
        /// Its index in the rotors' order.
        motor: usize,
        /// The word.
        word: Word,
    },
}

impl MotorCommand {
    /// Each motor's command, 0 to 1; 0 where it stops.
    pub fn levels(&self) -> [f32; MOTOR_COUNT] {
        match *self {
            Self::Stop | Self::Word { .. } => [0.0; MOTOR_COUNT],
            Self::Run(levels) => levels,
            Self::One { motor, level } => core::array::from_fn(|index| if index == motor { level } else { 0.0 }),
        }
    }
}

/// The motors' electronic speed controllers.
pub trait Motors {
    /// Sends one frame to every motor. The caller bounds the time this may take.
    /// Errors: [`Fault`] if the frame did not go out.
    fn write(&mut self, command: MotorCommand) -> impl Future<Output = Result<(), Fault>>;

    /// What the controllers have answered to the last frame, in the rotors' order; each answer once. None where they do
    /// not answer.
    fn answers(&mut self) -> [Option<Answer>; MOTOR_COUNT] {
        [None; MOTOR_COUNT]
    }
}

/// The watchdog that stops a vehicle whose control task does not come back.
pub trait Watchdog {
    /// Gives the control task until the next deadline.
    fn feed(&mut self);
}

/// What starts the whole firmware anew.
pub trait Restart {
    /// Whether there is a bootloader that it can start in the firmware's place.
    const HAS_BOOTLOADER: bool;

    /// Starts the firmware anew. On a board this does not return.
    fn restart(&mut self);

    /// Starts the bootloader, which waits for an image. On a board this does not return.
    fn start_bootloader(&mut self);
}

/// A port that a computer's programs open and close.
pub trait Port {
    /// Whether one has it open.
    fn is_open(&self) -> bool;
}

/// The battery's voltage, where a board can measure it.
pub trait Battery {
    /// Volts; none where there is nothing to measure with.
    fn voltage(&mut self) -> impl Future<Output = Option<f32>>;
}

/// A status light.
pub trait Light {
    /// On or off.
    fn set(&mut self, on: bool);
}

/// What flash is read and written by: 512 bytes, whole words of any flash there is.
pub type Record = [u32; 128];

/// Two sectors of flash, for records in places 0 to twice [`Self::RECORDS_PER_SECTOR`]. Each call blocks until the
/// flash is done, and never without end: while it programs or erases itself, the code in it may not run anyway.
pub trait Flash {
    /// Places in a sector.
    const RECORDS_PER_SECTOR: usize;

    /// What is in a place; every bit of a blank one is set.
    /// Errors: [`Fault`] if it cannot be read, as where power failed while it was written.
    fn read(&mut self, place: usize) -> Result<Record, Fault>;

    /// Fills a place, which must be blank.
    /// Errors: [`Fault`] if the flash reports an error.
    fn write(&mut self, place: usize, record: &Record) -> Result<(), Fault>;

    /// Blanks a sector, 0 or 1.
    /// Errors: [`Fault`] if the flash reports an error.
    fn erase(&mut self, sector: usize) -> Result<(), Fault>;
}

/// Bytes of a sector of a memory card.
pub const SECTOR_BYTES: usize = 512;

/// A slot for a memory card. Each call blocks until the card is done, for seconds where a card is at odds with itself:
/// only a task that nothing waits for may hold it.
pub trait Card {
    /// Powers up the card that is in the slot now, and learns its size.
    /// Errors: [`Fault`] if no card answers.
    fn start(&mut self) -> Result<(), Fault>;

    /// How many sectors it has.
    fn sectors(&self) -> u32;

    /// Reads a sector.
    /// Errors: [`Fault`] if the card does not answer, or reports an error.
    fn read(&mut self, sector: u32, data: &mut [u8; SECTOR_BYTES]) -> Result<(), Fault>;

    /// Writes a sector. It is on the card for good once this returns.
    /// Errors: [`Fault`] if the card does not take it: the sector is as it was, as it should be, or part of both.
    fn write(&mut self, sector: u32, data: &[u8; SECTOR_BYTES]) -> Result<(), Fault>;
}
