//! What motors' controllers answer on their own lines: samples of the pins, between two frames.
//!
//! Both ways ([`Protocol::BothWays`](crate::dshot::Protocol)) a line rests high. After a frame its pin is an input for
//! a while, pulled up, and a timer has DMA copy the port's pins to memory, [`SAMPLES_PER_BIT`] times in a bit of the
//! answer; then the timer's channel drives the pin again. So any pin will do, on whichever channel its frames come out,
//! complementary outputs too, which cannot capture. Pins on two ports take two streams, at the timer's update and at
//! its second compare event, half a sample later. (The Bolt needs the first one's stream for its radio chip.)
//!
//! Modes of pins are changed by reading and writing a register that a port's pins share. Nothing but this changes one
//! once the tasks run.
//!
//! However listening ends, also if it is dropped half-way, the pins are outputs again and the timer rests. Where a
//! panic cuts it, [`drive`] does it.
//!
//! [`SAMPLES_PER_BIT`]: crate::esc::samples::SAMPLES_PER_BIT

use super::transfers;
use crate::esc::samples::{self, SAMPLE_COUNT, SAMPLE_RATE_HZ};
use crate::hardware::{Fault, MOTOR_COUNT};
use embassy_futures::join::join;
use embassy_futures::select::{Either, select};
use embassy_stm32::Peri;
use embassy_stm32::dma::{Channel, InterruptHandler, Request, TransferOptions};
use embassy_stm32::interrupt::typelevel::Binding;
use embassy_stm32::pac::gpio::Gpio;
use embassy_stm32::pac::gpio::vals::{Moder, Pupdr};
use embassy_stm32::pac::timer::TimGp16;
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::{RoundTo, Timer};
use embassy_stm32::timer::{Ch2, Dma, GeneralInstance4Channel, UpDma};

/// The longest it may take; it takes 107 us.
const LISTENING_TIMEOUT_US: u64 = 200;

/// The channel whose compare event has the second port's pins copied, from 0.
const COMPARE: usize = 1;

/// A motor's pin: its port, and its number there.
#[derive(Clone, Copy)]
pub struct MotorPin {
    /// The port.
    pub port: Gpio,
    /// From 0 to 15.
    pub number: u8,
}

impl MotorPin {
    fn set(self, mode: Moder) {
        self.port.moder().modify(|w| w.set_moder(usize::from(self.number), mode));
    }
}

/// Has the motors' timers drive their pins.
pub fn drive(pins: &[MotorPin]) {
    pins.iter().for_each(|pin| pin.set(Moder::ALTERNATE));
}

/// Makes inputs of the motors' pins: somebody else may drive the lines.
pub fn release(pins: &[MotorPin]) {
    pins.iter().for_each(|pin| pin.set(Moder::INPUT));
}

/// The samples of one port.
struct Ear {
    port: Gpio,
    channel: Channel<'static>,
    request: Request,
    samples: [u16; SAMPLE_COUNT],
}

impl Ear {
    async fn hear(&mut self) {
        let pins = self.port.idr().as_ptr().cast();
        // SAFETY: a port's register of inputs, of which the lower half has the pins; the samples are borrowed for as
        // long as the transfer goes on, and dropping it ends it.
        unsafe { self.channel.read::<u16>(self.request, pins, &mut self.samples, TransferOptions::default()) }.await;
    }
}

/// What listens to all motors' lines. Must live in memory that the DMA controller reaches.
pub struct Ears<T: GeneralInstance4Channel> {
    timer: Timer<'static, T>,
    /// In the order of the outputs.
    pins: [MotorPin; MOTOR_COUNT],
    first: Ear,
    second: Option<Ear>,
}

impl<T: GeneralInstance4Channel> Ears<T> {
    /// For the motors' `pins` on one port, paced by a timer that nothing else uses; `dma` is its update request.
    pub fn on_a_port<D: UpDma<T>>(
        timer: Peri<'static, T>,
        pins: [MotorPin; MOTOR_COUNT],
        port: Gpio,
        dma: Peri<'static, D>,
        interrupts: impl Binding<D::Interrupt, InterruptHandler<D>> + 'static,
    ) -> Self {
        let timer = Timer::new(timer);
        timer.set_frequency(Hertz(SAMPLE_RATE_HZ), RoundTo::Slower);
        let registers = timer.regs_gp16();
        registers.ccr(COMPARE).write(|w| w.set_ccr(registers.arr().read().arr() / 2));
        let request = dma.request();
        let channel = Channel::new(dma, interrupts);
        Self { timer, pins, first: Ear { port, channel, request, samples: [0; SAMPLE_COUNT] }, second: None }
    }

    /// And for those on a second one; `dma` is the timer's second compare request.
    #[must_use]
    pub fn and<D: Dma<T, Ch2>>(
        mut self,
        port: Gpio,
        dma: Peri<'static, D>,
        interrupts: impl Binding<D::Interrupt, InterruptHandler<D>> + 'static,
    ) -> Self {
        let request = dma.request();
        let channel = Channel::new(dma, interrupts);
        self.second = Some(Ear { port, channel, request, samples: [0; SAMPLE_COUNT] });
        self
    }

    /// Pulls the lines up, for good: what nobody drives rests high.
    pub fn pull_up(&self) {
        for pin in self.pins {
            pin.port.pupdr().modify(|w| w.set_pupdr(usize::from(pin.number), Pupdr::PULL_UP));
        }
    }

    /// Listens right after a frame.
    /// Errors: [`Fault`] if the samples did not come.
    pub async fn listen(&mut self) -> Result<(), Fault> {
        let registers = self.timer.regs_gp16();
        let listening = Listening::begin(registers, self.pins);
        let begun = transfers::begin();
        let second = async {
            if let Some(second) = &mut self.second {
                second.hear().await;
            }
        };
        let start = async { registers.cr1().modify(|w| w.set_cen(true)) };
        // Each is polled in turn, so both streams wait when the timer starts.
        let heard = join(join(self.first.hear(), second), start);
        let heard = select(heard, embassy_time::Timer::after_micros(LISTENING_TIMEOUT_US)).await;
        drop(listening);
        match heard {
            Either::First(_) => begun.whole(),
            Either::Second(()) => Err(Fault),
        }
    }

    /// The levels of the answer on the motors' pin of this index, if there was one.
    pub fn levels(&self, output: usize) -> Option<u32> {
        let pin = self.pins.get(output)?;
        let ears = [Some(&self.first), self.second.as_ref()];
        let ear = ears.into_iter().flatten().find(|ear| ear.port.as_ptr() == pin.port.as_ptr())?;
        samples::levels(&ear.samples, pin.number)
    }
}

/// While the pins are inputs and the timer may ask for transfers.
struct Listening(TimGp16, [MotorPin; MOTOR_COUNT]);

impl Listening {
    fn begin(timer: TimGp16, pins: [MotorPin; MOTOR_COUNT]) -> Self {
        timer.cnt().write(|w| w.set_cnt(0));
        timer.sr().write(|w| w.0 = 0);
        timer.dier().modify(|w| {
            w.set_ude(true);
            w.set_ccde(COMPARE, true);
        });
        release(&pins);
        Self(timer, pins)
    }
}

impl Drop for Listening {
    fn drop(&mut self) {
        self.0.cr1().modify(|w| w.set_cen(false));
        self.0.dier().modify(|w| {
            w.set_ude(false);
            w.set_ccde(COMPARE, false);
        });
        drive(&self.1);
    }
}
