//! Registers of a sensor behind SPI, and the way from power to measuring through them.
//!
//! An [`exchange`] is bounded in time. A power-up is a table of [`Step`]s. [`PowerUp`] does one of them at a time, when
//! its time has come, so that a task with other work meanwhile does it. A setting is written, read back a millisecond
//! later, and written again if it did not stick, up to [`WRITE_ATTEMPTS_MAX`] times: the BMI088's accelerometer is
//! known to need that. Everything before a setting that failed for good is done again by the next attempt. After
//! [`RESTART_AFTER_FAILURES`] faulty measurements in a row it is all done again.

use crate::deadline::within;
use crate::hardware::{Clock, Fault};
use crate::spi::Device;
use nalgebra::Vector3;

/// The bit of the address that makes an access a read.
pub const READ_BIT: u8 = 0x80;

/// How often a setting is written before it counts as refused.
pub const WRITE_ATTEMPTS_MAX: u8 = 8;

/// Faults in a row after which a device is powered up anew.
pub const RESTART_AFTER_FAILURES: u8 = 5;

/// The longest a register access or the reading of a sample may take; 14 bytes at 5 MHz take 22 us.
pub const ACCESS_TIMEOUT_US: u64 = 500;

/// The longest a power-up may take.
pub const POWER_UP_TIMEOUT_US: u64 = 150_000;

/// rad/s in one count of a gyroscope: 2000 deg/s in 2^15 counts.
pub const RATE_PER_COUNT: f32 = 2000.0 / 32768.0 * core::f32::consts::PI / 180.0;

/// From power to the first access. It also keeps a bus that fails at once from taking all of its task's time.
pub const POWER_DELAY_US: u64 = 1_000;

/// From a write to reading it back.
const WRITE_DELAY_US: u64 = 1_000;

/// Exchanges `bytes` with `device`, within `limit`, us. The first of them is an address.
/// Errors: [`Fault`] if bus or chip select fail, or it takes longer.
pub async fn exchange(device: &mut impl Device, clock: &impl Clock, limit: u64, bytes: &mut [u8]) -> Result<(), Fault> {
    within(clock, limit, device.exchange(bytes)).await?
}

/// Reads `N` bytes from `register` on, of which the first means nothing.
/// Errors: as [`exchange`]'s, within [`ACCESS_TIMEOUT_US`].
pub async fn read_many<const N: usize>(
    device: &mut impl Device,
    clock: &impl Clock,
    register: u8,
) -> Result<[u8; N], Fault> {
    let mut bytes = [0; N];
    *bytes.first_mut().ok_or(Fault)? = READ_BIT | register;
    exchange(device, clock, ACCESS_TIMEOUT_US, &mut bytes).await?;
    Ok(bytes)
}

/// m/s^2 in one count of an accelerometer: so many standard gravities in 2^15 counts.
pub const fn acceleration_per_count(gravities: f32) -> f32 {
    gravities / 32768.0 * 9.806_65
}

/// Three signed 16-bit numbers, low byte first.
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
    /// Faulty measurements in a row.
    faults: u8,
}

impl PowerUp {
    /// Begins at `time`, us.
    pub fn new(steps: &'static [Step], time: u64) -> Self {
        Self { steps, next: 0, written: false, tries: 0, not_before: time, faults: 0 }
    }

    /// Begins anew at `time`, us.
    pub fn restart(&mut self, time: u64) {
        *self = Self::new(self.steps, time);
    }

    /// Counts a measurement, and begins anew at `time`, us, after too many faults.
    /// Errors: the measurement's.
    pub fn judge<T>(&mut self, measured: Result<T, Fault>, time: u64) -> Result<T, Fault> {
        self.faults = if measured.is_ok() { 0 } else { self.faults + 1 };
        if self.faults >= RESTART_AFTER_FAILURES {
            self.restart(time);
        }
        measured
    }

    /// Does everything that is left, within [`POWER_UP_TIMEOUT_US`].
    /// Errors: as [`Self::advance`]'s, or if it takes longer.
    pub async fn complete(&mut self, device: &mut impl Registers, clock: &impl Clock) -> Result<(), Fault> {
        let end = clock.now() + POWER_UP_TIMEOUT_US;
        while !self.is_done(clock.now()) {
            if self.due() > end {
                return Err(Fault);
            }
            clock.until(self.due()).await;
            self.advance(device, clock).await?;
        }
        Ok(())
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
    /// Errors: [`Fault`] if the device does not do what it should; it is begun anew then, no sooner than
    /// [`POWER_DELAY_US`] from now.
    pub async fn advance(&mut self, device: &mut impl Registers, clock: &impl Clock) -> Result<(), Fault> {
        let Some(step) = self.steps.get(self.next).filter(|_| clock.now() >= self.not_before) else { return Ok(()) };
        let done = self.act(step, device, clock).await;
        if done.is_err() {
            self.restart(clock.now() + POWER_DELAY_US);
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
                self.not_before = clock.now() + WRITE_DELAY_US;
                return Ok(());
            }
            Action::Set(settles) => {
                self.written = false;
                if device.read(register).await != Ok(value) {
                    self.tries += 1;
                    return if self.tries < WRITE_ATTEMPTS_MAX { Ok(()) } else { Err(Fault) };
                }
                settles
            }
        };
        (self.next, self.tries) = (self.next + 1, 0);
        self.not_before = clock.now() + u64::from(settles);
        Ok(())
    }
}
