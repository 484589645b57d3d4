//! The driver against a device that follows the data sheet, or fails.

use super::*;
use crate::registers::{READ_BIT, RESTART_AFTER_FAILURES};
use crate::tests::bench::{Device, Jumping, Line, Pin, Spi, X_LEFT, on_one_bus};
use core::cell::{Cell, RefCell};
use embassy_futures::block_on;
use nalgebra::Vector3;
use std::rc::Rc;

/// The device.
struct Chip {
    values: [u8; 128],
    clock: Jumping,
    /// It ignores the bus until its chip select has risen once.
    asleep: bool,
    /// What was written into it, and whether it was started.
    file: Vec<u8>,
    written: Vec<(u64, u8, u8)>,
    stuck: Option<u8>,
    line: Line,
}

impl Chip {
    fn reset(&mut self) {
        self.values = [0; 128];
        (self.values[0], self.values[0x7C]) = (CHIP_ID_BMI270, 0x03);
        (self.asleep, self.file) = (true, Vec::new());
    }
}

impl Device for Chip {
    fn line(&mut self) -> &mut Line {
        &mut self.line
    }

    fn exchange(&mut self, bytes: &mut [u8]) {
        let asleep = std::mem::take(&mut self.asleep);
        let [address, data @ ..] = bytes else { return };
        let register = *address & !READ_BIT;
        if *address & READ_BIT != 0 {
            // One byte that means nothing comes first.
            for (index, byte) in data.iter_mut().enumerate().skip(1) {
                let read = self.values[usize::from(register) + index - 1];
                *byte = self.stuck.unwrap_or(if asleep { 0 } else { read });
            }
            return;
        }
        if asleep {
            return;
        }
        let value = data[0];
        match register {
            0x5E => {
                assert_eq!((self.values[0x7C] & 1, self.values[0x59]), (0, 0), "the file needs power, and no run");
                self.file.extend_from_slice(data);
                return;
            }
            0x7E if value == 0xB6 => self.reset(),
            0x59 => {
                self.values[0x59] = value;
                let runs = value == 1 && self.file == CONFIGURATION;
                self.values[0x21] = if runs { 0x01 } else { 0x02 };
                self.values[usize::from(CROSS_SENSITIVITY)] = 0x7F * u8::from(runs);
            }
            _ => self.values[usize::from(register)] = value,
        }
        self.written.push((self.clock.now(), register, value));
    }
}

struct Bench {
    clock: Jumping,
    chip: Rc<RefCell<Chip>>,
    edges: Rc<Cell<bool>>,
    imu: Bmi270<Spi, Pin, Jumping>,
}

impl Bench {
    fn sample(&mut self) -> Result<RawImu, Fault> {
        block_on(self.imu.sample())
    }

    fn load(&self, register: usize, bytes: &[u8]) {
        self.chip.borrow_mut().values[register..register + bytes.len()].copy_from_slice(bytes);
    }
}

fn bench(mounting: &'static Mounting) -> Bench {
    let (clock, edges) = (Jumping::default(), Rc::new(Cell::new(true)));
    let mut chip = Chip {
        values: [0; 128],
        clock: clock.clone(),
        asleep: true,
        file: Vec::new(),
        written: Vec::new(),
        stuck: None,
        line: Line::default(),
    };
    chip.reset();
    let chip = Rc::new(RefCell::new(chip));
    let pin = Pin { rises: Rc::clone(&edges), late: 0, clock: clock.clone() };
    let [spi] = on_one_bus([chip.clone()]);
    let imu = Bmi270::new(spi, pin, clock.clone(), mounting);
    Bench { clock, chip, edges, imu }
}

