//! Which frames count, by the key.
//!
//! The port is trusted: the cable's owner may set another key, and need not sign. No other line may set one: a key that
//! goes over a radio is public.

use super::Receiver;
use crate::link::frame::Frame;
use crate::link::signing::Key;
use crate::parameters::table::Name;
use crate::shared::{Event, Severity};
use embassy_sync::blocking_mutex::raw::RawMutex;
use mavlink::MessageData;
use mavlink::dialects::common::{HEARTBEAT_DATA, RADIO_STATUS_DATA, SETUP_SIGNING_DATA};

impl<M: RawMutex> Receiver<'_, M> {
    /// Whether a frame counts. One that does not is counted as refused, and reported; but not radios' own words and
    /// heartbeats, which go on regardless.
    #[inline(never)]
    pub(super) fn is_genuine(&mut self, frame: &Frame<'_>) -> bool {
        let shared = self.shared;
        let must_be_signed = shared.parameters().get(Name::SignedOnly) > 0.0;
        let Err(refusal) = shared.signing().judge(frame, must_be_signed) else { return true };
        if shared.on_port().is_raised() {
            return true;
        }
        if !matches!(frame.message, HEARTBEAT_DATA::ID | RADIO_STATUS_DATA::ID) {
            self.refused();
            self.signature_refused.warn(shared, frame.time, format_args!("{refusal}"));
        }
        false
    }

    /// A key of zeros ends signing.
    pub(super) fn set_up_signing(&mut self, frame: &Frame<'_>, message: &SETUP_SIGNING_DATA) {
        let shared = self.shared;
        let key = Key::new(message.secret_key);
        let (severity, words) = if !shared.on_port().is_raised() {
            (Severity::Warning, "Signing: a key is taken over USB only")
        } else if shared.is_turning() {
            (Severity::Warning, "Signing: only disarmed, and no motor turning")
        } else {
            shared.set_signing(key, message.initial_timestamp, frame.time);
            (Severity::Information, if key.is_some() { "Signing: on, with a new key" } else { "Signing: off" })
        };
        shared.announce(Event::new(severity, words));
    }
}
