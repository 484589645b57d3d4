//! The journal under power cuts: after any of them, the value before or the new one, and room for the next.

use crate::support::chip::{Chip, FLASH_RECORDS, SECTOR_BYTES, Torn, Words};
use firmware::hardware::Record;
use firmware::parameters::journal::{Journal, Kept, Kind};
use std::cell::RefCell;

/// Every way in which a word can be left behind.
const TORN: [Torn; 3] = [Torn::Bits, Torn::Unreadable, Torn::Blank];

/// The journal that a boot finds, and the newest value; 0 without one.
fn opened<const WORD: usize>(chip: &RefCell<Chip>) -> (Journal<Words<'_, WORD>>, f32) {
    let mut words = [0; 5];
    let mut journal = Journal::open(Words(chip));
    let _ = journal.read(Kind::Parameters, &mut words);
    (journal, f32::from_bits(words[4]))
}

/// Boots, and saves a value in no more than two attempts; whether that succeeded.
fn saved<const WORD: usize>(chip: &RefCell<Chip>, value: f32) -> bool {
    let (mut journal, _) = opened::<WORD>(chip);
    let words = [-1.0, 1.0, 2.0, 3.0, value].map(f32::to_bits);
    (0..2).any(|_| journal.append(Kind::Parameters, &words).is_ok())
}

/// Saves `value` with the power failing at each word in turn, and hands each chip on as it is then, with power.
fn cut_everywhere<const WORD: usize>(
    chip: &RefCell<Chip>,
    torn: Torn,
    value: f32,
    check: &dyn Fn(&RefCell<Chip>, bool),
) {
    for power in 1.. {
        let cut = chip.clone();
        (cut.borrow_mut().power, cut.borrow_mut().torn) = (power, torn);
        let done = saved::<WORD>(&cut, value);
        let whole = cut.borrow().power > 0;
        cut.borrow_mut().power = usize::MAX;
        check(&cut, done);
        if whole {
            assert!(done, "a save with power throughout");
            return;
        }
    }
}

fn survives_cuts<const WORD: usize>(nested: bool) {
    // From blank flash to a second time through both sectors.
    let chip = Chip::erased();
    for round in 0..FLASH_RECORDS + 3 {
        let (before, new) = (round as f32, round as f32 + 1.0);
        for torn in TORN {
            cut_everywhere::<WORD>(&chip, torn, new, &|cut, done| {
                let (_, found) = opened::<WORD>(cut);
                assert!(found == new || found == before && !done, "{found} after {before}, {torn:?}");
                let (recovered, next) = (cut.clone(), 1e6);
                assert!(saved::<WORD>(&recovered, next), "no room after a cut, {torn:?}");
                assert_eq!(opened::<WORD>(&recovered).1, next);
                if nested {
                    cut_everywhere::<WORD>(cut, torn, next, &|cut, done| {
                        let (_, again) = opened::<WORD>(cut);
                        assert!(again == next || again == found && !done, "{again} after {found}, {torn:?}");
                        assert!(saved::<WORD>(cut, 2e6) && opened::<WORD>(cut).1 == 2e6, "{torn:?}");
                    });
                }
            });
        }
        assert!(saved::<WORD>(&chip, new));
    }
}

#[test]
fn flash_of_32_byte_words_survives_a_cut_at_any_word_and_another_after_it() {
    survives_cuts::<32>(true);
}

#[test]
fn flash_of_4_byte_words_survives_a_cut_at_any_word() {
    survives_cuts::<4>(false);
}

#[test]
fn flash_of_single_bytes_survives_a_cut_at_any_byte() {
    survives_cuts::<1>(false);
}

#[test]
fn flash_that_wears_out_keeps_the_last_value_that_it_took() {
    for round in 1..=2 * FLASH_RECORDS {
        let chip = Chip::erased();
        for value in 1..=round {
            assert!(saved::<32>(&chip, value as f32));
        }
        chip.borrow_mut().worn = true;
        let (mut journal, _) = opened::<32>(&chip);
        for _ in 0..5 * FLASH_RECORDS {
            assert!(journal.append(Kind::Parameters, &[0; 5]).is_err());
        }
        assert_eq!(opened::<32>(&chip).1, round as f32);
        // Nor does a boot in between change that.
        for _ in 0..5 * FLASH_RECORDS {
            assert!(!saved::<32>(&chip, 0.0));
        }
        assert_eq!(opened::<32>(&chip).1, round as f32);
    }
}

#[test]
fn blank_flash_never_held_anything_and_any_other_without_a_record_has_lost_it() {
    let chip = Chip::erased();
    let kept = |chip: &RefCell<Chip>| {
        let (mut journal, mut words) = (Journal::open(Words::<4>(chip)), [7]);
        let kept = [Kind::Parameters, Kind::Signing].map(|kind| journal.read(kind, &mut words));
        assert_eq!(words, [7]);
        kept
    };
    assert_eq!(kept(&chip), [Kept::Never; 2]);
    for byte in 0..2 * SECTOR_BYTES {
        let chip = chip.clone();
        chip.borrow_mut().bytes[byte] = 0;
        assert_eq!(kept(&chip), [Kept::Lost; 2], "byte {byte}");
    }
}

#[test]
fn a_record_is_erased_no_sooner_than_there_is_no_other_place() {
    let chip = Chip::erased();
    // Two copies of each.
    for value in 1..=FLASH_RECORDS / 2 {
        assert!(saved::<4>(&chip, value as f32));
    }
    let first = chip.borrow().bytes.clone();
    assert!(saved::<4>(&chip, 0.5));
    let both = chip.borrow().bytes.clone();
    // One sector is full, the other has the newest.
    assert!(first.iter().zip(&both).filter(|(old, new)| old != new).count() <= 2 * size_of::<Record>());
}

#[test]
fn either_kind_survives_a_cut_at_any_word_while_the_other_is_saved() {
    fn read(chip: &RefCell<Chip>, kind: Kind) -> [u32; 3] {
        let mut words = [0; 3];
        let _ = Journal::open(Words::<32>(chip)).read(kind, &mut words);
        words
    }
    fn save(chip: &RefCell<Chip>, kind: Kind, value: u32) -> bool {
        let mut journal = Journal::open(Words::<32>(chip));
        (0..2).any(|_| journal.append(kind, &[value; 3]).is_ok())
    }
    const KEPT_VALUE: u32 = 1_000;
    for (kept, saved) in [(Kind::Signing, Kind::Parameters), (Kind::Parameters, Kind::Signing)] {
        let chip = Chip::erased();
        assert!(save(&chip, kept, KEPT_VALUE));
        for round in 1..FLASH_RECORDS as u32 + 3 {
            for torn in TORN {
                for power in 1.. {
                    let cut = chip.clone();
                    (cut.borrow_mut().power, cut.borrow_mut().torn) = (power, torn);
                    let done = save(&cut, saved, round);
                    let whole = cut.borrow().power > 0;
                    cut.borrow_mut().power = usize::MAX;
                    let found = read(&cut, saved);
                    assert_eq!(read(&cut, kept), [KEPT_VALUE; 3], "{torn:?}");
                    assert!(found == [round; 3] || found == [round - 1; 3] && !done, "{found:?}, {torn:?}");
                    assert!(save(&cut, saved, round + KEPT_VALUE), "no room after a cut, {torn:?}");
                    assert_eq!(
                        (read(&cut, kept), read(&cut, saved)),
                        ([KEPT_VALUE; 3], [round + KEPT_VALUE; 3]),
                        "{torn:?}"
                    );
                    if whole {
                        break;
                    }
                }
            }
            assert!(save(&chip, saved, round));
        }
    }
}
