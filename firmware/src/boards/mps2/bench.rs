//! What a board on a bench has of a vehicle: a light.

use crate::hardware::{Battery, Fault, Light, MotorCommand, Motors};

/// The LEDs of the FPGA's input and output block.
const LEDS: *mut u32 = 0x4002_8000 as *mut u32;

/// The first LED.
pub struct Lamp;

impl Light for Lamp {
    fn set(&mut self, on: bool) {
        // SAFETY: this is the LEDs' register, and only this function touches it.
        unsafe { LEDS.write_volatile(u32::from(on)) };
    }
}

/// There is nothing to measure.
pub struct NoBattery;

impl Battery for NoBattery {
    async fn voltage(&mut self) -> Option<f32> {
        None
    }
}

/// There is nothing to turn.
pub struct NoMotors;

impl Motors for NoMotors {
    async fn write(&mut self, _command: MotorCommand) -> Result<(), Fault> {
        Ok(())
    }
}
