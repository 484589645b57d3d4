//! Requested logs, a message at a time: their list, or one of them.
//!
//! Where a card is ready its task answers ([`Library`](crate::shared::Library)): a file is requested chunk by chunk,
//! the next one while the last goes out. After [`ANSWER_TIMEOUT_US`] without an answer the download ends. Elsewhere
//! there is the flight recorder's recording, which is in memory. Nothing goes out while the vehicle is armed.

use crate::shared::{Answer, Bytes, CardState, Event, LOG_CHUNK_BYTES, Question, Severity, TransmitView};
use core::fmt::Display;
use embassy_sync::blocking_mutex::raw::RawMutex;
use mavlink::dialects::common::{LOG_DATA_DATA, LOG_ENTRY_DATA};

/// Time between messages: 45 KB/s at most, half of a fast line.
pub const MESSAGE_INTERVAL_US: u64 = 2_000;

/// The longest that the card may take over an answer: it also finishes a flight meanwhile, two seconds of it, and
/// begins the next one's file.
pub const ANSWER_TIMEOUT_US: u64 = 6_000_000;

/// Bytes of a message.
const LOG_PART_BYTES: usize = 90;

const _: () = assert!(LOG_CHUNK_BYTES.is_multiple_of(LOG_PART_BYTES));

/// A message.
pub enum Message {
    /// Of the list.
    Entry(LOG_ENTRY_DATA),
    /// Of a log.
    Data(LOG_DATA_DATA),
}

/// A client's request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Job {
    /// The entries from one number to another; as soon as it is known also how many there are.
    Entries { next: u16, last: u16, count: Option<u16> },
    /// The bytes of a log from one to another, which is not wanted.
    Data { id: u16, next: u32, end: u32 },
}

/// What is being sent. The newest request replaces the one before.
#[derive(Debug)]
pub struct Download {
    job: Option<Job>,
    /// Whether the card answers, or the recorder.
    from_card: bool,
    /// When the next message may go out, us.
    due: u64,
    /// The question to the card, and its timeout, us.
    question: Option<(Question, u64)>,
    /// Whether nothing can go out before it answers.
    is_waiting: bool,
    /// Where the chunk at hand begins.
    offset: u32,
    chunk: Option<Bytes>,
}

impl Download {
    /// Nothing is wanted.
    pub const fn new() -> Self {
        Self { job: None, from_card: false, due: 0, question: None, is_waiting: false, offset: 0, chunk: None }
    }

    /// Entries of the list, by their numbers, at `now`, us.
    pub fn list<M: RawMutex>(&mut self, first: u16, last: u16, now: u64, shared: TransmitView<'_, M>) {
        self.begin(Job::Entries { next: first, last, count: None }, now, shared);
    }

    /// So many bytes of a log, from `offset` on, at `now`, us.
    pub fn read<M: RawMutex>(&mut self, id: u16, offset: u32, count: u32, now: u64, shared: TransmitView<'_, M>) {
        self.begin(Job::Data { id, next: offset, end: offset.saturating_add(count) }, now, shared);
    }

    /// No more of it.
    pub fn end(&mut self) {
        *self = Self::new();
    }

    fn begin<M: RawMutex>(&mut self, job: Job, now: u64, shared: TransmitView<'_, M>) {
        let from_card = shared.card().state() == CardState::Ready;
        *self = Self { job: Some(job), from_card, due: now, ..Self::new() };
    }

    /// When something is due, us: a message, or the end of the patience with the card.
    pub fn due(&self) -> u64 {
        match (self.job, self.question) {
            (None, _) => u64::MAX,
            (Some(_), Some((_, until))) if self.is_waiting => until,
            (Some(_), _) => self.due,
        }
    }

