//! The STM32H743 (Cortex-M7).
//!
//! Clocks: a crystal of 8 MHz, times 100, halved: 400 MHz for the core, half for the buses, a quarter for their
//! peripherals. Every revision of the chip and its whole temperature range allow that at voltage scale 1; 480 MHz would
//! need revision V and scale 0, and a control tick has time to spare. The instruction cache is on. The data cache stays
//! off: it would stand between the core and the DMA buffers.

use super::super::cause::{Cause, Flags};
use super::super::{crystal, executors};
use cortex_m::peripheral::SCB;
use embassy_stm32::pac::iwdg::Iwdg;
use embassy_stm32::pac::rcc::vals::Sw;
use embassy_stm32::pac::{DBGMCU, FLASH, PWR, RCC};
use embassy_stm32::rcc::{self, AHBPrescaler, APBPrescaler, PllDiv, PllMul, PllPreDiv, PllSource};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Peripherals, interrupt, pac, peripherals};

/// The watchdog.
pub type Watchdog = peripherals::IWDG1;

/// Its registers, for code that outlasts its timeout.
pub const WATCHDOG: Iwdg = pac::IWDG1;

/// The interrupts that control and the sensor's task run in: nothing on the boards uses them.
pub const CONTROL_INTERRUPT: interrupt::Interrupt = interrupt::SAI1;
/// See [`CONTROL_INTERRUPT`].
pub const SENSOR_INTERRUPT: interrupt::Interrupt = interrupt::SAI2;
/// And the services.
pub const SERVICES_INTERRUPT: interrupt::Interrupt = interrupt::SAI3;

/// Cycles of the core in 0.08 ms.
pub const FRAME_PAUSE_CYCLES: u32 = 32_000;

/// Blocks of the raw gyro that wait for a card, 7 KB: a second at 1 kHz.
pub const GYRO_BLOCKS: usize = 32;

/// Where the vector table of the chip's own bootloader is.
pub const BOOTLOADER_ADDRESS: u32 = 0x1FF0_9800;

/// Looks at a clock that is to change. It changes within microseconds.
const CLOCK_POLLS_MAX: usize = 100_000;

/// Sets the clocks and takes every peripheral; whether the crystal runs. Once.
///
/// # Panics
/// The second time.
pub fn start() -> (Peripherals, bool) {
    spare_revision_y();
    let has_crystal = crystal::starts();
    let peripherals = embassy_stm32::init(clocks(has_crystal));
    // The clock stands still while a probe halts the core.
    DBGMCU.apb1lfzr1().modify(|w| w.set_tim5(true));
    (peripherals, has_crystal)
}

/// Revision Y may read wrong data from the AXI SRAM, where everything but the stack lies (ST's errata sheet ES0392,
/// 2.2.9). The remedy given there: no more than one read of it at a time.
fn spare_revision_y() {
    /// AXI_TARG7_FN_MOD, and its bit READ_ISS_OVERRIDE.
    const AXI_SRAM: (*mut u32, u32) = (0x5100_8108 as *mut u32, 1);
    /// The first revision without that fault has 0x2001.
    const FIRST_MENDED_REVISION: u16 = 0x2000;
    if DBGMCU.idc().read().rev_id() < FIRST_MENDED_REVISION {
        let (register, limit) = AXI_SRAM;
        // SAFETY: a register of the bus matrix, which nothing else here uses.
        unsafe { register.write_volatile(limit) };
    }
}

