//! What the other tasks know of the card.

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

/// Events that wait to be logged.
pub const CARD_EVENTS_CAPACITY: usize = 16;

/// The longest the card's task may be silent: more than an attempt to start a card and the wait for the next one.
pub const CARD_TIMEOUT_US: u64 = 10_000_000;

/// How the card is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CardState {
    /// The board has no slot for one.
    NoSlot,
    /// The slot is empty.
    Absent,
    /// It cannot be used.
    Failed,
    /// A flight would be logged, or is.
    Ready,
}

/// The card's state.
pub struct CardStatus {
    state: AtomicU8,
    /// When its task last set the state, ms.
    updated: AtomicU32,
}

impl CardStatus {
    /// No slot.
    pub const fn new() -> Self {
        Self { state: AtomicU8::new(CardState::NoSlot as u8), updated: AtomicU32::new(0) }
    }

    /// Sets the state, at `now`, us.
    pub fn set(&self, state: CardState, now: u64) {
        self.updated.store(milliseconds(now), Ordering::Relaxed);
        self.state.store(state as u8, Ordering::Relaxed);
    }

    /// How it is.
    pub fn state(&self) -> CardState {
        let state = self.state.load(Ordering::Relaxed);
        [CardState::NoSlot, CardState::Absent, CardState::Failed, CardState::Ready]
            .into_iter()
            .find(|known| *known as u8 == state)
            .unwrap_or(CardState::NoSlot)
    }

    /// Whether its task has been silent for too long at `now`, us: the card, or its driver, blocks it.
    pub fn is_silent(&self, now: u64) -> bool {
        let silence = milliseconds(now).wrapping_sub(self.updated.load(Ordering::Relaxed));
        self.state() != CardState::NoSlot && u64::from(silence) > CARD_TIMEOUT_US / 1_000
    }

    /// Whether flights are logged at `now`, us; none where there is no card that could.
    pub fn health(&self, now: u64) -> Option<bool> {
        match self.state() {
            CardState::NoSlot | CardState::Absent => None,
            CardState::Failed => Some(false),
            CardState::Ready => Some(!self.is_silent(now)),
        }
    }
}

/// The lowest 32 bits of the time in ms.
fn milliseconds(time: u64) -> u32 {
    (time / 1_000) as u32
}