#[test]
fn power_up_writes_the_file_and_the_data_sheets_registers_in_order() {
    let mut bench = bench(&Mounting::ALIGNED);
    bench.sample().unwrap();
    let chip = bench.chip.borrow();
    assert_eq!(chip.file, CONFIGURATION);
    let written: Vec<_> = chip.written.iter().map(|(_, register, value)| (*register, *value)).collect();
    let file = [(0x7E, 0xB6), (0x7C, 0x00), (0x59, 0x00), (0x5B, 0x00), (0x5C, 0x00), (0x59, 0x01)];
    let settings = [(0x40, 0x8C), (0x41, 0x03), (0x42, 0xCC), (0x43, 0), (0x53, 0x0A), (0x55, 0), (0x58, 4), (0x7D, 6)];
    assert_eq!(written, [&file[..], &settings[..]].concat());
    let time = |index: usize| chip.written[index].0;
    assert!(time(0) >= 1_000 && time(1) - time(0) >= 2_000 && time(2) - time(1) >= 450 && time(6) - time(5) >= 20_000);
    assert!(bench.clock.now() - time(13) >= 45_000, "the gyroscope has its time");
    drop(chip);
    assert!(bench.clock.now() + 10_000 < crate::imu::SAMPLE_TIMEOUT_US, "{} us", bench.clock.now());
}

#[test]
fn a_file_that_does_not_run_is_a_fault() {
    let mut bench = bench(&Mounting::ALIGNED);
    bench.chip.borrow_mut().file = vec![0];
    // A reset forgets it: only what is written after the reset counts, so it runs.
    bench.sample().unwrap();
    bench.chip.borrow_mut().reset();
    for _ in 0..RESTART_AFTER_FAILURES {
        bench.load(0, &[0]);
        bench.sample().unwrap_err();
    }
    bench.load(0, &[CHIP_ID_BMI270]);
    bench.sample().unwrap();
    assert_eq!(bench.chip.borrow().file, CONFIGURATION, "powered up anew");
}

#[test]
fn full_scale_counts_are_two_thousand_degrees_a_second_and_16_g_and_x_is_freed_of_z() {
    let mut bench = bench(&Mounting::ALIGNED);
    bench.sample().unwrap();
    bench.load(0x0C, &[0xFF, 0x7F, 0x00, 0x80, 0x00, 0x08]);
    bench.load(0x12, &[0x00, 0x00, 0x00, 0x80, 0x00, 0x40]);
    let sample = bench.sample().unwrap();
    let (rates, force) = (sample.angular_velocity.map(f64::from), sample.specific_force.unwrap().map(f64::from));
    let full = 2000.0_f64.to_radians();
    // 0x7F in seven bits is -1: x = 0 + 16384 / 512 counts.
    assert!((rates.x - full * 32.0 / 32768.0).abs() < 1e-7, "{rates}");
    assert!((rates.y + full).abs() < 1e-5 && (rates.z - 0.5 * full).abs() < 1e-5, "{rates}");
    let full = 16.0 * 9.806_65;
    assert!((force.x - full * 32767.0 / 32768.0).abs() < 1e-4 && (force.y + full).abs() < 1e-4, "{force}");
    assert!((force.z - 9.806_65).abs() < 1e-4, "{force}");
    assert!((f64::from(ImuParameters::BMI270.accelerometer_range) - full).abs() < 1e-4);
}

#[test]
fn the_mounting_turns_both_measurements() {
    let mut bench = bench(&X_LEFT);
    bench.sample().unwrap();
    bench.load(0x0C, &[0, 0x10, 0, 0, 0, 0, 0, 0x10, 0, 0, 0, 0]);
    let sample = bench.sample().unwrap();
    assert_eq!(sample.angular_velocity, Vector3::new(0.0, 4096.0 * RATE_PER_COUNT, 0.0));
    assert_eq!(sample.specific_force, Some(Vector3::new(0.0, 4096.0 * ACCELERATION_PER_COUNT, 0.0)));
}

#[test]
fn a_stuck_bus_is_a_fault_and_a_hanging_one_within_500_us() {
    for level in [0x00, 0xFF] {
        let mut bench = bench(&Mounting::ALIGNED);
        bench.sample().unwrap();
        bench.chip.borrow_mut().stuck = Some(level);
        assert_eq!(bench.sample(), Err(Fault));
    }
    let mut bench = bench(&Mounting::ALIGNED);
    bench.sample().unwrap();
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
fn without_edges_it_is_polled_1600_times_a_second() {
    let mut bench = bench(&Mounting::ALIGNED);
    bench.sample().unwrap();
    bench.edges.set(false);
    let before = bench.clock.now();
    for n in 0..100 {
        assert_eq!(bench.sample().unwrap().time - before, 1_562 + n * 625);
    }
    assert!(bench.imu.is_polled());
}
