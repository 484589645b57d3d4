//! The ICM-42688-P inertial measurement unit over SPI, and the ICM-42605 before it: power-up, data-ready, one sample at
//! a time.
//!
//! One device with gyroscope and accelerometer. Its data-ready pin INT1 rises 1000 times a second. Registers lie in
//! banks, of which all but the first hold settings alone. Registers, waits and scales are those of the data sheets
//! DS-000347 and DS-000292, as ArduPilot's, Betaflight's and PX4's drivers agree on them: the sheets were not at hand.
//! What `AFSR_OFF` does is in neither, and known from these drivers.
//!
//! | what | setting |
//! |---|---|
//! | gyroscope | 1000 Hz, 126 Hz bandwidth (122 Hz), low noise, +-2000 deg/s in 16 bits |
//! | accelerometer | 1000 Hz, 126 Hz bandwidth (122 Hz), low noise, +-16 g in 16 bits |
//! | clock | the device's own |
//! | bus | SPI mode 0 or 3, at most 24 MHz |
//!
//! The bandwidths are those of the anti-alias filters, the lowest that keep the samples as young as a BMI088's
//! ([`estimation::imu::sensor`]): at 258 Hz a vibration of 200 Hz would pass 2.7 times as strongly. The filters behind
//! them are set to let everything pass. There is a buffer of samples in the device, which is not used: every sample
//! is read as it becomes ready.
//!
//! Every sample reads the device's identity, and is refused if it is what a device holds that was reset: one that lost
//! its supply for a moment identifies itself well and measures nothing. Every wait is bounded. What does not come in
//! time is a [`Fault`]; after several in a row the next call powers the sensor up anew, which
//! takes about 70 ms.

use crate::hardware::{Clock, DataReady, Fault, Imu, RawImu};
use crate::mounting::Mounting;
use crate::pace::Pace;
use crate::registers::Action::{Expect, Set, Write};
use crate::registers::{
    ACCESS_TIMEOUT_US, POWER_DELAY_US, PowerUp, RATE_PER_COUNT, Registers, Step, acceleration_per_count, counts,
    exchange, read_many,
};
use crate::spi;
use estimation::imu::ImuParameters;

#[cfg(test)]
mod tests;

/// m/s^2 in one count, at 16 g.
pub const ACCELERATION_PER_COUNT: f32 = acceleration_per_count(16.0);

/// Time between samples.
const SAMPLE_PERIOD_US: u64 = 1_000;

/// WHO_AM_I.
const WHO_AM_I: u8 = 0x75;

/// REG_BANK_SEL, in every bank.
const REG_BANK_SEL: u8 = 0x76;

/// Where the data start: x, y, z of the accelerometer, then of the gyroscope.
const DATA_REGISTER: u8 = 0x1F;

/// What data registers hold from a reset to the first sample, and in the order in which they are read before the
/// settings.
const NO_DATA: [[u8; 2]; 2] = [i16::MIN.to_le_bytes(), i16::MIN.to_be_bytes()];

/// INTF_CONFIG1 as after a reset, but for bits 7 and 6, 01 in place of 10. They hold the gyroscope to one range: where
/// it changes its range by itself, it repeats one value for one or two milliseconds.
const AFSR_OFF: u8 = 0x51;

/// Which of the devices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// The ICM-42688-P.
    Icm42688P,
    /// The ICM-42605.
    Icm42605,
}

impl Model {
    /// What it calls itself.
    const fn identity(self) -> u8 {
        match self {
            Self::Icm42688P => 0x47,
            Self::Icm42605 => 0x42,
        }
    }

    /// What its samples are.
    pub const fn parameters(self) -> ImuParameters {
        match self {
            Self::Icm42688P => ImuParameters::ICM42688P,
            Self::Icm42605 => ImuParameters::ICM42605,
        }
    }

    /// The anti-alias filters' parameters DELT, DELTSQR and BITSHIFT: 126 Hz of the ICM-42688-P, 122 Hz of the
    /// ICM-42605.
    const fn filter(self) -> (u8, u16, u8) {
        match self {
            Self::Icm42688P => (3, 9, 12),
            Self::Icm42605 => (11, 122, 8),
        }
    }

