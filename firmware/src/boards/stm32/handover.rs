//! The first instructions: whatever ran before, here it begins as after a reset.
//!
//! A bootloader may hand over from a task of its own operating system (ArduPilot's does): on that task's stack, with
//! its interrupts armed, its caches and memory protection on, its clocks running. A thread that stays on that stack
//! overwrites memory that is somebody else's now; a data cache stands between the core and the DMA buffers; an
//! interrupt without a handler is a fault; a PLL that runs takes no new settings.

use cortex_m::Peripherals;

// Before memory is set up, by the runtime's own hook, without using a stack: no interrupt until `begin_anew` has ended
// those that are armed, the main stack from here on, no interrupt masked by its priority.
core::arch::global_asm!(
    ".section .text.__pre_init, \"ax\"",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init:",
    "cpsid i",
    "mrs r0, CONTROL",
    "bic r0, r0, #2",
    "msr CONTROL, r0",
    "isb",
    "movs r0, #0",
    "msr BASEPRI, r0",
    "bx lr",
    ".size __pre_init, . - __pre_init",
    ".text",
);

/// The core's own two interrupts that may wait: SysTick (PENDSTCLR) and PendSV (PENDSVCLR).
const END_PENDING: u32 = 1 << 25 | 1 << 27;

/// Turns off what may be on. Before anything is turned on, once.
pub fn begin_anew() {
    // SAFETY: nothing else runs yet, and nobody has the core's peripherals before this returns.
    let core = unsafe { Peripherals::steal() };
    // SAFETY: the runtime has set up memory and all handlers; from here on nothing is pending but what this firmware
    // starts.
    unsafe {
        core.SYST.csr.write(0);
        core.SCB.icsr.write(END_PENDING);
        core.NVIC.icer.iter().for_each(|lines| lines.write(u32::MAX));
        core.NVIC.icpr.iter().for_each(|lines| lines.write(u32::MAX));
        core.MPU.ctrl.write(0);
    }
    #[cfg(feature = "micoair-h743")]
    {
        end_caching(core);
        stop_plls();
    }
    quiet_peripherals();
    // SAFETY: as above.
    unsafe { cortex_m::interrupt::enable() };
}

/// What the data cache holds goes to memory, and nothing goes to the cache any more.
#[cfg(feature = "micoair-h743")]
fn end_caching(mut core: Peripherals) {
    if cortex_m::peripheral::SCB::dcache_enabled() {
        core.SCB.disable_dcache(&mut core.CPUID);
    }
}

/// Looks at a clock that is to change. It changes within microseconds.
#[cfg(feature = "micoair-h743")]
const POLLS: usize = 100_000;

/// Back to the chip's own oscillator. Embassy sets the PLLs as if none ran.
#[cfg(feature = "micoair-h743")]
fn stop_plls() {
    use embassy_stm32::pac::{RCC, rcc::vals::Sw};
    RCC.cr().modify(|w| w.set_hsion(true));
    let _ = (0..POLLS).find(|_| RCC.cr().read().hsirdy());
    RCC.cfgr().modify(|w| w.set_sw(Sw::HSI));
    let _ = (0..POLLS).find(|_| RCC.cfgr().read().sws() == Sw::HSI);
    for pll in 0..3 {
        RCC.cr().modify(|w| w.set_pllon(pll, false));
        let _ = (0..POLLS).find(|_| !RCC.cr().read().pllrdy(pll));
    }
}

/// Resets the DMA controllers, which would go on writing to memory, and the USB port, which a host would go on talking
/// to.
#[cfg(feature = "micoair-h743")]
fn quiet_peripherals() {
    let reset = embassy_stm32::pac::RCC.ahb1rstr();
    for is_reset in [true, false] {
        reset.modify(|w| {
            w.set_dma1rst(is_reset);
            w.set_dma2rst(is_reset);
            w.set_usb_otg_fsrst(is_reset);
        });
    }
}

/// Resets the DMA controllers, which would go on writing to memory, and the USB port, which a host would go on talking
/// to.
#[cfg(feature = "crazyflie-bolt")]
fn quiet_peripherals() {
    let (dma, usb) = (embassy_stm32::pac::RCC.ahb1rstr(), embassy_stm32::pac::RCC.ahb2rstr());
    for is_reset in [true, false] {
        dma.modify(|w| {
            w.set_dma1rst(is_reset);
            w.set_dma2rst(is_reset);
        });
        usb.modify(|w| w.set_usb_otg_fsrst(is_reset));
    }
}
