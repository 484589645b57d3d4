//! The STM32F405 (Cortex-M4F).
//!
//! Clocks: a crystal of 8 MHz to 168 MHz for the core, 42 and 84 MHz for the peripheral buses, their timers at twice
//! that. Flash needs six cycles of the core for a word, so its prefetch and its caches are on (they hold flash only, no
//! RAM).

use super::super::cause::{Cause, Flags};
use super::super::{crystal, executors};
use embassy_stm32::pac::iwdg::Iwdg;
use embassy_stm32::pac::{DBGMCU, FLASH, RCC, SYSCFG};
use embassy_stm32::rcc::{self, AHBPrescaler, APBPrescaler, PllMul, PllPDiv, PllPreDiv, PllQDiv, PllSource};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Peripherals, interrupt, pac, peripherals};

/// The watchdog.
pub type Watchdog = peripherals::IWDG;

/// Its registers, for code that outlasts its timeout.
pub const WATCHDOG: Iwdg = pac::IWDG;

/// The interrupts that control and the sensor's task run in: nothing on the board uses them.
pub const CONTROL_INTERRUPT: interrupt::Interrupt = interrupt::UART4;
/// See [`CONTROL_INTERRUPT`].
pub const SENSOR_INTERRUPT: interrupt::Interrupt = interrupt::UART5;
/// And the services.
pub const SERVICES_INTERRUPT: interrupt::Interrupt = interrupt::CAN1_TX;

/// Cycles of the core in 0.08 ms.
pub const FRAME_PAUSE_CYCLES: u32 = 13_440;

/// Blocks of the raw gyro that wait for a card: its board has no slot.
pub const GYRO_BLOCKS: usize = 0;

/// Where the vector table of the chip's own bootloader is.
pub const BOOTLOADER_ADDRESS: u32 = 0x1FFF_0000;

/// Sets the clocks and takes every peripheral; whether the crystal runs. Once.
///
/// # Panics
/// The second time.
pub fn start() -> (Peripherals, bool) {
    let has_crystal = crystal::starts();
    let peripherals = embassy_stm32::init(clocks(has_crystal));
    // The clock stands still while a probe halts the core.
    DBGMCU.apb1fzr().modify(|w| w.set_tim5(true));
    FLASH.acr().modify(|w| {
        w.set_prften(true);
        w.set_icen(true);
        w.set_dcen(true);
    });
    (peripherals, has_crystal)
}

fn clocks(has_crystal: bool) -> embassy_stm32::Config {
    let mut config = embassy_stm32::Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = has_crystal.then_some(rcc::Hse { freq: Hertz(8_000_000), mode: rcc::HseMode::Oscillator });
    // 2 MHz of the crystal's 8 or of the chip's own 16.
    let (source, prediv) =
        if has_crystal { (PllSource::HSE, PllPreDiv::DIV4) } else { (PllSource::HSI, PllPreDiv::DIV8) };
    rcc.pll_src = source;
    rcc.pll = Some(rcc::Pll {
        prediv,
        mul: PllMul::MUL168,
        divp: Some(PllPDiv::DIV2), // core: 168 MHz
        divq: Some(PllQDiv::DIV7), // 48 MHz, for USB
        divr: None,
    });
    rcc.sys = rcc::Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV1;
    rcc.apb1_pre = APBPrescaler::DIV4; // 42 MHz; timers 84 MHz
    rcc.apb2_pre = APBPrescaler::DIV2; // 84 MHz
    config
}

/// Why the chip started.
pub fn flags() -> Cause {
    let flags = RCC.csr().read();
    Cause::first(Flags {
        watchdog: flags.wdgrstf(),
        software: flags.sftrstf(),
        power: flags.porrstf(),
        brown_out: flags.borrstf(),
        pin: flags.padrstf(),
    })
}

/// Clears the flags, so that the next start reports its own.
pub fn clear_flags() {
    RCC.csr().modify(|w| w.set_rmvf(true));
}

/// Whether the chip is not held in reset while its supply is too low for it: an option, which comes off.
pub fn has_no_brown_out() -> bool {
    FLASH.optcr().read().bor_lev() == 0b11
}

/// Resets the DMA controllers, which would go on writing to memory, and the USB port, which a host would go on talking
/// to.
pub fn quiet(_: &mut cortex_m::Peripherals) {
    let (dma, usb) = (RCC.ahb1rstr(), RCC.ahb2rstr());
    for is_reset in [true, false] {
        dma.modify(|w| {
            w.set_dma1rst(is_reset);
            w.set_dma2rst(is_reset);
        });
        usb.modify(|w| w.set_usb_otg_fsrst(is_reset));
    }
}

/// Puts the bootloader where it expects to be: where the core looks for vectors, as where the boot pin has chosen it.
pub fn map_bootloader() {
    RCC.apb2enr().modify(|w| w.set_syscfgen(true));
    cortex_m::asm::dsb();
    SYSCFG.memrm().modify(|w| w.set_mem_mode(1));
}

executors::handlers! { UART4 => CONTROL, UART5 => SENSOR, CAN1_TX => SERVICES }
