//! Matek H743 V3 (SLIM, WING): STM32H743VI (Cortex-M7), ICM-42688-P and ICM-42605, TIM8 and TIM2 for the motors,
//! UART7 for the link, SDMMC1 for the log.
//!
//! ArduPilot has motors 3 and 4 on TIM5, which is the scheduler's here; the same pins are TIM2's as well.

use super::stm32::absent::NoPacketRadio;
use super::stm32::battery::DividedBattery;
use super::stm32::board::Board;
use super::stm32::card::{self, CardSlot};
use super::stm32::chip;
use super::stm32::clock::SystemClock;
use super::stm32::ears::{Ears, MotorPin};
use super::stm32::edges::{StampedPin, Stamps};
use super::stm32::imu::{self, BoardIcm42688, Bus, SLOW_EDGES, SharedBus};
use super::stm32::light::Lamp;
use super::stm32::link;
use super::stm32::motors::{Dshot, Line, OnTimer};
use super::stm32::started;
use super::stm32::storage::ParameterFlash;
use super::stm32::transfers::Errors;
use super::stm32::usb;
use super::stm32::watchdog::ChipWatchdog;
use crate::hardware::MOTOR_COUNT;
use crate::icm42688::{Icm42688, Model};
use crate::mounting::Mounting;
use crate::redundant::Redundant;
use core::mem::forget;
use embassy_stm32::exti::ExtiInput;
use embassy_stm32::gpio::{Level, Output, Pull, Speed};
use embassy_stm32::pac::gpio::Gpio;
use embassy_stm32::pac::timer::TimGp16;
use embassy_stm32::peripherals::{
    DMA1_CH0, DMA1_CH1, DMA1_CH2, DMA1_CH3, DMA1_CH4, DMA1_CH5, DMA1_CH6, DMA1_CH7, DMA2_CH0, DMA2_CH1, SDMMC1, TIM2,
    TIM4, TIM8, UART7, USART1, USART6, USB_OTG_FS,
};
use embassy_stm32::sdmmc::{self, Sdmmc};
use embassy_stm32::spi::Spi;
use embassy_stm32::usart::{BufferedUart, Uart};
use embassy_stm32::usb::Driver;
use embassy_stm32::{bind_interrupts, dma, exti, interrupt, pac, usart};
use static_cell::StaticCell;

bind_interrupts!(
    /// Interrupts and their handlers.
    #[derive(Debug)]
    pub struct Interrupts {
        DMA1_STREAM0 => Errors<DMA1_CH0>, dma::InterruptHandler<DMA1_CH0>;
        DMA1_STREAM1 => Errors<DMA1_CH1>, dma::InterruptHandler<DMA1_CH1>;
        DMA1_STREAM2 => Errors<DMA1_CH2>, dma::InterruptHandler<DMA1_CH2>;
        DMA1_STREAM3 => Errors<DMA1_CH3>, dma::InterruptHandler<DMA1_CH3>;
        DMA1_STREAM4 => Errors<DMA1_CH4>, dma::InterruptHandler<DMA1_CH4>;
        DMA1_STREAM5 => Errors<DMA1_CH5>, dma::InterruptHandler<DMA1_CH5>;
        DMA1_STREAM6 => Errors<DMA1_CH6>, dma::InterruptHandler<DMA1_CH6>;
        DMA1_STREAM7 => Errors<DMA1_CH7>, dma::InterruptHandler<DMA1_CH7>;
        DMA2_STREAM0 => Errors<DMA2_CH0>, dma::InterruptHandler<DMA2_CH0>;
        DMA2_STREAM1 => Errors<DMA2_CH1>, dma::InterruptHandler<DMA2_CH1>;
        EXTI2 => Stamps, exti::InterruptHandler<interrupt::typelevel::EXTI2>;
        EXTI15_10 => Stamps, exti::InterruptHandler<interrupt::typelevel::EXTI15_10>;
        OTG_FS => embassy_stm32::usb::InterruptHandler<USB_OTG_FS>;
        SDMMC1 => sdmmc::InterruptHandler<SDMMC1>;
        UART7 => usart::InterruptHandler<UART7>;
        USART1 => usart::BufferedInterruptHandler<USART1>;
        USART6 => usart::BufferedInterruptHandler<USART6>;
    }
);

/// As ArduPilot's definition of this board mounts the ICM-42688-P (yaw 180 degrees, in its axes forward, right, down).
const MOUNTING: Mounting = Mounting::new([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]).expect("no rotation");

/// As it mounts the ICM-42605 (yaw 270 degrees).
const SECOND_MOUNTING: Mounting =
    Mounting::new([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]).expect("no rotation");

/// The battery's divider, of the same definition.
const BATTERY_DIVIDER: f32 = 11.0;

/// The inertial sensors: the ICM-42688-P flies, the ICM-42605 stands by.
pub type BoardImu = Redundant<BoardIcm42688, BoardIcm42688>;

/// The motors.
pub type BoardMotors = Dshot<(OnTimer<TIM8, DMA1_CH2, Interrupts>, OnTimer<TIM2, DMA1_CH7, Interrupts>), TIM4>;

/// Their timers, as far as stopping needs them.
pub const MOTOR_TIMERS: [TimGp16; 2] = [
    // SAFETY: TIM8 is an advanced timer, and the registers of a general one are a subset of its own at the same places.
    unsafe { TimGp16::from_ptr(pac::TIM8.as_ptr()) },
    // SAFETY: TIM2 is a 32-bit general timer, with the registers of a 16-bit one at the same places.
    unsafe { TimGp16::from_ptr(pac::TIM2.as_ptr()) },
];

