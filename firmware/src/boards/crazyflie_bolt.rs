//! Crazyflie Bolt 1.1: STM32F405RG (Cortex-M4F), BMI088, TIM2 for the motors, USART2 on the deck port for the link,
//! USART6 for the radio chip.
//!
//! The controllers' power switches close only when the motor lines are driven low, and open by themselves when the chip
//! restarts.

use super::stm32::absent::NoCard;
use super::stm32::board::Board;
use super::stm32::chip;
use super::stm32::clock::SystemClock;
use super::stm32::ears::{Ears, MotorPin};
use super::stm32::edges::{StampedPin, Stamps};
use super::stm32::imu::{self, BoardBmi088, Bus, FAST_EDGES, SharedBus};
use super::stm32::light::Lamp;
use super::stm32::link;
use super::stm32::motors::{Dshot, Line, OnTimer};
use super::stm32::packet_radio::{self, PacketRadio, RadioBattery};
use super::stm32::started;
use super::stm32::storage::ParameterFlash;
use super::stm32::transfers::Errors;
use super::stm32::usb;
use super::stm32::watchdog::ChipWatchdog;
use crate::bmi088::Bmi088;
use crate::hardware::MOTOR_COUNT;
use crate::mounting::Mounting;
use core::mem::forget;
use embassy_stm32::exti::ExtiInput;
use embassy_stm32::gpio::{Level, Output, Pull, Speed};
use embassy_stm32::pac::gpio::Gpio;
use embassy_stm32::pac::timer::TimGp16;
use embassy_stm32::peripherals::{
    DMA1_CH1, DMA1_CH3, DMA1_CH4, DMA1_CH5, DMA1_CH6, DMA2_CH1, DMA2_CH2, DMA2_CH3, DMA2_CH7, TIM2, TIM8, USART2,
    USART3, USART6, USB_OTG_FS,
};
use embassy_stm32::spi::Spi;
use embassy_stm32::usart::{BufferedUart, Uart};
use embassy_stm32::usb::Driver;
use embassy_stm32::{bind_interrupts, dma, exti, interrupt, pac, usart};
use static_cell::StaticCell;

bind_interrupts!(
    /// Interrupts and their handlers.
    #[derive(Debug)]
    pub struct Interrupts {
        DMA1_STREAM1 => Errors<DMA1_CH1>, dma::InterruptHandler<DMA1_CH1>;
        DMA1_STREAM3 => Errors<DMA1_CH3>, dma::InterruptHandler<DMA1_CH3>;
        DMA1_STREAM4 => Errors<DMA1_CH4>, dma::InterruptHandler<DMA1_CH4>;
        DMA1_STREAM5 => Errors<DMA1_CH5>, dma::InterruptHandler<DMA1_CH5>;
        DMA1_STREAM6 => Errors<DMA1_CH6>, dma::InterruptHandler<DMA1_CH6>;
        DMA2_STREAM1 => Errors<DMA2_CH1>, dma::InterruptHandler<DMA2_CH1>;
        DMA2_STREAM2 => Errors<DMA2_CH2>, dma::InterruptHandler<DMA2_CH2>;
        DMA2_STREAM3 => Errors<DMA2_CH3>, dma::InterruptHandler<DMA2_CH3>;
        DMA2_STREAM7 => Errors<DMA2_CH7>, dma::InterruptHandler<DMA2_CH7>;
        EXTI4 => exti::InterruptHandler<interrupt::typelevel::EXTI4>;
        EXTI15_10 => Stamps, exti::InterruptHandler<interrupt::typelevel::EXTI15_10>;
        OTG_FS => embassy_stm32::usb::InterruptHandler<USB_OTG_FS>;
        USART2 => usart::InterruptHandler<USART2>;
        USART3 => usart::BufferedInterruptHandler<USART3>;
        USART6 => usart::InterruptHandler<USART6>;
    }
);

/// As Bitcraze's own firmware takes it: the sensor's axes are the body's.
const MOUNTING: Mounting = Mounting::ALIGNED;

/// The inertial sensor.
pub type BoardImu = BoardBmi088;

/// The motors.
pub type BoardMotors = Dshot<OnTimer<TIM2, DMA1_CH1, Interrupts>, TIM8>;

/// Their timers, as far as stopping needs them.
// SAFETY: TIM2 is a 32-bit general timer, with the registers of a 16-bit one at the same places.
pub const MOTOR_TIMERS: [TimGp16; 1] = [unsafe { TimGp16::from_ptr(pac::TIM2.as_ptr()) }];

