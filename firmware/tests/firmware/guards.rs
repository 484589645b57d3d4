//! What guards flight, and one failure of each: the tables of docs/security.md, row by row.

use crate::parameters::chip_with;
use crate::support::Simulated;
use crate::support::chip::{Chip, Words};
use crate::support::desk::Desk;
use crate::support::receiver::{Fed, Local, disarm, texts};
use firmware::boot;
use firmware::link::signing::{KEPT_WORDS, Key};
use firmware::parameters::storage::Storage;
use firmware::parameters::table::{Name, PARAMETERS};
use firmware::shared::QueuedRequest;
use flight::Request;
use mavlink::dialects::common::{MavParamType, PARAM_SET_DATA};
use std::cell::RefCell;

/// A page's tables are held to these tests.
const PAGE: &str = include_str!("../../../docs/security.md");

/// Parameters that guard flight: as the page calls them, and values that are not the defaults.
const PARAMETER_GUARDS: [(&str, &[(Name, f32)]); 6] = [
    ("`SIGN_ONLY`", &[(Name::SignedOnly, 1.0)]),
    ("`FENCE_RADIUS`, `FENCE_HEIGHT`", &[(Name::FenceRadius, 20.0), (Name::FenceHeight, 8.0)]),
    ("`BAT_LOW`, `BAT_CRIT`", &[(Name::BatteryLow, 14.0), (Name::BatteryCritical, 13.2)]),
    ("`MOT_ORDER`", &[(Name::MotorOrder, 4213.0)]),
    ("calibration (`IMU1_…`, `IMU2_…`)", &[(Name::Imu1GyroX, 0.01), (Name::Imu2ScaleZ, 1.02)]),
    ("what the certificate depends on (`MASS` …)", &[(Name::Mass, 0.4)]),
];

const KEY_LOST: [&str; 2] = ["Signing key lost: set it over USB", "Refused: signing key lost; set it over USB"];
const PARAMETERS_LOST: [&str; 2] =
    ["Parameters lost: defaults taken; set them again", "Refused: parameters lost; set again"];

fn key() -> Option<Key> {
    Key::new([0xC5; 32])
}

/// A chip on which a vehicle has kept all of it, and other values and another key before.
fn chip() -> RefCell<Chip> {
    let (chip, shared, clock) = (Chip::erased(), Local::new(), Simulated::default());
    let mut storage = Storage::load(Words::<4>(&chip), shared.for_storage());
    boot::start(Box::leak(Box::new(boot::Place::new())), shared.for_boot()).unwrap();
    shared.parameters.set(Name::FenceRadius, 500.0).unwrap();
    shared.set_signing(Key::new([0x11; 32]), 0, 0);
    clock.run(10_000, storage.keep(&clock, shared.for_storage()), |_| ());
    for (name, value) in PARAMETER_GUARDS.iter().flat_map(|(_, values)| *values) {
        shared.parameters.set(*name, *value).unwrap();
    }
    shared.set_signing(key(), 0, 0);
    clock.run(10_000, storage.keep(&clock, shared.for_storage()), |_| ());
    chip
}

/// A vehicle that boots on a chip, and keeps what it has for a while; if so, what it finds about a gyro.
fn booted(chip: &RefCell<Chip>, duration: u64, calibrates: bool) -> Local {
    let (shared, clock) = (Local::new(), Simulated::default());
    let mut storage = Storage::load(Words::<4>(chip), shared.for_storage());
    clock.run(duration, storage.keep(&clock, shared.for_storage()), |_| {
        if calibrates {
            shared.parameters.set(Name::Imu1GyroY, 0.02).unwrap();
        }
    });
    shared
}

/// What is not as it was kept.
fn changed(shared: &Local) -> Vec<&'static str> {
    let is_changed = |values: &[(Name, f32)]| values.iter().any(|(name, value)| shared.parameters.raw(*name) != *value);
    let parameters = PARAMETER_GUARDS.iter().filter(|(_, values)| is_changed(values)).map(|(name, _)| *name);
    let key = (shared.signing.key() != key()).then_some("signing key");
    key.into_iter().chain(parameters).collect()
}

/// Whether a disarm command without a signature counts.
fn obeys_a_stranger(shared: &Local) -> bool {
    Fed::new(shared).message(&disarm(), 1_000);
    shared.disarm.take()
}

