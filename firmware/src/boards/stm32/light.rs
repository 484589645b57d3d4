//! A light-emitting diode on a pin.

use crate::hardware::Light;
use embassy_stm32::gpio::{Level, Output};

/// The pin, and the level at which the diode is lit.
pub struct Lamp {
    pin: Output<'static>,
    lit: Level,
}

impl Lamp {
    /// A diode that is lit while `pin` is at `lit`.
    pub fn new(pin: Output<'static>, lit: Level) -> Self {
        Self { pin, lit }
    }
}

impl Light for Lamp {
    fn set(&mut self, on: bool) {
        let lit = bool::from(self.lit);
        self.pin.set_level(Level::from(lit == on));
    }
}
