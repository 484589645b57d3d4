//! What waits for its turn.

use core::cell::RefCell;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use heapless::Deque;

/// At most `ROOM` values, taken in the order in which they were put in. No task waits for it: neither for room nor for
/// a value.
pub struct Queue<M: RawMutex, T, const ROOM: usize>(Mutex<M, RefCell<Deque<T, ROOM>>>);

/// No room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Full;

impl<M: RawMutex, T, const ROOM: usize> Queue<M, T, ROOM> {
    /// Nothing waits.
    pub const fn new() -> Self {
        Self(Mutex::new(RefCell::new(Deque::new())))
    }

    /// Puts a value behind the others.
    /// Errors: [`Full`] where there is no room; the value is lost.
    pub fn put(&self, value: T) -> Result<(), Full> {
        // The mutex lets one in at a time, so the queue is never borrowed.
        self.0.lock(|queue| queue.try_borrow_mut().ok().and_then(|mut queue| queue.push_back(value).ok()).ok_or(Full))
    }

    /// Takes the first one.
    #[must_use]
    pub fn take(&self) -> Option<T> {
        self.0.lock(|queue| queue.try_borrow_mut().ok()?.pop_front())
    }
}
