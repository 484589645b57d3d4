//! Something to tell people: one line of text.
//!
//! Lines are put together from pieces here, not by the formatting of `core`, which would take 5 KB of flash.

/// The greatest length of a text, bytes: that of a MAVLink STATUSTEXT.
pub const TEXT_MAX: usize = 50;

/// One line, cut to what a STATUSTEXT holds.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Text(heapless::String<TEXT_MAX>);

impl Text {
    /// The pieces one after the other; what does not fit is cut off, and so is the rest of a character that fits in part.
    #[must_use]
    pub fn new(pieces: &[&str]) -> Self {
        let mut text = Self::default();
        for piece in pieces {
            let part = piece.get(..piece.floor_char_boundary(TEXT_MAX - text.0.len())).unwrap_or("");
            // It has room for as much.
            let _ = text.0.push_str(part);
            if part.len() < piece.len() {
                break;
            }
        }
        text
    }

    /// A count as people write it.
    #[must_use]
    pub fn count(number: u32) -> Self {
        // At most ten digits, found from the last one on.
        let (mut digits, mut rest) = ([""; 10], number);
        for place in digits.iter_mut().rev() {
            let digit = (rest % 10) as usize;
            *place = "0123456789".get(digit..=digit).unwrap_or("");
            rest /= 10;
            if rest == 0 {
                break;
            }
        }
        Self::new(&digits)
    }

    /// A number as people write it, with one decimal; at most 2e8 in size.
    #[must_use]
    pub fn decimal(number: f32) -> Self {
        let tenths = (number.abs() * 10.0 + 0.5) as u32;
        let sign = if number < 0.0 { "-" } else { "" };
        Self::new(&[sign, Self::count(tenths / 10).as_str(), ".", Self::count(tenths % 10).as_str()])
    }

    /// The line.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
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
