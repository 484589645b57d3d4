//! The driver against a register file that behaves as the data sheet says, with a clock that jumps.

use super::*;
use core::cell::{Cell, RefCell};
use core::convert::Infallible;
use core::future::{pending, ready};
use embassy_futures::block_on;
use embedded_hal_async::spi::{ErrorKind, ErrorType, Operation};
use std::rc::Rc;

/// A clock on which waiting costs nothing and moves time.
#[derive(Clone, Default)]
struct Jumping(Rc<Cell<u64>>);

impl Clock for Jumping {
    fn now(&self) -> u64 {
        self.0.get()
    }

    async fn until(&self, time: u64) {
        self.0.set(self.0.get().max(time));
    }
}

/// One write that a device heard.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Written {
    time: u64,
    register: u8,
    value: u8,
}

/// One of the two devices.
#[derive(Clone)]
struct Device(Rc<RefCell<Registers>>);

struct Registers {
    values: [u8; 128],
    clock: Jumping,
    written: Vec<Written>,
    /// Reads answer after the address, or after one more byte.
    dummy: usize,
    reset: u8,
    /// The accelerometer ignores the bus until its chip select has risen once.
    asleep: bool,
    stuck: Option<u8>,
    hangs: bool,
    fails: bool,
}

impl Device {
    fn new(clock: &Jumping, dummy: usize, reset: u8, id: u8) -> Self {
        let mut values = [0; 128];
        values[usize::from(CHIP_ID)] = id;
        let clock = clock.clone();
        let asleep = dummy > 0;
        let registers = Registers {
            values,
            clock,
            written: Vec::new(),
            dummy,
            reset,
            asleep,
            stuck: None,
            hangs: false,
            fails: false,
        };
        Self(Rc::new(RefCell::new(registers)))
    }

    fn load(&self, register: u8, bytes: &[u8]) {
        let start = usize::from(register);
        self.0.borrow_mut().values[start..start + bytes.len()].copy_from_slice(bytes);
    }
}

impl Registers {
    fn transfer(&mut self, bytes: &mut [u8]) {
        let asleep = std::mem::take(&mut self.asleep);
        let [address, data @ ..] = bytes else { return };
        let register = *address & !READ;
        if *address & READ == 0 {
            if asleep {
                return;
            }
            let value = data[0];
            self.written.push(Written { time: self.clock.now(), register, value });
            if register == self.reset && value == SOFT_RESET {
                self.asleep = self.dummy > 0;
            } else {
                self.values[usize::from(register)] = value;
            }
            return;
        }
        for (index, byte) in data.iter_mut().enumerate().skip(self.dummy) {
            let read = self.values[usize::from(register) + index - self.dummy];
            *byte = self.stuck.unwrap_or(if asleep { 0 } else { read });
        }
    }
}

impl ErrorType for Device {
    type Error = ErrorKind;
}

impl SpiDevice for Device {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        if self.0.borrow().fails {
            return Err(ErrorKind::Other);
        }
        if self.0.borrow().hangs {
            pending::<()>().await;
        }
        for operation in operations {
            match operation {
                Operation::TransferInPlace(bytes) => self.0.borrow_mut().transfer(bytes),
                Operation::Write(bytes) => self.0.borrow_mut().transfer(&mut bytes.to_vec()),
                _ => unreachable!("the driver writes or exchanges in place"),
            }
        }
        Ok(())
    }
}

/// A data-ready pin that rises when asked, or never.
struct Pin(Rc<Cell<bool>>);

impl embedded_hal::digital::ErrorType for Pin {
    type Error = Infallible;
}

impl Wait for Pin {
    async fn wait_for_high(&mut self) -> Result<(), Infallible> {
        pending().await
    }

    async fn wait_for_low(&mut self) -> Result<(), Infallible> {
        pending().await
    }

    async fn wait_for_rising_edge(&mut self) -> Result<(), Infallible> {
        if self.0.get() { ready(Ok(())).await } else { pending().await }
    }

    async fn wait_for_falling_edge(&mut self) -> Result<(), Infallible> {
        pending().await
    }

    async fn wait_for_any_edge(&mut self) -> Result<(), Infallible> {
        pending().await
    }
}

/// The driver and handles on everything it talks to.
struct Bench {
    clock: Jumping,
    accelerometer: Device,
    gyroscope: Device,
    data_ready: Rc<Cell<bool>>,
    imu: Bmi088<Device, Device, Pin, Jumping>,
}

