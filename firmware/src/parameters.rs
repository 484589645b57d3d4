//! Parameters: the few numbers that may be set from the ground, and where they are kept.
//!
//! Nothing the certificate depends on is here: vehicle, gains, rotors and reference bounds are built in and certified at
//! boot. A parameter can make the vehicle slower or quieter, never less safe, and changes only while disarmed.
//!
//! [`table`] says what there is, [`storage`] keeps it over a reboot in a [`journal`]; [`calibration`] is what the rows of the
//! inertial sensors mean together.

pub mod calibration;
pub mod journal;
pub mod storage;
pub mod table;

use core::fmt;
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use table::{Name, PARAMETERS, Row};

/// One value for each row of the table.
type Values = [f32; PARAMETERS.len()];

/// The table's defaults.
const DEFAULTS: Values = {
    let mut values = [0.0; PARAMETERS.len()];
    let mut index = 0;
    while index < PARAMETERS.len() {
        values[index] = PARAMETERS[index].default;
        index += 1;
    }
    values
};

/// The present values.
pub struct Parameters<M: RawMutex> {
    /// The numbers' bits. Each stands alone: nobody needs two that belong together.
    values: [AtomicU32; PARAMETERS.len()],
    /// Something changed since it was last saved.
    changed: Signal<M, ()>,
}

/// Why a value was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OutOfRange(
    /// Which parameter.
    pub Name,
);

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Row { name, least, most, unit, .. } = self.0.row();
        write!(f, "{name}: allowed are {least:?} to {most:?} {unit}")
    }
}

impl<M: RawMutex> Parameters<M> {
    /// The defaults.
    #[must_use]
    pub const fn new() -> Self {
        let mut values = [const { AtomicU32::new(0) }; PARAMETERS.len()];
        let mut index = 0;
        while index < PARAMETERS.len() {
            values[index] = AtomicU32::new(DEFAULTS[index].to_bits());
            index += 1;
        }
        Self { values, changed: Signal::new() }
    }

    /// The present values, in the table's order.
    fn all(&self) -> Values {
        self.values.each_ref().map(|value| f32::from_bits(value.load(Ordering::Relaxed)))
    }

    /// The present value.
    #[must_use]
    pub fn get(&self, name: Name) -> f32 {
        f32::from_bits(self.values[name as usize].load(Ordering::Relaxed))
    }

    /// Changes a value, to be saved when that is possible.
    ///
    /// # Errors
    /// [`OutOfRange`] for a value outside the table's range, not finite, or not whole where it has to be.
    pub fn set(&self, name: Name, value: f32) -> Result<(), OutOfRange> {
        self.restore(name, value)?;
        self.changed.signal(());
        Ok(())
    }

    /// As [`Self::set`], for a value that comes from storage and needs no saving.
    fn restore(&self, name: Name, value: f32) -> Result<(), OutOfRange> {
        if !name.row().allows(value) {
            return Err(OutOfRange(name));
        }
        self.values[name as usize].store(value.to_bits(), Ordering::Relaxed);
        Ok(())
    }
}

impl<M: RawMutex> Default for Parameters<M> {
    fn default() -> Self {
        Self::new()
    }
}
