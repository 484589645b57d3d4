//! Parameters in flash: read at boot, written when changed and only while disarmed.
//!
//! Each parameter is an item of its own, known by its place in the table, so a firmware with more parameters reads what an
//! older one wrote. `sequential-storage` spreads the wear, checks what it reads and repairs what a power cut left behind.
//!
//! Erasing a page of internal flash can stall the whole processor for seconds on some boards: another reason to write
//! only while disarmed. A vehicle that arms during a write on a board that does not stall is not hindered.

use super::table::PARAMETERS;
use super::{DEFAULTS, Values};
use crate::hardware::Clock;
use crate::shared::{Severity, Shared};
use core::ops::Range;
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_storage_async::nor_flash::NorFlash;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapConfigError, MapStorage};

/// An item (a key of one byte, a value of four) rounded up to the longest word of any flash, bytes; twice that for room.
const ITEM: usize = 64;

/// Reading every parameter takes less than this unless the flash hangs, us.
const READ_TIME_MAX: u64 = 500_000;

/// Writing one takes less than this, the erasure of two pages included, unless the flash hangs, us.
const WRITE_TIME_MAX: u64 = 10_000_000;

/// How often a change waiting for the vehicle to disarm is looked at again, us.
const RETRY: u64 = 200_000;

/// Flash that keeps parameters.
pub struct Storage<F: NorFlash> {
    map: MapStorage<u8, F, Cache<Uncached, Uncached, Uncached, u8>>,
    /// What was last read or written.
    saved: Values,
}

impl<F: NorFlash> Storage<F> {
    /// Storage in this part of the flash.
    ///
    /// # Errors
    /// If the range is not one of at least two whole pages.
    pub fn new(flash: F, range: Range<u32>) -> Result<Self, MapConfigError> {
        let map = MapStorage::new(flash, MapConfig::try_new(range)?, Cache::new_uncached());
        Ok(Self { map, saved: DEFAULTS })
    }

    /// Reads every parameter, once, before the first tick. What is missing, damaged or out of range stays at its default;
    /// all but the first is announced.
    pub async fn load<M: RawMutex>(&mut self, clock: &impl Clock, shared: &Shared<M>) {
        let end = clock.now().saturating_add(READ_TIME_MAX);
        if let Either::Second(()) = select(self.read(shared), clock.until(end)).await {
            shared.announce(Severity::Warning, &["Parameters: storage does not answer"]);
        }
        self.saved = shared.parameters.all();
    }

    async fn read<M: RawMutex>(&mut self, shared: &Shared<M>) {
        for row in &PARAMETERS {
            let mut buffer = [0; ITEM];
            let good = match self.map.fetch_item::<f32>(&mut buffer, &(row.parameter as u8)).await {
                Ok(None) => true,
                Ok(Some(value)) => shared.parameters.restore(row.parameter, value).is_ok(),
                Err(_) => false,
            };
            if !good {
                let name = row.name;
                shared.announce(Severity::Warning, &[name, ": stored value unusable, default taken"]);
            }
        }
    }

    /// Saves what changes, for ever.
    pub async fn keep<M: RawMutex>(&mut self, clock: &impl Clock, shared: &Shared<M>) -> ! {
        loop {
            // A change is announced by the signal; the time limit only makes the wait a bounded one.
            let wake = clock.now().saturating_add(WRITE_TIME_MAX);
            let _ = select(shared.parameters.changed.wait(), clock.until(wake)).await;
            self.save(clock, shared).await;
        }
    }

    /// Writes every value that differs from what was saved, each one as soon as the vehicle is disarmed.
    async fn save<M: RawMutex>(&mut self, clock: &impl Clock, shared: &Shared<M>) {
        for (row, saved) in PARAMETERS.iter().zip(&mut self.saved) {
            let value = shared.parameters.get(row.parameter);
            if value == *saved {
                continue;
            }
            while shared.is_armed() {
                clock.until(clock.now().saturating_add(RETRY)).await;
            }
            let mut buffer = [0; ITEM];
            let key = row.parameter as u8;
            let end = clock.now().saturating_add(WRITE_TIME_MAX);
            let written = select(self.map.store_item(&mut buffer, &key, &value), clock.until(end)).await;
            // Not tried again: a flash that fails would be worn out by it. The next change is another chance.
            *saved = value;
            if !matches!(written, Either::First(Ok(()))) {
                let name = row.name;
                shared.announce(Severity::Warning, &[name, ": set, but could not be saved"]);
            }
        }
    }
}
