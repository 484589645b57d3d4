//! Flights on a memory card: what an independent reader finds there, and the texts about a card that does not
//! do as it should.

#![expect(clippy::single_range_in_vec_init, reason = "flights are lists of times, some with one")]

use crate::support::Simulated;
use crate::support::card::{Image, PARTITION_START, Parsed, Simulation, files, formatted, parsed, small};
use crate::support::receiver::{Local, texts};
use core::f32::consts::TAU;
use core::ops::Range;
use fatfs::FatType;
use firmware::card::log::{GROWTH_BYTES, SIZE_MAX_BYTES};
use firmware::card::{RETRY_INTERVAL_US, run};
use firmware::hardware::{MotorCommand, SECTOR_BYTES};
use firmware::link::telemetry::vehicle;
use firmware::recorder::RECORDED_AFTERWARDS_US;
use firmware::recorder::gyro::BLOCK_BYTES;
use firmware::recorder::ring::{Ring, SLOT_BYTES};
use firmware::shared::{CardState, Event, Report, Severity, Shared, Traffic};
use mavlink::dialects::common::MavSysStatusSensor;
use nalgebra::Vector3;
use proptest::prelude::*;

/// A second, us.
const SECOND_US: u64 = 1_000_000;

/// A tick, us.
const TICK_US: u64 = 10_000;

/// Ticks that the recorder holds.
const RING_RECORDS: usize = 500;

pub fn shared() -> Local {
    let shared = Shared::new();
    shared.recorder.attach(Ring::recover(Box::leak(vec![[0; SLOT_BYTES]; RING_RECORDS].into_boxed_slice())), "mine");
    shared
}

/// Control, as far as the recorder knows it: a tick every 10 ms, whatever the card does.
pub struct Ticks<'s> {
    shared: &'s Local,
    due: u64,
}

impl<'s> Ticks<'s> {
    pub fn new(shared: &'s Local) -> Self {
        Self { shared, due: 0 }
    }

    /// The ticks that were due until `now`, us, of a vehicle that is armed in one of these times.
    pub fn until(&mut self, now: u64, armed: &[Range<u64>]) {
        while self.due <= now {
            let time = self.due;
            let tick = || Report::NONE.tick(time, MotorCommand::Stop, [None; 4], Some(11.1));
            self.shared.recorder.record(armed.iter().any(|range| range.contains(&time)), tick);
            self.due += TICK_US;
        }
    }
}

/// The times of the ticks of a flight, us: armed from `from` to `to`, and what is recorded afterwards.
pub fn times(from: u64, to: u64) -> Vec<u64> {
    (from..to + RECORDED_AFTERWARDS_US - TICK_US).step_by(TICK_US as usize).collect()
}

/// Logs for `duration` us what flights there are in these times.
fn fly(card: &Simulation, clock: &Simulated, shared: &Local, duration: u64, armed: &[Range<u64>]) {
    let mut ticks = Ticks::new(shared);
    ticks.due = clock.0.get();
    clock.run(duration, run(card.clone(), GROWTH_BYTES, clock, shared.for_card()), |now| ticks.until(now, armed));
}

/// The files of a card that are not empty, read.
fn logs(card: &Simulation) -> Vec<(String, Parsed)> {
    let mut medium = card.medium.borrow_mut();
    let sectors = medium.sectors;
    let files = files(&mut medium.image, sectors).into_iter().filter(|(_, bytes)| !bytes.is_empty());
    files.map(|(name, bytes)| (name, parsed(&bytes))).collect()
}

/// Whether SYS_STATUS reports a log, and a healthy one.
fn bits(shared: &Local, now: u64) -> (bool, bool) {
    let status = vehicle::status(None, None, Traffic::default(), shared.card.health(now));
    let bit = MavSysStatusSensor::MAV_SYS_STATUS_LOGGING;
    (status.onboard_control_sensors_present.contains(bit), status.onboard_control_sensors_health.contains(bit))
}

