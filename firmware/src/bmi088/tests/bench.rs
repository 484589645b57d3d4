//! A register file that follows the data sheet, a bus and pins around it, and a clock that jumps.

use super::super::*;
pub use crate::bench::{Jumping, Pin};
use core::cell::{Cell, RefCell};
use core::convert::Infallible;
use core::future::pending;
use embassy_futures::block_on;
use embedded_hal_async::spi::{ErrorKind, ErrorType};
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
    /// Its chip select is low.
    pub selected: bool,
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
    pub hangs: bool,
    pub fails: bool,
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
            selected: false,
            clock,
            written: Vec::new(),
            dummy,
            reset,
            asleep,
            stuck: None,
            deaf_per_setting: 0,
            lost: [0; 128],
            hangs: false,
            fails: false,
        };
        Self(Rc::new(RefCell::new(registers)))
    }

    pub fn load(&self, register: u8, bytes: &[u8]) {
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

/// The bus that both share.
pub struct Bus(pub [Part; 2]);

impl ErrorType for Bus {
    type Error = ErrorKind;
}

impl SpiBus for Bus {
    async fn transfer_in_place(&mut self, bytes: &mut [u8]) -> Result<(), ErrorKind> {
        let mut selected = self.0.iter().filter(|part| part.0.borrow().selected);
        let (Some(Part(part)), None) = (selected.next(), selected.next()) else { panic!("one device at a time") };
        if part.borrow().fails {
            return Err(ErrorKind::Other);
        }
        if part.borrow().hangs {
            pending::<()>().await;
        }
        part.borrow_mut().transfer(bytes);
        Ok(())
    }

    async fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }

    async fn read(&mut self, _: &mut [u8]) -> Result<(), ErrorKind> {
        unreachable!("the driver exchanges in place")
    }

    async fn write(&mut self, _: &[u8]) -> Result<(), ErrorKind> {
        unreachable!("the driver exchanges in place")
    }

    async fn transfer(&mut self, _: &mut [u8], _: &[u8]) -> Result<(), ErrorKind> {
        unreachable!("the driver exchanges in place")
    }
}

/// A device's chip select.
pub struct Select(pub Part);

impl embedded_hal::digital::ErrorType for Select {
    type Error = Infallible;
}

impl OutputPin for Select {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.0.borrow_mut().selected = true;
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.0.borrow_mut().selected = false;
        Ok(())
    }
}

/// The driver and handles on everything it talks to.
pub struct Bench {
    pub clock: Jumping,
    pub accelerometer: Part,
    pub gyroscope: Part,
    pub data_ready: Rc<Cell<bool>>,
    pub imu: Bmi088<Bus, Select, Pin, Jumping>,
}

pub fn bench(mounting: Mounting) -> Bench {
    let clock = Jumping::default();
    let accelerometer = Part::new(&clock, 1, ACCELEROMETER_RESET, 0x1E);
    let gyroscope = Part::new(&clock, 0, GYROSCOPE_RESET, 0x0F);
    let data_ready = Rc::new(Cell::new(true));
    let pin = Pin { rises: data_ready.clone(), late: 0, clock: clock.clone() };
    let parts = [accelerometer.clone(), gyroscope.clone()];
    let imu = Bmi088::new(Bus(parts.clone()), parts.map(Select), pin, clock.clone(), mounting);
    Bench { clock, accelerometer, gyroscope, data_ready, imu }
}

impl Bench {
    pub fn sample(&mut self) -> Result<RawImu, Fault> {
        block_on(self.imu.sample())
    }
}
