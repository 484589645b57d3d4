//! Setpoints in, and whose are flown: those of the sender that requested OFFBOARD; before such a request, those of the
//! first sender.
//!
//! A sender counts while its newest setpoint that can be flown is not older than [`SETPOINT_AGE_MAX_US`]. The sender of
//! an OFFBOARD command has its own setpoints flown once control grants it. If it sends none, another component of its
//! system may send them, as the only sender; otherwise the command is denied.

use super::Receiver;
use super::senders::{Sender, counts};
use crate::link::frame::Frame;
use crate::link::setpoint::{Here, SetpointRefusal, setpoint};
use crate::radio::RADIO_TIMEOUT_US as RADIO_SILENCE;
use controller_core::governor::Setpoint;
use embassy_sync::blocking_mutex::raw::RawMutex;
use flight::{SETPOINT_AGE_MAX_US, Stamped};
use mavlink::dialects::common::SET_POSITION_TARGET_LOCAL_NED_DATA;

impl<M: RawMutex> Receiver<'_, M> {
    pub(super) fn setpoint(&mut self, frame: &Frame<'_>, message: &SET_POSITION_TARGET_LOCAL_NED_DATA) {
        if let Err(refusal) = self.take_setpoint(frame, message) {
            self.refused();
            self.setpoint_refused.warn(self.shared, frame.time, format_args!("Setpoint refused: {refusal}"));
        }
    }

    fn take_setpoint(
        &mut self,
        frame: &Frame<'_>,
        message: &SET_POSITION_TARGET_LOCAL_NED_DATA,
    ) -> Result<(), SetpointRefusal> {
        let state = self.shared.report().get().and_then(|report| report.value.state);
        let value = setpoint(message, state.as_ref().and_then(Here::at).as_ref())?;
        let (sender, time) = ((frame.header.system, frame.header.component), frame.time);
        self.setpoints.receive(sender, time);
        if self.shared.sticks().get().is_some_and(|sticks| sticks.value) {
            // The last one is kept for a client that requests to fly them once the radio is silent: a request without
            // any is refused.
            self.setpoints.kept = Some((sender, Stamped { value, time }));
            return Err(SetpointRefusal::Sticks);
        }
        let taken = Some(self.setpoints.taken).filter(|taken| counts(taken, time)).map(|taken| taken.value);
        if self.shared.setpoint_owner().get().or(taken).is_some_and(|owner| owner != sender) {
            return Err(SetpointRefusal::Others);
        }
        self.setpoints.taken = Stamped { value: sender, time };
        let time = self.setpoints.clock.stamp(message.time_boot_ms, time);
        self.shared.setpoint().put(value, time);
        Ok(())
    }

    /// A client requests to fly setpoints at `now`, us: whose they will be. Silent sticks give way, and setpoints sent
    /// meanwhile count.
    /// Errors: what comes instead, in words.
    pub(super) fn claim_setpoints(&mut self, asker: Sender, now: u64) -> Result<Sender, &'static str> {
        let sender = self.setpoint_sender(asker, now)?;
        self.setpoints.taken = Stamped { value: sender, time: now };
        let sticks = self.shared.sticks().get();
        if sticks.is_some_and(|sticks| sticks.value && sticks.age(now) > RADIO_SILENCE) {
            self.shared.sticks().put(false, now);
            let is_fresh =
                |kept: &(Sender, Stamped<Setpoint>)| kept.0 == sender && kept.1.age(now) <= SETPOINT_AGE_MAX_US;
            if let Some((_, kept)) = self.setpoints.kept.take().filter(is_fresh) {
                self.shared.setpoint().put(kept.value, kept.time);
            }
        }
        Ok(sender)
    }

    /// Whose setpoints are flown if this sender requests it; its own if it sends none yet.
    fn setpoint_sender(&self, asker: Sender, now: u64) -> Result<Sender, &'static str> {
        let mut senders = self.setpoints.senders.iter().filter(|sender| counts(sender, now)).map(|sender| sender.value);
        if senders.clone().any(|sender| sender == asker) {
            return Ok(asker);
        }
        match (senders.next(), senders.next()) {
            (None, _) => self.unflown(now).map_or(Ok(asker), Err),
            (Some(only), None) if only.0 == asker.0 => Ok(only),
            _ => Err("another sender's setpoints"),
        }
    }
}
