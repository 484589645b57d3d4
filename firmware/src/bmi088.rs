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

use crate::deadline;
use crate::hardware::{Clock, Fault, Imu};
use controller_core::flight::ImuSample;
use core::future::Future;
use embedded_hal_async::digital::Wait;
use embedded_hal_async::spi::SpiDevice;
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

/// What the accelerometer calls itself, and where its data start (x, y, z, low byte first).
const ACCELEROMETER_ID: u8 = 0x1E;
const ACCELEROMETER_DATA: u8 = 0x12;

/// What the gyroscope calls itself, and where its data start (x, y, z, low byte first).
const GYROSCOPE_ID: u8 = 0x0F;
const GYROSCOPE_DATA: u8 = 0x02;

/// Written to a device's reset register, it restarts the device.
const SOFT_RESET: u8 = 0xB6;
const ACCELEROMETER_RESET: u8 = 0x7E;
const GYROSCOPE_RESET: u8 = 0x14;

/// From power to the first access, us. It also keeps a bus that fails at once from taking all of its task's time.
const POWER_TAKES: u64 = 1_000;

/// After a reset: 1 ms for the accelerometer, 30 ms for the gyroscope, and a little more, us.
const ACCELEROMETER_RESET_TAKES: u64 = 2_000;
const GYROSCOPE_RESET_TAKES: u64 = 35_000;

/// A register, what it is set to, and how long the device then needs, us.
struct Setting {
    register: u8,
    value: u8,
    settles: u64,
}

const fn setting(register: u8, value: u8, settles: u64) -> Setting {
    Setting { register, value, settles }
}

/// From suspended to measuring: ACC_PWR_CONF active, ACC_PWR_CTRL on (50 ms until it measures), ACC_CONF, ACC_RANGE.
const ACCELEROMETER_SETTINGS: [Setting; 4] =
    [setting(0x7C, 0x00, 5_000), setting(0x7D, 0x04, 50_000), setting(0x40, 0x8C, 1_000), setting(0x41, 0x03, 1_000)];

