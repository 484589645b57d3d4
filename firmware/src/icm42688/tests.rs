//! The driver against a device that follows the data sheet, or fails.

use super::*;
use crate::registers::{READ_BIT, RESTART_AFTER_FAILURES};
use crate::tests::bench::{Device, Jumping, Line, Pin, Spi, X_LEFT, on_one_bus};
use core::cell::{Cell, RefCell};
use embassy_futures::block_on;
use nalgebra::Vector3;
use std::rc::Rc;

/// The registers after a reset that matter here, as (bank, register, value).
const RESET: [(usize, usize, u8); 12] = [
    (0, 0x4C, 0x30),
    (0, 0x4D, 0x91),
    (0, 0x4F, 0x06),
    (0, 0x50, 0x06),
    (0, 0x52, 0x11),
    (0, 0x64, 0x10),
    (0, 0x65, 0x10),
    (1, 0x0C, 0x0D),
    (1, 0x0D, 0xAA),
    (1, 0x0E, 0x80),
    (2, 0x03, 0x1A),
    (2, 0x04, 0xAA),
];

/// The device.
struct Chip {
    id: u8,
    banks: [[u8; 128]; 3],
    bank: usize,
    clock: Jumping,
    /// When, in which bank, register, value.
    written: Vec<(u64, usize, u8, u8)>,
    stuck: Option<u8>,
    /// As many writes of each register are lost.
    deaf: usize,
    lost: [[usize; 128]; 3],
    line: Line,
}

impl Chip {
    fn reset(&mut self) {
        (self.banks, self.bank) = ([[0; 128]; 3], 0);
        for (bank, register, value) in RESET {
            self.banks[bank][register] = value;
        }
        self.banks[0][usize::from(WHO_AM_I)] = self.id;
        // Nothing is measured, high byte first.
        self.banks[0][0x1F..0x2B].copy_from_slice(&[0x80, 0].repeat(6));
    }
}

impl Device for Chip {
    fn line(&mut self) -> &mut Line {
        &mut self.line
    }

    fn exchange(&mut self, bytes: &mut [u8]) {
        let [address, data @ ..] = bytes else { return };
        let register = usize::from(*address & !READ_BIT);
        if *address & READ_BIT != 0 {
            // With the low byte first where it was set so.
            let swap = usize::from(self.banks[0][0x4C] & 0x10 == 0);
            for (index, byte) in data.iter_mut().enumerate() {
                let place = register + index;
                let place = if (0x1F..0x2B).contains(&place) { ((place - 0x1F) ^ swap) + 0x1F } else { place };
                *byte = self.stuck.unwrap_or(self.banks[self.bank][place]);
            }
            return;
        }
        let value = data[0];
        let lost = &mut self.lost[self.bank][register];
        if *lost < self.deaf && !matches!(register, 0x76 | 0x11) {
            *lost += 1;
            return;
        }
        self.written.push((self.clock.now(), self.bank, *address, value));
        match register {
            0x76 => self.bank = value.into(),
            0x11 if value == 1 && self.bank == 0 => self.reset(),
            _ => {
                // After that nothing but ranges, rates and modes may be set.
                let is_on = self.banks[0][0x4E] != 0;
                assert!(
                    !is_on || (self.bank == 0 && matches!(register, 0x4E..=0x50)),
                    "{register:#x} while it measures"
                );
                self.banks[self.bank][register] = value;
            }
        }
    }
}

struct Bench {
    clock: Jumping,
    chip: Rc<RefCell<Chip>>,
    edges: Rc<Cell<bool>>,
    imu: Icm42688<Spi, Pin, Jumping>,
}

impl Bench {
    fn sample(&mut self) -> Result<RawImu, Fault> {
        block_on(self.imu.sample())
    }

    /// Measured counts, of the accelerometer and of the gyroscope.
    fn measured(&self, counts: [i16; 6]) {
        let bytes = counts.map(i16::to_be_bytes);
        self.chip.borrow_mut().banks[0][0x1F..0x2B].copy_from_slice(bytes.as_flattened());
    }
}

fn chip(model: Model, clock: &Jumping) -> Rc<RefCell<Chip>> {
    let mut chip = Chip {
        id: model.identity(),
        banks: [[0; 128]; 3],
        bank: 0,
        clock: clock.clone(),
        written: Vec::new(),
        stuck: None,
        deaf: 0,
        lost: [[0; 128]; 3],
        line: Line::default(),
    };
    chip.reset();
    Rc::new(RefCell::new(chip))
}

