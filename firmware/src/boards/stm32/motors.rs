//! DShot300 for four motors on the channels of one timer, or of two, by burst DMA.
//!
//! A timer rests between frames: counter stopped at zero, every channel low. [`Motors::write`] draws the frames, starts
//! the counter, and at each update event one DMA burst sets the four widths of the next bit. The counter starts only
//! once the transfer waits for it, so that no burst can straddle an update. However a write ends, also if it is dropped
//! half-way, the timer rests again, and a controller discards the frame that was cut by its checksum. Two timers send
//! at the same time, each on its own.
//!
//! *Both ways* ([`Protocol::BothWays`]) the outputs are inverted: they rest high, and the same widths are low pulses.
//! [`Ears`] then hear what the controllers answer.
//!
//! The words are as wide as the timer's compare registers: a half-word written to a 32-bit timer would arrive doubled
//! in both halves of the register, a motor at full throttle.

use super::ears::Ears;
use super::transfers;
use crate::dshot::{self, BIT_RATE_HZ, Protocol, WAVEFORM_ROWS, Waveform};
use crate::esc::answer::Answer;
use crate::esc::gcr;
use crate::esc::request::Request;
use crate::hardware::{Fault, MOTOR_COUNT, MotorCommand, Motors};
use core::marker::PhantomData;
use core::mem::forget;
use dshot_frame::NormalFrame;
use embassy_futures::join::join;
use embassy_futures::select::{Either, select};
use embassy_stm32::Peri;
use embassy_stm32::dma::InterruptHandler;
use embassy_stm32::gpio::OutputType;
use embassy_stm32::interrupt::typelevel::Binding;
use embassy_stm32::pac::timer::TimGp16;
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::complementary_pwm::ComplementaryPwmPin;
use embassy_stm32::timer::low_level::{CountingMode, OutputCompareMode, RoundTo, Timer};
use embassy_stm32::timer::simple_pwm::PwmPin;
use embassy_stm32::timer::{
    AdvancedInstance4Channel, Channel, GeneralInstance4Channel, TimerChannel, TimerComplementaryPin, TimerPin, UpDma,
};

/// How long a frame may take. It takes a bit time a row, 60 us.
const FRAME_TIMEOUT_US: u64 = 4 * WAVEFORM_ROWS as u64 * 1_000_000 / BIT_RATE_HZ as u64;

/// The enable bits of a channel in CCER, the first channel's: the others' follow every four bits. Timers without
/// complementary outputs have nothing in the second's place.
const DIRECT_ENABLE_BIT: u32 = 1;
const COMPLEMENTARY_ENABLE_BIT: u32 = 1 << 2;

/// From an enable bit to the bit that inverts the output, and all of those.
const INVERTING_SHIFT: u32 = 1;
const INVERTING_BITS: u32 = 0xAAAA;

/// An output: a pin that a channel of the timer drives from here on.
pub struct Line<T> {
    channel: u8,
    enable: u32,
    _timer: PhantomData<T>,
}

impl<T: GeneralInstance4Channel> Line<T> {
    /// On a channel's own pin.
    pub fn direct<C: TimerChannel>(pin: Peri<'static, impl TimerPin<T, C>>) -> Self {
        forget(PwmPin::<T, C>::new(pin, OutputType::PushPull));
        Self::new(C::CHANNEL, DIRECT_ENABLE_BIT)
    }

    /// On the pin of its complementary output (CHxN), which is as high as its own would be while that is off.
    pub fn complementary<C: TimerChannel>(pin: Peri<'static, impl TimerComplementaryPin<T, C>>) -> Self
    where
        T: AdvancedInstance4Channel,
    {
        forget(ComplementaryPwmPin::<T, C>::new(pin, OutputType::PushPull));
        Self::new(C::CHANNEL, COMPLEMENTARY_ENABLE_BIT)
    }

    fn new(channel: Channel, enable: u32) -> Self {
        let index = channel.index();
        Self { channel: index as u8, enable: enable << (4 * index), _timer: PhantomData }
    }
}

/// What sends frames to some of the motors, or to all.
pub trait Lines {
    /// Wires motor i to the output `wiring[i]` of those that the board has.
    fn wire(&mut self, wiring: [usize; MOTOR_COUNT]);

