//! An upload of a mission.

use super::senders::Sender;
use crate::link::mission::{ITEMS, Item};
use heapless::Vec;

/// An upload, and the last that was finished.
#[derive(Default)]
pub(super) struct Upload {
    /// Whose it is; none is under way without one.
    pub client: Option<Sender>,
    /// How many items there will be.
    pub count: u16,
    pub items: Vec<Item, ITEMS>,
    /// When the next was requested, us, and how often.
    pub requested: u64,
    pub tries: u8,
    /// The last frame that counted, by its sequence number and checksum.
    pub last: Option<(u8, u16)>,
    /// Whose items were taken last.
    pub taken: Option<Sender>,
}