#[test]
fn every_flight_is_a_file_with_each_tick_and_every_text() {
    for (image, sectors) in [small(), formatted(FatType::Fat32, 70_000, 512)] {
        let (clock, shared) = (Simulated::default(), shared());
        let card = Simulation::new(image, sectors, &clock);
        let mut ticks = Ticks::new(&shared);
        let flights = [SECOND_US..3 * SECOND_US, 6 * SECOND_US..7 * SECOND_US];
        shared.gyro_log.attach(Box::leak(vec![[0; BLOCK_BYTES]; 32].into_boxed_slice()));
        let mut sampled = 0;
        clock.run(10 * SECOND_US, run(card.clone(), GROWTH_BYTES, &clock, shared.for_card()), |now| {
            ticks.until(now, &flights);
            while sampled <= now {
                let phase = TAU * 125.0 * sampled as f32 * 1e-6;
                shared.gyro_log.put(sampled, &Vector3::new(phase.cos(), phase.sin(), 0.1));
                sampled += 1_000;
            }
            if now == 900_000 || now == 2_000_000 {
                shared.announce(Event::new(Severity::Critical, format_args!("said at {now}")));
            }
        });
        assert_eq!(bits(&shared, clock.0.get()), (true, true));
        // For readers in other languages: .ci/logs.
        if let Some(folder) = std::env::var_os("LOGS") {
            let bytes = files(&mut card.medium.borrow_mut().image, sectors).remove("LOG00001.ULG").unwrap();
            std::fs::write(std::path::Path::new(&folder).join("card.ulg"), bytes).unwrap();
        }
        let logs = logs(&card);
        let names: Vec<&str> = logs.iter().map(|(name, _)| name.as_str()).collect();
        // The third is the next flight's.
        assert_eq!(names, ["LOG00001.ULG", "LOG00002.ULG", "LOG00003.ULG"]);
        let first = &logs[0].1;
        assert_eq!(first.ticks, times(SECOND_US, 3 * SECOND_US));
        assert_eq!((first.time, first.is_whole, first.gaps.len()), (SECOND_US, true, 0));
        let expected = [900_000, 2_000_000].map(|time| ('2', time, format!("said at {time}")));
        assert!(expected.iter().all(|text| first.texts.contains(text)), "{:?}", first.texts);
        // The whole flight's raw gyro, in blocks of 32 ms.
        assert!(first.gyro.windows(2).all(|pair| pair[1] - pair[0] == 32_000), "{:?}", first.gyro);
        let (begin, end) = (first.gyro[0], *first.gyro.last().unwrap());
        assert!(begin < SECOND_US + 40_000 && end > 5 * SECOND_US - 60_000, "{begin} to {end}");
        assert_eq!(logs[1].1.ticks, times(6 * SECOND_US, 7 * SECOND_US));
        assert!(logs[2].1.ticks.is_empty() && logs[2].1.is_whole);
        assert_eq!(
            texts(&shared)[2..],
            [
                "said at 2000000",
                "Log 00001: 399 records, 0 missed",
                "Card: next log 00002",
                "Log 00002: 299 records, 0 missed",
                "Card: next log 00003"
            ]
        );
    }
}

#[test]
fn a_file_without_a_flight_is_the_next_flights_whatever_restarts_come_between() {
    let (clock, (image, sectors)) = (Simulated::default(), small());
    let card = Simulation::new(image, sectors, &clock);
    for restart in 0..3 {
        let shared = shared();
        fly(&card, &clock, &shared, SECOND_US, &[]);
        assert_eq!(logs(&card).len(), 1, "{restart}");
    }
    let now = clock.0.get();
    let shared = shared();
    fly(&card, &clock, &shared, 5 * SECOND_US, &[now + SECOND_US..now + 2 * SECOND_US]);
    let logs = logs(&card);
    assert_eq!((logs.len(), &logs[0].1.ticks), (2, &times(now + SECOND_US, now + 2 * SECOND_US)));
}

