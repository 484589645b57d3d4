//! Parameters over a reboot, in flash like that of the boards, and in flash that fails.

use crate::support::Simulated;
use crate::support::chip::{Chip, FLASH_RECORDS, Words};
use crate::support::receiver::{Local, report, texts};
use firmware::hardware::{Fault, Flash, Record};
use firmware::outputs::wiring;
use firmware::parameters::storage::Storage;
use firmware::parameters::table::{Name, PARAMETERS};
use flight::Mode;
use std::cell::{Cell, RefCell};

/// What a boot finds.
fn booted<const WORD: usize>(chip: &RefCell<Chip>) -> Local {
    let shared = Local::new();
    Storage::load(Words::<WORD>(chip), shared.for_storage());
    shared
}

/// Boots, and keeps parameters for `duration`, us.
fn kept<const WORD: usize>(chip: &RefCell<Chip>, shared: &Local, duration: u64, each: impl FnMut(u64)) {
    let (clock, mut storage) = (Simulated::default(), Storage::load(Words::<WORD>(chip), shared.for_storage()));
    clock.run(duration, storage.keep(&clock, shared.for_storage()), each);
}

fn values_survive_a_reboot<const WORD: usize>() {
    let chip = Chip::erased();
    let shared = booted::<WORD>(&chip);
    assert!(texts(&shared).is_empty(), "an empty flash is no fault");
    // More values than fit in both sectors.
    kept::<WORD>(&chip, &shared, 600_000, |now| {
        shared.parameters.set(Name::HorizontalSpeed, 1.0 + now as f32 * 1e-5).unwrap();
        shared.parameters.set(Name::SystemId, 42.0).unwrap();
    });
    assert!(chip.borrow().writes > 2 * FLASH_RECORDS);
    let last = shared.parameters.get(Name::HorizontalSpeed);
    let shared = booted::<WORD>(&chip);
    assert_eq!(shared.parameters.get(Name::SystemId), 42.0);
    assert_eq!(shared.parameters.get(Name::HorizontalSpeed), last);
    assert_eq!(shared.parameters.get(Name::TelemetryRate), 25.0);
}

#[test]
fn values_survive_a_reboot_on_flash_of_32_byte_words() {
    values_survive_a_reboot::<32>();
}

#[test]
fn values_survive_a_reboot_on_flash_of_4_byte_words() {
    values_survive_a_reboot::<4>();
}

#[test]
fn nothing_is_written_while_a_motor_turns_and_nothing_else_keeps_one_from_turning() {
    for mode in [Mode::Idling, Mode::Flying, Mode::Descending, Mode::MotorTest] {
        let (chip, shared) = (Chip::erased(), Local::new());
        kept::<4>(&chip, &shared, 3_000_000, |now| {
            report(&shared, if now < 2_000_000 { mode } else { Mode::Ready }, now);
            shared.parameters.set(Name::BatteryLow, 10.0).unwrap();
            assert!(now >= 2_000_000 || chip.borrow().writes == 0, "{mode:?}");
            assert!(!shared.saving.is_raised(), "{mode:?}");
        });
        assert_eq!(booted::<4>(&chip).parameters.get(Name::BatteryLow), 10.0);
    }
}

/// Flash that counts what is written to it without control's having been warned.
struct Watched<'a> {
    words: Words<'a, 4>,
    shared: &'a Local,
    unwarned: &'a Cell<u32>,
}

impl Watched<'_> {
    fn look(&self) {
        self.unwarned.set(self.unwarned.get() + u32::from(!self.shared.saving.is_raised()));
    }
}

impl Flash for Watched<'_> {
    const RECORDS_PER_SECTOR: usize = FLASH_RECORDS;

    fn read(&mut self, place: usize) -> Result<Record, Fault> {
        self.words.read(place)
    }

    fn write(&mut self, place: usize, record: &Record) -> Result<(), Fault> {
        self.look();
        self.words.write(place, record)
    }

    fn erase(&mut self, sector: usize) -> Result<(), Fault> {
        self.look();
        self.words.erase(sector)
    }
}

#[test]
fn control_is_warned_while_flash_is_written() {
    let (chip, shared, unwarned) = (Chip::erased(), Local::new(), Cell::new(0));
    let flash = Watched { words: Words(&chip), shared: &shared, unwarned: &unwarned };
    let (clock, mut storage) = (Simulated::default(), Storage::load(flash, shared.for_storage()));
    let opened = unwarned.replace(0);
    clock.run(600_000, storage.keep(&clock, shared.for_storage()), |now| {
        shared.parameters.set(Name::HorizontalSpeed, 1.0 + now as f32 * 1e-5).unwrap();
    });
    assert!(chip.borrow().writes > 2 * FLASH_RECORDS, "{opened}");
    assert_eq!(unwarned.get(), 0);
    assert!(!shared.saving.is_raised());
}

