//! The beginning of a flight's file: what the recorder's file has, and the parameters and constants that are flown.
//!
//! ```text
//! 2 sectors of information and format | 9 of parameters (kind P) | 1 of the gyro's format, and the subscriptions
//! ```
//!
//! The law's constants are those that were built; the parameters `GAIN_...` beside them are percent of them. All
//! messages keep their places and lengths, so what a cut leaves of an older beginning under a newer one is still a
//! beginning.

use super::sector::{FILLER_KIND, MESSAGE_HEAD_BYTES, SECTOR_CAPACITY_BYTES, Sector};
use crate::configuration::CONSTANTS;
use crate::hardware::SECTOR_BYTES;
use crate::parameters::Parameters;
use crate::parameters::table::PARAMETERS;
use crate::recorder::{gyro, ulog};
use crate::shared::Read;
use embassy_sync::blocking_mutex::raw::RawMutex;

/// Sectors that a file begins with.
pub const HEAD_SECTORS: usize = 12;

/// Those of information and format.
const DEFINITION_SECTORS: usize = 2;

/// Those of parameters and constants; one is behind them.
const CONSTANT_SECTORS: usize = HEAD_SECTORS - DEFINITION_SECTORS - 1;

/// Parameters and constants in each of these.
const CONSTANTS_PER_SECTOR: usize = 13;

/// The longest of their names, bytes.
const NAME_MAX: usize = 24;

/// What their keys begin with, all of them numbers of single precision.
const KIND: &str = "float ";

const _: () = {
    assert!(PARAMETERS.len() + CONSTANTS.len() <= CONSTANT_SECTORS * CONSTANTS_PER_SECTOR);
    let message = MESSAGE_HEAD_BYTES + 1 + KIND.len() + NAME_MAX + size_of::<f32>();
    assert!(CONSTANTS_PER_SECTOR * message <= SECTOR_CAPACITY_BYTES);
};

/// What a file says of the vehicle.
pub struct FileHeader<'a, M: RawMutex> {
    /// What it is called.
    pub vehicle: &'static str,
    /// Their present values.
    pub parameters: Read<'a, Parameters<M>>,
}

impl<M: RawMutex> FileHeader<'_, M> {
    /// One of its sectors, of a file whose first record is of `time`.
    pub fn sector(&self, place: usize, time: u64) -> [u8; SECTOR_BYTES] {
        match place.checked_sub(DEFINITION_SECTORS) {
            None => self.defined(place, time),
            Some(CONSTANT_SECTORS) => subscribed(),
            Some(place) => self.numbers(place),
        }
    }

    fn defined(&self, place: usize, time: u64) -> [u8; SECTOR_BYTES] {
        let mut sector = [0xFF; SECTOR_BYTES];
        let (time, left) = (
            time.to_le_bytes(),
            (DEFINITION_SECTORS * SECTOR_BYTES).saturating_sub(ulog::definitions_size() + MESSAGE_HEAD_BYTES),
        );
        let filler = ulog::head(FILLER_KIND, left);
        let parts = ulog::definitions(&time, self.vehicle).chain([&filler[..]]);
        let _ = ulog::copy(parts, place * SECTOR_BYTES, &mut sector);
        sector
    }

    fn numbers(&self, place: usize) -> [u8; SECTOR_BYTES] {
        let parameters = PARAMETERS.iter().map(|row| (row.name, self.parameters.get(row.parameter)));
        let numbers = parameters.chain(CONSTANTS);
        let mut sector = Sector::new();
        for (name, value) in numbers.skip(place * CONSTANTS_PER_SECTOR).take(CONSTANTS_PER_SECTOR) {
            let length = KIND.len() + name.len();
            let head = ulog::head(b'P', 1 + length + size_of_val(&value));
            let _ = sector.put(&[&head, &[length as u8], KIND.as_bytes(), name.as_bytes(), &value.to_le_bytes()]);
        }
        sector.finish()
    }
}

/// The last.
fn subscribed() -> [u8; SECTOR_BYTES] {
    let mut sector = Sector::new();
    for parts in [gyro::FORMAT_PARTS, ulog::SUBSCRIPTION_PARTS, gyro::SUBSCRIPTION_PARTS] {
        let _ = sector.put(&parts);
    }
    sector.finish()
}

#[cfg(test)]
mod tests;