fn bench(mounting: Mounting) -> Bench {
    let clock = Jumping::default();
    let accelerometer = Device::new(&clock, 1, ACCELEROMETER_RESET, ACCELEROMETER_ID);
    let gyroscope = Device::new(&clock, 0, GYROSCOPE_RESET, GYROSCOPE_ID);
    let data_ready = Rc::new(Cell::new(true));
    let pin = Pin(data_ready.clone());
    let imu = Bmi088::new(accelerometer.clone(), gyroscope.clone(), pin, clock.clone(), mounting);
    Bench { clock, accelerometer, gyroscope, data_ready, imu }
}

impl Bench {
    fn sample(&mut self) -> Result<ImuSample, Fault> {
        block_on(self.imu.sample())
    }
}

fn writes(device: &Device) -> Vec<(u8, u8)> {
    device.0.borrow().written.iter().map(|written| (written.register, written.value)).collect()
}

/// When the write after that of `register` came, less its own time.
fn pause_after(device: &Device, register: u8) -> u64 {
    let device = device.0.borrow();
    let index = device.written.iter().position(|written| written.register == register).unwrap();
    device.written[index + 1].time - device.written[index].time
}

#[test]
fn power_up_writes_the_data_sheets_registers_in_order() {
    let mut bench = bench(Mounting::Aligned);
    bench.sample().unwrap();
    assert_eq!(writes(&bench.accelerometer), [(0x7E, 0xB6), (0x7C, 0x00), (0x7D, 0x04), (0x40, 0x8C), (0x41, 0x03)]);
    let gyroscope = [(0x14, 0xB6), (0x0F, 0x00), (0x10, 0x82), (0x16, 0x0D), (0x18, 0x01), (0x15, 0x80)];
    assert_eq!(writes(&bench.gyroscope), gyroscope);
}

#[test]
fn power_up_waits_as_long_as_the_devices_need() {
    let mut bench = bench(Mounting::Aligned);
    bench.sample().unwrap();
    assert!(bench.accelerometer.0.borrow().written[0].time >= 1_000);
    assert!(pause_after(&bench.accelerometer, ACCELEROMETER_RESET) >= 1_000);
    assert!(pause_after(&bench.accelerometer, 0x7C) >= 5_000);
    assert!(pause_after(&bench.accelerometer, 0x7D) >= 50_000);
    assert!(pause_after(&bench.gyroscope, GYROSCOPE_RESET) >= 30_000);
}

#[test]
fn power_up_ends_before_the_task_loses_patience() {
    let mut bench = bench(Mounting::Aligned);
    bench.sample().unwrap();
    assert!(bench.clock.now() + 10_000 < crate::imu::PATIENCE, "{} us", bench.clock.now());
}

#[test]
fn a_running_sensor_is_not_powered_up_again() {
    let mut bench = bench(Mounting::Aligned);
    bench.sample().unwrap();
    let before = (writes(&bench.accelerometer), writes(&bench.gyroscope));
    bench.sample().unwrap();
    assert_eq!(before, (writes(&bench.accelerometer), writes(&bench.gyroscope)));
}

#[test]
fn full_scale_counts_are_two_thousand_degrees_a_second_and_24_g() {
    let mut bench = bench(Mounting::Aligned);
    bench.gyroscope.load(GYROSCOPE_DATA, &[0x00, 0x80, 0xFF, 0x7F, 0x01, 0x00]);
    bench.accelerometer.load(ACCELEROMETER_DATA, &[0xFF, 0x7F, 0x00, 0x80, 0x55, 0x05]);
    let sample = bench.sample().unwrap();
    let rates = sample.angular_velocity.map(f64::from);
    let full = 2000.0_f64.to_radians();
    assert!((rates.x + full).abs() < 1e-5 && (rates.y - full * 32767.0 / 32768.0).abs() < 1e-5, "{rates}");
    assert!((rates.z - full / 32768.0).abs() < 1e-9, "{rates}");
    let force = sample.specific_force.map(f64::from);
    let full = 24.0 * 9.806_65;
    assert!((force.x - full * 32767.0 / 32768.0).abs() < 1e-4 && (force.y + full).abs() < 1e-4, "{force}");
    // At rest: 1365 counts are one gravity.
    assert!((force.z - 9.806_65).abs() < 0.01, "{force}");
}

