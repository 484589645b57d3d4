//! What the drivers' tests share: a clock that jumps, a data-ready pin, devices on a bus, and a mounting.

use crate::hardware::{Clock, DataReady, Fault};
use crate::mounting::Mounting;
use crate::spi::Selected;
use core::cell::{Cell, RefCell};
use core::convert::Infallible;
use core::future::pending;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::mutex::Mutex;
use embedded_hal::digital::{self, OutputPin};
use embedded_hal_async::spi::{ErrorKind, ErrorType, SpiBus};
use std::rc::Rc;

/// The sensor's x points left, its y back, its z up.
pub const X_LEFT: Mounting = Mounting::new([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]).unwrap();

/// A clock on which waiting costs nothing and moves time.
#[derive(Clone, Default)]
pub struct Jumping(Rc<Cell<u64>>);

impl Jumping {
    /// Lets time pass up to `time`.
    pub fn jump(&self, time: u64) {
        self.0.set(self.0.get().max(time));
    }
}

impl Clock for Jumping {
    fn now(&self) -> u64 {
        self.0.get()
    }

    async fn until(&self, time: u64) {
        self.jump(time);
    }
}

/// A data-ready pin that rises when waited for, a little before the waiting task wakes up, or never.
pub struct Pin {
    /// Whether it rises.
    pub rises: Rc<Cell<bool>>,
    /// How much later the waiting task wakes up, us.
    pub late: u64,
    /// The time.
    pub clock: Jumping,
}

impl DataReady for Pin {
    async fn rise(&mut self) -> Result<u64, Fault> {
        if !self.rises.get() {
            return pending().await;
        }
        let time = self.clock.now();
        self.clock.jump(time + self.late);
        Ok(time)
    }
}

/// How a device's line is.
#[derive(Default)]
pub struct Line {
    /// Its chip select is low.
    pub selected: bool,
    /// How often it has fallen.
    pub falls: usize,
    /// Its exchanges fail.
    pub fails: bool,
    /// Its exchanges never end.
    pub hangs: bool,
}

/// Registers behind SPI that follow a data sheet.
pub trait Device {
    /// Its line.
    fn line(&mut self) -> &mut Line;

    /// Takes bytes and puts its answer in their places.
    fn exchange(&mut self, bytes: &mut [u8]);
}

type Shared = Rc<RefCell<dyn Device>>;

/// The bus of several devices.
pub struct Bus(Vec<Shared>);

/// A device's chip select.
pub struct Select(Shared);

/// A device as drivers have it.
pub type Spi = Selected<'static, NoopRawMutex, Bus, Select>;

/// These devices on one bus.
pub fn on_one_bus<const N: usize>(devices: [Shared; N]) -> [Spi; N] {
    let bus = Box::leak(Box::new(Mutex::new(Bus(devices.to_vec()))));
    devices.map(|device| Selected::new(bus, Select(device)))
}

impl ErrorType for Bus {
    type Error = ErrorKind;
}

impl SpiBus for Bus {
    async fn transfer_in_place(&mut self, bytes: &mut [u8]) -> Result<(), ErrorKind> {
        let mut selected = self.0.iter().filter(|device| device.borrow_mut().line().selected);
        let (Some(device), None) = (selected.next(), selected.next()) else { panic!("one device at a time") };
        if device.borrow_mut().line().fails {
            return Err(ErrorKind::Other);
        }
        if device.borrow_mut().line().hangs {
            pending::<()>().await;
        }
        device.borrow_mut().exchange(bytes);
        Ok(())
    }

    async fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }

    async fn read(&mut self, _: &mut [u8]) -> Result<(), ErrorKind> {
        unreachable!("the drivers exchange in place")
    }

    async fn write(&mut self, _: &[u8]) -> Result<(), ErrorKind> {
        unreachable!("the drivers exchange in place")
    }

    async fn transfer(&mut self, _: &mut [u8], _: &[u8]) -> Result<(), ErrorKind> {
        unreachable!("the drivers exchange in place")
    }
}

impl digital::ErrorType for Select {
    type Error = Infallible;
}

impl OutputPin for Select {
    fn set_low(&mut self) -> Result<(), Infallible> {
        let mut device = self.0.borrow_mut();
        let line = device.line();
        (line.selected, line.falls) = (true, line.falls + 1);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().line().selected = false;
        Ok(())
    }
}