    /// Speaks both ways from now on: the lines rest high.
    fn invert(&mut self);

    /// Prepares a frame for each motor.
    fn draw(&mut self, frames: &[NormalFrame; MOTOR_COUNT], protocol: Protocol);

    /// Sends the frames.
    fn send(&mut self) -> impl Future<Output = Result<(), Fault>>;
}

/// Controllers on one timer. Must live in memory that the DMA controller reaches.
pub struct OnTimer<T: GeneralInstance4Channel, D: UpDma<T>, I> {
    timer: Timer<'static, T>,
    dma: Peri<'static, D>,
    interrupts: I,
    waveform: Waveform<T::Word>,
    /// The channel (0 to 3) of each motor; none where it is on another timer.
    channels: [Option<u8>; MOTOR_COUNT],
    /// The enable bits of the lines.
    enable: u32,
    /// Timer ticks in a bit.
    period: u16,
}

impl<T, D, I> OnTimer<T, D, I>
where
    T: GeneralInstance4Channel,
    D: UpDma<T>,
    I: Binding<D::Interrupt, InterruptHandler<D>> + Copy,
{
    /// Every channel low, nothing sent. `lines` are the board's outputs in their order, none for those on another
    /// timer; `dma` is the timer's update request.
    pub fn new(
        timer: Peri<'static, T>,
        lines: [Option<Line<T>>; MOTOR_COUNT],
        dma: Peri<'static, D>,
        interrupts: I,
    ) -> Self {
        let timer = Timer::new(timer);
        timer.set_counting_mode(CountingMode::EdgeAlignedUp);
        timer.set_frequency(Hertz(BIT_RATE_HZ), RoundTo::Slower);
        timer.set_autoreload_preload(true);
        for channel in [Channel::Ch1, Channel::Ch2, Channel::Ch3, Channel::Ch4] {
            timer.set_output_compare_mode(channel, OutputCompareMode::PwmMode1);
            timer.set_output_compare_preload(channel, true);
        }
        let enable = lines.iter().flatten().fold(0, |enable, line| enable | line.enable);
        timer.regs_gp16().ccer().modify(|w| w.0 |= enable);
        rest(timer.regs_gp16());
        timer.enable_outputs();
        let period = timer.regs_gp16().arr().read().arr() + 1;
        let channels = lines.map(|line| line.map(|line| line.channel));
        Self { timer, dma, interrupts, waveform: Waveform::silent(), channels, enable, period }
    }
}

impl<T, D, I> Lines for OnTimer<T, D, I>
where
    T: GeneralInstance4Channel,
    D: UpDma<T>,
    I: Binding<D::Interrupt, InterruptHandler<D>> + Copy,
{
    fn wire(&mut self, wiring: [usize; MOTOR_COUNT]) {
        let channels = self.channels;
        self.channels = wiring.map(|output| channels.get(output).copied().flatten());
    }

    fn invert(&mut self) {
        self.timer.regs_gp16().ccer().modify(|w| w.0 |= self.enable << INVERTING_SHIFT);
    }

    fn draw(&mut self, frames: &[NormalFrame; MOTOR_COUNT], protocol: Protocol) {
        self.waveform.draw(frames, protocol, &self.channels, self.period);
    }

    async fn send(&mut self) -> Result<(), Fault> {
        let resting = Resting(self.timer.regs_gp16());
        self.timer.enable_update_dma(true);
        let words = self.waveform.words();
        let (dma, interrupts) = (self.dma.reborrow(), self.interrupts);
        let transfer = self.timer.setup_update_dma_burst(dma, interrupts, Channel::Ch1, Channel::Ch4, words);
        let begun = transfers::begin();
        self.timer.start();
        let sent = select(transfer, embassy_time::Timer::after_micros(FRAME_TIMEOUT_US)).await;
        drop(resting);
        match sent {
            Either::First(()) => begun.whole(),
            Either::Second(()) => Err(Fault),
        }
    }
}

impl<A: Lines, B: Lines> Lines for (A, B) {
    fn wire(&mut self, wiring: [usize; MOTOR_COUNT]) {
        self.0.wire(wiring);
        self.1.wire(wiring);
    }