#[test]
fn mountings_are_proper_rotations_of_both_measurements() {
    for mounting in [Mounting::Aligned, Mounting::XLeft] {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| mounting.to_body(axis));
        assert_eq!(x.cross(&y), z, "{mounting:?}");
        assert_eq!((x.norm(), y.norm(), x.dot(&y)), (1.0, 1.0, 0.0), "{mounting:?}");
    }
    let mut bench = bench(Mounting::XLeft);
    bench.gyroscope.load(GYROSCOPE_DATA, &[0x00, 0x10, 0, 0, 0, 0]);
    bench.accelerometer.load(ACCELEROMETER_DATA, &[0x00, 0x10, 0, 0, 0, 0]);
    let sample = bench.sample().unwrap();
    assert_eq!(sample.angular_velocity, Vector3::new(0.0, 4096.0 * RATE_PER_COUNT, 0.0));
    assert_eq!(sample.specific_force, Vector3::new(0.0, 4096.0 * ACCELERATION_PER_COUNT, 0.0));
}

#[test]
fn another_chips_identity_is_a_fault() {
    let mut other = bench(Mounting::Aligned);
    other.accelerometer.load(CHIP_ID, &[0x1F]);
    assert_eq!(other.sample(), Err(Fault));
    let mut other = bench(Mounting::Aligned);
    other.gyroscope.load(CHIP_ID, &[0x0E]);
    assert_eq!(other.sample(), Err(Fault));
}

#[test]
fn a_bus_that_fails_at_once_leaves_time_for_other_tasks() {
    let mut other = bench(Mounting::Aligned);
    other.accelerometer.0.borrow_mut().fails = true;
    for _ in 0..100 {
        let before = other.clock.now();
        assert_eq!(other.sample(), Err(Fault));
        assert!(other.clock.now() - before >= 1_000);
    }
}

#[test]
fn a_setting_that_does_not_stick_is_a_fault() {
    let mut bench = bench(Mounting::Aligned);
    bench.gyroscope.0.borrow_mut().stuck = Some(GYROSCOPE_ID);
    assert_eq!(bench.sample(), Err(Fault));
}

#[test]
fn a_stuck_bus_in_flight_is_a_fault_and_not_a_vehicle_at_rest() {
    for level in [0x00, 0xFF] {
        for broken in [0, 1] {
            let mut bench = bench(Mounting::Aligned);
            bench.sample().unwrap();
            let device = if broken == 0 { &bench.gyroscope } else { &bench.accelerometer };
            device.0.borrow_mut().stuck = Some(level);
            assert_eq!(bench.sample(), Err(Fault), "level {level:#x}, device {broken}");
        }
    }
}

#[test]
fn without_data_ready_a_sample_ends_in_a_fault_within_2500_us() {
    let mut bench = bench(Mounting::Aligned);
    bench.sample().unwrap();
    bench.data_ready.set(false);
    let before = bench.clock.now();
    assert_eq!(bench.sample(), Err(Fault));
    assert_eq!(bench.clock.now() - before, 2_500);
}

#[test]
fn a_bus_that_hangs_ends_in_a_fault_within_500_us() {
    for broken in [0, 1] {
        let mut bench = bench(Mounting::Aligned);
        bench.sample().unwrap();
        let device = if broken == 0 { &bench.gyroscope } else { &bench.accelerometer };
        device.0.borrow_mut().hangs = true;
        let before = bench.clock.now();
        assert_eq!(bench.sample(), Err(Fault));
        assert_eq!(bench.clock.now() - before, 500);
    }
}

#[test]
fn one_fault_costs_one_sample_and_many_power_the_sensor_up_anew() {
    let mut bench = bench(Mounting::Aligned);
    bench.sample().unwrap();
    let writes_of_one_power_up = writes(&bench.gyroscope).len();
    bench.data_ready.set(false);
    bench.sample().unwrap_err();
    bench.data_ready.set(true);
    bench.sample().unwrap();
    assert_eq!(writes(&bench.gyroscope).len(), writes_of_one_power_up);
    bench.data_ready.set(false);
    for _ in 0..RESTART_AFTER {
        bench.sample().unwrap_err();
    }
    bench.data_ready.set(true);
    bench.sample().unwrap();
    assert_eq!(writes(&bench.gyroscope).len(), 2 * writes_of_one_power_up);
}
