//! Transfer errors of the DMA controllers: they end the transfer, and not the flight.
//!
//! Embassy's interrupt handler panics at one. This one is bound to every stream before it, and takes the error away:
//! the controller has switched the stream off by itself, and Embassy's handler, which comes next, finds nothing to do.
//! So no task is woken, and a task that waits is done when its own time limit wakes it. Embassy then takes a stream
//! that is off for one that has finished: where that matters, the motors' frames and the sensors' samples, [`Begun`]
//! makes it a fault. A frame of the link is lost. What the link receives stops; the bytes that follow overrun, and
//! Embassy starts reception again. Dropping a transfer clears its stream, and the next one begins anew.

use crate::hardware::Fault;
use core::marker::PhantomData;
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_stm32::dma::ChannelInstance;
use embassy_stm32::interrupt::typelevel::Handler;
use embassy_stm32::pac::dma::Dma;
use embassy_stm32::{pac, peripherals};

/// Errors of all streams since boot.
static ERRORS: AtomicU32 = AtomicU32::new(0);

/// As many errors as there were when something began.
pub struct Begun(u32);

/// Something begins now.
pub fn begin() -> Begun {
    Begun(ERRORS.load(Ordering::Relaxed))
}

impl Begun {
    /// Whether no stream has failed since then.
    /// Errors: [`Fault`] if one has.
    pub fn whole(&self) -> Result<(), Fault> {
        if ERRORS.load(Ordering::Relaxed) == self.0 { Ok(()) } else { Err(Fault) }
    }
}

/// Bound to a stream's interrupt before Embassy's handler.
pub struct Errors<T>(PhantomData<T>);

/// A stream of one of the controllers.
pub trait Stream: ChannelInstance {
    /// Its controller.
    const CONTROLLER: Dma;
    /// Its number.
    const NUMBER: usize;
}

impl<T: Stream> Handler<T::Interrupt> for Errors<T> {
    unsafe fn on_interrupt() {
        let (half, place) = (T::NUMBER / 4, T::NUMBER % 4);
        if T::CONTROLLER.isr(half).read().teif(place) {
            T::CONTROLLER.ifcr(half).write(|w| w.set_teif(place, true));
            ERRORS.fetch_add(1, Ordering::Relaxed);
        }
    }
}

macro_rules! streams {
    ($controller:ident: $($stream:ident $number:literal),*) => {
        $(impl Stream for peripherals::$stream {
            const CONTROLLER: Dma = pac::$controller;
            const NUMBER: usize = $number;
        })*
    };
}

streams!(DMA1: DMA1_CH0 0, DMA1_CH1 1, DMA1_CH2 2, DMA1_CH3 3, DMA1_CH4 4, DMA1_CH5 5, DMA1_CH6 6, DMA1_CH7 7);
streams!(DMA2: DMA2_CH0 0, DMA2_CH1 1, DMA2_CH2 2, DMA2_CH3 3, DMA2_CH4 4, DMA2_CH5 5, DMA2_CH6 6, DMA2_CH7 7);
