//! Power that fails at every single write to a memory card, before it, after it and in the middle of it.

#![expect(clippy::single_range_in_vec_init, reason = "flights are lists of times, some with one")]

use crate::card::{Ticks, shared};
use crate::support::Simulated;
use crate::support::card::{Image, Simulation, files, formatted, parsed};
use crate::support::receiver::{Local, texts};
use fatfs::FatType;
use firmware::card::log::GROWTH_BYTES;
use firmware::card::run;
use firmware::hardware::SECTOR_BYTES;
use std::collections::BTreeMap;

const SECOND_US: u64 = 1_000_000;

/// Bytes of a torn sector that are new: in a name, a first cluster and a length of the directory's entries, in numbers
/// of tables, in records.
const TEAR_OFFSETS: [usize; 5] = [1, 62, 131, 430, SECTOR_BYTES - 1];

/// Records in a sector: what a cut may lose of those that were written before.
const SECTOR_RECORDS: usize = 3;

/// A log as it was before: its name and bytes.
type Files = BTreeMap<String, Vec<u8>>;

/// Flies two flights, the second longer than a chunk; what is on the card then, and the times of its ticks when each
/// write began.
fn flown(card: &Simulation, clock: &Simulated, shared: &Local) {
    let mut ticks = Ticks::new(shared);
    clock.run(12 * SECOND_US, run(card.clone(), GROWTH_BYTES, clock, shared.for_card()), |now| {
        ticks.until(now, &[SECOND_US..2 * SECOND_US, 5 * SECOND_US..9 * SECOND_US]);
    });
}

/// What a reader finds after a cut: files that are whole but for the newest, and records in order.
fn check(image: &mut Image, sectors: u32, known: &Files, on_card: usize, what: &str) -> Files {
    let files = files(image, sectors);
    for (name, bytes) in known {
        assert!(files.get(name) == Some(bytes), "{what}: {name} has changed");
    }
    // Of all that is on the card, in order: at most a sector's records more or fewer than were confirmed.
    let ticks: Vec<u64> = files.values().filter(|file| !file.is_empty()).flat_map(|file| parsed(file).ticks).collect();
    let sound = ticks.windows(2).take_while(|pair| pair[0] < pair[1] && pair[1] < 20 * SECOND_US).count() + 1;
    assert!(ticks.is_empty() && on_card == 0 || sound >= on_card, "{what}: {} of {on_card}", sound);
    assert!(ticks.len() <= on_card + SECTOR_RECORDS, "{what}: {} of {on_card}", ticks.len());
    files
}

/// Records in a sector that was written, where it is one of records.
fn records(sector: &[u8; SECTOR_BYTES]) -> usize {
    let head = [&b"ULog\x01\x12\x35\x01"[..], &[0; 8]].concat();
    parsed(&[&head[..], sector].concat()).ticks.len()
}

fn cut_everywhere(kind: FatType, sectors: u32, cluster: u32) {
    let (clock, shared) = (Simulated::default(), shared());
    let (empty, sectors) = formatted(kind, sectors, cluster);
    let card = Simulation::new(empty.clone(), sectors, &clock);
    flown(&card, &clock, &shared);
    let written = std::mem::take(&mut card.medium.borrow_mut().written);
    let last = files(&mut card.medium.borrow_mut().image, sectors);
    assert_eq!(last.keys().collect::<Vec<_>>(), ["LOG00001.ULG", "LOG00002.ULG", "LOG00003.ULG"]);
    assert!(last["LOG00002.ULG"].len() == 2 * GROWTH_BYTES as usize, "the second is longer than a chunk");

    let (mut image, mut on_card) = (empty, 0);
    let mut known = Files::new();
    for (index, (sector, data)) in written.iter().enumerate() {
        let old = image.get(sector).copied();
        let what = format!("write {index} of {}, sector {sector}", written.len());
        for tear in TEAR_OFFSETS {
            let mut torn = old.unwrap_or([0; SECTOR_BYTES]);
            torn[..tear].copy_from_slice(&data[..tear]);
            image.insert(*sector, torn);
            let _ = check(&mut image, sectors, &known, on_card, &format!("{what}, torn at {tear}"));
        }
        // A start after the cut, now and then: it changes no file but the newest, and logs to one that it may log to.
        if index % 7 == 0 {
            let tear = TEAR_OFFSETS[index / 7 % TEAR_OFFSETS.len()];
            let mut torn = old.unwrap_or([0; SECTOR_BYTES]);
            torn[..tear].copy_from_slice(&data[..tear]);
            image.insert(*sector, torn);
            restart(image.clone(), sectors, &known, &format!("{what}, torn at {tear}"));
        }
        image.insert(*sector, *data);
        on_card += records(data);
        let there = check(&mut image, sectors, &known, on_card, &what);
        // A file that another one has followed is finished.
        if let Some((name, _)) = there.last_key_value() {
            known = there
                .iter()
                .filter(|(other, _)| *other < name)
                .map(|(name, file)| (name.clone(), file.clone()))
                .collect();
        }
    }
}

/// Starts with what a cut has left and flies: what was there stays, but for a torn sector, and the flight is logged.
fn restart(image: Image, sectors: u32, known: &Files, what: &str) {
    let (clock, shared) = (Simulated::default(), shared());
    let before = files(&mut image.clone(), sectors);
    let card = Simulation::new(image, sectors, &clock);
    let mut ticks = Ticks::new(&shared);
    clock.run(4 * SECOND_US, run(card.clone(), GROWTH_BYTES, &clock, shared.for_card()), |now| {
        ticks.until(now, &[SECOND_US..SECOND_US + 50_000])
    });
    let after = files(&mut card.medium.borrow_mut().image, sectors);
    for (name, bytes) in known {
        assert!(after.get(name) == Some(bytes), "{what}: {name} has changed");
    }
    let newest = after.iter().rev().nth(1).unwrap();
    let log = parsed(newest.1);
    assert_eq!((log.ticks.len(), log.is_whole), (204, true), "{what}: {}", newest.0);
    assert!(texts(&shared).iter().any(|text| text.ends_with("204 records, 0 missed")), "{what}");
    // Where it had records before, they were not overwritten: the flight is in another file, and the torn sector is
    // gone.
    for (name, bytes) in before.iter().filter(|(_, bytes)| bytes.len() > 2 * SECTOR_BYTES) {
        let (old, new) = (parsed(bytes), parsed(&after[name]));
        let untouched = old.ticks.is_empty() || name != newest.0;
        assert!(untouched || !old.is_whole, "{what}: {name} was overwritten");
        assert!(new.is_whole, "{what}: {name}");
        if name != newest.0 {
            assert!(
                old.ticks.starts_with(&new.ticks) && old.ticks.len() <= new.ticks.len() + SECTOR_RECORDS,
                "{what}: {name}"
            );
        }
    }
}

#[test]
fn power_cut_at_every_write_loses_the_sector_being_written_and_nothing_else_on_fat16() {
    cut_everywhere(FatType::Fat16, 9_000, 1_024);
}

#[test]
fn power_cut_at_every_write_loses_the_sector_being_written_and_nothing_else_on_fat32() {
    cut_everywhere(FatType::Fat32, 70_000, 512);
}
