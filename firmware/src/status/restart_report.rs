//! Why the vehicle restarted by itself, reported: to the first ground station, to the card once it is ready, and every
//! [`RESTART_REPORT_INTERVAL_US`] until the vehicle arms.

use crate::shared::{CardState, Event, Severity, StatusView, TEXT_MAX};
use embassy_sync::blocking_mutex::raw::RawMutex;

/// The time between two reports.
pub const RESTART_REPORT_INTERVAL_US: u64 = 60_000_000;

/// When and to whom they are reported.
#[derive(Debug, Default)]
pub struct RestartReport {
    /// The receivers of the last report: a ground station, the card.
    listened: [bool; 2],
    /// When they are due again, us.
    due: u64,
    is_over: bool,
}

impl RestartReport {
    /// Reports them, if it is time at `now`, us.
    pub fn tick<M: RawMutex>(&mut self, shared: StatusView<'_, M>, now: u64) {
        self.is_over |= shared.is_armed();
        let Some(words) = shared.last_words().get().filter(|_| !self.is_over) else { return };
        let listening = [shared.ground_station().get().is_some(), shared.card().state() == CardState::Ready];
        let is_new = listening.iter().zip(&self.listened).any(|(now, before)| *now && !before);
        if !is_new && now < self.due {
            return;
        }
        *self = Self { listened: listening, due: now.saturating_add(RESTART_REPORT_INTERVAL_US), is_over: false };
        let mut rest = words.value.as_str();
        let mut head = "Restarted: ";
        while !rest.is_empty() {
            // Cut at a whole character, as a text is.
            let length = rest.floor_char_boundary(TEXT_MAX - head.len());
            shared.announce(Event::new(Severity::Critical, format_args!("{head}{rest}")));
            (rest, head) = (rest.get(length..).unwrap_or(""), "");
        }
    }
}
