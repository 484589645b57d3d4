//! Parameters: the few numbers that may be set from the ground, and where they are kept.
//!
//! Nothing the certificate depends on is here: vehicle, gains, rotors and reference bounds are built in and certified at
//! boot. A parameter can make the vehicle slower or quieter, never less safe, and changes only while disarmed.
//!
//! [`table`] says what there is, [`storage`] keeps it over a reboot in a [`journal`].

pub mod journal;
pub mod storage;
pub mod table;

use crate::shared::Decimal;
use core::cell::Cell;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use table::{Name, PARAMETERS};

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
    values: Mutex<M, Cell<Values>>,
    /// Something changed since it was last saved.
    changed: Signal<M, ()>,
}

/// Why a value was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OutOfRange(
    /// Which parameter.
    pub Name,
);

impl core::fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let row = self.0.row();
        let (least, most) = (Decimal(row.least), Decimal(row.most));
        write!(f, "{}: allowed are {least} to {most} {}", row.name, row.unit)
    }
}

impl<M: RawMutex> Parameters<M> {
    /// The defaults.
    #[must_use]
    pub const fn new() -> Self {
        Self { values: Mutex::new(Cell::new(DEFAULTS)), changed: Signal::new() }
    }

    /// The present values, in the table's order.
    fn all(&self) -> Values {
        self.values.lock(Cell::get)
    }

    /// The present value.
    #[must_use]
    pub fn get(&self, name: Name) -> f32 {
        self.all()[name as usize]
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
        self.values.lock(|cell| {
            let mut values = cell.get();
            values[name as usize] = value;
            cell.set(values);
        });
        Ok(())
    }
}

impl<M: RawMutex> Default for Parameters<M> {
    fn default() -> Self {
        Self::new()
    }
}
