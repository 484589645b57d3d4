//! The senders of setpoints.

use super::setpoint_clock::SetpointClock;
use controller_core::governor::Setpoint;
use flight::{SETPOINT_AGE_MAX_US, Stamped};

/// Senders that are known at a time.
const SENDERS_KNOWN: usize = 4;

/// A sender: system and component.
pub(super) type Sender = (u8, u8);

/// A place for a sender. No system has this number.
const NO_SENDER: Stamped<Sender> = Stamped { value: (0, 0), time: 0 };

/// The senders of setpoints that can be flown.
#[derive(Debug)]
pub(super) struct Senders {
    /// Each sender, and when its last came, us.
    pub senders: [Stamped<Sender>; SENDERS_KNOWN],
    /// Whose are taken before a request on the link, and when the last came, us.
    pub taken: Stamped<Sender>,
    /// The last that was refused because the sticks fly, and whose it was.
    pub kept: Option<(Sender, Stamped<Setpoint>)>,
    /// The clock of whose are taken.
    pub clock: SetpointClock,
}

impl Default for Senders {
    fn default() -> Self {
        Self { senders: [NO_SENDER; SENDERS_KNOWN], taken: NO_SENDER, kept: None, clock: SetpointClock::default() }
    }
}

impl Senders {
    /// Notes a sender, in place of the one that has been silent for longest.
    pub fn receive(&mut self, sender: Sender, now: u64) {
        if let Some(place) =
            self.senders.iter_mut().min_by_key(|known| if known.value == sender { 0 } else { known.time })
        {
            *place = Stamped { value: sender, time: now };
        }
    }
}

/// Whether a sender's setpoints count at `now`, us.
pub(super) fn counts(sender: &Stamped<Sender>, now: u64) -> bool {
    sender.value != NO_SENDER.value && sender.age(now) <= SETPOINT_AGE_MAX_US
}