#[test]
fn in_flight_nothing_is_written_but_the_flights_own_sectors_in_order() {
    let (clock, shared, (image, sectors)) = (Simulated::default(), shared(), small());
    let card = Simulation::new(image, sectors, &clock);
    fly(&card, &clock, &shared, SECOND_US, &[]);
    card.medium.borrow_mut().written.clear();
    let before = files(&mut card.medium.borrow_mut().image.clone(), sectors);
    // The task starts anew, and the card is as it was: the first thing it writes is the flight.
    fly(&card, &clock, &shared, 2 * SECOND_US, &[SECOND_US..10 * SECOND_US]);
    let written: Vec<u32> = card.medium.borrow().written.iter().map(|(sector, _)| *sector).collect();
    let data = written[0]..written[0] + GROWTH_BYTES / SECTOR_BYTES as u32;
    assert!(written.len() > 60 && written.iter().all(|sector| data.contains(sector)), "{written:?}");
    assert!(written[2..].is_sorted_by(|a, b| b - a == 1));
    let after = files(&mut card.medium.borrow_mut().image, sectors);
    assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>());
}

#[test]
fn a_flight_longer_than_its_file_makes_it_longer_and_then_goes_on_in_the_next() {
    let (clock, shared, (image, sectors)) = (Simulated::default(), shared(), formatted(FatType::Fat16, 80_000, 4_096));
    let card = Simulation::new(image, sectors, &clock);
    let minutes = 18 * 60 * SECOND_US;
    fly(&card, &clock, &shared, minutes + 5 * SECOND_US, &[SECOND_US..minutes]);
    let logs = logs(&card);
    let ticks: Vec<u64> = logs.iter().flat_map(|(_, log)| log.ticks.clone()).collect();
    assert!(ticks == times(SECOND_US, minutes), "{}", ticks.len());
    assert!(logs.iter().all(|(_, log)| log.is_whole && log.gaps.is_empty()));
    let sizes: Vec<usize> = files(&mut card.medium.borrow_mut().image, sectors).values().map(Vec::len).collect();
    assert_eq!((sizes.len(), sizes[0]), (3, SIZE_MAX_BYTES as usize));
    assert!(sizes.iter().all(|size| size.is_multiple_of(GROWTH_BYTES as usize)));
}

#[test]
fn a_slow_card_loses_nothing_until_the_recorder_is_full_and_the_loss_is_reported() {
    for (stall, missed) in [(4 * SECOND_US, 0..1), (7 * SECOND_US, 150..260)] {
        let (clock, shared, (image, sectors)) = (Simulated::default(), shared(), small());
        let card = Simulation::new(image, sectors, &clock);
        fly(&card, &clock, &shared, SECOND_US, &[]);
        card.medium.borrow_mut().written.clear();
        // 2 ms each, and one of them seconds.
        card.medium.borrow_mut().takes = Some(if stall > 5 * SECOND_US {
            |write| if write == 50 { 7_000_000 } else { 2_000 }
        } else {
            |write| if write == 50 { 4_000_000 } else { 2_000 }
        });
        let now = clock.0.get();
        let _ = texts(&shared);
        fly(&card, &clock, &shared, 15 * SECOND_US, &[now + SECOND_US..now + 11 * SECOND_US]);
        let (_, log) = logs(&card).swap_remove(0);
        let all = times(now + SECOND_US, now + 11 * SECOND_US);
        let lost = all.len() - log.ticks.len();
        assert!(missed.contains(&lost), "{lost}");
        assert!(log.ticks.is_sorted() && log.is_whole);
        let expected: Vec<u16> = Some(lost as u16 * 10).filter(|gap| *gap > 0).into_iter().collect();
        assert_eq!(log.gaps, expected);
        let words = format!("Log 00001: {} records, {lost} missed", log.ticks.len());
        assert!(texts(&shared).contains(&words), "{words}");
    }
}