fn clocks(has_crystal: bool) -> embassy_stm32::Config {
    let mut config = embassy_stm32::Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = has_crystal.then_some(rcc::Hse { freq: Hertz(8_000_000), mode: rcc::HseMode::Oscillator });
    // 8 MHz of the crystal's 8 or of the chip's own 64.
    let (source, prediv) =
        if has_crystal { (PllSource::HSE, PllPreDiv::DIV1) } else { (PllSource::HSI, PllPreDiv::DIV8) };
    rcc.pll1 = Some(rcc::Pll {
        source,
        prediv,
        mul: PllMul::MUL100,
        fracn: None,
        divp: Some(PllDiv::DIV2), // core: 400 MHz
        divq: Some(PllDiv::DIV8), // SPI1 to SPI3 and SDMMC1: 100 MHz, as SPI4 has from its bus
        divr: None,
    });
    // The same 8 MHz times 60, for the port: the crystal is more exact than USB requires. A PLL that is fed more than 2
    // MHz must run in its wide range, which the driver chooses above 420 MHz.
    rcc.pll3 = Some(rcc::Pll {
        source,
        prediv,
        mul: PllMul::MUL60,
        fracn: None,
        divp: None,
        divq: Some(PllDiv::DIV10), // 48 MHz
        divr: None,
    });
    rcc.mux.usbsel = rcc::mux::Usbsel::PLL3_Q;
    rcc.sys = rcc::Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV2; // 200 MHz
    rcc.apb1_pre = APBPrescaler::DIV2; // 100 MHz; timers 200 MHz
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.apb3_pre = APBPrescaler::DIV2;
    rcc.apb4_pre = APBPrescaler::DIV2;
    rcc.voltage_scale = rcc::VoltageScale::Scale1;
    rcc.mux.adcsel = rcc::mux::Adcsel::PER; // the internal 64 MHz oscillator, divided by the driver
    config
}

/// Why the chip started.
pub fn flags() -> Cause {
    let flags = RCC.rsr().read();
    Cause::first(Flags {
        watchdog: flags.iwdg1rstf(),
        software: flags.sftrstf(),
        power: flags.porrstf(),
        brown_out: flags.borrstf(),
        pin: flags.pinrstf(),
    })
}

/// Clears the flags, so that the next start reports its own.
pub fn clear_flags() {
    RCC.rsr().modify(|w| w.set_rmvf(true));
}

/// Whether the chip is not held in reset while its supply is too low for it: an option, which comes off.
pub fn has_no_brown_out() -> bool {
    FLASH.optsr_cur().read().bor_lev() == 0
}

/// Ends what a bootloader may have left on and the core's own handover does not reach.
pub fn quiet(core: &mut cortex_m::Peripherals) {
    end_caching(core);
    stop_plls();
    quiet_peripherals();
}

/// What the data cache holds goes to memory, and nothing goes to the cache any more.
fn end_caching(core: &mut cortex_m::Peripherals) {
    if SCB::dcache_enabled() {
        core.SCB.disable_dcache(&mut core.CPUID);
    }
}

/// Back to the chip's own oscillator. Embassy sets the PLLs as if none ran.
fn stop_plls() {
    RCC.cr().modify(|w| w.set_hsion(true));
    let _ = (0..CLOCK_POLLS_MAX).find(|_| RCC.cr().read().hsirdy());
    RCC.cfgr().modify(|w| w.set_sw(Sw::HSI));
    let _ = (0..CLOCK_POLLS_MAX).find(|_| RCC.cfgr().read().sws() == Sw::HSI);
    for pll in 0..3 {
        RCC.cr().modify(|w| w.set_pllon(pll, false));
        let _ = (0..CLOCK_POLLS_MAX).find(|_| !RCC.cr().read().pllrdy(pll));
    }
}

/// Resets the DMA controllers, which would go on writing to memory, and the USB port, which a host would go on talking
/// to.
fn quiet_peripherals() {
    let reset = RCC.ahb1rstr();
    for is_reset in [true, false] {
        reset.modify(|w| {
            w.set_dma1rst(is_reset);
            w.set_dma2rst(is_reset);
            w.set_usb_otg_fsrst(is_reset);
        });
    }
}

/// Puts the bootloader where it expects to be: it is there already.
pub fn map_bootloader() {}

/// Whether the USB port's own supply comes up, which its driver would wait for without end.
pub fn has_usb_supply() -> bool {
    /// Each takes 20 ns or more.
    const SUPPLY_POLLS_MAX: u32 = 1_000_000;
    let control = PWR.cr3();
    control.modify(|w| w.set_usb33den(true));
    (0..SUPPLY_POLLS_MAX).any(|_| control.read().usb33rdy())
}

executors::handlers! { SAI1 => CONTROL, SAI2 => SENSOR, SAI3 => SERVICES }
