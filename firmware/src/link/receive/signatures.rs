//! Whose frames count, and the key that says so.
//!
//! The port is trusted: who has the cable may set another key, and need not sign, or with another key. Nobody else may set one: a key that
//! goes over a radio is everybody's.

use super::Receiver;
use crate::link::frame::Frame;
use crate::link::signing::{KEY, Key, Stamp};
use crate::parameters::table::Name;
use crate::shared::{Event, Severity};
use embassy_sync::blocking_mutex::raw::RawMutex;
use mavlink::MessageData;
use mavlink::dialects::common::{HEARTBEAT_DATA, RADIO_STATUS_DATA};

/// SETUP_SIGNING. The crate's type would take half a kilobyte more.
pub(super) struct SetupSigning {
    stamp: Stamp,
    /// System and component.
    target: [u8; 2],
    key: [u8; KEY],
}

impl SetupSigning {
    /// The message's number.
    pub(super) const ID: u32 = 256;

    /// What a message of that number says.
    fn of(frame: &Frame<'_>) -> Self {
        // Zeros at the end are cut off.
        let byte = |place: usize| frame.payload.get(place).copied().unwrap_or(0);
        Self {
            stamp: Stamp::from_le_bytes(core::array::from_fn(byte)),
            target: [byte(8), byte(9)],
            key: core::array::from_fn(|place| byte(10 + place)),
        }
    }
}

impl<M: RawMutex> Receiver<'_, M> {
    /// Whether a frame counts. One that does not is counted as refused, and told; but not radios' own words and
    /// heartbeats, which go on whatever anybody says.
    #[inline(never)]
    pub(super) fn is_genuine(&mut self, frame: &Frame<'_>) -> bool {
        let shared = self.shared;
        let must_be_signed = shared.parameters.get(Name::SignedOnly) > 0.0;
        let Err(refusal) = shared.signing.judge(frame, must_be_signed) else { return true };
        if shared.on_port.is_raised() {
            return true;
        }
        if !matches!(frame.message, HEARTBEAT_DATA::ID | RADIO_STATUS_DATA::ID) {
            self.refused();
            self.signature_refused.warn(shared, frame.time, refusal);
        }
        false
    }

    /// A key of zeros ends signing.
    pub(super) fn set_up_signing(&mut self, frame: &Frame<'_>) {
        let SetupSigning { stamp, target: [system, component], key } = SetupSigning::of(frame);
        if !self.is_addressed(system, component) {
            return;
        }
        let shared = self.shared;
        let key = Key::new(key);
        let (severity, words) = if !shared.on_port.is_raised() {
            (Severity::Warning, "Signing: a key is taken over USB only")
        } else if shared.is_turning() {
            (Severity::Warning, "Signing: only disarmed, and no motor turning")
        } else {
            shared.set_signing(key, stamp, frame.time);
            (Severity::Information, if key.is_some() { "Signing: on, with a new key" } else { "Signing: off" })
        };
        shared.announce(Event::new(severity, words));
    }
}
