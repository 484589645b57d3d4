//! Every flight as a file on a memory card: each tick, every text that goes out, and the raw gyro where that is wanted.
//!
//! ```text
//! control -> recorder's ring --+-> sectors of whole ULog messages -> LOG00012.ULG
//! events  -> a queue of its own +
//! gyro    -> blocks of samples -+
//! ring as a reset left it ---------------------------------------> REC00013.ULG
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`sector`] | messages in a sector, whole or torn |
//! | [`file_header`] | what a flight's file says of the vehicle, before its data |
//! | [`log`] | a flight's file, made before the flight |
//! | [`copy`] | the recording that a reset left, as a file |
//! | [`library`] | the files, read over the link |
//! | [`volume`] | numbered files in a FAT file system |
//! | [`geometry`] | whether a card's file system can be used |
//!
//! - Control writes to the recorder's ring, as without a card, and never waits. This task follows along; it may fall
//!   behind by as much as the ring holds. What is overwritten before it was read is counted, noted in the file and
//!   reported.
//! - A card may take its time or take for ever: everything here blocks, so a board gives this task the lowest priority
//!   of all. A card that is missing, full, removed, worn out or formatted for something else is reported in words,
//!   tried again every [`RETRY_INTERVAL_US`], and does not prevent arming.
//! - A cut of power loses the sector that is being written (three records) and what was not yet in it. It loses no file
//!   that was there before: [`log`] and [`volume`] explain why.

pub mod copy;
pub mod file_header;
pub mod geometry;
pub mod library;
pub mod log;
pub mod sector;
pub mod volume;

use crate::hardware::{Card, Clock};
use crate::recorder::follow::{Followed, Follower};
use crate::shared::{CardState, CardView, Event, Severity};
use core::convert::Infallible;
use embassy_sync::blocking_mutex::raw::RawMutex;
use file_header::FileHeader;
use heapless::Deque;
use library::Library;
use log::Log;
use volume::{Trouble, Volume};

/// Time between looks for records.
pub const POLL_INTERVAL_US: u64 = 10_000;

/// Time between attempts to use a card that cannot be used.
pub const RETRY_INTERVAL_US: u64 = 3_000_000;

/// What is made ready before a flight: 8 minutes.
pub const PREPARED_BYTES: u32 = 8 << 20;

/// Records that are taken at one look, at most: what fell behind is caught up with in several.
const RECORDS_AT_ONCE: usize = 200;

/// Events that are kept for the beginning of the next flight.
const EVENTS_KEPT: usize = 16;

/// Logs every flight, for ever, in files that are `prepared` bytes long before it: [`PREPARED_BYTES`], if there is
/// nothing against it.
pub async fn run<C: Card, M: RawMutex>(mut card: C, prepared: u32, clock: &impl Clock, shared: CardView<'_, M>) -> ! {
    let mut logger = Logger {
        prepared,
        clock,
        shared,
        follower: shared.recorder().follower(),
        events: Deque::new(),
        is_copied: false,
        missed: 0,
        reported: None,
    };
    loop {
        let Err(trouble) = logger.use_card(&mut card).await;
        shared.card().set(if trouble == Trouble::Absent { CardState::Absent } else { CardState::Failed }, clock.now());
        logger.report(trouble);
        clock.until(clock.now().saturating_add(RETRY_INTERVAL_US)).await;
    }
}

/// Whether a flight goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Flight {
    /// None is recorded.
    None,
    /// More will come.
    Recording,
    /// All of it is in the file.
    Ended,
}

struct Logger<'a, K, M: RawMutex> {
    prepared: u32,
    clock: &'a K,
    shared: CardView<'a, M>,
    follower: Follower,
    /// The newest announced events, and when, us.
    events: Deque<(u64, Event), EVENTS_KEPT>,
    /// Whether the recording that the start found has been copied, as far as it could be.
    is_copied: bool,
    /// Records that this flight's file lacks.
    missed: u32,
    /// The trouble reported last.
    reported: Option<Trouble>,
}

