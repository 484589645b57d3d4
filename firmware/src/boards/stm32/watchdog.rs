//! The independent watchdog: a clock of its own restarts the chip when the control task stops feeding it.

use super::chip;
use crate::configuration::PERIOD_US;
use crate::hardware::Watchdog;
use embassy_stm32::Peri;
use embassy_stm32::pac::iwdg::Iwdg;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_stm32::wdg::IndependentWatchdog;

/// Time without food: 50 ms, or five ticks of a slow control task. The watchdog's clock is crude: on the F405 50 ms
/// are 34 to 94 ms.
const TIMEOUT_US: u32 = if PERIOD_US > 10_000 { 5 * PERIOD_US as u32 } else { 50_000 };

/// Polls within which the watchdog takes over new settings. It needs five of its own cycles, a third of a millisecond.
const SETTING_POLLS_MAX: usize = 100_000;

/// The chip's watchdog. It starts with the first food, so that booting may take its time; then nothing but a restart
/// stops it.
pub struct ChipWatchdog {
    watchdog: IndependentWatchdog<'static, chip::Watchdog>,
    started: bool,
}

impl ChipWatchdog {
    /// Not started.
    pub fn new(peripheral: Peri<'static, chip::Watchdog>) -> Self {
        Self { watchdog: IndependentWatchdog::new(peripheral, TIMEOUT_US), started: false }
    }
}

impl Watchdog for ChipWatchdog {
    fn feed(&mut self) {
        if !self.started {
            self.watchdog.unleash();
            self.started = true;
        }
        self.watchdog.pet();
    }
}

/// Patience of a running watchdog for as long as this lives: for work that stalls the whole core.
pub struct Patience {
    registers: Iwdg,
    prescaler: Pr,
    reload: u16,
}

impl Patience {
    /// Half a minute from now, by the watchdog's clock.
    pub fn new(registers: Iwdg) -> Self {
        let (prescaler, reload) = (registers.pr().read().pr(), registers.rlr().read().rl());
        set(registers, Pr::DIVIDE_BY256, 0xFFF);
        Self { registers, prescaler, reload }
    }
}

impl Drop for Patience {
    fn drop(&mut self) {
        set(self.registers, self.prescaler, self.reload);
    }
}

fn set(registers: Iwdg, prescaler: Pr, reload: u16) {
    // Food in between would lock the registers again.
    cortex_m::interrupt::free(|_| {
        registers.kr().write(|w| w.set_key(Key::ENABLE));
        registers.pr().write(|w| w.set_pr(prescaler));
        registers.rlr().write(|w| w.set_rl(reload));
    });
    // Fed too early, it would start from the old value.
    let _ = (0..SETTING_POLLS_MAX).find(|_| registers.sr().read().0 & 0b11 == 0);
    registers.kr().write(|w| w.set_key(Key::RESET));
}
