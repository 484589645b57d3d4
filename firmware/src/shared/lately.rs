//! What people were told a moment ago, so that nobody fills the line with one text.

use super::event::{Event, Text};
use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;

/// Texts that are remembered.
const REMEMBERED: usize = 8;

/// How long a text is not said again, ms.
const SILENCE: u32 = 1_000;

/// The last texts, each by a checksum, and when they were said, ms.
pub(super) struct Lately<M: RawMutex> {
    said: Mutex<M, Cell<[(u16, u32); REMEMBERED]>>,
    /// The time of control's last tick, ms; zero before the first, when nothing is held back.
    now: AtomicU32,
}

impl<M: RawMutex> Lately<M> {
    /// Nothing said.
    pub const fn new() -> Self {
        Self { said: Mutex::new(Cell::new([(0, 0); REMEMBERED])), now: AtomicU32::new(0) }
    }

    /// It is `now`, us.
    pub fn pass(&self, now: u64) {
        self.now.store((now / 1_000) as u32, Ordering::Relaxed);
    }

    /// Whether the same was said within a second; if not, it is remembered. A change of mode is always news.
    pub fn has_said(&self, event: &Event) -> bool {
        let now = self.now.load(Ordering::Relaxed);
        if now == 0 || matches!(event, Event::Mode(_)) {
            return false;
        }
        let sum = mavlink::calculate_crc(Text::new(event).as_str().as_bytes(), 0);
        self.said.lock(|cell| {
            let mut said = cell.get();
            let is_recent = |&(text, at): &(u16, u32)| text == sum && at != 0 && now.wrapping_sub(at) < SILENCE;
            if said.iter().any(is_recent) {
                return true;
            }
            said.rotate_right(1);
            let [first, ..] = &mut said;
            *first = (sum, now);
            cell.set(said);
            false
        })
    }
}