impl<K: Clock, M: RawMutex> Logger<'_, K, M> {
    /// Logs on this card until it makes trouble.
    async fn use_card<C: Card>(&mut self, card: &mut C) -> Result<Infallible, Trouble> {
        let shared = self.shared;
        card.start().map_err(|_| Trouble::Absent)?;
        let volume = Volume::open(card)?;
        if !core::mem::replace(&mut self.is_copied, true) {
            // Tried once: a card that has no room for it would get an empty file at each attempt.
            if let Some(number) = copy::copy(&volume, shared.recorder())? {
                shared.announce(Event::new(Severity::Information, format_args!("Last recording: REC{number:05}.ULG")));
            }
        }
        let mut library = Library::default();
        loop {
            let mut log = Log::prepare(&volume, &self.beginning())?;
            let number = log.number();
            shared.card().set(CardState::Ready, self.clock.now());
            if self.reported.take().is_some() || !log.has_begun() {
                shared.announce(Event::new(Severity::Information, format_args!("Card: next log {number:05}")));
            }
            if let Err(trouble) = self.fill(&volume, &mut log, &mut library).await {
                // What is not on the card goes into the next file.
                self.follower.go_back(log.pending());
                return Err(trouble);
            }
            let ticks = log.finish(&volume)?;
            let missed = core::mem::take(&mut self.missed);
            let severity = if missed > 0 { Severity::Warning } else { Severity::Information };
            let words = format_args!("Log {number:05}: {ticks} records, {missed} missed");
            shared.announce(Event::new(severity, words));
        }
    }

    /// What files begin with now.
    fn beginning(&self) -> FileHeader<'_, M> {
        FileHeader { vehicle: self.shared.recorder().vehicle(), parameters: self.shared.parameters() }
    }

    /// Fills a file with a flight, as much of it as a file holds. Until the flight begins, other files may be
    /// read; while none is, this one is made longer.
    async fn fill<C: Card>(
        &mut self,
        volume: &Volume<'_, C>,
        log: &mut Log,
        library: &mut Library,
    ) -> Result<(), Trouble> {
        let mut may_grow = true;
        loop {
            self.shared.card().set(CardState::Ready, self.clock.now());
            match self.write(volume, log)? {
                Flight::Ended => return Ok(()),
                Flight::Recording if log.is_full() => return Ok(()),
                Flight::None if self.serve(volume, log, library) => {}
                Flight::None if may_grow && log.size() < self.prepared => match log.grow(volume) {
                    Ok(()) => {}
                    // It is as long as it can be, and will do for a shorter flight.
                    Err(Trouble::Full) => {
                        may_grow = false;
                        self.report(Trouble::Full);
                    }
                    Err(trouble) => return Err(trouble),
                },
                Flight::None | Flight::Recording => {}
            }
            self.clock.until(self.clock.now().saturating_add(POLL_INTERVAL_US)).await;
        }
    }

    /// Answers the link's questions about the files; whether a client is reading.
    fn serve<C: Card>(&self, volume: &Volume<'_, C>, log: &Log, library: &mut Library) -> bool {
        let (shared, now) = (self.shared, self.clock.now());
        if let Some(question) = shared.library().take_question() {
            let answer = library.answer(question, now, volume, log.number(), shared.recorder());
            shared.library().answer(question, answer);
            shared.outgoing().signal(());
        } else if !library.is_busy(now) {
            library.close(volume);
        }
        library.is_busy(now)
    }

    /// Writes what there is to be written.
    fn write<C: Card>(&mut self, volume: &Volume<'_, C>, log: &mut Log) -> Result<Flight, Trouble> {
        self.keep_events();
        while !log.is_full()
            && let Some(block) = self.shared.gyro_log().take()
        {
            // Of flights alone.
            if log.has_begun() {
                log.gyro(volume, &block)?;
            }
        }
        for _ in 0..RECORDS_AT_ONCE {
            match self.shared.recorder().follow(&mut self.follower) {
                Followed::Record { is_first: true, .. } if log.has_begun() => {
                    // The next flight, whose first record is for the next file.
                    self.follower.go_back(1);
                    return Ok(Flight::Ended);
                }
                Followed::Record { record, missed, .. } => {
                    if missed > 0 {
                        self.missed = self.missed.saturating_add(missed);
                        log.gap(volume, missed, self.shared.recorder().spacing())?;
                    }
                    log.record(volume, &self.beginning(), &record).inspect_err(|_| self.follower.go_back(1))?;
                }
                Followed::Nothing { is_recording } => {
                    if log.has_begun() {
                        while let Some((time, event)) = self.events.pop_front() {
                            log.event(volume, time, &event)?;
                        }
                    }
                    return Ok(match (is_recording, log.has_begun()) {
                        (true, _) => Flight::Recording,
                        (false, true) => Flight::Ended,
                        (false, false) => Flight::None,
                    });
                }
            }
            if log.is_full() {
                break;
            }
        }
        Ok(Flight::Recording)
    }

    /// Takes announced events; the oldest makes room.
    fn keep_events(&mut self) {
        while let Some(event) = self.shared.card_events().take() {
            if self.events.is_full() {
                let _ = self.events.pop_front();
            }
            let _ = self.events.push_back((self.clock.now(), event));
        }
    }

    /// Reports a trouble once.
    fn report(&mut self, trouble: Trouble) {
        if self.reported != Some(trouble) {
            self.reported = Some(trouble);
            let severity = if trouble == Trouble::Absent { Severity::Information } else { Severity::Warning };
            self.shared.announce(Event::new(severity, trouble));
        }
    }
}
