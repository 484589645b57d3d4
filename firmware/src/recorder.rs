//! The flight recorder: the last seconds of the last flight, in memory that outlives a reset.
//!
//! ```text
//! control -> Tick -> Ring (memory that no start clears) -> ULog over the link (LOG_REQUEST_LIST, LOG_REQUEST_DATA)
//! ```
//!
//! - A recording begins when the vehicle is armed and ends [`RECORDED_AFTERWARDS_US`] after it is disarmed or stopped.
//!   The one before it is lost then, and not sooner: after a crash that reset the board, what led to it is there to be
//!   fetched.
//! - A record is of one tick. Up to 100 Hz each tick makes one, above that each second, third ...: records are
//!   [`RECORD_SPACING_MIN_US`] or more apart, so that memory and card hold as long a flight at any rate. Where the card
//!   takes the [raw gyro](gyro) as well they are [`SPACING_BESIDE_GYRO_US`] apart.
//! - Every record carries a number and a checksum ([`ring`]). What a reset cut short is left out, and so is what was
//!   never written.
//! - What is fetched is a [ULog file](ulog), which PlotJuggler, `pyulog` and PX4's Flight Review read. No recording is
//!   served while one is made.
//!
//! A loss of power loses it. Where a board has a memory card, [`crate::card`] follows along ([`follow`]) and writes
//! every record to it.

pub mod follow;
pub mod gyro;
pub mod ring;
pub mod tick;
pub mod ulog;

use core::cell::RefCell;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use ring::Ring;
use tick::Tick;

/// How long is recorded after the motors have stopped: what the vehicle does then is worth knowing.
pub const RECORDED_AFTERWARDS_US: u64 = 2_000_000;

/// The least time between two records.
pub const RECORD_SPACING_MIN_US: u64 = 10_000;

/// The same beside the raw gyro: a card then writes no more sectors than without it, 33 a second.
pub const SPACING_BESIDE_GYRO_US: u64 = 40_000;

/// What records, and what there is.
struct Recording {
    ring: Ring<'static>,
    /// What the vehicle is called.
    vehicle: &'static str,
    /// The time between ticks, and between records, us.
    period: u64,
    spacing: u64,
    /// How long it is until the next record, and until the recording ends, us.
    next: u64,
    left: u64,
}

/// The recorder that control writes and the link reads.
pub struct Recorder<M: RawMutex>(Mutex<M, RefCell<Option<Recording>>>);

impl<M: RawMutex> Recorder<M> {
    /// Without memory: it records nothing.
    pub const fn new() -> Self {
        Self(Mutex::new(RefCell::new(None)))
    }

    /// Records in `ring` from now on; what it has kept can be fetched, as of a `vehicle` that is called so.
    pub fn attach(&self, ring: Ring<'static>, vehicle: &'static str) {
        self.0.lock(|recording| {
            recording.replace(Some(Recording {
                ring,
                vehicle,
                period: RECORD_SPACING_MIN_US,
                spacing: RECORD_SPACING_MIN_US,
                next: 0,
                left: 0,
            }))
        });
    }

    /// What the vehicle is called.
    pub fn vehicle(&self) -> &'static str {
        self.with(|recording| recording.vehicle).unwrap_or_default()
    }

    /// Control ticks are so long apart, us, and records `spacing` at least: [`RECORD_SPACING_MIN_US`] both, unless this
    /// says otherwise.
    pub fn ticks_last(&self, period: u64, spacing: u64) {
        self.with(|recording| {
            recording.period = period.max(1);
            recording.spacing = spacing.div_ceil(recording.period) * recording.period;
        });
    }

    /// The time between two records, us.
    pub fn spacing(&self) -> u64 {
        self.with(|recording| recording.spacing).unwrap_or(RECORD_SPACING_MIN_US)
    }

    /// One control tick of a vehicle that is `armed` or not.
    pub fn record(&self, armed: bool, tick: impl FnOnce() -> Tick) {
        self.with(|recording| {
            let Recording { ring, period, spacing, next, left, .. } = recording;
            if armed && *left == 0 {
                ring.begin();
                *next = 0;
            }
            *left = if armed { RECORDED_AFTERWARDS_US } else { left.saturating_sub(*period) };
            if *left > 0 && *next == 0 {
                ring.put(&tick().to_bytes());
                *next = *spacing;
            }
            *next = next.saturating_sub(*period);
        });
    }

    /// The length of the last recording as a file, bytes; none while one is made, or without one.
    pub fn size(&self) -> Option<u32> {
        let count = self.with(|recording| (recording.left == 0).then(|| recording.ring.len())).flatten();
        count.filter(|&count| count > 0).map(ulog::size)
    }

    /// Reads the file from `offset` on into `out`; how many bytes there were. None while a recording is made.
    pub fn read(&self, offset: u32, out: &mut [u8]) -> usize {
        let read = |recording: &mut Recording| {
            let Recording { ring, vehicle, left, .. } = recording;
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
