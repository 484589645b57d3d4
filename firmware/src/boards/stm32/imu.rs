//! The inertial sensors of the boards: chip selects on an SPI bus with DMA, which several may share, data-ready on an
//! interrupt pin.

use super::clock::SystemClock;
use super::edges::StampedPin;
use super::transfers::{self, Begun};
use crate::bmi088::Bmi088;
use crate::bmi270::Bmi270;
use crate::icm42688::Icm42688;
use crate::spi::Selected;
use embassy_stm32::Peri;
use embassy_stm32::gpio::{Level, Output, Pin, Speed};
use embassy_stm32::mode::Async;
use embassy_stm32::spi::mode::Master;
use embassy_stm32::spi::{self, Config, Spi};
use embassy_stm32::time::Hertz;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::mutex::Mutex;
use embedded_hal_async::spi::{ErrorKind, ErrorType, SpiBus};

/// A bus of whose transfers none counts in which the DMA controller failed.
pub struct Bus(Spi<'static, Async, Master>);

impl Bus {
    /// To be shared.
    pub fn new(spi: Spi<'static, Async, Master>) -> SharedBus {
        Mutex::new(Self(spi))
    }
}

impl ErrorType for Bus {
    type Error = ErrorKind;
}

/// What became of a transfer that has begun then.
fn checked(begun: &Begun, done: Result<(), spi::Error>) -> Result<(), ErrorKind> {
    done.map_err(|_| ErrorKind::Other).and(begun.whole().map_err(|_| ErrorKind::Other))
}

impl SpiBus for Bus {
    async fn read(&mut self, words: &mut [u8]) -> Result<(), ErrorKind> {
        let begun = transfers::begin();
        checked(&begun, self.0.read(words).await)
    }

    async fn write(&mut self, words: &[u8]) -> Result<(), ErrorKind> {
        let begun = transfers::begin();
        checked(&begun, self.0.write(words).await)
    }

    async fn transfer(&mut self, read: &mut [u8], write: &[u8]) -> Result<(), ErrorKind> {
        let begun = transfers::begin();
        checked(&begun, self.0.transfer(read, write).await)
    }

    async fn transfer_in_place(&mut self, words: &mut [u8]) -> Result<(), ErrorKind> {
        let begun = transfers::begin();
        checked(&begun, self.0.transfer_in_place(words).await)
    }

    async fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

/// A bus that several devices share, each for as long as an exchange takes.
pub type SharedBus = Mutex<CriticalSectionRawMutex, Bus>;

/// A device on such a bus.
pub type Device = Selected<'static, CriticalSectionRawMutex, Bus, Output<'static>>;

/// How steep a chip select's edges are.
pub const FAST_EDGES: Speed = Speed::VeryHigh;

/// And on PC13 to PC15, which can drive little.
pub const SLOW_EDGES: Speed = Speed::Low;

/// A device on `bus`, chosen by a low level on `select`.
pub fn device(bus: &'static SharedBus, select: Peri<'static, impl Pin>, speed: Speed) -> Device {
    Selected::new(bus, Output::new(select, Level::High, speed))
}

/// A BMI088 as the boards wire it.
pub type BoardBmi088 = Bmi088<Device, StampedPin, SystemClock>;

/// A BMI270 as the boards wire it.
pub type BoardBmi270 = Bmi270<Device, StampedPin, SystemClock>;

/// An ICM-42688-P or ICM-42605 as the boards wire it.
pub type BoardIcm42688 = Icm42688<Device, StampedPin, SystemClock>;

/// The sensors take up to 10 MHz. The driver rounds to its nearest divider, above the requested one too: this becomes
/// 6.25 MHz on the H743 (100 MHz / 16) and 5.25 MHz on the F405 (42 MHz / 8), where 8 MHz would become 10.5 MHz.
const BUS_FREQUENCY: Hertz = Hertz(6_000_000);

/// SPI mode 0, as the bus driver has it by default.
pub fn config() -> Config {
    let mut config = Config::default();
    config.frequency = BUS_FREQUENCY;
    config
}
