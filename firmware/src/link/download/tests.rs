use super::*;
use crate::shared::Shared;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;

type Local = Shared<NoopRawMutex>;

/// Messages that a request leads to if the card has one log of `size` bytes, each the lowest bits of its place; the
/// ticks of 1 ms that took.
fn messages(size: u32, offset: u32, wanted: u32) -> (Vec<Message>, u64) {
    let shared = Local::new();
    shared.card.set(CardState::Ready, 0);
    let mut download = Download::new();
    download.read(0, offset, wanted, 0, shared.for_transmit());
    let (mut messages, mut now) = (vec![], 0);
    let mut is_answered = false;
    while download.due() < u64::MAX {
        if now >= download.due() || is_answered {
            messages.extend(download.next(now, shared.for_transmit()));
        }
        is_answered = false;
        if let Some(question) = shared.library.take_question() {
            let answer = match question {
                Question::Count => Answer::Count(1),
                Question::Size(0) => Answer::Size(size),
                Question::Bytes { id: 0, offset } => {
                    let end = size.min(offset.saturating_add(LOG_CHUNK_BYTES as u32)).max(offset);
                    Answer::Bytes((offset..end).map(|place| place as u8).collect())
                }
                _ => Answer::Unknown,
            };
            shared.library.answer(question, answer);
            is_answered = true;
        }
        now += 1_000;
    }
    (messages, now / 1_000)
}

/// Counts of the messages that a request for `wanted` bytes of `size` from `offset` on leads to.
fn counts(size: u32, offset: u32, wanted: u32) -> Vec<u8> {
    let mut next = offset;
    let count = |message: Message| {
        let Message::Data(LOG_DATA_DATA { ofs, id: 0, count, data }) = message else { panic!("no data") };
        assert_eq!(ofs, next);
        next += u32::from(count);
        assert!(data.iter().zip(ofs..next).all(|(byte, place)| *byte == place as u8));
        count
    };
    messages(size, offset, wanted).0.into_iter().map(count).collect()
}

#[test]
fn a_log_is_sent_in_parts_and_its_end_is_marked() {
    assert_eq!(counts(200, 0, u32::MAX), [90, 90, 20]);
    assert_eq!(counts(180, 0, u32::MAX), [90, 90, 0]);
    assert_eq!(counts(1_000, 100, 180), [90, 90]);
    assert_eq!(counts(1_000, 100, 100), [90, 10]);
    assert_eq!(counts(0, 0, 90), [0]);
    assert_eq!(counts(200, 500, 90), [0]);
    assert_eq!(counts(200, u32::MAX, u32::MAX), [0]);
    let long = counts(3 * LOG_CHUNK_BYTES as u32, 0, u32::MAX);
    assert!(long.len() == 25 && long[..24].iter().all(|count| *count == 90) && long[24] == 0, "{long:?}");
    assert_eq!(counts(LOG_CHUNK_BYTES as u32 + 10, 0, u32::MAX), [[90; 8].as_slice(), &[10]].concat());
}

#[test]
fn the_next_chunk_is_requested_while_the_last_goes_out() {
    let (messages, ticks) = messages(90 * 800, 0, u32::MAX);
    assert_eq!(messages.len(), 801);
    // One every 2 ms, and no wait between chunks.
    assert!(ticks < 2 * 801 + 10, "{ticks}");
}