    fn invert(&mut self) {
        self.0.invert();
        self.1.invert();
    }

    fn draw(&mut self, frames: &[NormalFrame; MOTOR_COUNT], protocol: Protocol) {
        self.0.draw(frames, protocol);
        self.1.draw(frames, protocol);
    }

    async fn send(&mut self) -> Result<(), Fault> {
        let (first, second) = join(self.0.send(), self.1.send()).await;
        first.and(second)
    }
}

/// The motors on their lines.
pub struct Dshot<L, T: GeneralInstance4Channel> {
    lines: L,
    ears: Ears<T>,
    protocol: Protocol,
    /// The output of each motor.
    wiring: [usize; MOTOR_COUNT],
    /// Where controllers are asked for extended answers.
    request: Option<Request>,
    answers: [Option<Answer>; MOTOR_COUNT],
}

impl<L: Lines, T: GeneralInstance4Channel> Dshot<L, T> {
    /// Plain frames, motor i on output i.
    pub fn new(lines: L, ears: Ears<T>) -> Self {
        let (protocol, wiring) = (Protocol::Plain, [0, 1, 2, 3]);
        Self { lines, ears, protocol, wiring, request: None, answers: [None; MOTOR_COUNT] }
    }

    /// Wires motor i to the output `wiring[i]` of those that the board has.
    pub fn wire(&mut self, wiring: [usize; MOTOR_COUNT]) {
        self.wiring = wiring;
        self.lines.wire(wiring);
    }

    /// Speaks both ways from now on, where the controllers may be asked for `extended` answers as well.
    pub fn listen(&mut self, extended: bool) {
        self.protocol = Protocol::BothWays;
        self.request = extended.then(Request::default);
        self.ears.pull_up();
        self.lines.invert();
    }

    async fn hear(&mut self) {
        self.answers = [None; MOTOR_COUNT];
        if self.ears.listen().await.is_ok() {
            let heard = |output| Answer::from_bits(gcr::decoded(self.ears.levels(output)?)?);
            self.answers = self.wiring.map(heard);
        }
        if let Some(request) = &mut self.request {
            request.note(&self.answers);
        }
    }
}

impl<L: Lines, T: GeneralInstance4Channel> Motors for Dshot<L, T> {
    async fn write(&mut self, command: MotorCommand) -> Result<(), Fault> {
        let frames = dshot::frames(command);
        let usable = frames.as_ref().map(|_| ()).map_err(|fault| *fault);
        let mut frames = frames.unwrap_or_else(|_| dshot::stop());
        if let Some(request) = &mut self.request {
            let asked = request.next(command == MotorCommand::Stop);
            frames.iter_mut().zip(asked).filter(|(_, asked)| *asked).for_each(|(frame, _)| *frame = dshot::extend());
        }
        self.lines.draw(&frames, self.protocol);
        self.lines.send().await?;
        if self.protocol == Protocol::BothWays {
            self.hear().await;
        }
        usable
    }

    fn answers(&mut self) -> [Option<Answer>; MOTOR_COUNT] {
        core::mem::take(&mut self.answers)
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
    for channel in 0..MOTOR_COUNT {
        timer.ccr(channel).write(|w| w.set_ccr(0));
    }
    timer.egr().write(|w| w.set_ug(true));
}

/// How the controllers on a timer are spoken to, as its registers say.
pub fn protocol(timer: TimGp16) -> Protocol {
    if timer.ccer().read().0 & INVERTING_BITS == 0 { Protocol::Plain } else { Protocol::BothWays }
}
