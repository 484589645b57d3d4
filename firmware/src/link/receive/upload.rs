//! An upload of a mission.

use super::senders::Sender;
use crate::link::mission::{Item, MISSION_CAPACITY};
use heapless::Vec;

/// An upload, and the last that was finished.
#[derive(Default)]
pub(super) struct Upload {
    /// Whose it is; none is under way without one.
    pub client: Option<Sender>,
    /// How many items there will be.
    pub count: u16,
    pub items: Vec<Item, MISSION_CAPACITY>,
    /// When the next was requested, and when the last one came, us.
    pub requested: u64,
    pub progressed: u64,
    /// Whether an item of another number has come since.
    pub is_out_of_sequence: bool,
    /// The last frame that counted, by its sequence number and checksum.
    pub last: Option<(u8, u16)>,
    /// Whose items were taken last.
    pub taken: Option<Sender>,
}