#[test]
fn a_value_that_did_not_change_wears_nothing() {
    let (chip, shared) = (Chip::erased(), Local::new());
    kept::<4>(&chip, &shared, 100_000, |_| shared.parameters.set(Name::BatteryLow, 10.0).unwrap());
    let writes = chip.borrow().writes;
    let shared = booted::<4>(&chip);
    kept::<4>(&chip, &shared, 100_000, |_| shared.parameters.set(Name::BatteryLow, 10.0).unwrap());
    assert_eq!(chip.borrow().writes, writes);
}

#[test]
fn damaged_bytes_never_become_a_value_out_of_range() {
    for place in 0..200 {
        for damage in [0x00, 0x55] {
            let (chip, shared) = (Chip::erased(), Local::new());
            kept::<4>(&chip, &shared, 10_000, |_| shared.parameters.set(Name::SystemId, 42.0).unwrap());
            chip.borrow_mut().bytes[place] = damage;
            let shared = booted::<4>(&chip);
            assert!([1.0, 42.0].contains(&shared.parameters.get(Name::SystemId)), "byte {place}");
        }
    }
}

/// A record of so many words as it is in flash, from the values' bits; its checksum by dividing bit after bit, the
/// highest first.
fn record<const WORDS: usize>(number: u32, values: &[f32]) -> [u32; WORDS] {
    let mut record = [u32::MAX; _];
    (record[0], record[1]) = (number, values.len() as u32);
    record[2..].iter_mut().zip(values).for_each(|(word, value)| *word = value.to_bits());
    let bits = record[..WORDS - 1].iter().flat_map(|word| (0..32).map(move |bit| (word >> bit) & 1));
    let remainder = bits.fold(u32::MAX, |remainder, bit| {
        let divisor = if remainder >> 31 == bit { 0 } else { 0x04C1_1DB7 };
        (remainder << 1) ^ divisor
    });
    record[WORDS - 1] = !remainder.reverse_bits();
    record
}

/// A chip in which another firmware left these values.
pub fn chip_with(values: &[f32]) -> RefCell<Chip> {
    let chip = Chip::erased();
    (0..2).for_each(|copy| Words::<4>(&chip).write(copy, &record(1 + copy as u32, values)).unwrap());
    chip
}

#[test]
fn a_record_without_a_copy_is_used_reported_and_written_anew() {
    let chip = Chip::erased();
    Words::<4>(&chip).write(0, &record(1, &[42.0])).unwrap();
    let shared = Local::new();
    kept::<4>(&chip, &shared, 10_000, |_| ());
    assert_eq!(shared.parameters.get(Name::SystemId), 42.0);
    assert_eq!((texts(&shared), chip.borrow().writes), (vec!["Stored values: one copy only, written anew".into()], 3));
    assert!(texts(&booted::<4>(&chip)).is_empty());
}

#[test]
fn a_stored_value_out_of_range_is_reported_and_the_default_used() {
    for value in [0.0_f32, 256.0, f32::NAN] {
        let shared = booted::<4>(&chip_with(&[value, 25.0, 7.0, 2.0, 0.0]));
        assert_eq!(shared.parameters.get(Name::SystemId), 1.0);
        assert_eq!(shared.parameters.get(Name::HorizontalSpeed), 7.0);
        assert_eq!(texts(&shared), ["SYS_ID lost: default taken; set it again"]);
        assert_eq!(shared.parameters.lost(), Some("SYS_ID"));
    }
}

#[test]
fn records_of_firmware_with_fewer_parameters_and_with_more_are_read() {
    let shared = booted::<4>(&chip_with(&[42.0, 30.0]));
    let values = PARAMETERS.map(|row| shared.parameters.get(row.parameter));
    assert_eq!(values[..5], [42.0, 30.0, 5.0, 2.0, 0.0]);
    let mut more = PARAMETERS.map(|row| row.default).to_vec();
    more[..5].copy_from_slice(&[42.0, 30.0, 7.0, 3.0, 11.0]);
    more.extend([1e9, f32::NAN]);
    let shared = booted::<4>(&chip_with(&more));
    let values = PARAMETERS.map(|row| shared.parameters.get(row.parameter));
    let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&values), bits(&more[..PARAMETERS.len()]));
    assert!(texts(&shared).is_empty());
}

