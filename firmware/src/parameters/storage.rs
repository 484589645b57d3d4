//! Parameters in flash: read at boot, written when changed and only while no motor turns.
//!
//! All values are one record of a [`journal`](super::journal), each known by its place in the table, so a firmware with
//! more parameters reads what an older one wrote. The key that frames are signed with is another.
//!
//! What was stored and cannot be read is lost, and the vehicle does not arm until it is set again: a default would open
//! a fence or a link that its owner closed. Nothing is written over lost parameters before that, so a restart does not
//! forget the loss.
//!
//! Erasing a sector of internal flash can stall the whole processor for seconds on some boards. So nothing is written
//! while a motor turns, and while something is, none begins to: control refuses.

use super::journal::{Journal, Kept, Kind, VALUES_MAX};
use super::table::PARAMETERS;
use super::{DEFAULTS, Values};
use crate::deadline::within;
use crate::hardware::{Clock, Fault, Flash};
use crate::link::signing::KEPT_WORDS;
use crate::shared::{Event, Severity, StorageView};
use embassy_sync::blocking_mutex::raw::RawMutex;

const _: () = assert!(PARAMETERS.len() <= VALUES_MAX);

/// How often the values are looked at without a word that one has changed.
const SAVE_POLL_INTERVAL_US: u64 = 10_000_000;

/// How often a change waiting for the vehicle to disarm is looked at again.
const SAVE_RETRY_INTERVAL_US: u64 = 200_000;

/// Flash that keeps parameters.
pub struct Storage<F> {
    journal: Journal<F>,
    /// What was last read or written.
    saved: Values,
}

impl<F: Flash> Storage<F> {
    /// Reads every parameter, once, before the first tick. What was never stored stays at its default; what is lost, or
    /// out of range, as well, and that is announced.
    pub fn load<M: RawMutex>(flash: F, shared: StorageView<'_, M>) -> Self {
        let mut journal = Journal::open(flash);
        let mut values = DEFAULTS.map(f32::to_bits);
        if journal.read(Kind::Parameters, &mut values) == Kept::Lost {
            values = DEFAULTS.map(f32::to_bits);
            shared.parameters().lose_all();
            shared.announce(Event::new(Severity::Critical, "Parameters lost: defaults taken; set them again"));
        }
        let mut signing = [0; KEPT_WORDS];
        match journal.read(Kind::Signing, &mut signing) {
            Kept::Whole => {
                shared.signing().restore(&signing);
                // Its stamps are to be kept ahead before anything flies.
                shared.parameters().save_soon();
            }
            Kept::Lost => {
                shared.signing().lose();
                shared.announce(Event::new(Severity::Critical, "Signing key lost: set it over USB"));
            }
            Kept::Never => {}
        }
        for (row, value) in PARAMETERS.iter().zip(values) {
            if shared.parameters().restore(row.parameter, f32::from_bits(value)).is_err() {
                let words = format_args!("{} lost: default taken; set it again", row.name);
                shared.announce(Event::new(Severity::Critical, words));
            }
        }
        if [Kind::Parameters, Kind::Signing].iter().any(|kind| journal.is_endangered(*kind)) {
            shared.announce(Event::new(Severity::Warning, "Stored values: one copy only, written anew"));
            shared.parameters().save_soon();
        }
        Self { journal, saved: shared.parameters().all() }
    }

    /// Saves what changes, for ever.
    pub async fn keep<M: RawMutex>(&mut self, clock: &impl Clock, shared: StorageView<'_, M>) -> ! {
        loop {
            // A change is announced by the signal; the time limit only makes the wait a bounded one.
            let _ = within(clock, SAVE_POLL_INTERVAL_US, shared.parameters().changed.wait()).await;
            // Raised first and checked afterwards: control either sees it, or has already reported that a motor turns.
            shared.saving().raise();
            while shared.is_turning() {
                shared.saving().lower();
                clock.until(clock.now().saturating_add(SAVE_RETRY_INTERVAL_US)).await;
                shared.saving().raise();
            }
            self.save(shared);
            self.save_signing(shared, clock.now());
            shared.saving().lower();
        }
    }

    /// Writes the values if one differs from what was saved, or has no copy; none while one is lost.
    fn save<M: RawMutex>(&mut self, shared: StorageView<'_, M>) {
        let values = shared.parameters().all();
        // By their bits: NaN stands for "as built", and NaN is not equal to itself.
        let differ = |value: &f32, saved: &f32| value.to_bits() != saved.to_bits();
        let is_saved = !values.iter().zip(&self.saved).any(|(value, saved)| differ(value, saved))
            && !self.journal.is_endangered(Kind::Parameters)
            && !self.journal.is_lost(Kind::Parameters);
        if is_saved || shared.parameters().lost().is_some() {
            return;
        }
        let written = self.append(Kind::Parameters, &values.map(f32::to_bits)).is_ok();
        for (row, (value, saved)) in PARAMETERS.iter().zip(values.iter().zip(&self.saved)) {
            if !written && differ(value, saved) {
                let words = format_args!("{}: set, but could not be saved", row.name);
                shared.announce(Event::new(Severity::Warning, words));
            }
        }
        self.saved = values;
    }

    /// Writes the key and how far its stamps have come, if what was written does not do any more.
    fn save_signing<M: RawMutex>(&mut self, shared: StorageView<'_, M>, now: u64) {
        let unkept = shared.signing().unkept(now, self.journal.is_endangered(Kind::Signing));
        if unkept.is_some_and(|words| self.append(Kind::Signing, &words).is_err()) {
            shared.announce(Event::new(Severity::Warning, "Signing: key or stamps could not be saved"));
        }
    }

    /// Twice and no more: one place may be bad, and a flash that fails would be worn out by more. The next change is
    /// another chance.
    fn append(&mut self, kind: Kind, words: &[u32]) -> Result<(), Fault> {
        self.journal.append(kind, words).or_else(|_| self.journal.append(kind, words))
    }
}