    /// The next message at `now`, us, if there is one.
    pub fn next<M: RawMutex>(&mut self, now: u64, shared: TransmitView<'_, M>) -> Option<Message> {
        let job = self.job.filter(|_| now >= self.due)?;
        if shared.is_armed() {
            self.give_up(shared, "Log: not while armed");
            return None;
        }
        let message = match job {
            Job::Entries { next, last, count: None } => {
                let Answer::Count(count) = self.answer(Question::Count, now, shared)? else { return None };
                // A request beyond the end is answered with the end.
                let end = count.saturating_sub(1);
                self.job = Some(Job::Entries { next: next.min(end), last: last.min(end), count: Some(count) });
                self.job = self.job.filter(|_| count > 0);
                return (count == 0).then_some(Message::Entry(LOG_ENTRY_DATA::DEFAULT));
            }
            Job::Entries { next, last, count: Some(count) } => {
                let answer = self.answer(Question::Size(next), now, shared)?;
                let size = if let Answer::Size(size) = answer { size } else { 0 };
                let job = Job::Entries { next: next.saturating_add(1), last, count: Some(count) };
                self.job = (next < last).then_some(job);
                Message::Entry(LOG_ENTRY_DATA {
                    id: next,
                    num_logs: count,
                    last_log_num: count.saturating_sub(1),
                    size,
                    ..LOG_ENTRY_DATA::DEFAULT
                })
            }
            Job::Data { id, next, end } => {
                let wanted = end.saturating_sub(next).min(LOG_PART_BYTES as u32) as usize;
                let (data, count) = self.part(id, next, wanted, end, now, shared)?;
                let after = next.saturating_add(count as u32);
                // A message that is not full is the last: what ends with a full one is followed by an empty one.
                self.job = (count == LOG_PART_BYTES && after < end).then_some(Job::Data { id, next: after, end });
                Message::Data(LOG_DATA_DATA { ofs: next, id, count: count as u8, data })
            }
        };
        self.due = now.saturating_add(MESSAGE_INTERVAL_US);
        Some(message)
    }

    /// The next bytes of a log, and how many of those that are wanted there are, if they are at hand.
    fn part<M: RawMutex>(
        &mut self,
        id: u16,
        next: u32,
        wanted: usize,
        end: u32,
        now: u64,
        shared: TransmitView<'_, M>,
    ) -> Option<([u8; LOG_PART_BYTES], usize)> {
        let begin = next.checked_sub(self.offset).unwrap_or(u32::MAX) as usize;
        // A chunk that is not full ends where the log does.
        let is_there = |chunk: &Bytes| begin <= chunk.len() && (begin + wanted <= chunk.len() || !chunk.is_full());
        let is_at_hand = self.chunk.as_ref().is_some_and(is_there);
        if !is_at_hand {
            match self.answer(Question::Bytes { id, offset: next }, now, shared)? {
                Answer::Bytes(chunk) => {
                    let behind = next.saturating_add(chunk.len() as u32);
                    if chunk.is_full() && behind < end {
                        self.put_question(Question::Bytes { id, offset: behind }, now, shared);
                    }
                    (self.offset, self.chunk) = (next, Some(chunk));
                }
                Answer::Unknown => {
                    self.give_up(shared, format_args!("Log {id}: not found"));
                    return None;
                }
                _ => {
                    self.give_up(shared, format_args!("Log {id}: cannot be read"));
                    return None;
                }
            }
        }
        let begin = next.saturating_sub(self.offset) as usize;
        let bytes = self.chunk.as_ref().and_then(|chunk| chunk.get(begin..)).unwrap_or_default();
        let mut data = [0; LOG_PART_BYTES];
        let count = data.iter_mut().zip(bytes.iter().take(wanted)).map(|(to, from)| *to = *from).count();
        Some((data, count))
    }

    /// The answer of the recorder or the card; sends the question to the card, and gives up after the timeout.
    fn answer<M: RawMutex>(&mut self, question: Question, now: u64, shared: TransmitView<'_, M>) -> Option<Answer> {
        if self.from_card != (shared.card().state() == CardState::Ready) {
            // The numbers have changed their meaning.
            self.give_up(shared, "Log: the card has come or gone, list again");
            return None;
        }
        if !self.from_card {
            return Some(shared.recorder().answer(question));
        }
        let Some((_, until)) = self.question.filter(|(asked, _)| *asked == question) else {
            self.put_question(question, now, shared);
            self.is_waiting = true;
            return None;
        };
        let answer = shared.library().fetch(question);
        self.is_waiting = answer.is_none();
        if answer.is_some() {
            self.question = None;
        } else if now >= until {
            self.give_up(shared, "Log: the card does not answer");
        }
        answer
    }

    fn put_question<M: RawMutex>(&mut self, question: Question, now: u64, shared: TransmitView<'_, M>) {
        if self.from_card {
            shared.library().put_question(question, now);
            self.question = Some((question, now.saturating_add(ANSWER_TIMEOUT_US)));
        }
    }

    fn give_up<M: RawMutex>(&mut self, shared: TransmitView<'_, M>, words: impl Display) {
        self.end();
        shared.announce(Event::new(Severity::Warning, words));
    }
}

#[cfg(test)]
mod tests;