#[test]
fn half_as_long_records_of_older_firmware_are_read_and_followed_by_whole_ones() {
    let older = |number, id| record::<64>(number, &[id, 30.0, 7.0]);
    let pair = |[first, second]: [[u32; 64]; 2]| {
        let mut words = first.into_iter().chain(second);
        [(); _].map(|()| words.next().unwrap())
    };
    let blank = [u32::MAX; _];
    let torn = [0x55; _];
    let places = [
        vec![[older(1, 42.0), older(2, 42.0)]],
        vec![[older(1, 1.0), older(2, 1.0)], [older(3, 42.0), older(4, 42.0)]],
        vec![[older(1, 1.0), older(2, 42.0)], [older(3, 42.0), torn]],
        vec![[older(1, 42.0), older(2, 42.0)], [torn, blank]],
    ];
    for places in places {
        let chip = Chip::erased();
        for (place, halves) in places.iter().enumerate() {
            Words::<4>(&chip).write(place, &pair(*halves)).unwrap();
        }
        let shared = booted::<4>(&chip);
        assert_eq!(shared.parameters.get(Name::SystemId), 42.0);
        assert!(texts(&shared).is_empty());
        kept::<4>(&chip, &shared, 10_000, |_| shared.parameters.set(Name::VerticalSpeed, 3.0).unwrap());
        let shared = booted::<4>(&chip);
        assert_eq!([Name::SystemId, Name::VerticalSpeed].map(|name| shared.parameters.get(name)), [42.0, 3.0]);
        assert!(texts(&shared).is_empty());
    }
}

#[test]
fn flash_that_fails_is_reported_and_nothing_is_written_before_something_is_set() {
    let chip = Chip::erased();
    chip.borrow_mut().fails = true;
    let shared = booted::<4>(&chip);
    let lost = ["Parameters lost: defaults taken; set them again", "Signing key lost: set it over USB"];
    assert_eq!(texts(&shared), lost);
    // What the vehicle sets by itself, a calibration, is no word of an operator's.
    let shared = Local::new();
    kept::<4>(&chip, &shared, 10_000, |_| shared.parameters.set(Name::Imu1GyroX, 0.01).unwrap());
    assert_eq!((texts(&shared), chip.borrow().writes), (lost.map(str::to_owned).to_vec(), 0));
    let shared = Local::new();
    kept::<4>(&chip, &shared, 10_000, |_| {
        shared.parameters.set_again();
        shared.parameters.set(Name::SystemId, 42.0).unwrap();
    });
    assert_eq!(texts(&shared)[2..], ["SYS_ID: set, but could not be saved"]);
}

#[test]
fn a_value_that_could_not_be_saved_is_not_tried_again_and_again() {
    let (chip, shared) = (Chip::erased(), Local::new());
    chip.borrow_mut().worn = true;
    kept::<4>(&chip, &shared, 60_000_000, |_| shared.parameters.set(Name::SystemId, 42.0).unwrap());
    assert_eq!(chip.borrow().writes, 2);
    assert_eq!(texts(&shared), ["SYS_ID: set, but could not be saved"]);
}

#[test]
fn the_table_is_in_order_and_within_mavlinks_limits() {
    for (index, row) in PARAMETERS.iter().enumerate() {
        assert_eq!(row.parameter as usize, index);
        assert!(row.name.len() <= 16 && row.min < row.max, "{row:?}");
        assert!(if row.parameter.is_tuned() { row.default.is_nan() } else { row.allows(row.default) }, "{row:?}");
        assert!(PARAMETERS.iter().filter(|other| other.name == row.name).count() == 1);
        assert_eq!(Name::from_name(row.name), Some(row.parameter));
    }
}

#[test]
fn rotors_are_wired_to_outputs_by_a_digit_each() {
    assert_eq!(wiring(1234.0), Some([0, 1, 2, 3]));
    // Betaflight's order, and PX4's and ArduPilot's, of the rotors front left, front right, rear right, rear left.
    assert_eq!(wiring(4213.0), Some([3, 1, 0, 2]));
    assert_eq!(wiring(3142.0), Some([2, 0, 3, 1]));
    let whole = (1000..=9999).filter(|order| wiring(*order as f32).is_some()).count();
    assert_eq!(whole, 24, "every order, and no other number");
}

#[test]
fn an_order_that_leaves_a_rotor_without_an_output_is_refused() {
    let shared = Local::new();
    for order in [1233.0, 1235.0, 2340.0, 1234.5, 12.0, f32::NAN] {
        let refused = shared.parameters.set(Name::MotorOrder, order).unwrap_err();
        assert_eq!(refused.to_string(), "MOT_ORDER: each of the digits 1 to 4, once");
    }
    shared.parameters.set(Name::MotorOrder, 4213.0).unwrap();
    assert_eq!(shared.parameters.get(Name::MotorOrder), 4213.0);
}

#[test]
fn the_serial_line_takes_the_usual_rates() {
    let shared = Local::new();
    for rate in [57_600.0, 115_200.0, 230_400.0, 460_800.0, 921_600.0] {
        shared.parameters.set(Name::SerialRate, rate).unwrap();
    }
    let refused = shared.parameters.set(Name::SerialRate, 100_000.0).unwrap_err().to_string();
    assert_eq!(refused, "SER_BAUD: allowed are 57600 to 921600  by 57600");
}