/// Their pins, in the order of the outputs.
pub const MOTOR_PINS: [MotorPin; MOTOR_COUNT] = [
    MotorPin { port: pac::GPIOB, number: 0 },
    MotorPin { port: pac::GPIOB, number: 1 },
    MotorPin { port: pac::GPIOA, number: 0 },
    MotorPin { port: pac::GPIOA, number: 1 },
];

/// The battery.
pub type BoardBattery = DividedBattery;

/// The slot for a memory card.
pub type BoardCard = CardSlot;

/// There is no chip that carries packets over a radio.
pub type BoardPacketRadio = NoPacketRadio;

/// No bootloader looks at a line.
pub const BOOT_LINE: Option<(Gpio, usize)> = None;

/// What it is called.
pub const NAME: &str = "Matek H743";

/// Sets the clocks and takes every peripheral. Once.
///
/// # Panics
/// The second time, and where a clock makes no 921,600 or 420,000 baud.
#[must_use]
pub fn take() -> Board<BoardImu, BoardMotors, BoardBattery, BoardCard, BoardPacketRadio> {
    let restart = started::cause();
    let (p, has_crystal) = chip::start();

    // The motors first: their lines float until here.
    let lines = [Some(Line::complementary(p.PB0)), Some(Line::complementary(p.PB1)), None, None];
    let first = OnTimer::new(p.TIM8, lines, p.DMA1_CH2, Interrupts);
    let lines = [None, None, Some(Line::direct(p.PA0)), Some(Line::direct(p.PA1))];
    let second = OnTimer::new(p.TIM2, lines, p.DMA1_CH7, Interrupts);
    let ears = Ears::on_a_port(p.TIM4, MOTOR_PINS, pac::GPIOB, p.DMA2_CH0, Interrupts);
    let motors = Dshot::new((first, second), ears.and(pac::GPIOA, p.DMA2_CH1, Interrupts));
    // The chip pulls the buzzer's line up; low is silent.
    forget(Output::new(p.PA15, Level::Low, Speed::Low));

    static FIRST_BUS: StaticCell<SharedBus> = StaticCell::new();
    let spi = Spi::new(p.SPI1, p.PA5, p.PD7, p.PA6, p.DMA1_CH1, p.DMA1_CH0, Interrupts, imu::config());
    let device = imu::device(FIRST_BUS.init(Bus::new(spi)), p.PC15, SLOW_EDGES);
    let data_ready = StampedPin { pin: ExtiInput::new(p.PB2, p.EXTI2, Pull::None, Interrupts), line: 2 };
    let first = Icm42688::new(Model::Icm42688P, device, data_ready, SystemClock, &MOUNTING);
    static SECOND_BUS: StaticCell<SharedBus> = StaticCell::new();
    let spi = Spi::new(p.SPI4, p.PE12, p.PE14, p.PE13, p.DMA1_CH5, p.DMA1_CH6, Interrupts, imu::config());
    let device = imu::device(SECOND_BUS.init(Bus::new(spi)), p.PC13, SLOW_EDGES);
    // Without edges, should this pin not be the sensor's, it is polled.
    let data_ready = StampedPin { pin: ExtiInput::new(p.PE15, p.EXTI15, Pull::Down, Interrupts), line: 15 };
    let second = Icm42688::new(Model::Icm42605, device, data_ready, SystemClock, &SECOND_MOUNTING);

    let uart = Uart::new(p.UART7, p.PE7, p.PE8, p.DMA1_CH3, p.DMA1_CH4, Interrupts, link::config());
    let uart = uart.expect("UART7's clock makes no 921,600 baud");
    let (receiver, transmitter) = link::halves(uart);
    let (to, from) = link::simulator_rings();
    let uart = BufferedUart::new(p.USART1, p.PA10, p.PA9, to, from, Interrupts, link::config());
    let uart = uart.expect("USART1's clock makes no 921,600 baud");
    let (simulator_receiver, simulator_transmitter) = link::simulator_halves(uart);
    let (to, from) = link::radio_rings();
    let uart = BufferedUart::new(p.USART6, p.PC7, p.PC6, to, from, Interrupts, link::radio_config());
    let (radio, _) = link::simulator_halves(uart.expect("USART6's clock makes no 420,000 baud"));

    let usb = chip::has_usb_supply()
        .then(|| Driver::new_fs(p.USB_OTG_FS, Interrupts, p.PA12, p.PA11, usb::packets(), usb::config()));

    let (clock, command) = (p.PC12, p.PD2);
    let mut card = sdmmc::Config::default();
    card.data_transfer_timeout = card::BUSY_TIMEOUT_CYCLES;
    let card = Sdmmc::new_4bit(p.SDMMC1, Interrupts, clock, command, p.PC8, p.PC9, p.PC10, p.PC11, card);

    Board {
        imu: Redundant::new(first, second),
        motors,
        watchdog: ChipWatchdog::new(p.IWDG1),
        battery: DividedBattery::new(p.ADC1, p.PC0, BATTERY_DIVIDER),
        light: Lamp::new(Output::new(p.PE4, Level::High, Speed::Low), Level::Low),
        receiver,
        transmitter,
        usb,
        simulator_receiver,
        simulator_transmitter,
        radio: Some(radio),
        packet_radio: None,
        card: Some(CardSlot::new(card)),
        storage: ParameterFlash::new(p.FLASH),
        has_crystal,
        restart,
    }
}
