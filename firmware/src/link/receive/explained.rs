//! Messages that are not used.

use flight::Stamped;

/// Which of them were explained.
#[derive(Debug, Default)]
pub(super) struct Explained {
    /// A bit for each that was explained, in the order of the list of such messages.
    pub explained: u16,
    /// The last setpoint's name.
    pub setpoint: Option<Stamped<&'static str>>,
}
