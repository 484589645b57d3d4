//! What came that is not used.

use flight::Stamped;

/// What was explained of it.
#[derive(Debug, Default)]
pub(super) struct Explained {
    /// What was explained, bit by bit, in the order of the list of such messages.
    pub explained: u16,
    /// The last setpoint's name.
    pub setpoint: Option<Stamped<&'static str>>,
}
