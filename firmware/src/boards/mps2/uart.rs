//! CMSDK UARTs as byte streams: an interrupt moves each received byte into a buffer, and wakes a task that waits to
//! send.
//!
//! A byte that finds the buffer full is lost and counted, as it would be on a wire.

use core::cell::Cell;
use core::convert::Infallible;
use core::future::poll_fn;
use core::task::Poll;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_sync::waitqueue::AtomicWaker;
use embedded_io_async::{ErrorType, Read, Write};

/// Received bytes that wait to be read: more than two answers of the simulator, each of two poses and ten samples of
/// its sensors.
const BUFFER_BYTES: usize = 4096;

/// Cycles a bit: 25 MHz / 27 = 926 kBd. The emulator sends bytes at once, but wants a rate that a UART could have.
const CYCLES_PER_BIT: u32 = 27;

// Offsets in words, and bits.
const DATA_REGISTER: usize = 0;
const STATE_REGISTER: usize = 1;
const CONTROL_REGISTER: usize = 2;
const INTERRUPTS_REGISTER: usize = 3;
const BAUD_DIVIDER_REGISTER: usize = 4;
const STATE_TRANSMIT_FULL: u32 = 1 << 0;
const STATE_RECEIVE_FULL: u32 = 1 << 1;
const CONTROL_ENABLE: u32 = 0b1111;
const INTERRUPT_TRANSMIT: u32 = 1 << 0;
const INTERRUPT_RECEIVE: u32 = 1 << 1;

/// One of the board's UARTs.
pub struct Uart {
    base: usize,
    received: Pipe<CriticalSectionRawMutex, BUFFER_BYTES>,
    transmitted: AtomicWaker,
    lost: Mutex<CriticalSectionRawMutex, Cell<u32>>,
}

/// To the simulator.
pub static SIMULATOR: Uart = Uart::new(0x4000_4000);

/// To the ground station.
pub static GROUND: Uart = Uart::new(0x4000_5000);

impl Uart {
    const fn new(base: usize) -> Self {
        Self { base, received: Pipe::new(), transmitted: AtomicWaker::new(), lost: Mutex::new(Cell::new(0)) }
    }

    fn read_register(&self, offset: usize) -> u32 {
        // SAFETY: `base` is the address of a UART with five registers; `offset` is one of the constants above.
        unsafe { (self.base as *const u32).add(offset).read_volatile() }
    }

    fn write_register(&self, offset: usize, value: u32) {
        // SAFETY: as above.
        unsafe { (self.base as *mut u32).add(offset).write_volatile(value) }
    }

    pub(super) fn init(&self) {
        self.write_register(BAUD_DIVIDER_REGISTER, CYCLES_PER_BIT);
        self.write_register(CONTROL_REGISTER, CONTROL_ENABLE);
    }

    /// Both directions of the stream. The buffers are shared: one reader and one writer at a time make sense of it.
    pub fn split(&'static self) -> (Receiver, Sender) {
        (Receiver(self), Sender(self))
    }

    /// Bytes lost since boot.
    pub fn lost(&self) -> u32 {
        self.lost.lock(Cell::get)
    }

    fn on_receive(&self) {
        self.write_register(INTERRUPTS_REGISTER, INTERRUPT_RECEIVE);
        while self.read_register(STATE_REGISTER) & STATE_RECEIVE_FULL != 0 {
            let byte = self.read_register(DATA_REGISTER) as u8;
            if self.received.try_write(&[byte]).is_err() {
                self.lost.lock(|lost| lost.set(lost.get().saturating_add(1)));
            }
        }
    }

    fn on_transmit(&self) {
        self.write_register(INTERRUPTS_REGISTER, INTERRUPT_TRANSMIT);
        self.transmitted.wake();
    }
}

/// The bytes a UART receives.
pub struct Receiver(&'static Uart);

impl ErrorType for Receiver {
    type Error = Infallible;
}

impl Read for Receiver {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        Ok(self.0.received.read(buffer).await)
    }
}

/// The bytes a UART sends.
pub struct Sender(&'static Uart);

impl ErrorType for Sender {
    type Error = Infallible;
}

impl Write for Sender {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for byte in bytes {
            let full = || self.0.read_register(STATE_REGISTER) & STATE_TRANSMIT_FULL != 0;
            poll_fn(|context| {
                self.0.transmitted.register(context.waker());
                if full() { Poll::Pending } else { Poll::Ready(()) }
            })
            .await;
            self.0.write_register(DATA_REGISTER, u32::from(*byte));
        }
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

pub(super) unsafe extern "C" fn simulator_received() {
    SIMULATOR.on_receive();
}

pub(super) unsafe extern "C" fn simulator_transmitted() {
    SIMULATOR.on_transmit();
}

pub(super) unsafe extern "C" fn ground_received() {
    GROUND.on_receive();
}

pub(super) unsafe extern "C" fn ground_transmitted() {
    GROUND.on_transmit();
}
