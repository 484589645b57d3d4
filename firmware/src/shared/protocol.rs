//! What a client speaks.

/// A protocol of the link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Protocol {
    /// [MAVLink](crate::link).
    Mavlink,
    /// [CRTP](crate::crtp).
    Crtp,
}
