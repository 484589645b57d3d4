//! Something to tell people: one line of text.

use core::fmt::{self, Write};

/// The greatest length of a text, bytes: that of a MAVLink STATUSTEXT.
pub const TEXT_MAX: usize = 50;

/// One line, cut to what a STATUSTEXT holds.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Text(heapless::String<TEXT_MAX>);

impl Text {
    /// `words` written out; what does not fit is cut off, and so is the rest of a character that fits in part.
    #[must_use]
    pub fn new(words: impl fmt::Display) -> Self {
        let mut text = Self::default();
        // The only error is a full line.
        let _ = write!(text, "{words}");
        text
    }

    /// The line.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Write for Text {
    fn write_str(&mut self, words: &str) -> fmt::Result {
        words.chars().try_for_each(|character| self.0.push(character).map_err(|_| fmt::Error))
    }
}

/// A number as people write it, with one decimal; at most 2e8 in size. (The formatting of floats in `core` takes 11 KB of
/// flash.)
#[derive(Debug, Clone, Copy)]
pub struct Decimal(
    /// The number.
    pub f32,
);

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let tenths = (self.0.abs() * 10.0 + 0.5) as u32;
        let sign = if self.0 < 0.0 { "-" } else { "" };
        write!(f, "{sign}{}.{}", tenths / 10, tenths % 10)
    }
}

/// How much it matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Severity {
    /// Good to know.
    Information,
    /// Something is not as it should be.
    Warning,
    /// The vehicle acts on its own.
    Critical,
}

/// Something to tell people.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Event {
    /// How much it matters.
    pub severity: Severity,
    /// What it is.
    pub text: Text,
}
