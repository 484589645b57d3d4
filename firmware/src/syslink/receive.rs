//! The line's receiving half.

use super::message::Received;
use super::parser::Parser;
use super::wire::Wire;
use crate::hardware::Clock;
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::Read;

/// The longest wait for bytes, and the wait after a line that failed.
const READ_TIMEOUT_US: u64 = 100_000;
const RETRY_DELAY_US: u64 = 1_000;

/// Bytes read at once.
const READ_CHUNK_BYTES: usize = 32;

/// What comes from the chip.
pub struct Listener<'a, M: RawMutex> {
    parser: Parser,
    wire: &'a Wire<M>,
}

impl<'a, M: RawMutex> Listener<'a, M> {
    /// Nothing received yet.
    pub const fn new(wire: &'a Wire<M>) -> Self {
        Self { parser: Parser::new(), wire }
    }

    /// Takes bytes that came at `now`, us, and hands on what they say.
    pub fn feed(&mut self, bytes: &[u8], now: u64) {
        let wire = self.wire;
        self.parser.feed(bytes, |frame| {
            if let Some(said) = Received::from_frame(frame) {
                wire.take(said, now);
            }
        });
        wire.count(self.parser.dropped(), now);
    }
}

/// Receives for ever.
pub async fn receive<R: Read, M: RawMutex>(mut line: R, clock: &impl Clock, wire: &Wire<M>) -> ! {
    let mut listener = Listener::new(wire);
    let mut chunk = [0; READ_CHUNK_BYTES];
    loop {
        let wake = clock.now().saturating_add(READ_TIMEOUT_US);
        match select(line.read(&mut chunk), clock.until(wake)).await {
            Either::First(Ok(count @ 1..)) => listener.feed(chunk.get(..count).unwrap_or(&chunk), clock.now()),
            Either::First(_) => clock.until(clock.now().saturating_add(RETRY_DELAY_US)).await,
            Either::Second(()) => {}
        }
    }
}