/// A sensor that measures from its power-up on.
fn bench(model: Model, mounting: &'static Mounting) -> Bench {
    let (clock, edges) = (Jumping::default(), Rc::new(Cell::new(true)));
    let chip = chip(model, &clock);
    let pin = Pin { rises: Rc::clone(&edges), late: 0, clock: clock.clone() };
    let [spi] = on_one_bus([chip.clone()]);
    let mut imu = Icm42688::new(model, spi, pin, clock.clone(), mounting);
    block_on(imu.power_up()).unwrap();
    let bench = Bench { clock, chip, edges, imu };
    bench.measured([0, 0, 2048, 0, 0, 0]);
    bench
}

#[test]
fn power_up_writes_the_data_sheets_registers_in_order() {
    for (model, gyroscope, accelerometer) in [
        (Model::Icm42688P, [(0x0C, 3), (0x0D, 9), (0x0E, 0xC0)], [(0x03, 6), (0x04, 9), (0x05, 0xC0)]),
        (Model::Icm42605, [(0x0C, 11), (0x0D, 122), (0x0E, 0x80)], [(0x03, 22), (0x04, 122), (0x05, 0x80)]),
    ] {
        let bench = bench(model, &Mounting::ALIGNED);
        let chip = bench.chip.borrow();
        let first = [(0x76, 0), (0x11, 1), (0x4C, 3), (0x4D, 0x51), (0x14, 3), (0x64, 0), (0x65, 8)];
        let then = [(0x4F, 6), (0x50, 6), (0x52, 0xFF)];
        let zeroth = [&first[..], &then].concat().into_iter().map(|(register, value)| (0, register, value));
        let others = [(1, gyroscope), (2, accelerometer)].into_iter().flat_map(|(bank, settings)| {
            // The bank is chosen in the one before it.
            let chosen = [(bank - 1, 0x76, bank as u8)].into_iter();
            chosen.chain(settings.map(|(register, value)| (bank, register, value)))
        });
        let expected: Vec<_> = zeroth.chain(others).chain([(2, 0x76, 0), (0, 0x4E, 0x0F)]).collect();
        let written: Vec<_> =
            chip.written.iter().map(|(_, bank, register, value)| (*bank, *register, *value)).collect();
        assert_eq!(written, expected, "{model:?}");
        let time = |index: usize| chip.written[index].0;
        assert!(time(0) >= 1_000 && time(2) - time(1) >= 2_000);
        assert!(bench.clock.now() - time(chip.written.len() - 1) >= 45_000, "the gyroscope has its time");
        assert!(bench.clock.now() + 10_000 < crate::imu::SAMPLE_TIMEOUT_US, "{} us", bench.clock.now());
    }
}

#[test]
fn full_scale_counts_are_two_thousand_degrees_a_second_and_16_g() {
    let mut bench = bench(Model::Icm42688P, &Mounting::ALIGNED);
    bench.measured([i16::MAX, i16::MIN, 2048, i16::MIN, 16384, 1]);
    let sample = bench.sample().unwrap();
    let (rates, force) = (sample.angular_velocity.map(f64::from), sample.specific_force.unwrap().map(f64::from));
    let full = 2000.0_f64.to_radians();
    assert!((rates.x + full).abs() < 1e-5 && (rates.y - 0.5 * full).abs() < 1e-5, "{rates}");
    assert!((rates.z - full / 32768.0).abs() < 1e-9, "{rates}");
    assert!((f64::from(ImuParameters::ICM42688P.gyro_range) - full).abs() < 1e-5);
    let full = 16.0 * 9.806_65;
    assert!((force.x - full * 32767.0 / 32768.0).abs() < 1e-4 && (force.y + full).abs() < 1e-4, "{force}");
    assert!((force.z - 9.806_65).abs() < 1e-4, "{force}");
    assert!((f64::from(ImuParameters::ICM42688P.accelerometer_range) - full).abs() < 1e-4);
}

#[test]
fn the_mounting_turns_both_measurements() {
    let mut bench = bench(Model::Icm42688P, &X_LEFT);
    bench.measured([4096, 0, 0, 4096, 0, 0]);
    let sample = bench.sample().unwrap();
    assert_eq!(sample.angular_velocity, Vector3::new(0.0, 4096.0 * RATE_PER_COUNT, 0.0));
    assert_eq!(sample.specific_force, Some(Vector3::new(0.0, 4096.0 * ACCELERATION_PER_COUNT, 0.0)));
}

#[test]
fn one_model_is_not_taken_for_the_other() {
    for (model, other) in [(Model::Icm42688P, Model::Icm42605), (Model::Icm42605, Model::Icm42688P)] {
        let mut bench = bench(model, &Mounting::ALIGNED);
        bench.chip.borrow_mut().banks[0][usize::from(WHO_AM_I)] = other.identity();
        assert_eq!(bench.sample(), Err(Fault));
        bench.chip.borrow_mut().id = other.identity();
        bench.imu.power_up.restart(bench.clock.now());
        assert_eq!(bench.sample(), Err(Fault));
        assert_eq!(bench.chip.borrow().banks[0][0x4E], 0, "it is not turned on");
    }
}