#[test]
fn a_card_that_fails_in_flight_is_reported_and_after_recovery_the_rest_goes_to_the_next_file() {
    let (clock, shared, (image, sectors)) = (Simulated::default(), shared(), small());
    let card = Simulation::new(image, sectors, &clock);
    let mut ticks = Ticks::new(&shared);
    let medium = card.medium.clone();
    let mut seen = vec![];
    clock.run(12 * SECOND_US, run(card.clone(), GROWTH_BYTES, &clock, shared.for_card()), |now| {
        ticks.until(now, &[SECOND_US..8 * SECOND_US]);
        medium.borrow_mut().fails = (3 * SECOND_US..5 * SECOND_US).contains(&now);
        if now == 4 * SECOND_US {
            seen.push(bits(&shared, now));
        }
    });
    assert_eq!(seen, [(true, false)]);
    assert_eq!(bits(&shared, clock.0.get()), (true, true));
    let logs = logs(&card);
    let all: Vec<u64> = logs.iter().flat_map(|(_, log)| log.ticks.clone()).collect();
    assert_eq!(all, times(SECOND_US, 8 * SECOND_US));
    assert!(logs.iter().all(|(_, log)| log.is_whole) && !logs[1].1.ticks.is_empty());
    let said = texts(&shared);
    assert_eq!(said.iter().filter(|text| *text == "Card failed: flights are not logged").count(), 1, "{said:?}");
}

#[test]
fn a_missing_or_removed_card_is_reported_once_and_an_inserted_one_is_used() {
    let (clock, shared, (image, sectors)) = (Simulated::default(), shared(), small());
    let card = Simulation::new(image, sectors, &clock);
    card.medium.borrow_mut().is_absent = true;
    fly(&card, &clock, &shared, 4 * RETRY_INTERVAL_US, &[]);
    assert_eq!(texts(&shared), ["No card: flights are not logged"]);
    assert_eq!(bits(&shared, clock.0.get()), (false, false));
    let medium = card.medium.clone();
    let mut ticks = Ticks::new(&shared);
    let begin = clock.0.get();
    ticks.due = begin;
    clock.run(4 * RETRY_INTERVAL_US, run(card.clone(), GROWTH_BYTES, &clock, shared.for_card()), |now| {
        medium.borrow_mut().is_absent = now < begin + 2 * RETRY_INTERVAL_US || now > begin + 3 * RETRY_INTERVAL_US;
        ticks.until(now, &[begin + 3 * RETRY_INTERVAL_US - SECOND_US..u64::MAX]);
    });
    assert_eq!(
        texts(&shared),
        ["No card: flights are not logged", "Card: next log 00001", "Card failed: flights are not logged"]
    );
}

#[test]
fn a_full_card_is_reported_keeps_its_files_and_gets_no_empty_ones() {
    // Room for the first chunk and a part of the second.
    let (clock, shared, (image, sectors)) = (Simulated::default(), shared(), formatted(FatType::Fat16, 4_400, 512));
    let card = Simulation::new(image, sectors, &clock);
    let minutes = 10 * 60 * SECOND_US;
    fly(&card, &clock, &shared, minutes + 30 * SECOND_US, &[SECOND_US..minutes]);
    let said = texts(&shared);
    assert!(said.contains(&"Card full: move logs off it".into()), "{said:?}");
    assert_eq!(bits(&shared, clock.0.get()), (true, false));
    let before = files(&mut card.medium.borrow_mut().image, sectors);
    let ticks = &logs(&card)[0].1.ticks;
    assert!(before.len() <= 2 && ticks.len() > 4_000, "{} {}", before.len(), ticks.len());
    assert_eq!(*ticks, times(SECOND_US, minutes)[..ticks.len()]);
    // With a recording that a reset has left, which finds no room either.
    fly(&card, &clock, &shared, 10 * RETRY_INTERVAL_US, &[]);
    let mut after = files(&mut card.medium.borrow_mut().image, sectors);
    after.retain(|name, bytes| !bytes.is_empty() || before.contains_key(name));
    assert!(after == before, "{:?}", after.keys());
    assert!(files(&mut card.medium.borrow_mut().image, sectors).len() <= before.len() + 1);
}

#[test]
fn the_root_directory_is_never_made_longer() {
    let (clock, shared, (image, sectors)) = (Simulated::default(), shared(), formatted(FatType::Fat32, 70_000, 512));
    let card = Simulation::new(image, sectors, &clock);
    // A sector has room for 16 names.
    let flights: Vec<_> = (0..20).map(|flight| (4 * flight + 1) * SECOND_US..(4 * flight + 2) * SECOND_US).collect();
    fly(&card, &clock, &shared, 85 * SECOND_US, &flights);
    assert_eq!(logs(&card).len(), 16);
    assert_eq!(bits(&shared, clock.0.get()), (true, false));
}

