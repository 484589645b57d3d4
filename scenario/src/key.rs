//! The keys of scenario files. Each is declared once, with its values, its default and its meaning: readers check what
//! they read by it ([`crate::section`]), and [`crate::schema`] prints it.

use crate::section::{FieldError, Section};
use controller_core::constants::Constant;

/// The keys of a section, or of a table in one.
#[derive(Debug)]
pub struct Layout {
    /// The section's name, or the key of the table.
    pub name: &'static str,
    /// Its meaning.
    pub about: &'static str,
    /// Every key that it may have.
    pub keys: &'static [Key],
}

/// One key.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// As in the file.
    pub name: &'static str,
    /// The values that it may have.
    pub values: Values,
    /// What a file says that leaves it out.
    pub left_out: LeftOut,
    /// Its meaning.
    pub about: &'static str,
}

/// The values of a key.
#[derive(Debug, Clone, Copy)]
pub enum Values {
    /// A number.
    Number(Bounds),
    /// A number without a fraction.
    Whole(Bounds),
    /// Three numbers.
    Vector(Bounds),
    /// A least and a greatest number.
    Range(Bounds),
    /// Any number of values.
    List(&'static Values),
    /// Values of either kind.
    Either(&'static [Values; 2]),
    /// A text.
    Text,
    /// One of these texts.
    Choice(&'static [&'static str]),
    /// A table.
    Table(&'static Layout),
    /// Any number of tables.
    Tables(&'static Layout),
    /// A table with the keys of one of these, by its `kind`.
    Kinds(&'static [&'static Layout]),
    /// A table with the constants of any of these in the section of this name.
    Constants(&'static str, &'static [&'static [Constant]]),
}

/// What a file says that leaves a key out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LeftOut {
    /// The key must be there.
    Refused,
    /// This number, or three of it.
    Default(f64),
    /// What the key's meaning says.
    Described,
}

impl Key {
    /// A key that must be there.
    #[must_use]
    pub const fn new(name: &'static str, values: Values, about: &'static str) -> Self {
        Self { name, values, left_out: LeftOut::Refused, about }
    }

    /// A number that must be there.
    #[must_use]
    pub const fn number(name: &'static str, bounds: Bounds, about: &'static str) -> Self {
        Self::new(name, Values::Number(bounds), about)
    }

    /// One of these texts, or what the key's meaning says.
    #[must_use]
    pub const fn choice(name: &'static str, texts: &'static [&'static str], about: &'static str) -> Self {
        Self::new(name, Values::Choice(texts), about).optional()
    }

    /// Three numbers that must be there.
    #[must_use]
    pub const fn vector(name: &'static str, bounds: Bounds, about: &'static str) -> Self {
        Self::new(name, Values::Vector(bounds), about)
    }

    /// A table that may be left out.
    #[must_use]
    pub const fn table(layout: &'static Layout) -> Self {
        Self::new(layout.name, Values::Table(layout), layout.about).optional()
    }

    /// The same key with a default.
    #[must_use]
    pub const fn or(self, default: f64) -> Self {
        Self { left_out: LeftOut::Default(default), ..self }
    }

    /// The number where the file leaves it out; zero without a default.
    #[must_use]
    pub const fn default(&self) -> f64 {
        match self.left_out {
            LeftOut::Default(default) => default,
            _ => 0.0,
        }
    }

    /// The same key, which may be left out, as its meaning says.
    #[must_use]
    pub const fn optional(self) -> Self {
        Self { left_out: LeftOut::Described, ..self }
    }
}

/// The bounds of a number, and its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The least.
    pub min: f64,
    /// The greatest.
    pub max: f64,
    /// Whether the number is greater than the least.
    pub above_min: bool,
    /// Empty without one.
    pub unit: &'static str,
    /// Whether [`Self::check`] does; otherwise the key's reader checks it in its own words.
    is_checked: bool,
}

impl Bounds {
    /// From `min` to `max`.
    #[must_use]
    pub const fn between(min: f64, max: f64, unit: &'static str) -> Self {
        Self { min, max, above_min: false, unit, is_checked: true }
    }

    /// From zero to one.
    pub const SHARE: Self = Self::between(0.0, 1.0, "");

    /// Every number of single precision.
    #[must_use]
    pub const fn any(unit: &'static str) -> Self {
        Self::between(f64::NEG_INFINITY, f64::INFINITY, unit)
    }

    /// Zero and above.
    #[must_use]
    pub const fn not_negative(unit: &'static str) -> Self {
        Self::between(0.0, f64::INFINITY, unit)
    }

    /// Above zero.
    #[must_use]
    pub const fn positive(unit: &'static str) -> Self {
        Self { above_min: true, ..Self::not_negative(unit) }
    }

    /// Above zero, which a constructor of the law's types checks.
    #[must_use]
    pub const fn physical(unit: &'static str) -> Self {
        Self::positive(unit).checked_later()
    }

    /// The same bounds, which the key's reader checks.
    #[must_use]
    pub const fn checked_later(self) -> Self {
        Self { is_checked: false, ..self }
    }

    /// Refuses `value`, found at the path `field`, if it is outside.
    ///
    /// # Errors
    /// Names the field, what is allowed and what was found.
    pub fn check(&self, field: impl Into<String>, value: f64) -> Result<f64, FieldError> {
        let Self { min, max, above_min, unit, is_checked } = *self;
        if !is_checked || (min..=max).contains(&value) && !(above_min && value == min) {
            return Ok(value);
        }
        let allowed = match (above_min, max.is_finite()) {
            (true, _) => "must be positive".to_owned(),
            (false, false) => "must not be negative".to_owned(),
            (false, true) if unit.is_empty() => format!("must be from {min} to {max}"),
            (false, true) => format!("must be from {min} to {max} {unit}"),
        };
        Err(FieldError::new(field, format!("{allowed}, found {value}")))
    }
}

/// Whole numbers beyond this are not exact in double precision.
const EXACT_WHOLE_MAX: f64 = 9_007_199_254_740_992.0;

/// The seed of a random generator.
pub const SEED: Key =
    Key::new("seed", Values::Whole(Bounds::between(0.0, EXACT_WHOLE_MAX, "")), "Of the random generator.").or(0.0);

/// Reads [`SEED`].
///
/// # Errors
/// If it is no whole number from 0 to 2^53.
pub fn read_seed(section: &Section) -> Result<u64, FieldError> {
    let seed = section.number(SEED.name)?;
    if seed.fract() == 0.0 && (0.0..=EXACT_WHOLE_MAX).contains(&seed) {
        return Ok(seed as u64);
    }
    let problem = format!("must be a whole number from 0 to {EXACT_WHOLE_MAX}, found {seed}");
    Err(FieldError::new(section.path_of(SEED.name), problem))
}
