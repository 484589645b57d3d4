//! MicoAir H743 V2: STM32H743VI (Cortex-M7), BMI088 and BMI270, TIM1 for the motors, USART1 for the link,
//! SDMMC1 for the log.

use super::stm32::absent::NoPacketRadio;
use super::stm32::battery::DividedBattery;
use super::stm32::board::Board;
use super::stm32::card::{self, CardSlot};
use super::stm32::chip;
use super::stm32::clock::SystemClock;
use super::stm32::ears::{Ears, MotorPin};
use super::stm32::edges::{StampedPin, Stamps};
use super::stm32::imu::{self, BoardBmi088, BoardBmi270, Bus, FAST_EDGES, SharedBus};
use super::stm32::light::Lamp;
use super::stm32::link;
use super::stm32::motors::{Dshot, Line, OnTimer};
use super::stm32::started;
use super::stm32::storage::ParameterFlash;
use super::stm32::transfers::Errors;
use super::stm32::usb;
use super::stm32::watchdog::ChipWatchdog;
use crate::bmi088::Bmi088;
use crate::bmi270::Bmi270;
use crate::hardware::MOTOR_COUNT;
use crate::mounting::Mounting;
use crate::redundant::Redundant;
use embassy_stm32::exti::ExtiInput;
use embassy_stm32::gpio::{Level, Output, Pull, Speed};
use embassy_stm32::pac::gpio::Gpio;
use embassy_stm32::pac::timer::TimGp16;
use embassy_stm32::peripherals::{
    DMA1_CH0, DMA1_CH1, DMA1_CH2, DMA1_CH3, DMA1_CH4, DMA1_CH5, DMA1_CH6, DMA2_CH0, SDMMC1, TIM1, TIM4, USART1, USART2,
    USART6, USB_OTG_FS,
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
        DMA2_STREAM0 => Errors<DMA2_CH0>, dma::InterruptHandler<DMA2_CH0>;
        EXTI9_5 => Stamps, exti::InterruptHandler<interrupt::typelevel::EXTI9_5>;
        EXTI15_10 => Stamps, exti::InterruptHandler<interrupt::typelevel::EXTI15_10>;
        OTG_FS => embassy_stm32::usb::InterruptHandler<USB_OTG_FS>;
        SDMMC1 => sdmmc::InterruptHandler<SDMMC1>;
        USART1 => usart::InterruptHandler<USART1>;
        USART2 => usart::BufferedInterruptHandler<USART2>;
        USART6 => usart::BufferedInterruptHandler<USART6>;
    }
);

/// As ArduPilot's definition of this board mounts the BMI088 (roll 180 degrees, then yaw 270, in its axes forward,
/// right, down).
const MOUNTING: Mounting = Mounting::new([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]).expect("no rotation");

/// As it mounts the BMI270 (roll 180 degrees).
const SECOND_MOUNTING: Mounting = Mounting::ALIGNED;

/// The battery's divider, of the same definition.
const BATTERY_DIVIDER: f32 = 21.12;

/// The inertial sensors: the BMI088 flies, the BMI270 stands by.
pub type BoardImu = Redundant<BoardBmi088, BoardBmi270>;

/// The motors.
pub type BoardMotors = Dshot<OnTimer<TIM1, DMA1_CH2, Interrupts>, TIM4>;

/// Their timers, as far as stopping needs them.
// SAFETY: TIM1 is an advanced timer, and the registers of a general one are a subset of its own at the same places.
pub const MOTOR_TIMERS: [TimGp16; 1] = [unsafe { TimGp16::from_ptr(pac::TIM1.as_ptr()) }];

/// Their pins, in the order of the outputs.
pub const MOTOR_PINS: [MotorPin; MOTOR_COUNT] = [
    MotorPin { port: pac::GPIOE, number: 14 },
    MotorPin { port: pac::GPIOE, number: 13 },
    MotorPin { port: pac::GPIOE, number: 11 },
    MotorPin { port: pac::GPIOE, number: 9 },
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
pub const NAME: &str = "MicoAir H743 V2";

/// Sets the clocks and takes every peripheral. Once.
///
/// # Panics
/// The second time, and where a clock makes no 921,600 or 420,000 baud.
#[must_use]
pub fn take() -> Board<BoardImu, BoardMotors, BoardBattery, BoardCard, BoardPacketRadio> {
    let restart = started::cause();
    let (p, has_crystal) = chip::start();

    // The motors first: their lines float until here.
    let lines = [Line::direct(p.PE14), Line::direct(p.PE13), Line::direct(p.PE11), Line::direct(p.PE9)].map(Some);
    let outputs = OnTimer::new(p.TIM1, lines, p.DMA1_CH2, Interrupts);
    let motors = Dshot::new(outputs, Ears::on_a_port(p.TIM4, MOTOR_PINS, pac::GPIOE, p.DMA2_CH0, Interrupts));

    static FIRST_BUS: StaticCell<SharedBus> = StaticCell::new();
    let spi = Spi::new(p.SPI2, p.PD3, p.PC3, p.PC2, p.DMA1_CH1, p.DMA1_CH0, Interrupts, imu::config());
    let bus = FIRST_BUS.init(Bus::new(spi));
    let devices = [imu::device(bus, p.PD4, FAST_EDGES), imu::device(bus, p.PD5, FAST_EDGES)];
    let data_ready = StampedPin { pin: ExtiInput::new(p.PC15, p.EXTI15, Pull::None, Interrupts), line: 15 };
    let first = Bmi088::new(devices, data_ready, SystemClock, &MOUNTING);
    static SECOND_BUS: StaticCell<SharedBus> = StaticCell::new();
    let spi = Spi::new(p.SPI3, p.PB3, p.PD6, p.PB4, p.DMA1_CH5, p.DMA1_CH6, Interrupts, imu::config());
    let device = imu::device(SECOND_BUS.init(Bus::new(spi)), p.PA15, FAST_EDGES);
    let data_ready = StampedPin { pin: ExtiInput::new(p.PB7, p.EXTI7, Pull::None, Interrupts), line: 7 };
    let imu = Redundant::new(first, Bmi270::new(device, data_ready, SystemClock, &SECOND_MOUNTING));

    let uart = Uart::new(p.USART1, p.PA10, p.PA9, p.DMA1_CH3, p.DMA1_CH4, Interrupts, link::config());
    let uart = uart.expect("USART1's clock makes no 921,600 baud");
    let (receiver, transmitter) = link::halves(uart);
    let (to, from) = link::simulator_rings();
    let uart = BufferedUart::new(p.USART2, p.PA3, p.PA2, to, from, Interrupts, link::config());
    let uart = uart.expect("USART2's clock makes no 921,600 baud");
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
        imu,
        motors,
        watchdog: ChipWatchdog::new(p.IWDG1),
        battery: DividedBattery::new(p.ADC1, p.PC0, BATTERY_DIVIDER),
        light: Lamp::new(Output::new(p.PE2, Level::High, Speed::Low), Level::Low),
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
