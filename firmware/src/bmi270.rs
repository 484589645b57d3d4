//! The BMI270 inertial measurement unit over SPI: power-up with its configuration file, data-ready, one sample at a
//! time.
//!
//! One device with gyroscope and accelerometer, which measures only after a file was written into it
//! ([`CONFIGURATION`]). Its data-ready pin INT1 rises 1600 times a second: it has no 1000 Hz. Registers, waits and
//! scales are those of the BMI270 data sheet.
//!
//! | what | setting |
//! |---|---|
//! | gyroscope | 1600 Hz, fourfold oversampling (about 94 Hz), low noise, +-2000 deg/s in 16 bits |
//! | accelerometer | 1600 Hz, fourfold oversampling (188 Hz), +-16 g in 16 bits |
//! | bus | SPI mode 0 or 3, at most 10 MHz; a byte that means nothing comes before each answer |
//!
//! The gyroscope's x feels its z a little; the device knows how much, and the data sheet leaves the correction to the
//! reader: omega_x = x - zx z / 512, zx being a signed number of 7 bits.
//!
//! Every sample reads the chip's identity. Every wait is bounded. What does not come in time is a [`Fault`]; after
//! several in a row the next call powers the sensor up anew, which takes about 90 ms.

use crate::hardware::{Clock, DataReady, Fault, Imu, RawImu};
use crate::mounting::Mounting;
use crate::pace::Pace;
use crate::registers::Action::{Expect, Set, Upload, Wake, Write};
use crate::registers::{
    POWER_DELAY_US, PowerUp, RATE_PER_COUNT, Registers, Step, acceleration_per_count, counts, exchange, read_many,
};
use crate::spi;
use estimation::imu::ImuParameters;

#[cfg(test)]
mod tests;

/// What the device runs: Bosch Sensortec's own, its smallest ("maximum FIFO"), which measures and recognises no
/// gestures. Under the BSD-3-Clause licence, copyright (c) 2023 Bosch Sensortec GmbH:
/// `firmware/licences/BMI270_SensorAPI.txt`.
pub const CONFIGURATION: &[u8; 328] = include_bytes!("bmi270/configuration.bin");

/// m/s^2 in one count, at 16 g.
pub const ACCELERATION_PER_COUNT: f32 = acceleration_per_count(16.0);

/// Time between samples.
const SAMPLE_PERIOD_US: u64 = 625;

/// The longest that writing the file may take; at 5 MHz it takes 530 us.
const UPLOAD_TIMEOUT_US: u64 = 2_000;

const CHIP_ID: u8 = 0x00;
const CHIP_ID_BMI270: u8 = 0x24;

/// Where the data start: x, y, z of the accelerometer, then of the gyroscope, low byte first.
const DATA_REGISTER: u8 = 0x0C;

/// Where the file leaves how much of z the gyroscope's x feels.
const CROSS_SENSITIVITY: u8 = 0x1E;

/// It wakes up listening to I2C, and again after its reset; the first rise of its chip select turns it to SPI. A reset
/// takes 2 ms. Then: PWR_CONF without power save, which the file needs; INIT_CTRL 0, INIT_ADDR 0, INIT_DATA the file,
/// INIT_CTRL 1; INTERNAL_STATUS reports within 20 ms that the file runs. Settings: ACC_CONF, ACC_RANGE, GYR_CONF,
/// GYR_RANGE, INT1 as push-pull and active high, not latched, data-ready to INT1; PWR_CTRL on, after which the
/// gyroscope takes 45 ms.
const POWER_UP: [Step; 19] = [
    (CHIP_ID, 0, Wake),
    (0x7E, 0xB6, Write(2_000)),
    (CHIP_ID, 0, Wake),
    (CHIP_ID, CHIP_ID_BMI270, Expect(0xFF)),
    (0x7C, 0x00, Set(1_000)),
    (0x59, 0x00, Write(0)),
    (0x5B, 0x00, Write(0)),
    (0x5C, 0x00, Write(0)),
    (0x5E, 0, Upload(CONFIGURATION)),
    (0x59, 0x01, Write(20_000)),
    (0x21, 0x01, Expect(0x0F)),
    (0x40, 0x8C, Set(0)),
    (0x41, 0x03, Set(0)),
    (0x42, 0xCC, Set(0)),
    (0x43, 0x00, Set(0)),
    (0x53, 0x0A, Set(0)),
    (0x55, 0x00, Set(0)),
    (0x58, 0x04, Set(0)),
    (0x7D, 0x06, Set(50_000)),
];

