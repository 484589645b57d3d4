//! The BMI088 inertial measurement unit over SPI: power-up, data-ready, one sample at a time.
//!
//! The package holds two devices that share a bus and little else: a gyroscope and an accelerometer, each with a chip
//! select of its own. The gyroscope sets the pace: its data-ready pin INT3 rises 1000 times a second, and each rise is one
//! sample of both. Registers, waits and scales are those of the BMI088 data sheet.
//!
//! | what | setting |
//! |---|---|
//! | gyroscope | 1000 Hz, 116 Hz bandwidth, +-2000 deg/s in 16 bits |
//! | accelerometer | 1600 Hz, 145 Hz bandwidth (fourfold oversampling), +-24 g in 16 bits |
//! | bus | SPI mode 0 or 3, at most 10 MHz |
//!
//! Every sample asks both devices who they are before it believes their numbers: a bus stuck high or low would otherwise
//! read as a vehicle that does not turn. Every wait is bounded; what does not come in time is a [`Fault`]. After
//! [`RESTART_AFTER`] faults in a row the next call powers the sensor up anew, which takes a tenth of a second.

use crate::deadline::within;
use crate::hardware::{Clock, Fault, Imu};
use controller_core::flight::ImuSample;
use embedded_hal::digital::OutputPin;
use embedded_hal_async::digital::Wait;
use embedded_hal_async::spi::SpiBus;
use nalgebra::Vector3;

#[cfg(test)]
mod tests;

/// rad/s in one count: 2000 deg/s in 2^15 counts.
pub const RATE_PER_COUNT: f32 = 2000.0 / 32768.0 * core::f32::consts::PI / 180.0;

/// m/s^2 in one count: 24 standard gravities in 2^15 counts.
pub const ACCELERATION_PER_COUNT: f32 = 24.0 / 32768.0 * 9.806_65;

/// Faults in a row after which the sensor is powered up anew.
pub const RESTART_AFTER: u8 = 5;

/// The longest wait for data-ready, us: two and a half periods, so that one missed edge is no fault.
const DATA_READY_WITHIN: u64 = 2_500;

/// The longest a register access or the reading of a sample may take, us; 11 bytes at 5 MHz take 18 us.
const ACCESS_WITHIN: u64 = 500;

/// The bit of the address that makes an access a read.
const READ: u8 = 0x80;

/// Both devices hold their identity here.
const CHIP_ID: u8 = 0x00;

/// One of the two devices.
struct Device {
    /// Which chip select is its own.
    select: usize,
    /// What it calls itself.
    id: u8,
    /// Where its data start (x, y, z, low byte first).
    data: u8,
    /// Bytes of a read before the answer: the address, and for the accelerometer one that means nothing.
    lead: usize,
}

const ACCELEROMETER: Device = Device { select: 0, id: 0x1E, data: 0x12, lead: 2 };
const GYROSCOPE: Device = Device { select: 1, id: 0x0F, data: 0x02, lead: 1 };

/// Written to a device's reset register, it restarts the device.
const SOFT_RESET: u8 = 0xB6;
const ACCELEROMETER_RESET: u8 = 0x7E;
const GYROSCOPE_RESET: u8 = 0x14;

/// From power to the first access, us. It also keeps a bus that fails at once from taking all of its task's time.
const POWER_TAKES: u64 = 1_000;

/// What a step of the power-up does with its register and value.
#[derive(Clone, Copy, PartialEq)]
enum Action {
    /// Reads what means nothing.
    Wake,
    /// Reads, and expects the value.
    Expect,
    /// Writes, and waits for as many microseconds.
    Write(u16),
    /// Writes, waits, reads back.
    Set(u16),
}

use Action::{Expect, Set, Wake, Write};

/// From power to measuring. The accelerometer wakes up listening to I2C, and again after its reset; the first rise of its
/// chip select turns it to SPI. A reset takes it 1 ms and the gyroscope 30 ms, and is given a little more.
///
/// Settings of the accelerometer: ACC_PWR_CONF active, ACC_PWR_CTRL on (50 ms until it measures), ACC_CONF, ACC_RANGE. Of the
/// gyroscope: GYRO_RANGE, GYRO_BANDWIDTH, INT3 as push-pull and active high (INT4 left as it was), data-ready to INT3,
/// data-ready on. The top bit of GYRO_BANDWIDTH always reads as one, so it is written as one.
#[rustfmt::skip]
const POWER_UP: [(&Device, u8, u8, Action); 15] = [
    (&ACCELEROMETER, CHIP_ID,             0,                Wake),
    (&ACCELEROMETER, ACCELEROMETER_RESET, SOFT_RESET,       Write(2_000)),
    (&ACCELEROMETER, CHIP_ID,             0,                Wake),
    (&ACCELEROMETER, CHIP_ID,             ACCELEROMETER.id, Expect),
    (&ACCELEROMETER, 0x7C,                0x00,             Set(5_000)),
    (&ACCELEROMETER, 0x7D,                0x04,             Set(50_000)),
    (&ACCELEROMETER, 0x40,                0x8C,             Set(1_000)),
    (&ACCELEROMETER, 0x41,                0x03,             Set(1_000)),
    (&GYROSCOPE,     CHIP_ID,             GYROSCOPE.id,     Expect),
    (&GYROSCOPE,     GYROSCOPE_RESET,     SOFT_RESET,       Write(35_000)),
    (&GYROSCOPE,     0x0F,                0x00,             Set(1_000)),
    (&GYROSCOPE,     0x10,                0x82,             Set(1_000)),
    (&GYROSCOPE,     0x16,                0x0D,             Set(1_000)),
    (&GYROSCOPE,     0x18,                0x01,             Set(1_000)),
    (&GYROSCOPE,     0x15,                0x80,             Set(1_000)),
];