#[test]
fn a_card_with_a_foreign_format_is_reported_and_left_as_it_is() {
    let (good, sectors) = small();
    let foreign = |change: &dyn Fn(&mut Image)| {
        let mut image = good.clone();
        change(&mut image);
        let (clock, shared) = (Simulated::default(), shared());
        let card = Simulation::new(image, sectors, &clock);
        fly(&card, &clock, &shared, 2 * RETRY_INTERVAL_US, &[SECOND_US..2 * SECOND_US]);
        assert_eq!(texts(&shared), ["Card unusable: format it as FAT32 (MBR)"]);
        assert!(card.medium.borrow().written.is_empty());
    };
    foreign(&Image::clear);
    // The kind of partition that exFAT has, and no table at all.
    foreign(&|image| image.get_mut(&0).unwrap()[446 + 4] = 0x07);
    foreign(&|image| {
        let first = image[&PARTITION_START];
        image.insert(0, first);
    });
    // Sectors of a cluster, sectors at all, bytes of a sector.
    foreign(&|image| image.get_mut(&PARTITION_START).unwrap()[13] = 0);
    foreign(&|image| image.get_mut(&PARTITION_START).unwrap()[19..21].fill(0xFF));
    foreign(&|image| image.get_mut(&PARTITION_START).unwrap()[11..13].copy_from_slice(&1_024_u16.to_le_bytes()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_damaged_beginning_of_a_file_system_ends_in_words_and_never_in_a_panic(
        damage in prop::collection::vec((0..SECTOR_BYTES, any::<u8>()), 1..6), is_table: bool,
    ) {
        let (mut image, sectors) = small();
        let sector = image.get_mut(if is_table { &0 } else { &PARTITION_START }).unwrap();
        damage.iter().for_each(|(at, byte)| sector[if is_table { *at } else { *at % 64 }] = *byte);
        let (clock, shared) = (Simulated::default(), shared());
        let card = Simulation::new(image, sectors, &clock);
        fly(&card, &clock, &shared, SECOND_US, &[300_000..SECOND_US]);
        prop_assert_eq!(texts(&shared).len(), 1);
    }
}

#[test]
fn the_recording_that_a_reset_left_is_copied_once() {
    let (clock, shared, (image, sectors)) = (Simulated::default(), shared(), small());
    let mut ticks = Ticks::new(&shared);
    ticks.until(4 * SECOND_US, &[SECOND_US..3 * SECOND_US / 2]);
    let mut whole = vec![0; shared.recorder.size().unwrap() as usize];
    assert_eq!(shared.recorder.read(0, &mut whole), whole.len());
    let card = Simulation::new(image, sectors, &clock);
    for restart in 0..3 {
        fly(&card, &clock, &shared, SECOND_US, &[]);
        let files = files(&mut card.medium.borrow_mut().image, sectors);
        assert_eq!(files.keys().collect::<Vec<_>>(), ["LOG00002.ULG", "REC00001.ULG"], "{restart}");
        assert_eq!(files["REC00001.ULG"], whole);
        assert!(texts(&shared).contains(&"Last recording: REC00001.ULG".into()));
    }
    // Another recording is another file.
    let shared = self::shared();
    Ticks::new(&shared).until(5 * SECOND_US, &[SECOND_US..2 * SECOND_US]);
    fly(&card, &clock, &shared, SECOND_US, &[]);
    let files = files(&mut card.medium.borrow_mut().image, sectors);
    assert_eq!(files.keys().collect::<Vec<_>>(), ["LOG00002.ULG", "REC00001.ULG", "REC00003.ULG"]);
    assert_eq!(files["REC00001.ULG"], whole);
}

#[test]
fn a_card_that_blocks_its_task_is_reported() {
    let shared = shared();
    shared.card.set(CardState::Ready, 5 * SECOND_US);
    assert_eq!((shared.card.health(14 * SECOND_US), shared.card.health(16 * SECOND_US)), (Some(true), Some(false)));
}
