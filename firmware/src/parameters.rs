//! Parameters: the numbers that may be set from the ground, and where they are kept.
//!
//! They change only while disarmed. What the certificate depends on is certified when it is set, and refused if that
//! fails; it counts from the next boot, which certifies it again.
//!
//! [`table`] lists them, [`storage`] keeps it over a reboot in a [`journal`]; [`calibration`], `flight` and [`tuned`]
//! are what rows mean together: the inertial sensors', those of the flight rules, and those of the configuration.

pub mod calibration;
mod flight;
pub mod journal;
pub mod storage;
pub mod table;
pub mod tuned;

use core::cell::Cell;
use core::fmt;
use core::sync::atomic::{AtomicU32, Ordering};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use table::{Name, PARAMETERS, Row};
use tuned::{Built, Unfit};

/// One value for each row of the table.
type Values = [f32; PARAMETERS.len()];

/// Words with a bit for each row that is lost, and their last bit: every value is lost, and none was set since.
const LOST_WORDS: usize = PARAMETERS.len() / WORD_BITS + 1;
const ALL_LOST: usize = LOST_WORDS * WORD_BITS - 1;
const WORD_BITS: usize = u32::BITS as usize;

const _: () = assert!(PARAMETERS.len() <= ALL_LOST);

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
    /// The numbers' bits. Each stands alone: no reader needs two that belong together.
    values: [AtomicU32; PARAMETERS.len()],
    /// A bit for each row whose stored value is lost, and [`ALL_LOST`].
    lost: [AtomicU32; LOST_WORDS],
    /// Something changed since it was last saved.
    changed: Signal<M, ()>,
    /// What the rows of the configuration change; none before boot.
    built: Mutex<M, Cell<Option<&'static Built>>>,
}

/// Why a value was refused.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ValueRefusal {
    /// The table does not allow it for this parameter.
    OutOfRange(Name),
    /// This parameter is read-only.
    ReadOnly(Name),
    /// Before boot has reported the configuration that this parameter changes.
    NothingBuilt(Name),
    /// The vehicle could not fly with it.
    Unfit(Name, Unfit),
}

impl fmt::Display for ValueRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange(Name::MotorOrder) => f.write_str("MOT_ORDER: each of the digits 1 to 4, once"),
            Self::OutOfRange(parameter) => {
                let Row { name, min, max, unit, step, .. } = parameter.row();
                if *step > 1.0 {
                    return write!(f, "{name}: allowed are {min:.0} to {max:.0} {unit} by {step:.0}");
                }
                write!(f, "{name}: allowed are {min:.2} to {max:.2} {unit}")
            }
            Self::ReadOnly(parameter) => write!(f, "{}: is read-only", parameter.row().name),
            Self::NothingBuilt(parameter) => write!(f, "{}: not yet", parameter.row().name),
            Self::Unfit(parameter, _) => write!(f, "{}: refused, cannot be flown", parameter.row().name),
        }
    }
}

impl<M: RawMutex> Parameters<M> {
    /// The defaults.
    pub const fn new() -> Self {
        let mut values = [const { AtomicU32::new(0) }; PARAMETERS.len()];
        let mut index = 0;
        while index < PARAMETERS.len() {
            values[index] = AtomicU32::new(DEFAULTS[index].to_bits());
            index += 1;
        }
        let lost = [const { AtomicU32::new(0) }; LOST_WORDS];
        Self { values, lost, changed: Signal::new(), built: Mutex::new(Cell::new(None)) }
    }

    /// Boots: the rows of the configuration change what was `built`. Values that were tuned on another one are dropped;
    /// whether there were any.
    pub fn boot(&self, built: &'static Built) -> bool {
        self.built.lock(|cell| cell.set(Some(built)));
        let dropped = self.raw(Name::TunedOn) != built.identity as f32 && self.set_by_hand().next().is_some();
        if dropped {
            Name::tuned().for_each(|name| self.put(name, f32::NAN));
            self.changed.signal(());
        }
        dropped
    }

