//! What the chips add to [`crate::boards::handover`]: a data cache stands between the core and the DMA buffers, a PLL
//! that runs takes no new settings, and DMA controllers go on writing to memory.

use cortex_m::Peripherals;

/// Turns off what may be on.
pub fn quiet(core: &mut Peripherals) {
    #[cfg(feature = "micoair-h743")]
    {
        end_caching(core);
        stop_plls();
    }
    #[cfg(feature = "crazyflie-bolt")]
    let _ = core;
    quiet_peripherals();
}

/// What the data cache holds goes to memory, and nothing goes to the cache any more.
#[cfg(feature = "micoair-h743")]
fn end_caching(core: &mut Peripherals) {
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
