//! The link's questions about logs, and the answers: the card's task reads its files, the link never waits for it.
//!
//! One question is open at a time, and a new one replaces it. An answer names its question, so that a late one is known
//! for what it is.

use super::latest::Latest;
use super::queue::Queue;
use crate::recorder::Recorder;
use embassy_sync::blocking_mutex::raw::RawMutex;
use heapless::Vec;

/// Bytes of an answer at most: eight messages full.
pub const LOG_CHUNK_BYTES: usize = 720;

/// Bytes of a log.
pub type Bytes = Vec<u8, LOG_CHUNK_BYTES>;

/// Something about the logs. They are numbered from 0 on, in the order in which they were made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Question {
    /// How many there are now. What a number stands for changes with this question only.
    Count,
    /// How long one is.
    Size(u16),
    /// What is in one.
    Bytes {
        /// Its number.
        id: u16,
        /// From which byte on.
        offset: u32,
    },
}

/// The answer to a question.
#[expect(clippy::large_enum_variant, reason = "there is one at a time, and nothing to put its bytes in")]
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// So many.
    Count(u16),
    /// So many bytes.
    Size(u32),
    /// These; fewer than [`LOG_CHUNK_BYTES`] at its end only.
    Bytes(Bytes),
    /// There is no log of that number.
    Unknown,
    /// It is there, and cannot be read.
    Unreadable,
}

impl<M: RawMutex> Recorder<M> {
    /// Answers as if its recording were the only log.
    pub fn answer(&self, question: Question) -> Answer {
        let size = self.size();
        match (question, size) {
            (Question::Count, _) => Answer::Count(size.is_some().into()),
            (Question::Size(0), Some(size)) => Answer::Size(size),
            (Question::Bytes { id: 0, offset }, Some(_)) => {
                let mut bytes = [0; LOG_CHUNK_BYTES];
                let count = self.read(offset, &mut bytes);
                Answer::Bytes(bytes.get(..count).and_then(|bytes| Vec::from_slice(bytes).ok()).unwrap_or_default())
            }
            (Question::Size(_) | Question::Bytes { .. }, _) => Answer::Unknown,
        }
    }
}

/// The question that is open, and the last answer.
pub struct Library<M: RawMutex> {
    question: Latest<M, Question>,
    answers: Queue<M, (Question, Answer), 1>,
}

impl<M: RawMutex> Library<M> {
    /// No question.
    pub const fn new() -> Self {
        Self { question: Latest::new(), answers: Queue::new() }
    }

    /// The link's question, at `now`, us.
    pub fn put_question(&self, question: Question, now: u64) {
        let _ = self.answers.take();
        self.question.put(question, now);
    }

    /// The card's task takes the open question.
    #[must_use]
    pub fn take_question(&self) -> Option<Question> {
        self.question.take().map(|question| question.value)
    }

    /// And answers it. An answer that was not fetched makes room.
    pub fn answer(&self, question: Question, answer: Answer) {
        let _ = self.answers.take();
        let _ = self.answers.put((question, answer));
    }

    /// The link fetches the answer to a question, if it is there.
    #[must_use]
    pub fn fetch(&self, question: Question) -> Option<Answer> {
        self.answers.take().filter(|(answered, _)| *answered == question).map(|(_, answer)| answer)
    }
}
