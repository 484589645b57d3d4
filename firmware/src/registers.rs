//! Registers of a sensor behind SPI, and the way from power to measuring through them.
//!
//! An [`exchange`] is bounded in time. A power-up is a table of [`Step`]s. [`PowerUp`] does one of them at a time, when
//! its time has come, so that a task with other work meanwhile does it. A setting is written, read back a millisecond
//! later, and written again if it did not stick, up to [`TRIES`] times: the BMI088's accelerometer is known to need
//! that. Everything before a setting that failed for good is done again by the next attempt.

use crate::deadline::within;
use crate::hardware::{Clock, Fault};
use crate::spi::Device;
use nalgebra::Vector3;

/// The bit of the address that makes an access a read.
pub const READ: u8 = 0x80;

/// How often a setting is written before it counts as refused.
pub const TRIES: u8 = 8;

/// From power to the first access, us. It also keeps a bus that fails at once from taking all of its task's time.
pub const POWER_TAKES: u64 = 1_000;

/// From a write to reading it back, us.
const WRITE_TAKES: u64 = 1_000;

/// Exchanges `bytes` with `device`, within `limit`, us. The first of them is an address.
///
/// # Errors
/// [`Fault`] if bus or chip select fail, or it takes longer.
pub async fn exchange(device: &mut impl Device, clock: &impl Clock, limit: u64, bytes: &mut [u8]) -> Result<(), Fault> {
    within(clock, limit, device.exchange(bytes)).await?
}

/// Three signed 16-bit numbers, low byte first.
#[must_use]
pub fn counts([xl, xh, yl, yh, zl, zh]: [u8; 6]) -> Vector3<f32> {
    let [x, y, z] = [[xl, xh], [yl, yh], [zl, zh]].map(|bytes| f32::from(i16::from_le_bytes(bytes)));
    Vector3::new(x, y, z)
}

/// One device's registers.
pub trait Registers {
    /// Reads one.
    async fn read(&mut self, register: u8) -> Result<u8, Fault>;

    /// Writes one, or several bytes to one.
    async fn write(&mut self, register: u8, bytes: &[u8]) -> Result<(), Fault>;
}

/// What a step of the power-up does with its register and value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// Reads what means nothing.
    Wake,
    /// Reads, and expects the value in these bits.
    Expect(u8),
    /// Writes, and waits for as many microseconds.
    Write(u16),
    /// Writes, reads back, and waits.
    Set(u16),
    /// Writes these bytes in the value's place.
    Upload(&'static [u8]),
}

/// Register, value, and what to do with them.
pub type Step = (u8, u8, Action);

/// A power-up under way, or done.
#[derive(Debug)]
pub struct PowerUp {
    steps: &'static [Step],
    next: usize,
    /// The next step's setting was written and is to be read back.
    written: bool,
    tries: u8,
    not_before: u64,
}

impl PowerUp {
    /// Begins at `time`, us.
    pub fn new(steps: &'static [Step], time: u64) -> Self {
        Self { steps, next: 0, written: false, tries: 0, not_before: time }
    }

    /// Begins anew at `time`, us.
    pub fn restart(&mut self, time: u64) {
        *self = Self::new(self.steps, time);
    }

    /// Whether the device measures: every step is done, and has had its time.
    pub fn is_done(&self, now: u64) -> bool {
        self.next >= self.steps.len() && now >= self.not_before
    }

    /// When there is something to do, us.
    pub fn due(&self) -> u64 {
        self.not_before
    }

    /// Does what is due.
    ///
    /// # Errors
    /// [`Fault`] if the device does not do what it should; it is begun anew then, no sooner than [`POWER_TAKES`] from
    /// now.
    pub async fn advance(&mut self, device: &mut impl Registers, clock: &impl Clock) -> Result<(), Fault> {
        let Some(step) = self.steps.get(self.next).filter(|_| clock.now() >= self.not_before) else { return Ok(()) };
        let done = self.act(step, device, clock).await;
        if done.is_err() {
            self.restart(clock.now() + POWER_TAKES);
        }
        done
    }

    async fn act(
        &mut self,
        &(register, value, action): &Step,
        device: &mut impl Registers,
        clock: &impl Clock,
    ) -> Result<(), Fault> {
        let settles = match action {
            Action::Wake => {
                device.read(register).await?;
                0
            }
            Action::Expect(bits) => {
                let found = device.read(register).await?;
                if found & bits != value {
                    return Err(Fault);
                }
                0
            }
            Action::Write(settles) => {
                device.write(register, &[value]).await?;
                settles
            }
            Action::Upload(bytes) => {
                device.write(register, bytes).await?;
                0
            }
            Action::Set(_) if !self.written => {
                self.written = true;
                // One that fails does not read back.
                let _ = device.write(register, &[value]).await;
                self.not_before = clock.now() + WRITE_TAKES;
                return Ok(());
            }
            Action::Set(settles) => {
                self.written = false;
                if device.read(register).await != Ok(value) {
                    self.tries += 1;
                    return if self.tries < TRIES { Ok(()) } else { Err(Fault) };
                }
                settles
            }
        };
        (self.next, self.tries) = (self.next + 1, 0);
        self.not_before = clock.now() + u64::from(settles);
        Ok(())
    }
}
