//! What is still to be sent of a recording, a message at a time.

use mavlink::dialects::common::LOG_DATA_DATA;

/// Time between messages, us: 45 KB/s at most, half of a fast line.
pub const INTERVAL: u64 = 2_000;

/// Bytes of a message.
const PART: usize = 90;

/// A part of a recording that somebody wants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Download {
    offset: u32,
    /// The first byte that is not wanted.
    end: u32,
    /// When the next message may go out, us.
    pub due: u64,
}

impl Download {
    /// From `offset` on, `count` bytes, at once.
    #[must_use]
    pub fn new(offset: u32, count: u32, now: u64) -> Self {
        Self { offset, end: offset.saturating_add(count), due: now }
    }

    /// The next message of what `read` reads at an offset, and what is left then, at `now`, us. A message that is not full is the
    /// last: what ends with a full one is followed by an empty one.
    pub fn next(mut self, now: u64, read: impl Fn(u32, &mut [u8]) -> usize) -> (LOG_DATA_DATA, Option<Self>) {
        let mut data = [0; PART];
        let wanted = self.end.saturating_sub(self.offset).min(PART as u32) as usize;
        let count = data.get_mut(..wanted).map_or(0, |part| read(self.offset, part));
        let message = LOG_DATA_DATA { ofs: self.offset, id: 0, count: count as u8, data };
        self.offset = self.offset.saturating_add(count as u32);
        self.due = now.saturating_add(INTERVAL);
        let all_sent = count < PART || self.offset == self.end;
        (message, (!all_sent).then_some(self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts of the messages that a request for `wanted` bytes of `size` from `offset` on leads to.
    fn counts(size: u32, offset: u32, wanted: u32) -> Vec<u8> {
        let read = |offset: u32, out: &mut [u8]| out.len().min(size.saturating_sub(offset) as usize);
        let mut counts = vec![];
        let mut download = Some(Download::new(offset, wanted, 0));
        while let Some(current) = download {
            let (message, left) = current.next(5, read);
            assert_eq!(message.ofs, offset + counts.iter().map(|count| u32::from(*count)).sum::<u32>());
            assert!(left.is_none_or(|left| left.due == 5 + INTERVAL));
            counts.push(message.count);
            download = left;
        }
        counts
    }

    #[test]
    fn what_is_wanted_comes_in_parts_and_the_end_is_told() {
        assert_eq!(counts(200, 0, u32::MAX), [90, 90, 20]);
        assert_eq!(counts(180, 0, u32::MAX), [90, 90, 0]);
        assert_eq!(counts(1_000, 100, 180), [90, 90]);
        assert_eq!(counts(1_000, 100, 100), [90, 10]);
        assert_eq!(counts(0, 0, 90), [0]);
        assert_eq!(counts(200, 500, 90), [0]);
        assert_eq!(counts(200, u32::MAX, u32::MAX), [0]);
    }
}
