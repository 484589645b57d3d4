//! The latest texts, so that one text does not fill the line.

use super::event::Event;
use core::cell::Cell;
use core::hash::{Hash, Hasher};
use core::mem::discriminant;
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;

const TEXTS_REMEMBERED: usize = 8;

/// How long a text is not sent again.
const TEXT_INTERVAL_MIN_MS: u32 = 1_000;

/// The last texts, each by its kind's hash, and when they were sent, ms.
pub(super) struct RecentTexts<M: RawMutex> {
    sent: Mutex<M, Cell<[(u32, u32); TEXTS_REMEMBERED]>>,
    /// The time of control's last tick, ms; zero before the first, when nothing is held back.
    now: AtomicU32,
}

impl<M: RawMutex> RecentTexts<M> {
    /// Nothing sent yet.
    pub const fn new() -> Self {
        Self { sent: Mutex::new(Cell::new([(0, 0); TEXTS_REMEMBERED])), now: AtomicU32::new(0) }
    }

    /// It is `now`, us.
    pub fn set_time(&self, now: u64) {
        self.now.store((now / 1_000) as u32, Ordering::Relaxed);
    }

    /// Whether the same words, or a refusal of that kind, were sent within a second; if not, it is remembered. Control
    /// sends every other event once.
    pub fn repeats(&self, event: &Event) -> bool {
        let now = self.now.load(Ordering::Relaxed);
        let mut sum = Sum(0x811C_9DC5);
        // Not formatted: that takes stack which control lacks.
        match event {
            _ if now == 0 => return false,
            Event::Words(_, text) => sum.write(text.as_str().as_bytes()),
            Event::Refused(refusal) => discriminant(refusal).hash(&mut sum),
            _ => return false,
        }
        let sum = sum.0;
        self.sent.lock(|cell| {
            let mut sent = cell.get();
            let is_recent =
                |&(text, at): &(u32, u32)| text == sum && at != 0 && now.wrapping_sub(at) < TEXT_INTERVAL_MIN_MS;
            if sent.iter().any(is_recent) {
                return true;
            }
            sent.rotate_right(1);
            let [first, ..] = &mut sent;
            *first = (sum, now);
            cell.set(sent);
            false
        })
    }
}

/// The FNV hash, of 32 bits.
struct Sum(u32);

impl Hasher for Sum {
    fn write(&mut self, bytes: &[u8]) {
        self.0 = bytes.iter().fold(self.0, |sum, byte| (sum ^ u32::from(*byte)).wrapping_mul(16_777_619));
    }

    fn finish(&self) -> u64 {
        self.0.into()
    }
}
