//! The mission: the items that the link has received last, all of them, for control to fly.

use crate::link::mission::{Item, MISSION_CAPACITY};
use core::cell::RefCell;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use heapless::Vec;

/// The items, in memory only: none after a restart.
pub struct Mission<M: RawMutex>(Mutex<M, RefCell<Vec<Item, MISSION_CAPACITY>>>);

impl<M: RawMutex> Mission<M> {
    /// No items.
    pub const fn new() -> Self {
        Self(Mutex::new(RefCell::new(Vec::new())))
    }

    /// How many items there are.
    pub fn count(&self) -> u16 {
        // The mutex lets one in at a time, so the list is never borrowed.
        self.0.lock(|items| items.try_borrow().map_or(0, |items| items.len() as u16))
    }

    /// The item of this number, from 0.
    pub fn item(&self, number: u16) -> Option<Item> {
        self.0.lock(|items| items.try_borrow().ok()?.get(usize::from(number)).copied())
    }

    /// Other items in place of those that there are.
    pub fn replace(&self, by: &[Item]) {
        self.0.lock(|items| {
            if let Ok(mut items) = items.try_borrow_mut() {
                items.clear();
                // There is room for as many as an upload may have.
                let _ = items.extend_from_slice(by);
            }
        });
    }
}