/// How the sensor sits in the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mounting {
    /// The sensor's axes are the body's: x forward, y left, z up.
    Aligned,
    /// The sensor's x points left, its y back, its z up.
    XLeft,
}

impl Mounting {
    /// From the sensor's axes to the body's.
    #[must_use]
    pub fn to_body(self, sensor: Vector3<f32>) -> Vector3<f32> {
        match self {
            Self::Aligned => sensor,
            Self::XLeft => Vector3::new(-sensor.y, sensor.x, sensor.z),
        }
    }
}

/// The two devices on their bus, the pin that says when, and the clock that bounds every wait.
pub struct Bmi088<B, S, P, C> {
    bus: B,
    /// Chip selects of accelerometer and gyroscope.
    selects: [S; 2],
    data_ready: P,
    clock: C,
    mounting: Mounting,
    /// Faults in a row; at [`RESTART_AFTER`] the sensor counts as not powered up.
    faults: u8,
}

impl<B: SpiBus, S: OutputPin, P: Wait, C: Clock> Bmi088<B, S, P, C> {
    /// Touches nothing yet: the first sample powers the sensor up. `selects` are those of accelerometer and gyroscope, high.
    pub fn new(bus: B, selects: [S; 2], data_ready: P, clock: C, mounting: Mounting) -> Self {
        Self { bus, selects, data_ready, clock, mounting, faults: RESTART_AFTER }
    }

    async fn power_up(&mut self) -> Result<(), Fault> {
        self.clock.until(self.clock.now() + POWER_TAKES).await;
        for (device, register, value, action) in POWER_UP {
            if let Write(settles) | Set(settles) = action {
                self.access(device, &mut [register, value]).await?;
                self.clock.until(self.clock.now() + u64::from(settles)).await;
            }
            if let Wake | Expect | Set(_) = action {
                let [found, ..] = self.read(device, register, 1).await?;
                if found != value && action != Wake {
                    return Err(Fault);
                }
            }
        }
        Ok(())
    }

    async fn measure(&mut self) -> Result<ImuSample, Fault> {
        let rising = within(&self.clock, DATA_READY_WITHIN, self.data_ready.wait_for_rising_edge());
        rising.await?.map_err(|_| Fault)?;
        let mut counted = [Vector3::zeros(); 2];
        for (device, counted) in [GYROSCOPE, ACCELEROMETER].iter().zip(&mut counted) {
            let [id, ..] = self.read(device, CHIP_ID, 1).await?;
            if id != device.id {
                return Err(Fault);
            }
            *counted = self.mounting.to_body(counts(self.read(device, device.data, 6).await?));
        }
        let [rates, accelerations] = counted;
        Ok(ImuSample {
            angular_velocity: rates * RATE_PER_COUNT,
            specific_force: accelerations * ACCELERATION_PER_COUNT,
        })
    }

    /// Reads `count` registers, at most six, from `register` on.
    async fn read(&mut self, device: &Device, register: u8, count: usize) -> Result<[u8; 6], Fault> {
        let mut bytes = [READ | register, 0, 0, 0, 0, 0, 0, 0];
        self.access(device, bytes.get_mut(..device.lead + count).ok_or(Fault)?).await?;
        let [_, early @ .., _] = bytes;
        let [_, _, late @ ..] = bytes;
        Ok(if device.lead == 1 { early } else { late })
    }

    /// Exchanges `bytes` with a device, the first of them being an address.
    async fn access(&mut self, device: &Device, bytes: &mut [u8]) -> Result<(), Fault> {
        let [accelerometer, gyroscope] = &mut self.selects;
        let select = if device.select == 0 { accelerometer } else { gyroscope };
        let _selected = Selected::new(select)?;
        let exchange = async {
            self.bus.transfer_in_place(bytes).await?;
            self.bus.flush().await
        };
        within(&self.clock, ACCESS_WITHIN, exchange).await?.map_err(|_| Fault)
    }
}

/// A device's chip select, low until this goes, however an access ends.
struct Selected<'a, S: OutputPin>(&'a mut S);

impl<'a, S: OutputPin> Selected<'a, S> {
    fn new(select: &'a mut S) -> Result<Self, Fault> {
        match select.set_low() {
            Ok(()) => Ok(Self(select)),
            Err(_) => Err(Fault),
        }
    }
}

impl<S: OutputPin> Drop for Selected<'_, S> {
    fn drop(&mut self) {
        // A pin that cannot rise shows at the next access: its device does not say who it is.
        let _ = self.0.set_high();
    }
}

impl<B: SpiBus, S: OutputPin, P: Wait, C: Clock> Imu for Bmi088<B, S, P, C> {
    async fn sample(&mut self) -> Result<ImuSample, Fault> {
        if self.faults >= RESTART_AFTER {
            self.power_up().await?;
            self.faults = 0;
        }
        let sample = self.measure().await;
        self.faults = if sample.is_ok() { 0 } else { self.faults + 1 };
        sample
    }
}

/// Three signed 16-bit numbers, low byte first.
fn counts([xl, xh, yl, yh, zl, zh]: [u8; 6]) -> Vector3<f32> {
    let [x, y, z] = [[xl, xh], [yl, yh], [zl, zh]].map(|bytes| f32::from(i16::from_le_bytes(bytes)));
    Vector3::new(x, y, z)
}