    /// What was built, once it is known.
    fn built(&self) -> Option<&'static Built> {
        self.built.lock(Cell::get)
    }

    /// The rows of the configuration that are not as built.
    pub fn set_by_hand(&self) -> impl Iterator<Item = Name> {
        Name::tuned().filter(|name| !self.raw(*name).is_nan())
    }

    /// The present values, in the table's order.
    fn all(&self) -> Values {
        self.values.each_ref().map(|value| f32::from_bits(value.load(Ordering::Relaxed)))
    }

    /// The present value; what was built, where that is a row of the configuration that was not set.
    pub fn get(&self, name: Name) -> f32 {
        let value = self.raw(name);
        if value.is_nan() { self.built().and_then(|built| built.value(name)).unwrap_or(value) } else { value }
    }

    /// The present value as it is kept: no number for one that is as built.
    pub fn raw(&self, name: Name) -> f32 {
        f32::from_bits(self.values[name as usize].load(Ordering::Relaxed))
    }

    /// Changes a value, to be saved when that is possible. One of the configuration is certified first, which takes
    /// long, with all others as they are; it counts from the next boot.
    /// Errors: [`ValueRefusal`] for a value outside the table's range, not finite, between its steps, or with which the
    /// vehicle could not fly.
    pub fn set(&self, name: Name, value: f32) -> Result<(), ValueRefusal> {
        if name == Name::TunedOn {
            return Err(ValueRefusal::ReadOnly(name));
        }
        if !name.row().allows(value) {
            return Err(ValueRefusal::OutOfRange(name));
        }
        let value = if name.is_tuned() { self.judged(name, value)? } else { value };
        self.put(name, value);
        self.note(name as usize, false);
        self.changed.signal(());
        Ok(())
    }

    /// What is kept for a value of the configuration, if the vehicle could fly with it.
    fn judged(&self, name: Name, value: f32) -> Result<f32, ValueRefusal> {
        let built = self.built().ok_or(ValueRefusal::NothingBuilt(name))?;
        let value = if built.value(name) == Some(value) { f32::NAN } else { value };
        built
            .judge(|other| if other == name { value } else { self.raw(other) })
            .map_err(|unfit| ValueRefusal::Unfit(name, unfit))?;
        self.put(Name::TunedOn, built.identity as f32);
        Ok(value)
    }

    /// As [`Self::set`], for a value that comes from storage and needs no saving. Boot judges it.
    fn restore(&self, name: Name, value: f32) -> Result<(), ValueRefusal> {
        let is_as_built = name.is_tuned() && value.is_nan();
        if !is_as_built && !name.row().allows(value) {
            // Nobody can set that one; without it the rows of the configuration are as built, and boot says so.
            self.note(name as usize, name != Name::TunedOn);
            return Err(ValueRefusal::OutOfRange(name));
        }
        self.put(name, value);
        Ok(())
    }

    /// Every stored value is lost.
    fn lose_all(&self) {
        self.note(ALL_LOST, true);
    }

    /// An operator sets values again, after all of them were lost.
    pub fn set_again(&self) {
        self.note(ALL_LOST, false);
    }

    /// What was stored, cannot be read, and was not set since: the first such row, or all of them.
    pub fn lost(&self) -> Option<&'static str> {
        // Control asks in every tick.
        if self.lost.iter().all(|word| word.load(Ordering::Relaxed) == 0) {
            return None;
        }
        let is_lost = |bit: usize| self.lost[bit / WORD_BITS].load(Ordering::Relaxed) >> (bit % WORD_BITS) & 1 == 1;
        let row = PARAMETERS.iter().find(|row| is_lost(row.parameter as usize));
        if is_lost(ALL_LOST) { Some("parameters") } else { row.map(|row| row.name) }
    }

    /// Takes note of what is lost, or not any more.
    fn note(&self, bit: usize, is_lost: bool) {
        let (word, mask) = (&self.lost[bit / WORD_BITS], 1 << (bit % WORD_BITS));
        if is_lost {
            word.fetch_or(mask, Ordering::Relaxed);
        } else {
            word.fetch_and(!mask, Ordering::Relaxed);
        }
    }

    /// Has storage look for something to save.
    pub(crate) fn save_soon(&self) {
        self.changed.signal(());
    }

    fn put(&self, name: Name, value: f32) {
        self.values[name as usize].store(value.to_bits(), Ordering::Relaxed);
    }
}
