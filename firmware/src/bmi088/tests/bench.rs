//! A register file that follows the data sheet.

use super::super::*;
use crate::tests::bench::{self, Jumping, Line, Pin, Spi, on_one_bus};
use core::cell::{Cell, RefCell};
use embassy_futures::block_on;
use std::rc::Rc;

/// One write that a device received.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Written {
    pub time: u64,
    pub register: u8,
    pub value: u8,
}

/// One of the two devices.
#[derive(Clone)]
pub struct Part(pub Rc<RefCell<Registers>>);

pub struct Registers {
    pub values: [u8; 128],
    pub line: Line,
    clock: Jumping,
    pub written: Vec<Written>,
    /// Reads answer after the address, or after one more byte.
    dummy: usize,
    pub reset: u8,
    /// The accelerometer ignores the bus until its chip select has risen once.
    asleep: bool,
    pub stuck: Option<u8>,
    /// How often the first writes of each setting are lost.
    pub deaf_per_setting: usize,
    /// How often the writes of a register were lost so far.
    lost: [usize; 128],
}

impl Part {
    pub fn new(clock: &Jumping, dummy: usize, reset: u8, id: u8) -> Self {
        let mut values = [0; 128];
        values[usize::from(CHIP_ID)] = id;
        // The accelerometer is suspended until it is set otherwise.
        values[0x7C] = 0x03;
        let clock = clock.clone();
        let asleep = dummy > 0;
        let registers = Registers {
            values,
            line: Line::default(),
            clock,
            written: Vec::new(),
            dummy,
            reset,
            asleep,
            stuck: None,
            deaf_per_setting: 0,
            lost: [0; 128],
        };
        Self(Rc::new(RefCell::new(registers)))
    }

    pub fn load(&self, register: u8, bytes: &[u8]) {
        let start = usize::from(register);
        self.0.borrow_mut().values[start..start + bytes.len()].copy_from_slice(bytes);
    }
}

impl bench::Device for Registers {
    fn line(&mut self) -> &mut Line {
        &mut self.line
    }

    fn exchange(&mut self, bytes: &mut [u8]) {
        let asleep = std::mem::take(&mut self.asleep);
        let [address, data @ ..] = bytes else { return };
        let register = *address & !READ_BIT;
        if *address & READ_BIT == 0 {
            if asleep {
                return;
            }
            let (value, lost) = (data[0], &mut self.lost[usize::from(register)]);
            if register != self.reset && *lost < self.deaf_per_setting {
                *lost += 1;
                return;
            }
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

/// The driver and handles on everything it talks to.
pub struct Bench {
    pub clock: Jumping,
    pub accelerometer: Part,
    pub gyroscope: Part,
    pub data_ready: Rc<Cell<bool>>,
    pub imu: Bmi088<Spi, Pin, Jumping>,
}

pub fn bench(mounting: &'static Mounting) -> Bench {
    let clock = Jumping::default();
    let accelerometer = Part::new(&clock, 1, ACCELEROMETER_RESET, 0x1E);
    let gyroscope = Part::new(&clock, 0, GYROSCOPE_RESET, 0x0F);
    let data_ready = Rc::new(Cell::new(true));
    let pin = Pin { rises: data_ready.clone(), late: 0, clock: clock.clone() };
    let devices = on_one_bus([accelerometer.0.clone(), gyroscope.0.clone()]);
    let imu = Bmi088::new(devices, pin, clock.clone(), mounting);
    Bench { clock, accelerometer, gyroscope, data_ready, imu }
}

impl Bench {
    pub fn sample(&mut self) -> Result<RawImu, Fault> {
        block_on(self.imu.sample())
    }
}