/// GYRO_RANGE, GYRO_BANDWIDTH, INT3 as push-pull and active high (INT4 left as it was), data-ready to INT3, data-ready on.
/// The top bit of GYRO_BANDWIDTH always reads as one, so it is written as one.
const GYROSCOPE_SETTINGS: [Setting; 5] = [
    setting(0x0F, 0x00, 1_000),
    setting(0x10, 0x82, 1_000),
    setting(0x16, 0x0D, 1_000),
    setting(0x18, 0x01, 1_000),
    setting(0x15, 0x80, 1_000),
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

/// The two devices, the pin that says when, and the clock that bounds every wait.
pub struct Bmi088<A, G, P, C> {
    accelerometer: A,
    gyroscope: G,
    data_ready: P,
    clock: C,
    mounting: Mounting,
    /// Faults in a row; at [`RESTART_AFTER`] the sensor counts as not powered up.
    faults: u8,
}

impl<A: SpiDevice, G: SpiDevice, P: Wait, C: Clock> Bmi088<A, G, P, C> {
    /// Touches nothing yet: the first sample powers the sensor up.
    pub fn new(accelerometer: A, gyroscope: G, data_ready: P, clock: C, mounting: Mounting) -> Self {
        Self { accelerometer, gyroscope, data_ready, clock, mounting, faults: RESTART_AFTER }
    }

    async fn power_up(&mut self) -> Result<(), Fault> {
        self.wait(POWER_TAKES).await;
        // The accelerometer wakes up listening to I2C, and again after its reset; the first rise of its chip select turns
        // it to SPI. What that access reads means nothing.
        self.accelerometer_register(CHIP_ID).await?;
        self.accelerometer_write(ACCELEROMETER_RESET, SOFT_RESET).await?;
        self.wait(ACCELEROMETER_RESET_TAKES).await;
        self.accelerometer_register(CHIP_ID).await?;
        expect(self.accelerometer_register(CHIP_ID).await?, ACCELEROMETER_ID)?;
        for Setting { register, value, settles } in ACCELEROMETER_SETTINGS {
            self.accelerometer_write(register, value).await?;
            self.wait(settles).await;
            expect(self.accelerometer_register(register).await?, value)?;
        }

        expect(self.gyroscope_register(CHIP_ID).await?, GYROSCOPE_ID)?;
        self.gyroscope_write(GYROSCOPE_RESET, SOFT_RESET).await?;
        self.wait(GYROSCOPE_RESET_TAKES).await;
        for Setting { register, value, settles } in GYROSCOPE_SETTINGS {
            self.gyroscope_write(register, value).await?;
            self.wait(settles).await;
            expect(self.gyroscope_register(register).await?, value)?;
        }
        Ok(())
    }

    async fn measure(&mut self) -> Result<ImuSample, Fault> {
        within(&self.clock, DATA_READY_WITHIN, self.data_ready.wait_for_rising_edge()).await?;
        expect(self.gyroscope_register(CHIP_ID).await?, GYROSCOPE_ID)?;
        // Address, then six bytes.
        let mut rates = [READ | GYROSCOPE_DATA, 0, 0, 0, 0, 0, 0];
        within(&self.clock, ACCESS_WITHIN, self.gyroscope.transfer_in_place(&mut rates)).await?;
        expect(self.accelerometer_register(CHIP_ID).await?, ACCELEROMETER_ID)?;
        // Address, a byte that means nothing, then six bytes.
        let mut accelerations = [READ | ACCELEROMETER_DATA, 0, 0, 0, 0, 0, 0, 0];
        within(&self.clock, ACCESS_WITHIN, self.accelerometer.transfer_in_place(&mut accelerations)).await?;
        let [_, rates @ ..] = rates;
        let [_, _, accelerations @ ..] = accelerations;
        Ok(ImuSample {
            angular_velocity: self.mounting.to_body(counts(rates) * RATE_PER_COUNT),
            specific_force: self.mounting.to_body(counts(accelerations) * ACCELERATION_PER_COUNT),
        })
    }

    async fn accelerometer_register(&mut self, register: u8) -> Result<u8, Fault> {
        let mut bytes = [READ | register, 0, 0];
        within(&self.clock, ACCESS_WITHIN, self.accelerometer.transfer_in_place(&mut bytes)).await?;
        let [_, _, value] = bytes;
        Ok(value)
    }

    async fn accelerometer_write(&mut self, register: u8, value: u8) -> Result<(), Fault> {
        within(&self.clock, ACCESS_WITHIN, self.accelerometer.write(&[register, value])).await
    }

    async fn gyroscope_register(&mut self, register: u8) -> Result<u8, Fault> {
        let mut bytes = [READ | register, 0];
        within(&self.clock, ACCESS_WITHIN, self.gyroscope.transfer_in_place(&mut bytes)).await?;
        let [_, value] = bytes;
        Ok(value)
    }

    async fn gyroscope_write(&mut self, register: u8, value: u8) -> Result<(), Fault> {
        within(&self.clock, ACCESS_WITHIN, self.gyroscope.write(&[register, value])).await
    }

    async fn wait(&self, duration: u64) {
        self.clock.until(self.clock.now() + duration).await;
    }
}

impl<A: SpiDevice, G: SpiDevice, P: Wait, C: Clock> Imu for Bmi088<A, G, P, C> {
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

/// What an access comes to within `limit` us, all errors being alike.
async fn within<T, E>(clock: &impl Clock, limit: u64, access: impl Future<Output = Result<T, E>>) -> Result<T, Fault> {
    deadline::within(clock, limit, access).await?.map_err(|_| Fault)
}

fn expect(found: u8, wanted: u8) -> Result<(), Fault> {
    if found == wanted { Ok(()) } else { Err(Fault) }
}

/// Three signed 16-bit numbers, low byte first.
fn counts([xl, xh, yl, yh, zl, zh]: [u8; 6]) -> Vector3<f32> {
    let [x, y, z] = [[xl, xh], [yl, yh], [zl, zh]].map(|bytes| f32::from(i16::from_le_bytes(bytes)));
    Vector3::new(x, y, z)
}
