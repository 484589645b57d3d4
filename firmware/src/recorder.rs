//! The flight recorder: the last seconds of the last flight, tick by tick, in memory that outlives a reset.
//!
//! ```text
//! control -> Tick -> Ring (memory that no start clears) -> ULog over the link (LOG_REQUEST_LIST, LOG_REQUEST_DATA)
//! ```
//!
//! - A recording begins when the vehicle is armed and ends [`AFTERWARDS`] after it is disarmed or stopped. The one
//!   before it is lost then, and not sooner: after a crash that reset the board, what led to it is there to be fetched.
//! - Every record carries a number and a checksum ([`ring`]). What a reset cut short is left out, and so is what was
//!   never written.
//! - What is fetched is a [ULog file](ulog), which PlotJuggler, `pyulog` and PX4's Flight Review read. No recording is
//!   served while one is made.
//!
//! A loss of power loses it. Where a board has a memory card, [`crate::card`] follows along ([`follow`]) and writes
//! every record to it.

pub mod follow;
pub mod ring;
pub mod tick;
pub mod ulog;

use core::cell::RefCell;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use ring::Ring;
use tick::Tick;

/// Ticks that are recorded after the motors have stopped: what the vehicle does then is worth knowing.
pub const AFTERWARDS: u16 = 200;

/// What records, and what there is.
struct Recording {
    ring: Ring<'static>,
    /// What the vehicle is called.
    vehicle: &'static str,
    /// Ticks that are still recorded.
    left: u16,
}

/// The recorder that control writes and the link reads.
pub struct Recorder<M: RawMutex>(Mutex<M, RefCell<Option<Recording>>>);

impl<M: RawMutex> Recorder<M> {
    /// Without memory: it records nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self(Mutex::new(RefCell::new(None)))
    }

    /// Records in `ring` from now on; what it has kept can be fetched, as of a `vehicle` that is called so.
    pub fn attach(&self, ring: Ring<'static>, vehicle: &'static str) {
        self.0.lock(|recording| recording.replace(Some(Recording { ring, vehicle, left: 0 })));
    }

    /// What the vehicle is called.
    #[must_use]
    pub fn vehicle(&self) -> &'static str {
        self.with(|recording| recording.vehicle).unwrap_or_default()
    }

    /// One control tick of a vehicle that is `armed` or not.
    pub fn record(&self, armed: bool, tick: impl FnOnce() -> Tick) {
        self.with(|recording| {
            if armed && recording.left == 0 {
                recording.ring.begin();
            }
            recording.left = if armed { AFTERWARDS } else { recording.left.saturating_sub(1) };
            if recording.left > 0 {
                recording.ring.put(&tick().to_bytes());
            }
        });
    }

    /// The length of the last recording as a file, bytes; none while one is made, or without one.
    #[must_use]
    pub fn size(&self) -> Option<u32> {
        let count = self.with(|recording| (recording.left == 0).then(|| recording.ring.len())).flatten();
        count.filter(|&count| count > 0).map(ulog::size)
    }

    /// Reads the file from `offset` on into `out`; how many bytes there were. None while a recording is made.
    #[must_use]
    pub fn read(&self, offset: u32, out: &mut [u8]) -> usize {
        let read = |recording: &mut Recording| {
            let Recording { ring, vehicle, left } = recording;
            if *left == 0 { ulog::read(ring, vehicle, offset as usize, out) } else { 0 }
        };
        self.with(read).unwrap_or(0)
    }

    /// Forgets the last recording. One that is made goes on.
    pub fn erase(&self) {
        self.with(|recording| {
            if recording.left == 0 {
                recording.ring.erase();
            }
        });
    }

    fn with<T>(&self, act: impl FnOnce(&mut Recording) -> T) -> Option<T> {
        self.0.lock(|recording| recording.try_borrow_mut().ok().and_then(|mut recording| recording.as_mut().map(act)))
    }
}

impl<M: RawMutex> Default for Recorder<M> {
    fn default() -> Self {
        Self::new()
    }
}
