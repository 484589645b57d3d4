//! DShot300 for four motors on the four channels of one timer, by burst DMA.
//!
//! The timer rests between frames: counter stopped at zero, every channel low. [`Motors::write`] draws the frames,
//! starts the counter, and at each update event one DMA burst sets the four widths of the next bit. The counter starts
//! only once the transfer waits for it, so that no burst can straddle an update. However a write ends, also if it is
//! dropped half-way, the timer rests again, and a controller discards the frame that was cut by its checksum.
//!
//! The words are as wide as the timer's compare registers: a half-word written to a 32-bit timer would arrive doubled
//! in both halves of the register, a motor at full throttle.

use super::transfers;
use crate::dshot::{self, BIT_RATE, ROWS, Waveform};
use crate::hardware::{Fault, MOTORS, MotorCommand, Motors};
use embassy_futures::select::{Either, select};
use embassy_stm32::Peri;
use embassy_stm32::dma::InterruptHandler;
use embassy_stm32::interrupt::typelevel::Binding;
use embassy_stm32::pac::timer::TimGp16;
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::{CountingMode, OutputCompareMode, RoundTo, Timer};
use embassy_stm32::timer::simple_pwm::PwmPin;
use embassy_stm32::timer::{Ch1, Ch2, Ch3, Ch4, Channel, GeneralInstance4Channel, UpDma};

/// The timer's four pins, by channel.
pub struct Pins<T: GeneralInstance4Channel>(
    pub PwmPin<'static, T, Ch1>,
    pub PwmPin<'static, T, Ch2>,
    pub PwmPin<'static, T, Ch3>,
    pub PwmPin<'static, T, Ch4>,
);

/// How long a frame may take, us. It takes a bit time a row, 60 us.
const FRAME_WITHIN: u64 = 4 * ROWS as u64 * 1_000_000 / BIT_RATE as u64;

/// Four controllers on one timer. Must live in memory that the DMA controller reaches.
pub struct Dshot<T: GeneralInstance4Channel, D: UpDma<T>, I> {
    timer: Timer<'static, T>,
    dma: Peri<'static, D>,
    interrupts: I,
    waveform: Waveform<T::Word>,
    /// The channel (0 to 3) of each motor.
    channels: [usize; MOTORS],
    /// Timer ticks in a bit.
    period: u16,
    /// Held for as long as the timer drives them.
    _pins: Pins<T>,
}

impl<T, D, I> Dshot<T, D, I>
where
    T: GeneralInstance4Channel,
    D: UpDma<T>,
    I: Binding<D::Interrupt, InterruptHandler<D>> + Copy,
{
    /// Every channel low, nothing sent. Motor i is on channel `channels[i]` (0 to 3); `dma` is the timer's update
    /// request.
    pub fn new(
        timer: Peri<'static, T>,
        pins: Pins<T>,
        channels: [usize; MOTORS],
        dma: Peri<'static, D>,
        interrupts: I,
    ) -> Self {
        let timer = Timer::new(timer);
        timer.set_counting_mode(CountingMode::EdgeAlignedUp);
        timer.set_frequency(Hertz(BIT_RATE), RoundTo::Slower);
        timer.set_autoreload_preload(true);
        for channel in [Channel::Ch1, Channel::Ch2, Channel::Ch3, Channel::Ch4] {
            timer.set_output_compare_mode(channel, OutputCompareMode::PwmMode1);
            timer.set_output_compare_preload(channel, true);
            timer.enable_channel(channel, true);
        }
        rest(timer.regs_gp16());
        timer.enable_outputs();
        let period = timer.regs_gp16().arr().read().arr() + 1;
        Self { timer, dma, interrupts, waveform: Waveform::silent(), channels, period, _pins: pins }
    }

    /// Wires motor i to the output `wiring[i]` of those that the board has.
    pub fn wire(&mut self, wiring: [usize; MOTORS]) {
        let channels = self.channels;
        self.channels = wiring.map(|output| channels.get(output).copied().unwrap_or(output));
    }

    async fn send(&mut self) -> Result<(), Fault> {
        let resting = Resting(self.timer.regs_gp16());
        self.timer.enable_update_dma(true);
        let words = self.waveform.words();
        let (dma, interrupts) = (self.dma.reborrow(), self.interrupts);
        let transfer = self.timer.setup_update_dma_burst(dma, interrupts, Channel::Ch1, Channel::Ch4, words);
        let begun = transfers::begin();
        self.timer.start();
        let sent = select(transfer, embassy_time::Timer::after_micros(FRAME_WITHIN)).await;
        drop(resting);
        match sent {
            Either::First(()) => begun.whole(),
            Either::Second(()) => Err(Fault),
        }
    }
}

impl<T, D, I> Motors for Dshot<T, D, I>
where
    T: GeneralInstance4Channel,
    D: UpDma<T>,
    I: Binding<D::Interrupt, InterruptHandler<D>> + Copy,
{
    async fn write(&mut self, command: MotorCommand) -> Result<(), Fault> {
        let frames = dshot::frames(command);
        let usable = frames.as_ref().map(|_| ()).map_err(|fault| *fault);
        self.waveform.draw(&frames.unwrap_or_else(|_| dshot::stop()), &self.channels, self.period);
        self.send().await?;
        usable
    }
}

/// Puts the timer to rest when a write ends, whichever way.
struct Resting(TimGp16);

impl Drop for Resting {
    fn drop(&mut self) {
        rest(self.0);
    }
}

/// Stops the counter at zero with every channel low, and takes back its requests to the DMA controller.
///
/// Order matters: requests off first, so that the update event that loads the zeros requests no transfer.
pub fn rest(timer: TimGp16) {
    timer.dier().modify(|w| w.set_ude(false));
    timer.cr1().modify(|w| w.set_cen(false));
    for channel in 0..MOTORS {
        timer.ccr(channel).write(|w| w.set_ccr(0));
    }
    timer.egr().write(|w| w.set_ug(true));
}