/// The device and the clock.
struct Port<'a, D, C> {
    spi: &'a mut D,
    clock: &'a C,
}

impl<D: spi::Device, C: Clock> Registers for Port<'_, D, C> {
    async fn read(&mut self, register: u8) -> Result<u8, Fault> {
        let [_, _, value] = read_many(self.spi, self.clock, register).await?;
        Ok(value)
    }

    async fn write(&mut self, register: u8, bytes: &[u8]) -> Result<(), Fault> {
        // DMA takes it from RAM.
        let mut all = [0; 1 + CONFIGURATION.len()];
        let used = all.get_mut(..=bytes.len()).ok_or(Fault)?;
        if let [address, rest @ ..] = used {
            *address = register;
            rest.copy_from_slice(bytes);
        }
        exchange(self.spi, self.clock, UPLOAD_TIMEOUT_US, used).await
    }
}

/// The device, the data-ready pin, and the clock that bounds every wait.
pub struct Bmi270<D, P, C> {
    spi: D,
    clock: C,
    pace: Pace<P>,
    mounting: &'static Mounting,
    power_up: PowerUp,
    /// What the gyroscope's x feels of its z; none before it was read.
    cross_sensitivity: Option<f32>,
}

impl<D: spi::Device, P: DataReady, C: Clock> Bmi270<D, P, C> {
    /// Touches nothing yet: the first sample powers the sensor up.
    pub fn new(spi: D, data_ready: P, clock: C, mounting: &'static Mounting) -> Self {
        let power_up = PowerUp::new(&POWER_UP, clock.now() + POWER_DELAY_US);
        let pace = Pace::new(data_ready, SAMPLE_PERIOD_US);
        Self { spi, clock, pace, mounting, power_up, cross_sensitivity: None }
    }

    fn port(&mut self) -> Port<'_, D, C> {
        Port { spi: &mut self.spi, clock: &self.clock }
    }

    /// Powers it up, if it is not, and reads the gyroscope's cross-sensitivity of x to z.
    async fn ready(&mut self) -> Result<f32, Fault> {
        if let Some(known) = self.cross_sensitivity {
            return Ok(known);
        }
        let Self { spi, clock, power_up, .. } = self;
        power_up.complete(&mut Port { spi, clock }, clock).await?;
        let bits = self.port().read(CROSS_SENSITIVITY).await?;
        // Seven bits, the highest of them the sign.
        let known = f32::from(((bits << 1) as i8) >> 1) / 512.0;
        Ok(*self.cross_sensitivity.insert(known))
    }

    async fn measure(&mut self, cross_sensitivity: f32) -> Result<RawImu, Fault> {
        let time = self.pace.next(&self.clock).await;
        if self.port().read(CHIP_ID).await? != CHIP_ID_BMI270 {
            return Err(Fault);
        }
        let [_, _, a0, a1, a2, a3, a4, a5, g0, g1, g2, g3, g4, g5] =
            read_many(&mut self.spi, &self.clock, DATA_REGISTER).await?;
        let mut rates = counts([g0, g1, g2, g3, g4, g5]);
        rates.x -= cross_sensitivity * rates.z;
        let accelerations = counts([a0, a1, a2, a3, a4, a5]);
        Ok(RawImu {
            time,
            angular_velocity: self.mounting.to_body(rates) * RATE_PER_COUNT,
            specific_force: Some(self.mounting.to_body(accelerations) * ACCELERATION_PER_COUNT),
        })
    }
}

impl<D: spi::Device, P: DataReady, C: Clock> Imu for Bmi270<D, P, C> {
    async fn sample(&mut self) -> Result<RawImu, Fault> {
        let cross_sensitivity = self.ready().await?;
        let sample = self.measure(cross_sensitivity).await;
        let sample = self.power_up.judge(sample, self.clock.now() + POWER_DELAY_US);
        if !self.power_up.is_done(self.clock.now()) {
            self.cross_sensitivity = None;
        }
        sample
    }

    fn parameters(&self) -> ImuParameters {
        ImuParameters::BMI270
    }

    fn is_polled(&self) -> bool {
        self.pace.is_polled()
    }
}
