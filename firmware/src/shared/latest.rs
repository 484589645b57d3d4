//! The freshest value of something.

use core::cell::Cell;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use flight::Stamped;

/// The freshest value of something, overwritten by each newer one.
pub struct Latest<M: RawMutex, T: Copy>(Mutex<M, Cell<Option<Stamped<T>>>>);

impl<M: RawMutex, T: Copy> Latest<M, T> {
    /// Nothing yet.
    pub const fn new() -> Self {
        Self(Mutex::new(Cell::new(None)))
    }

    /// Replaces the value.
    pub fn put(&self, value: T, time: u64) {
        self.0.lock(|cell| cell.set(Some(Stamped { value, time })));
    }

    /// The value with its time, left in place.
    pub fn get(&self) -> Option<Stamped<T>> {
        self.0.lock(Cell::get)
    }

    /// The value, left in place, if it is at most so old at `now`, us.
    pub fn recent(&self, age_max: u64, now: u64) -> Option<T> {
        self.get().filter(|value| value.age(now) <= age_max).map(|value| value.value)
    }

    /// The value with its time, taken away.
    #[must_use]
    pub fn take(&self) -> Option<Stamped<T>> {
        self.0.lock(Cell::take)
    }
}