#[test]
fn settings_are_written_again_one_by_one_until_they_stick() {
    let mut bench = bench(Model::Icm42688P, &Mounting::ALIGNED);
    for (lost, sticks) in [(1, true), (4, true), (8, false)] {
        let mut chip = bench.chip.borrow_mut();
        (chip.deaf, chip.lost) = (lost, [[0; 128]; 3]);
        drop(chip);
        bench.imu.power_up.restart(bench.clock.now());
        let before = bench.clock.now();
        let powered = block_on(bench.imu.power_up());
        assert_eq!(powered.is_ok(), sticks, "{lost} lost");
        assert!(bench.clock.now() - before < crate::imu::SAMPLE_TIMEOUT_US, "{} us", bench.clock.now() - before);
    }
}

#[test]
fn a_device_that_was_reset_measures_nothing_and_is_powered_up_anew() {
    let mut bench = bench(Model::Icm42688P, &Mounting::ALIGNED);
    bench.sample().unwrap();
    bench.chip.borrow_mut().reset();
    for _ in 0..RESTART_AFTER_FAILURES {
        assert_eq!(bench.sample(), Err(Fault));
    }
    block_on(bench.imu.power_up()).unwrap();
    assert_eq!(bench.chip.borrow().banks[0][0x4E], 0x0F);
    bench.measured([0, 0, 2048, 0, 0, 0]);
    bench.sample().unwrap();
}

#[test]
fn a_device_left_in_another_bank_is_powered_up_from_there() {
    let mut bench = bench(Model::Icm42605, &Mounting::ALIGNED);
    bench.chip.borrow_mut().bank = 2;
    for _ in 0..RESTART_AFTER_FAILURES {
        assert_eq!(bench.sample(), Err(Fault));
    }
    block_on(bench.imu.power_up()).unwrap();
    bench.measured([0, 0, 2048, 0, 0, 0]);
    bench.sample().unwrap();
}

#[test]
fn a_stuck_bus_is_a_fault_and_a_hanging_one_within_500_us() {
    for level in [0x00, 0xFF] {
        let mut bench = bench(Model::Icm42688P, &Mounting::ALIGNED);
        bench.chip.borrow_mut().stuck = Some(level);
        assert_eq!(bench.sample(), Err(Fault));
    }
    let mut bench = bench(Model::Icm42688P, &Mounting::ALIGNED);
    bench.chip.borrow_mut().line.hangs = true;
    let before = bench.clock.now();
    assert_eq!(bench.sample(), Err(Fault));
    assert_eq!(bench.clock.now() - before, 500);
    assert!(!bench.chip.borrow().line.selected);
    // Powering up a bus that hangs ends as well, and leaves time for others.
    for _ in 0..20 {
        let before = bench.clock.now();
        assert_eq!(bench.sample(), Err(Fault));
        assert!((500..150_000).contains(&(bench.clock.now() - before)));
    }
}

#[test]
fn without_edges_it_is_polled_a_thousand_times_a_second() {
    let mut bench = bench(Model::Icm42688P, &Mounting::ALIGNED);
    bench.sample().unwrap();
    bench.edges.set(false);
    let before = bench.clock.now();
    for n in 0..100 {
        assert_eq!(bench.sample().unwrap().time - before, 2_500 + n * 1_000);
    }
    assert!(bench.imu.is_polled());
}

#[test]
fn two_sensors_on_one_bus_both_measure() {
    let clock = Jumping::default();
    let chips = [Model::Icm42688P, Model::Icm42605].map(|model| chip(model, &clock));
    let pin = || Pin { rises: Rc::new(Cell::new(true)), late: 0, clock: clock.clone() };
    let [first, second] = on_one_bus([chips[0].clone(), chips[1].clone()]);
    let first = Icm42688::new(Model::Icm42688P, first, pin(), clock.clone(), &Mounting::ALIGNED);
    let second = Icm42688::new(Model::Icm42605, second, pin(), clock.clone(), &Mounting::ALIGNED);
    let mut both = crate::redundant::Redundant::new(first, second);
    for chip in &chips {
        // Whoever powers up reads as after a reset until something is measured.
        assert_eq!(chip.borrow().banks[0][0x4E], 0);
    }
    assert_eq!(block_on(both.sample()), Err(Fault));
    assert_eq!(block_on(both.standby()), Some(Err(Fault)));
    for (chip, count) in chips.iter().zip([100_i16, 200]) {
        chip.borrow_mut().banks[0][0x25..0x27].copy_from_slice(&count.to_be_bytes());
    }
    let rate = |sample: Result<RawImu, Fault>| sample.unwrap().angular_velocity.x / RATE_PER_COUNT;
    assert_eq!(rate(block_on(both.sample())), 100.0);
    assert_eq!(rate(block_on(both.standby()).unwrap()), 200.0);
}