/// The answers to an arm request of a vehicle that is otherwise ready.
fn texts_of_arming(shared: &Local) -> Vec<String> {
    let mut desk = Desk::new(shared);
    for tick in 0..200 {
        shared.ground_station.put((), desk.now);
        if tick == 199 {
            texts(shared);
            shared.request(QueuedRequest { request: Request::Arm, order: None, setpoints: None });
        }
        desk.tick();
    }
    texts(shared)
}

/// Bytes of a record.
const RECORD_BYTES: usize = 256;

/// The places of records of as many words as the key has, or the parameters, the newest first.
fn places(chip: &RefCell<Chip>, words: u8) -> Vec<usize> {
    let bytes = &chip.borrow().bytes;
    let records = bytes.chunks(RECORD_BYTES).enumerate().filter(|(_, record)| record[4..6] == [words, 0]);
    let mut numbers: Vec<_> = records.map(|(place, record)| (record[0], place)).collect();
    numbers.sort_by(|a, b| b.cmp(a));
    numbers.into_iter().map(|(_, place)| place).collect()
}

const OF_THE_KEY: u8 = KEPT_WORDS as u8;
const OF_PARAMETERS: u8 = PARAMETERS.len() as u8;

#[test]
fn one_bit_or_one_record_less_changes_nothing_that_is_kept() {
    let chip = chip();
    assert_eq!(changed(&booted(&chip, 1_000, false)), [""; 0]);
    let holds = |damaged: &RefCell<Chip>, what: &str| {
        let shared = Local::new();
        Storage::load(Words::<4>(damaged), shared.for_storage());
        assert_eq!(changed(&shared), [""; 0], "{what}");
        assert!(!shared.signing.is_lost() && shared.parameters.lost().is_none(), "{what}");
        assert!(!obeys_a_stranger(&shared), "{what}");
    };
    let places = [OF_THE_KEY, OF_PARAMETERS].map(|words| places(&chip, words));
    assert!(places.iter().all(|places| places.len() >= 4), "two copies, and two older: {places:?}");
    let places = places.concat();
    for bit in places.iter().flat_map(|place| place * 8 * RECORD_BYTES..(place + 1) * 8 * RECORD_BYTES) {
        let damaged = chip.clone();
        damaged.borrow_mut().bytes[bit / 8] ^= 1 << (bit % 8);
        holds(&damaged, &format!("bit {bit}"));
    }
    for place in places {
        for byte in [0x00, 0xFF, 0x5A] {
            let damaged = chip.clone();
            damaged.borrow_mut().bytes[place * RECORD_BYTES..(place + 1) * RECORD_BYTES].fill(byte);
            holds(&damaged, &format!("record {place}, {byte}"));
        }
    }
}

/// A bit damaged in so many of the newest records of one kind.
fn without(chip: &RefCell<Chip>, words: u8, records: usize) -> RefCell<Chip> {
    let damaged = chip.clone();
    for place in places(chip, words).into_iter().take(records) {
        damaged.borrow_mut().bytes[place * RECORD_BYTES + 20] ^= 1;
    }
    damaged
}

/// Newest records that are damaged: both copies, and with them everything older.
const DAMAGED_WORDS: [usize; 2] = [2, usize::MAX];

#[test]
fn with_both_copies_of_the_key_gone_nothing_counts_but_over_usb_until_it_is_set_again() {
    for records in DAMAGED_WORDS {
        let damaged = without(&chip(), OF_THE_KEY, records);
        // A restart does not forget it, whatever the vehicle finds out by itself.
        for _ in 0..2 {
            let shared = booted(&damaged, 30_000_000, true);
            assert_eq!(texts(&shared)[0], KEY_LOST[0]);
            assert_eq!(changed(&shared), ["signing key"]);
            assert!(!obeys_a_stranger(&shared));
            assert_eq!(texts(&shared), [KEY_LOST[1]], "a station that comes late");
            assert_eq!(texts_of_arming(&shared), [KEY_LOST[1]]);
        }
        for again in [key(), None] {
            let (chip, shared, clock) = (damaged.clone(), Local::new(), Simulated::default());
            let mut storage = Storage::load(Words::<4>(&chip), shared.for_storage());
            shared.set_signing(again, 0, 0);
            clock.run(10_000, storage.keep(&clock, shared.for_storage()), |_| ());
            let shared = booted(&chip, 10_000, false);
            assert_eq!((shared.signing.key(), shared.signing.is_lost()), (again, false));
        }
    }
}

