//! The raw gyro on its way to the card: every sample, in blocks as PX4's topic `sensor_gyro_fifo` has them.
//!
//! ```text
//! inertial sensor's task -> block of 32 samples -> blocks that wait -> card's file
//! ```
//!
//! A sample is what the sensor measured: body axes, before calibration and filters, in the counts that it came in. A
//! block ends when it is full, or where samples are missing. It has the time of its last sample and the mean time
//! between two of its samples, by the data-ready edges. Where the card falls behind, the oldest block makes room; the
//! times show the gap.
//!
//! Without memory ([`GyroLog::attach`]) nothing is logged, and nothing costs anything.

use super::ulog::head;
use crate::registers::RATE_PER_COUNT;
use core::cell::RefCell;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use nalgebra::Vector3;

/// Samples of a block.
const BLOCK_SAMPLES: usize = 32;

/// Bytes of a block's numbers before its samples: two times, device, time between samples, scale.
const BLOCK_HEAD_BYTES: usize = 28;

/// Bytes of an axis.
const AXIS_BYTES: usize = 2 * BLOCK_SAMPLES;

/// Bytes of a block: the last is how many samples it has.
pub const BLOCK_BYTES: usize = BLOCK_HEAD_BYTES + 3 * AXIS_BYTES + 1;

/// A block, as it stands in the file.
pub type Block = [u8; BLOCK_BYTES];

/// The longest time between two samples of a block: three of the slowest sensor's periods.
const SAMPLE_GAP_MAX_US: u64 = 3_000;

/// Its name and its fields in ULog's words: PX4's.
pub const FORMAT: &str = "sensor_gyro_fifo:uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float dt;\
float scale;int16_t[32] x;int16_t[32] y;int16_t[32] z;uint8_t samples;";
const NAME: &str = "sensor_gyro_fifo";

const FORMAT_HEAD: [u8; 3] = head(b'F', FORMAT.len());

/// Kind A: blocks are subscription 1, the first of their name.
const SUBSCRIPTION_HEAD: [u8; 6] = {
    let [low, high, kind] = head(b'A', 3 + NAME.len());
    [low, high, kind, 0, 1, 0]
};

/// The message that defines a block.
pub const FORMAT_PARTS: [&[u8]; 2] = [&FORMAT_HEAD, FORMAT.as_bytes()];

/// The message after which blocks may come.
pub const SUBSCRIPTION_PARTS: [&[u8]; 2] = [&SUBSCRIPTION_HEAD, NAME.as_bytes()];

/// What stands before each block.
pub const DATA_HEAD: [u8; 5] = {
    let [low, high, kind] = head(b'D', 2 + BLOCK_BYTES);
    [low, high, kind, 1, 0]
};

/// Blocks that wait in memory, one of them being filled.
struct Waiting {
    blocks: &'static mut [Block],
    /// The oldest that is full, and how many are.
    oldest: usize,
    full: usize,
    /// Samples of the one behind these, and the times of its first and of the newest of all, us.
    samples: usize,
    first: u64,
    newest: u64,
}

/// The raw gyro that the inertial sensor's task writes and the card's reads.
pub struct GyroLog<M: RawMutex>(Mutex<M, RefCell<Option<Waiting>>>);

impl<M: RawMutex> GyroLog<M> {
    /// Without memory: nothing is logged.
    pub const fn new() -> Self {
        Self(Mutex::new(RefCell::new(None)))
    }

    /// Logs in these blocks, two at least, from now on.
    pub fn attach(&self, blocks: &'static mut [Block]) {
        if blocks.len() >= 2 {
            let waiting = Waiting { blocks, oldest: 0, full: 0, samples: 0, first: 0, newest: 0 };
            self.0.lock(|cell| cell.replace(Some(waiting)));
        }
    }

    /// Whether anything is logged.
    pub fn is_attached(&self) -> bool {
        self.with(|_| ()).is_some()
    }

    /// A sample of `time`, us: body rate, rad/s, as it was measured.
    pub fn put(&self, time: u64, rate: &Vector3<f32>) {
        self.with(|waiting| {
            if waiting.samples > 0 && !(1..=SAMPLE_GAP_MAX_US).contains(&time.saturating_sub(waiting.newest)) {
                waiting.finish();
            }
            waiting.put(time, rate);
            if waiting.samples == BLOCK_SAMPLES {
                waiting.finish();
            }
        });
    }

    /// The oldest block that waits.
    pub fn take(&self) -> Option<Block> {
        self.with(|waiting| {
            waiting.full = waiting.full.checked_sub(1)?;
            let block = waiting.blocks.get(waiting.oldest).copied();
            waiting.oldest = (waiting.oldest + 1) % waiting.blocks.len();
            block
        })
        .flatten()
    }

    fn with<T>(&self, act: impl FnOnce(&mut Waiting) -> T) -> Option<T> {
        self.0.lock(|waiting| waiting.try_borrow_mut().ok().and_then(|mut waiting| waiting.as_mut().map(act)))
    }
}

impl Waiting {
    /// The block that is being filled.
    fn filling(&mut self) -> Option<&mut Block> {
        let place = (self.oldest + self.full) % self.blocks.len();
        self.blocks.get_mut(place)
    }

    fn put(&mut self, time: u64, rate: &Vector3<f32>) {
        let sample = self.samples;
        let counts = rate.map(|rate| (rate / RATE_PER_COUNT + 0.5_f32.copysign(rate)) as i16);
        let Some(block) = self.filling() else { return };
        if sample == 0 {
            block.fill(0);
        }
        let axes = block.get_mut(BLOCK_HEAD_BYTES..).unwrap_or_default().as_chunks_mut::<AXIS_BYTES>().0;
        for (axis, count) in axes.iter_mut().zip(&counts) {
            if let Some(place) = axis.as_chunks_mut().0.get_mut(sample) {
                *place = count.to_le_bytes();
            }
        }
        (self.samples, self.newest) = (sample + 1, time);
        if sample == 0 {
            self.first = time;
        }
    }

    /// Ends the block that is being filled; the oldest makes room for the next.
    fn finish(&mut self) {
        let (samples, newest) = (core::mem::take(&mut self.samples), self.newest);
        let between = newest.saturating_sub(self.first) as f32 / samples.saturating_sub(1).max(1) as f32;
        let Some(block) = self.filling() else { return };
        let (time, device) = (newest.to_le_bytes(), 1_u32.to_le_bytes());
        let (between, scale) = (between.to_le_bytes(), RATE_PER_COUNT.to_le_bytes());
        let begins = time.iter().chain(&time).chain(&device).chain(&between).chain(&scale);
        block.iter_mut().zip(begins).for_each(|(to, from)| *to = *from);
        if let Some(last) = block.last_mut() {
            *last = samples as u8;
        }
        if self.full + 1 == self.blocks.len() {
            self.oldest = (self.oldest + 1) % self.blocks.len();
        } else {
            self.full += 1;
        }
    }
}

#[cfg(test)]
mod tests;