    /// A reset takes it 1 ms, is given 2, and returns to the first bank, from whichever it is in. The sensors are off
    /// until PWR_MGMT0 turns them on, because nothing else may be set afterwards; then the gyroscope takes 30 ms to
    /// start, and should stay on for 45. Settings: INTF_CONFIG0 data low byte first, no I2C; INTF_CONFIG1; INT_CONFIG
    /// INT1 as push-pull, active high, pulses; INT_CONFIG1 as the data sheet requires of these pins, pulses of 100 us;
    /// INT_SOURCE0 data-ready to INT1; GYRO_CONFIG0, ACCEL_CONFIG0; GYRO_ACCEL_CONFIG0 no further filters; in the
    /// second and third bank the anti-alias filters.
    const fn power_up(self) -> [Step; 21] {
        let (delt, square, shift) = self.filter();
        let [low, high] = square.to_le_bytes();
        let high = shift << 4 | high;
        [
            (REG_BANK_SEL, 0, Write(0)),
            (0x11, 0x01, Write(2_000)),
            (WHO_AM_I, self.identity(), Expect(0xFF)),
            (0x4C, 0x03, Set(0)),
            (0x4D, AFSR_OFF, Set(0)),
            (0x14, 0x03, Set(0)),
            (0x64, 0x00, Set(0)),
            (0x65, 0x08, Set(0)),
            (0x4F, 0x06, Set(0)),
            (0x50, 0x06, Set(0)),
            (0x52, 0xFF, Set(0)),
            (REG_BANK_SEL, 1, Write(0)),
            (0x0C, delt, Set(0)),
            (0x0D, low, Set(0)),
            (0x0E, high, Set(0)),
            (REG_BANK_SEL, 2, Write(0)),
            (0x03, delt << 1, Set(0)),
            (0x04, low, Set(0)),
            (0x05, high, Set(0)),
            (REG_BANK_SEL, 0, Write(0)),
            (0x4E, 0x0F, Set(50_000)),
        ]
    }

    /// From power to measuring.
    fn steps(self) -> &'static [Step] {
        const ICM42688P: [Step; 21] = Model::Icm42688P.power_up();
        const ICM42605: [Step; 21] = Model::Icm42605.power_up();
        match self {
            Self::Icm42688P => &ICM42688P,
            Self::Icm42605 => &ICM42605,
        }
    }
}

/// The device on its bus.
struct Port<'a, D, C> {
    spi: &'a mut D,
    clock: &'a C,
}

impl<D: spi::Device, C: Clock> Registers for Port<'_, D, C> {
    async fn read(&mut self, register: u8) -> Result<u8, Fault> {
        let [_, value] = read_many(self.spi, self.clock, register).await?;
        Ok(value)
    }

    async fn write(&mut self, register: u8, bytes: &[u8]) -> Result<(), Fault> {
        let &[value] = bytes else { return Err(Fault) };
        exchange(self.spi, self.clock, ACCESS_TIMEOUT_US, &mut [register, value]).await
    }
}

/// The device, the data-ready pin, and the clock that bounds every wait.
pub struct Icm42688<D, P, C> {
    spi: D,
    clock: C,
    pace: Pace<P>,
    mounting: &'static Mounting,
    model: Model,
    power_up: PowerUp,
}

impl<D: spi::Device, P: DataReady, C: Clock> Icm42688<D, P, C> {
    /// Touches nothing yet: the first sample powers the sensor up.
    pub fn new(model: Model, spi: D, data_ready: P, clock: C, mounting: &'static Mounting) -> Self {
        let power_up = PowerUp::new(model.steps(), clock.now() + POWER_DELAY_US);
        Self { spi, pace: Pace::new(data_ready, SAMPLE_PERIOD_US), clock, mounting, model, power_up }
    }

    async fn power_up(&mut self) -> Result<(), Fault> {
        let Self { spi, clock, power_up, .. } = self;
        power_up.complete(&mut Port { spi, clock }, clock).await
    }

    async fn measure(&mut self) -> Result<RawImu, Fault> {
        let time = self.pace.next(&self.clock).await;
        let mut port = Port { spi: &mut self.spi, clock: &self.clock };
        if port.read(WHO_AM_I).await? != self.model.identity() {
            return Err(Fault);
        }
        let [_, data @ ..] = read_many::<13>(port.spi, port.clock, DATA_REGISTER).await?;
        if NO_DATA.iter().any(|nothing| data.as_chunks().0.iter().all(|counted| counted == nothing)) {
            return Err(Fault);
        }
        let [a0, a1, a2, a3, a4, a5, g0, g1, g2, g3, g4, g5] = data;
        let (accelerations, rates) = (counts([a0, a1, a2, a3, a4, a5]), counts([g0, g1, g2, g3, g4, g5]));
        Ok(RawImu {
            time,
            angular_velocity: self.mounting.to_body(rates) * RATE_PER_COUNT,
            specific_force: Some(self.mounting.to_body(accelerations) * ACCELERATION_PER_COUNT),
        })
    }
}

impl<D: spi::Device, P: DataReady, C: Clock> Imu for Icm42688<D, P, C> {
    async fn sample(&mut self) -> Result<RawImu, Fault> {
        self.power_up().await?;
        let sample = self.measure().await;
        self.power_up.judge(sample, self.clock.now() + POWER_DELAY_US)
    }

    fn parameters(&self) -> ImuParameters {
        self.model.parameters()
    }

    fn is_polled(&self) -> bool {
        self.pace.is_polled()
    }
}