#[test]
fn with_both_copies_of_the_parameters_gone_it_does_not_arm_until_one_is_set_again() {
    for records in DAMAGED_WORDS {
        let damaged = without(&chip(), OF_PARAMETERS, records);
        for _ in 0..2 {
            let shared = booted(&damaged, 30_000_000, true);
            assert_eq!(texts(&shared)[0], PARAMETERS_LOST[0]);
            let lost = PARAMETER_GUARDS.map(|(name, _)| name).into_iter().filter(|name| *name != "`SIGN_ONLY`");
            assert!(changed(&shared).into_iter().eq(lost), "only signing is by default as it was");
            assert!(!obeys_a_stranger(&shared));
            texts(&shared);
            assert_eq!(texts_of_arming(&shared), [PARAMETERS_LOST[1]]);
        }
        let (shared, clock) = (Local::new(), Simulated::default());
        let mut storage = Storage::load(Words::<4>(&damaged), shared.for_storage());
        shared.on_port.raise();
        let fence = PARAM_SET_DATA {
            param_value: 20.0,
            target_system: 1,
            target_component: 1,
            param_id: "FENCE_RADIUS".into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        };
        Fed::new(&shared).message(&fence, 0);
        clock.run(10_000, storage.keep(&clock, shared.for_storage()), |_| ());
        let shared = booted(&damaged, 10_000, false);
        assert_eq!((shared.parameters.lost(), shared.parameters.get(Name::FenceRadius)), (None, 20.0));
        assert_eq!(shared.signing.key(), key());
    }
}

#[test]
fn a_stored_value_out_of_range_keeps_it_on_the_ground_until_it_is_set() {
    for row in PARAMETERS.iter().filter(|row| !row.parameter.is_tuned() && row.parameter != Name::TunedOn) {
        let mut values = PARAMETERS.map(|row| row.default);
        values[row.parameter as usize] = f32::NAN;
        let shared = Local::new();
        Storage::load(Words::<4>(&chip_with(&values)), shared.for_storage());
        assert_eq!(texts(&shared), [format!("{} lost: default taken; set it again", row.name)]);
        assert_eq!(shared.parameters.lost(), Some(row.name));
        if row.parameter == Name::FenceRadius {
            assert_eq!(texts_of_arming(&shared), ["Refused: FENCE_RADIUS lost; set again"]);
        }
        shared.parameters.set(row.parameter, row.default).unwrap();
        assert_eq!(shared.parameters.lost(), None);
    }
}

/// The rows of the page's table that begins with this header.
fn rows(header: &str) -> Vec<&'static str> {
    let table = PAGE.lines().skip_while(|line| !line.starts_with(header));
    table.take_while(|line| line.starts_with('|')).skip(2).collect()
}

#[test]
fn the_pages_table_of_what_is_kept_says_what_these_tests_see() {
    let parameters = PARAMETER_GUARDS.map(|(name, values)| {
        let default = values.iter().map(|(name, _)| match name.row().default {
            built if built.is_nan() => "as built".to_owned(),
            default => default.to_string(),
        });
        format!("| {name} | as it was | {}; does not arm |", default.collect::<Vec<_>>().join(", "))
    });
    let key = "| signing key | as it was | nothing counts but over USB; does not arm |".to_owned();
    let expected: Vec<_> = std::iter::once(key).chain(parameters).collect();
    assert_eq!(rows("| kept |"), expected);
    let said = |what: &str, [at_boot, later]: [&str; 2]| format!("| {what} | {at_boot} | {later} |");
    let range = ["FENCE_RADIUS lost: default taken; set it again", "Refused: FENCE_RADIUS lost; set again"];
    let expected = [said("signing key", KEY_LOST), said("parameters", PARAMETERS_LOST), said("one value", range)];
    assert_eq!(rows("| lost |"), expected);
}

#[test]
fn every_test_that_the_page_names_for_what_is_received_exists() {
    let sources = [
        include_str!("radio.rs"),
        include_str!("arming.rs"),
        include_str!("link_frames.rs"),
        include_str!("link_missions.rs"),
        include_str!("link_signing.rs"),
        include_str!("../../../flight/tests/modes.rs"),
        include_str!("../../../flight/src/detectors/tests.rs"),
    ];
    let rows = rows("| received |");
    assert!(rows.len() >= 8);
    for row in rows {
        let test = row.rsplit('`').nth(1).unwrap();
        assert!(sources.iter().any(|source| source.contains(&format!("fn {test}()"))), "{row}");
    }
}
