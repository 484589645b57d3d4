//! The card's files, read over the link: counted, measured, read a chunk at a time, between two looks for records.
//!
//! Offered are the newest [`FILES_OFFERED_MAX`] files, in the order of their numbers, and behind them the flight
//! recorder's recording. What a number stands for is settled when they are counted. Files are opened for reading only.
//! One that cannot be read is reported as unreadable, and the card goes on logging: an old file's damage is no reason
//! not to log the next flight.

use super::log;
use super::volume::{Entry, File, Kind, Trouble, Volume};
use crate::hardware::{Card, SECTOR_BYTES};
use crate::recorder::Recorder;
use crate::shared::{Answer, Bytes, LOG_CHUNK_BYTES, Question, Read};
use core::ops::ControlFlow;
use embassy_sync::blocking_mutex::raw::RawMutex;
use heapless::Vec;

/// Files that are offered at most.
pub const FILES_OFFERED_MAX: usize = 64;

/// How long after a question the next one is expected: what can wait does, meanwhile.
const QUESTION_INTERVAL_MAX_US: u64 = 1_000_000;

/// What is offered, and what of it is open. It belongs to the volume that it was used with.
#[derive(Default)]
pub struct Library {
    /// In the order of their numbers; none until they have been counted.
    files: Option<Vec<Entry, FILES_OFFERED_MAX>>,
    open: Option<Open>,
    /// Until when a client is reading, us.
    busy_until: u64,
}

/// An open file, and how much of it was used.
#[derive(Clone, Copy)]
struct Open {
    id: u16,
    file: File,
    size: u32,
}

impl Library {
    /// Whether a client is reading at `now`, us.
    pub fn is_busy(&self, now: u64) -> bool {
        now < self.busy_until
    }

    /// Answers a question at `now`, us. The file of number `next` is being filled and not offered.
    pub fn answer<C: Card, M: RawMutex>(
        &mut self,
        question: Question,
        now: u64,
        volume: &Volume<'_, C>,
        next: u32,
        recorder: Read<'_, Recorder<M>>,
    ) -> Answer {
        self.busy_until = now.saturating_add(QUESTION_INTERVAL_MAX_US);
        let answer = self.find(question, volume, next, recorder);
        answer.unwrap_or_else(|_| {
            self.close(volume);
            Answer::Unreadable
        })
    }

    /// Closes what is open.
    pub fn close<C: Card>(&mut self, volume: &Volume<'_, C>) {
        if let Some(open) = self.open.take() {
            // It was not written to, so there is nothing to lose.
            let _ = volume.close(open.file);
        }
    }

    fn find<C: Card, M: RawMutex>(
        &mut self,
        question: Question,
        volume: &Volume<'_, C>,
        next: u32,
        recorder: Read<'_, Recorder<M>>,
    ) -> Result<Answer, Trouble> {
        if question == Question::Count || self.files.is_none() {
            self.close(volume);
            self.files = Some(files(volume, next)?);
        }
        let files = self.files.as_deref().unwrap_or_default();
        let count = files.len() as u16;
        let (id, offset) = match question {
            Question::Count => return Ok(Answer::Count(count + u16::from(recorder.size().is_some()))),
            Question::Size(id) => (id, None),
            Question::Bytes { id, offset } => (id, Some(offset)),
        };
        let Some(entry) = files.get(usize::from(id)).copied() else {
            // Behind them there is one more, as if it were the only one.
            let question = match (id.checked_sub(count), offset) {
                (Some(0), None) => Question::Size(0),
                (Some(0), Some(offset)) => Question::Bytes { id: 0, offset },
                _ => return Ok(Answer::Unknown),
            };
            return Ok(recorder.answer(question));
        };
        let open = self.opened(id, &entry, volume)?;
        let Some(offset) = offset else { return Ok(Answer::Size(open.size)) };
        let mut bytes = [0; LOG_CHUNK_BYTES];
        let left = open.size.saturating_sub(offset).min(LOG_CHUNK_BYTES as u32) as usize;
        let wanted = bytes.get_mut(..left).unwrap_or_default();
        let count = if left > 0 { volume.read(open.file, offset, wanted)? } else { 0 };
        Ok(Answer::Bytes(bytes.get(..count).and_then(|bytes| Bytes::from_slice(bytes).ok()).unwrap_or_default()))
    }

    /// The open file of this number; another one is closed.
    fn opened<C: Card>(&mut self, id: u16, entry: &Entry, volume: &Volume<'_, C>) -> Result<Open, Trouble> {
        if let Some(open) = self.open.filter(|open| open.id == id) {
            return Ok(open);
        }
        self.close(volume);
        let file = volume.open_to_read(entry.kind, entry.number)?;
        // Known as open before anything else can fail: a failure closes it.
        let open = self.open.insert(Open { id, file, size: entry.size });
        if entry.kind == Kind::Log && entry.size.is_multiple_of(SECTOR_BYTES as u32) {
            open.size = log::end(volume, file, entry.size)?;
        }
        Ok(*open)
    }
}

/// The newest files that hold something, in the order of their numbers.
fn files<C: Card>(volume: &Volume<'_, C>, next: u32) -> Result<Vec<Entry, FILES_OFFERED_MAX>, Trouble> {
    let mut files: Vec<Entry, FILES_OFFERED_MAX> = Vec::new();
    volume.list(|entry| {
        let is_offered = entry.size > 0 && entry.is_sound && (entry.kind, entry.number) != (Kind::Log, next);
        let place = files.iter().take_while(|other| other.number < entry.number).count();
        if is_offered && (!files.is_full() || place > 0) {
            // The oldest makes room.
            let shift = usize::from(files.is_full());
            if shift > 0 {
                files.remove(0);
            }
            // There is room, and the place is not beyond the end.
            let _ = files.insert(place - shift, entry);
        }
        ControlFlow::Continue(())
    })?;
    Ok(files)
}
