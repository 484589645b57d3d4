//! The BMI088 of both boards: two chip selects on one SPI bus with DMA, data-ready on an interrupt pin.

use super::clock::SystemClock;
use crate::bmi088::{Bmi088, Mounting};
use embassy_embedded_hal::shared_bus::asynch::spi::SpiDevice;
use embassy_stm32::exti::ExtiInput;
use embassy_stm32::gpio::Output;
use embassy_stm32::mode::Async;
use embassy_stm32::spi::mode::Master;
use embassy_stm32::spi::{Config, Spi};
use embassy_stm32::time::Hertz;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::mutex::Mutex;
use static_cell::StaticCell;

type Bus = Spi<'static, Async, Master>;
type Device = SpiDevice<'static, CriticalSectionRawMutex, Bus, Output<'static>>;

/// The sensor as the boards wire it.
pub type BoardImu = Bmi088<Device, Device, ExtiInput<'static, Async>, SystemClock>;

/// The sensor takes up to 10 MHz. The driver rounds to its nearest divider, above what was asked for too: this becomes
/// 6.25 MHz on the H743 (100 MHz / 16) and 5.25 MHz on the F405 (42 MHz / 8), where 8 MHz would become 10.5 MHz.
const FREQUENCY: Hertz = Hertz(6_000_000);

/// SPI mode 0, as the bus driver has it by default.
#[must_use]
pub fn config() -> Config {
    let mut config = Config::default();
    config.frequency = FREQUENCY;
    config
}

/// The sensor from its bus, its two chip selects (idle high) and its gyroscope's data-ready pin. Once.
pub fn bmi088(
    bus: Bus,
    accelerometer: Output<'static>,
    gyroscope: Output<'static>,
    data_ready: ExtiInput<'static, Async>,
    mounting: Mounting,
) -> BoardImu {
    static BUS: StaticCell<Mutex<CriticalSectionRawMutex, Bus>> = StaticCell::new();
    let bus = &*BUS.init(Mutex::new(bus));
    let (accelerometer, gyroscope) = (SpiDevice::new(bus, accelerometer), SpiDevice::new(bus, gyroscope));
    Bmi088::new(accelerometer, gyroscope, data_ready, SystemClock, mounting)
}
