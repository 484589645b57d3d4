//! The BMI088 inertial measurement unit over SPI: power-up, data-ready, one sample at a time.
//!
//! The package holds two devices that share a bus and little else: a gyroscope and an accelerometer, each with a chip
//! select of its own. The gyroscope sets the pace: its data-ready pin INT3 rises 1000 times a second, and each rise is
//! one sample of both; `crate::pace` reads by the clock where it does not. Registers, waits and scales are those of the
//! BMI088 data sheet.
//!
//! | what | setting |
//! |---|---|
//! | gyroscope | 1000 Hz, 116 Hz bandwidth, +-2000 deg/s in 16 bits |
//! | accelerometer | 1600 Hz, 145 Hz bandwidth (fourfold oversampling), +-24 g in 16 bits |
//! | bus | SPI mode 0 or 3, at most 10 MHz |
//!
//! Every sample reads both chip identities before it accepts their numbers: a bus stuck high or low would otherwise
//! read as a vehicle that does not turn. Every wait is bounded. A gyroscope that does not answer in time is a
//! [`Fault`]; an accelerometer that does not leaves a sample without a force. After several faults in a row a device is
//! powered up anew. The gyroscope's samples wait for its own, which takes 45 ms; for the accelerometer's, a step
//! between two samples, they do not.

use crate::hardware::{Clock, DataReady, Fault, Imu, RawImu};
use crate::mounting::Mounting;
use crate::pace::Pace;
use crate::registers::Action::{Expect, Set, Wake, Write};
use crate::registers::{
    ACCESS_TIMEOUT_US, POWER_DELAY_US, POWER_UP_TIMEOUT_US, PowerUp, RATE_PER_COUNT, READ_BIT, Registers, Step,
    acceleration_per_count, counts, exchange,
};
use crate::spi;
use estimation::imu::ImuParameters;
use nalgebra::Vector3;

#[cfg(test)]
mod tests;

/// m/s^2 in one count, at 24 g.
pub const ACCELERATION_PER_COUNT: f32 = acceleration_per_count(24.0);

/// Time between samples.
const SAMPLE_PERIOD_US: u64 = 1_000;

/// How long an accelerometer that did not power up is left alone: on a bus that hangs, asking costs the gyroscope
/// time.
const ACCELEROMETER_RETRY_INTERVAL_US: u64 = 100_000;

/// Both devices hold their identity here.
const CHIP_ID: u8 = 0x00;

/// One of the two devices.
struct Device {
    /// What it calls itself.
    id: u8,
    /// Where its data start (x, y, z, low byte first).
    data: u8,
    /// Bytes of a read before the answer: the address, and for the accelerometer one that means nothing.
    lead: usize,
    /// From power to measuring.
    power_up: &'static [Step],
}

/// Written to a device's reset register, it restarts the device.
const SOFT_RESET: u8 = 0xB6;
const ACCELEROMETER_RESET: u8 = 0x7E;
const GYROSCOPE_RESET: u8 = 0x14;

/// The accelerometer wakes up listening to I2C, and again after its reset; the first rise of its chip select turns it
/// to SPI. A reset takes it 1 ms and is given 2. Settings: ACC_PWR_CONF active, ACC_PWR_CTRL on (50 ms until it
/// measures), ACC_CONF, ACC_RANGE.
const ACCELEROMETER: Device = Device {
    id: 0x1E,
    data: 0x12,
    lead: 2,
    power_up: &[
        (CHIP_ID, 0, Wake),
        (ACCELEROMETER_RESET, SOFT_RESET, Write(2_000)),
        (CHIP_ID, 0, Wake),
        (CHIP_ID, 0x1E, Expect(0xFF)),
        (0x7C, 0x00, Set(5_000)),
        (0x7D, 0x04, Set(50_000)),
        (0x40, 0x8C, Set(0)),
        (0x41, 0x03, Set(0)),
    ],
};

/// A reset takes the gyroscope 30 ms, and is given 35. Settings: GYRO_RANGE, GYRO_BANDWIDTH, INT3 as push-pull and
/// active high (INT4 left as it was), data-ready to INT3, data-ready on. The top bit of GYRO_BANDWIDTH always reads as
/// one, so it is written as one.
const GYROSCOPE: Device = Device {
    id: 0x0F,
    data: 0x02,
    lead: 1,
    power_up: &[
        (CHIP_ID, 0x0F, Expect(0xFF)),
        (GYROSCOPE_RESET, SOFT_RESET, Write(35_000)),
        (0x0F, 0x00, Set(0)),
        (0x10, 0x82, Set(0)),
        (0x16, 0x0D, Set(0)),
        (0x18, 0x01, Set(0)),
        (0x15, 0x80, Set(0)),
    ],
};

/// A device, and how far its power-up is.
struct Part {
    device: &'static Device,
    power_up: PowerUp,
}

impl Part {
    fn new(device: &'static Device, time: u64) -> Self {
        Self { device, power_up: PowerUp::new(device.power_up, time) }
    }
}

/// One device on the bus.
struct Port<'a, D, C> {
    spi: &'a mut D,
    clock: &'a C,
    device: &'static Device,
}

impl<D: spi::Device, C: Clock> Port<'_, D, C> {
    /// Reads `count` registers, at most six, from `register` on.
    async fn read_many(&mut self, register: u8, count: usize) -> Result<[u8; 6], Fault> {
        let mut bytes = [READ_BIT | register, 0, 0, 0, 0, 0, 0, 0];
        let used = bytes.get_mut(..self.device.lead + count).ok_or(Fault)?;
        exchange(self.spi, self.clock, ACCESS_TIMEOUT_US, used).await?;
        let [_, early @ .., _] = bytes;
        let [_, _, late @ ..] = bytes;
        Ok(if self.device.lead == 1 { early } else { late })
    }

    /// What it measures, in counts, if it is itself.
    async fn measure(&mut self) -> Result<Vector3<f32>, Fault> {
        let id = self.read(CHIP_ID).await?;
        if id != self.device.id {
            return Err(Fault);
        }
        Ok(counts(self.read_many(self.device.data, 6).await?))
    }
}

