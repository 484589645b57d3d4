//! Whether the board's crystal runs. The driver of the clocks would wait for it for ever, without a report.

use embassy_stm32::pac::RCC;

/// Looks at it, at least: each takes 4 cycles or more of a core at 64 MHz or less, so a tenth of a second together at
/// the least. A crystal takes a few milliseconds.
const POLLS_MAX: u32 = 1_600_000;

/// Starts the crystal; whether it runs. Before the clocks are set, once.
pub fn starts() -> bool {
    RCC.cr().modify(|w| w.set_hseon(true));
    let runs = (0..POLLS_MAX).any(|_| RCC.cr().read().hserdy());
    if !runs {
        RCC.cr().modify(|w| w.set_hseon(false));
    }
    runs
}
