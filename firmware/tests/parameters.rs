//! Parameters over a reboot, in flash like that of the boards, and in flash that fails.

mod support;

use controller_core::flight::Mode;
use core::future::pending;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use firmware::parameters::storage::Storage;
use firmware::parameters::table::{Name, PARAMETERS};
use std::cell::RefCell;
use support::Simulated;
use support::receiver::{Local, report, texts};

/// Erasable pages of the test's flash, bytes.
const PAGE: usize = 1024;

/// What is in the flash, and whether it works.
struct Chip {
    bytes: Vec<u8>,
    answers: bool,
    fails: bool,
    writes: usize,
}

impl Chip {
    fn erased() -> RefCell<Self> {
        RefCell::new(Self { bytes: vec![0xFF; 2 * PAGE], answers: true, fails: false, writes: 0 })
    }
}

/// Flash that writes `WORD` bytes at once, each of them once between erasures, as the H743's does.
struct Flash<'a, const WORD: usize>(&'a RefCell<Chip>);

impl<const WORD: usize> Flash<'_, WORD> {
    async fn ready(&self) -> Result<(), NorFlashErrorKind> {
        let (answers, fails) = (self.0.borrow().answers, self.0.borrow().fails);
        if !answers {
            pending::<()>().await;
        }
        if fails { Err(NorFlashErrorKind::Other) } else { Ok(()) }
    }
}

impl<const WORD: usize> ErrorType for Flash<'_, WORD> {
    type Error = NorFlashErrorKind;
}

impl<const WORD: usize> ReadNorFlash for Flash<'_, WORD> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        self.ready().await?;
        let start = offset as usize;
        bytes.copy_from_slice(&self.0.borrow().bytes[start..start + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        2 * PAGE
    }
}

impl<const WORD: usize> NorFlash for Flash<'_, WORD> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        self.ready().await?;
        self.0.borrow_mut().bytes[from as usize..to as usize].fill(0xFF);
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        self.ready().await?;
        let start = offset as usize;
        assert!(start.is_multiple_of(WORD) && bytes.len().is_multiple_of(WORD));
        let mut chip = self.0.borrow_mut();
        chip.writes += 1;
        let place = &mut chip.bytes[start..start + bytes.len()];
        assert!(place.iter().all(|&byte| byte == 0xFF), "written twice");
        place.copy_from_slice(bytes);
        Ok(())
    }
}

fn storage<const WORD: usize>(chip: &RefCell<Chip>) -> Storage<Flash<'_, WORD>> {
    Storage::new(Flash(chip), 0..2 * PAGE as u32).unwrap()
}

/// What a boot finds.
fn booted<const WORD: usize>(chip: &RefCell<Chip>) -> Local {
    let shared = Local::new();
    let (clock, mut storage) = (Simulated::default(), storage::<WORD>(chip));
    let load = async {
        storage.load(&clock, &shared).await;
        pending::<()>().await;
    };
    clock.run(1_000_000, load, |_| ());
    shared
}

/// Keeps parameters for `duration`, us.
fn kept<const WORD: usize>(chip: &RefCell<Chip>, shared: &Local, duration: u64, each: impl FnMut(u64)) {
    let (clock, mut storage) = (Simulated::default(), storage::<WORD>(chip));
    clock.run(duration, storage.keep(&clock, shared), each);
}

fn values_survive_a_reboot<const WORD: usize>() {
    let chip = Chip::erased();
    let shared = booted::<WORD>(&chip);
    assert!(texts(&shared).is_empty(), "an empty flash is no fault");
    // Far more values than fit on a page.
    kept::<WORD>(&chip, &shared, 600_000, |now| {
        shared.parameters.set(Name::HorizontalSpeed, 1.0 + now as f32 * 1e-5).unwrap();
        shared.parameters.set(Name::SystemId, 42.0).unwrap();
    });
    assert!(chip.borrow().writes > 2 * PAGE / 32);
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
fn nothing_is_written_while_armed() {
    let (chip, shared) = (Chip::erased(), Local::new());
    kept::<4>(&chip, &shared, 3_000_000, |now| {
        report(&shared, if now < 2_000_000 { Mode::Flying } else { Mode::Disarmed }, now);
        shared.parameters.set(Name::BatteryLow, 10.0).unwrap();
        assert!(now >= 2_000_000 || chip.borrow().writes == 0);
    });
    assert_eq!(booted::<4>(&chip).parameters.get(Name::BatteryLow), 10.0);
}

#[test]
fn a_value_that_did_not_change_wears_nothing() {
    let (chip, shared) = (Chip::erased(), Local::new());
    kept::<4>(&chip, &shared, 100_000, |_| shared.parameters.set(Name::BatteryLow, 10.0).unwrap());
    let writes = chip.borrow().writes;
    let shared = booted::<4>(&chip);
    let (clock, mut storage) = (Simulated::default(), storage::<4>(&chip));
    let both = async {
        storage.load(&clock, &shared).await;
        storage.keep(&clock, &shared).await;
    };
    clock.run(100_000, both, |_| shared.parameters.set(Name::BatteryLow, 10.0).unwrap());
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

#[test]
fn a_stored_value_out_of_range_is_told_and_the_default_taken() {
    use sequential_storage::cache::Cache;
    use sequential_storage::map::{MapConfig, MapStorage};
    for value in [0.0_f32, 256.0, f32::NAN] {
        let chip = Chip::erased();
        let config = MapConfig::new(0..2 * PAGE as u32);
        let mut map = MapStorage::<u8, _, _>::new(Flash::<4>(&chip), config, Cache::new_uncached());
        embassy_futures::block_on(map.store_item(&mut [0; 64], &(Name::SystemId as u8), &value)).unwrap();
        let shared = booted::<4>(&chip);
        assert_eq!(shared.parameters.get(Name::SystemId), 1.0);
        assert_eq!(texts(&shared), ["SYS_ID: stored value unusable, default taken"]);
    }
}

#[test]
fn flash_that_fails_or_hangs_is_told_and_flown_without() {
    let chip = Chip::erased();
    chip.borrow_mut().fails = true;
    let shared = booted::<4>(&chip);
    assert_eq!(texts(&shared).len(), PARAMETERS.len());
    kept::<4>(&chip, &shared, 10_000, |_| shared.parameters.set(Name::SystemId, 42.0).unwrap());
    assert_eq!(texts(&shared), ["SYS_ID: set, but could not be saved"]);

    let chip = Chip::erased();
    chip.borrow_mut().answers = false;
    let shared = booted::<4>(&chip);
    assert_eq!(texts(&shared), ["Parameters: storage does not answer"]);
    kept::<4>(&chip, &shared, 11_000_000, |_| shared.parameters.set(Name::SystemId, 42.0).unwrap());
    assert_eq!(texts(&shared), ["SYS_ID: set, but could not be saved"]);
}

#[test]
fn storage_needs_two_whole_pages() {
    let chip = Chip::erased();
    assert!(Storage::new(Flash::<4>(&chip), 0..PAGE as u32).is_err());
    assert!(Storage::new(Flash::<4>(&chip), 8..2 * PAGE as u32).is_err());
}

#[test]
fn the_table_is_in_order_and_within_mavlinks_limits() {
    for (index, row) in PARAMETERS.iter().enumerate() {
        assert_eq!(row.parameter as usize, index);
        assert!(row.name.len() <= 16 && row.allows(row.default) && row.least < row.most, "{row:?}");
        assert!(PARAMETERS.iter().filter(|other| other.name == row.name).count() == 1);
        assert_eq!(Name::from_bytes(row.name.as_bytes()), Some(row.parameter));
    }
}