impl<D: spi::Device, C: Clock> Registers for Port<'_, D, C> {
    async fn read(&mut self, register: u8) -> Result<u8, Fault> {
        let [value, ..] = self.read_many(register, 1).await?;
        Ok(value)
    }

    async fn write(&mut self, register: u8, bytes: &[u8]) -> Result<(), Fault> {
        let &[value] = bytes else { return Err(Fault) };
        exchange(self.spi, self.clock, ACCESS_TIMEOUT_US, &mut [register, value]).await
    }
}

/// The two devices, the data-ready pin, and the clock that bounds every wait.
pub struct Bmi088<D, P, C> {
    /// Accelerometer and gyroscope.
    devices: [D; 2],
    pace: Pace<P>,
    clock: C,
    mounting: &'static Mounting,
    accelerometer: Part,
    gyroscope: Part,
}

impl<D: spi::Device, P: DataReady, C: Clock> Bmi088<D, P, C> {
    /// Touches nothing yet: the first sample powers the sensor up. `devices` are accelerometer and gyroscope.
    pub fn new(devices: [D; 2], data_ready: P, clock: C, mounting: &'static Mounting) -> Self {
        let time = clock.now() + POWER_DELAY_US;
        let (accelerometer, gyroscope) = (Part::new(&ACCELEROMETER, time), Part::new(&GYROSCOPE, time));
        Self { devices, pace: Pace::new(data_ready, SAMPLE_PERIOD_US), clock, mounting, accelerometer, gyroscope }
    }

    /// Both devices at once, because most of it is waiting; the gyroscope's faults end it, and the accelerometer's only
    /// its own. An accelerometer that is being left alone is not waited for.
    async fn power_up(&mut self) -> Result<(), Fault> {
        let now = self.clock.now();
        let end = now + POWER_UP_TIMEOUT_US;
        let mut with_accelerometer = self.accelerometer.power_up.due() <= now + POWER_DELAY_US;
        loop {
            let (now, fast, slow) = (self.clock.now(), &self.gyroscope.power_up, &self.accelerometer.power_up);
            let waiting = with_accelerometer && !slow.is_done(now);
            if fast.is_done(now) && !waiting {
                return Ok(());
            }
            let due = match (fast.is_done(now), waiting) {
                (false, true) => fast.due().min(slow.due()),
                (false, false) => fast.due(),
                (true, _) => slow.due(),
            };
            if due > end {
                return Err(Fault);
            }
            self.clock.until(due).await;
            self.advance_gyroscope().await?;
            if with_accelerometer {
                with_accelerometer = self.advance_accelerometer().await.is_ok();
            }
        }
    }

    async fn advance_gyroscope(&mut self) -> Result<(), Fault> {
        let Self { devices: [_, spi], clock, gyroscope, .. } = self;
        let mut port = Port { spi, clock, device: gyroscope.device };
        gyroscope.power_up.advance(&mut port, clock).await
    }

    async fn advance_accelerometer(&mut self) -> Result<(), Fault> {
        let Self { devices: [spi, _], clock, accelerometer, .. } = self;
        let mut port = Port { spi, clock, device: accelerometer.device };
        let advanced = accelerometer.power_up.advance(&mut port, clock).await;
        if advanced.is_err() {
            accelerometer.power_up.restart(clock.now() + ACCELEROMETER_RETRY_INTERVAL_US);
        }
        advanced
    }

    /// The rates, in counts.
    async fn rates(&mut self) -> Result<Vector3<f32>, Fault> {
        let Self { devices: [_, spi], clock, gyroscope, .. } = self;
        let measured = Port { spi, clock, device: gyroscope.device }.measure().await;
        gyroscope.power_up.judge(measured, clock.now() + POWER_DELAY_US)
    }

    /// The accelerations, in counts; none from an accelerometer that does not answer, which is powered up by a step
    /// instead.
    async fn accelerations(&mut self) -> Option<Vector3<f32>> {
        if !self.accelerometer.power_up.is_done(self.clock.now()) {
            // It says by itself when to go on.
            let _ = self.advance_accelerometer().await;
            return None;
        }
        let Self { devices: [spi, _], clock, accelerometer, .. } = self;
        let measured = Port { spi, clock, device: accelerometer.device }.measure().await;
        accelerometer.power_up.judge(measured, clock.now() + ACCELEROMETER_RETRY_INTERVAL_US).ok()
    }
}

impl<D: spi::Device, P: DataReady, C: Clock> Imu for Bmi088<D, P, C> {
    async fn sample(&mut self) -> Result<RawImu, Fault> {
        if !self.gyroscope.power_up.is_done(self.clock.now()) {
            self.power_up().await?;
        }
        let time = self.pace.next(&self.clock).await;
        let angular_velocity = self.mounting.to_body(self.rates().await?) * RATE_PER_COUNT;
        let accelerations = self.accelerations().await;
        let specific_force = accelerations.map(|counted| self.mounting.to_body(counted) * ACCELERATION_PER_COUNT);
        Ok(RawImu { time, angular_velocity, specific_force })
    }

    fn parameters(&self) -> ImuParameters {
        ImuParameters::BMI088
    }

    fn is_polled(&self) -> bool {
        self.pace.is_polled()
    }
}