/// Their pins, in the order of the outputs.
pub const MOTOR_PINS: [MotorPin; MOTOR_COUNT] = [
    MotorPin { port: pac::GPIOA, number: 1 },
    MotorPin { port: pac::GPIOB, number: 11 },
    MotorPin { port: pac::GPIOA, number: 15 },
    MotorPin { port: pac::GPIOB, number: 10 },
];

/// The radio chip measures the battery.
pub type BoardBattery = RadioBattery;

/// There is no slot for a memory card.
pub type BoardCard = NoCard;

/// The radio chip.
pub type BoardPacketRadio = PacketRadio;

/// Bitcraze's bootloader looks at the radio chip's line, PC7, and starts ST's bootloader where it is low.
pub const BOOT_LINE: Option<(Gpio, usize)> = Some((pac::GPIOC, 7));

/// What it is called.
pub const NAME: &str = "Crazyflie Bolt 1.1";

/// Sets the clocks and takes every peripheral. Once.
///
/// # Panics
/// The second time, and where a clock makes no 921,600 or 1,000,000 baud.
#[must_use]
pub fn take() -> Board<BoardImu, BoardMotors, BoardBattery, BoardCard, BoardPacketRadio> {
    let restart = started::cause();
    let (p, has_crystal) = chip::start();

    // The motors first: PA15 is pulled up until here, and the controllers must not see that.
    let lines = [Line::direct(p.PA1), Line::direct(p.PB11), Line::direct(p.PA15), Line::direct(p.PB10)].map(Some);
    let outputs = OnTimer::new(p.TIM2, lines, p.DMA1_CH1, Interrupts);
    let ears = Ears::on_a_port(p.TIM8, MOTOR_PINS, pac::GPIOA, p.DMA2_CH1, Interrupts);
    let motors = Dshot::new(outputs, ears.and(pac::GPIOB, p.DMA2_CH3, Interrupts));
    // The controllers have power for as long as these are held: for ever.
    forget([
        Output::new(p.PA0, Level::High, Speed::Low),
        Output::new(p.PB12, Level::High, Speed::Low),
        Output::new(p.PC8, Level::High, Speed::Low),
        Output::new(p.PC15, Level::High, Speed::Low),
    ]);

    static BUS: StaticCell<SharedBus> = StaticCell::new();
    let spi = Spi::new(p.SPI2, p.PB13, p.PB15, p.PB14, p.DMA1_CH4, p.DMA1_CH3, Interrupts, imu::config());
    let bus = BUS.init(Bus::new(spi));
    let devices = [imu::device(bus, p.PB1, FAST_EDGES), imu::device(bus, p.PB0, FAST_EDGES)];
    let data_ready = StampedPin { pin: ExtiInput::new(p.PC14, p.EXTI14, Pull::None, Interrupts), line: 14 };
    let imu = Bmi088::new(devices, data_ready, SystemClock, &MOUNTING);

    let uart = Uart::new(p.USART2, p.PA3, p.PA2, p.DMA1_CH6, p.DMA1_CH5, Interrupts, link::config());
    let uart = uart.expect("USART2's clock makes no 921,600 baud");
    let (receiver, transmitter) = link::halves(uart);
    let (to, from) = link::simulator_rings();
    let uart = BufferedUart::new(p.USART3, p.PC11, p.PC10, to, from, Interrupts, link::config());
    let uart = uart.expect("USART3's clock makes no 921,600 baud");
    let (simulator_receiver, simulator_transmitter) = link::simulator_halves(uart);

    let config = packet_radio::config();
    let uart = Uart::new(p.USART6, p.PC7, p.PC6, p.DMA2_CH7, p.DMA2_CH2, Interrupts, config);
    let uart = uart.expect("USART6's clock makes no 1,000,000 baud");
    // Pulled up: a chip without power takes no bytes.
    let radio = PacketRadio::new(uart, ExtiInput::new(p.PA4, p.EXTI4, Pull::Up, Interrupts));

    let usb = Driver::new_fs(p.USB_OTG_FS, Interrupts, p.PA12, p.PA11, usb::packets(), usb::config());

    Board {
        imu,
        motors,
        watchdog: ChipWatchdog::new(p.IWDG),
        battery: radio.battery(),
        light: Lamp::new(Output::new(p.PD2, Level::Low, Speed::Low), Level::High),
        receiver,
        transmitter,
        usb: Some(usb),
        simulator_receiver,
        simulator_transmitter,
        radio: None,
        packet_radio: Some(radio),
        card: None,
        storage: ParameterFlash::new(p.FLASH),
        has_crystal,
        restart,
    }
}
