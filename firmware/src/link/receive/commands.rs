//! Commands in: their target, their sender's permission, and their answer.

use super::Receiver;
use super::addressed::Addressed;
use crate::frames;
use crate::link::acknowledgement::{Order, command_of};
use crate::link::command::{Action, Call, action};
use crate::link::frame::Frame;
use crate::link::origin::Origin;
use crate::link::repetitions::Delivery;
use crate::link::telemetry::vehicle;
use crate::shared::{Calibration, Event, QueuedRequest, Reply, Severity};
use embassy_sync::blocking_mutex::raw::RawMutex;
use flight::Request;
use mavlink::dialects::common::MavResult;
use nalgebra::Vector3;

impl<M: RawMutex> Receiver<'_, M> {
    /// Acts on a command, if the message is one of the dialect's; another is answered by its number.
    pub(super) fn command<D: Addressed>(&mut self, frame: &Frame<'_>, message: Option<&D>)
    where
        for<'m> Call: From<&'m D>,
    {
        let Some(message) = message else { return self.unknown(frame) };
        if self.is_target(message.target()) {
            self.call(frame, &Call::from(message));
        }
    }

    /// Answers a command that the dialect does not have.
    #[inline(never)]
    fn unknown(&mut self, frame: &Frame<'_>) {
        let unknown = command_of(frame.message, frame.payload);
        match unknown.filter(|(_, target)| self.is_target((*target).into())) {
            Some((command, _)) => {
                let order = Order::read(command, frame);
                self.shared.reply(Reply::Command(order.answered(MavResult::MAV_RESULT_UNSUPPORTED)));
            }
            None => self.refused(),
        }
    }

    /// Acts on a command once, and has it answered.
    #[inline(never)]
    pub(super) fn call(&mut self, frame: &Frame<'_>, call: &Call) {
        let (order, armed) = (Order::read(call.command as u16, frame), self.shared.commander().get());
        let delivery = self.repetitions.check(frame, order.command);
        if delivery != Delivery::New {
            self.traffic.repeated = self.traffic.repeated.wrapping_add(1);
            self.shared.reply(match delivery {
                Delivery::Overtaken => Reply::Command(order.answered(MavResult::MAV_RESULT_TEMPORARILY_REJECTED)),
                _ => Reply::Likewise { order, of: order.frame },
            });
            return;
        }
        let result = if !self.shared.is_armed() || self.commander.may_command(call, order.sender, armed, frame.time) {
            match self.act(call, order, frame.time) {
                Some(result) => result,
                None => return,
            }
        } else {
            self.stranger_refused.warn(self.shared, frame.time, "Refused: another station commands");
            MavResult::MAV_RESULT_DENIED
        };
        self.shared.reply(Reply::Command(order.answered(result)));
    }

    /// Acts on a command at `now`, us; the answer, unless control gives it.
    fn act(&mut self, call: &Call, order: Order, now: u64) -> Option<MavResult> {
        let report = self.shared.report().get();
        let home = report.and_then(|report| report.value.home).map_or_else(Vector3::zeros, |home| frames::world(&home));
        let origin = self.shared.origin().get().map_or_else(Origin::default, |origin| origin.value);
        match action(call, self.shared.is_armed(), &origin, &home) {
            Action::Request(request) => {
                if let (Request::FlyMission(_), Err((number, refusal))) = (&request, self.check_mission()) {
                    let words = format_args!("Mission item {number}: {refusal}");
                    self.shared.announce(Event::new(Severity::Warning, words));
                    return Some(MavResult::MAV_RESULT_DENIED);
                }
                let setpoints = if request == Request::FlySetpoints {
                    match self.claim_setpoints(order.sender, now) {
                        Ok(sender) => Some(sender),
                        Err(others) => {
                            let words = format_args!("No OFFBOARD by {others}");
                            self.shared.announce(Event::new(Severity::Warning, words));
                            return Some(MavResult::MAV_RESULT_DENIED);
                        }
                    }
                } else {
                    None
                };
                self.shared.request(QueuedRequest { request, order: Some(order), setpoints });
                return None;
            }
            Action::ForceDisarm => self.shared.request_disarm(),
            Action::EnterHil => self.shared.hil().raise(),
            Action::Restart => return Some(self.restart(false)),
            Action::StartBootloader => return Some(self.restart(true)),
            Action::Refuse(result, words) => {
                self.shared.announce(Event::new(Severity::Warning, words));
                return Some(result);
            }
            Action::Calibrate(procedure) => return self.calibrate((procedure, order)).err(),
            Action::Answer(result) => return Some(result),
            Action::Send(kind) => {
                self.shared.reply(Reply::Requested(kind, order));
                return None;
            }
            Action::Reply(reply) => self.shared.reply(reply),
            Action::ReplyModes => (1..=vehicle::MODE_COUNT).for_each(|index| self.shared.reply(Reply::Mode(index))),
        }
        Some(MavResult::MAV_RESULT_ACCEPTED)
    }

    /// Has the vehicle restarted, into its bootloader or not, once this answer is out. What is refused leaves alone
    /// what was accepted.
    fn restart(&mut self, into_bootloader: bool) -> MavResult {
        let shared = self.shared;
        let (refused, result) = if !shared.can_restart().is_raised() {
            ("Restart: not supported here", MavResult::MAV_RESULT_UNSUPPORTED)
        } else if into_bootloader && !shared.has_bootloader().is_raised() {
            ("Restart: there is no bootloader", MavResult::MAV_RESULT_UNSUPPORTED)
        } else if shared.saving().is_raised() {
            ("Restart: parameters are being saved", MavResult::MAV_RESULT_TEMPORARILY_REJECTED)
        } else if shared.restarting().is_raised() {
            if shared.into_bootloader().is_raised() == into_bootloader {
                return MavResult::MAV_RESULT_ACCEPTED;
            }
            ("Restart: another one is under way", MavResult::MAV_RESULT_TEMPORARILY_REJECTED)
        } else {
            if into_bootloader {
                shared.into_bootloader().raise();
            } else {
                shared.into_bootloader().lower();
            }
            // Raised first and checked afterwards: control either sees it, or has already reported that a motor turns.
            shared.restarting().raise();
            if !shared.is_turning() {
                return MavResult::MAV_RESULT_ACCEPTED;
            }
            shared.restarting().lower();
            ("Restart: only disarmed, and no motor turning", MavResult::MAV_RESULT_DENIED)
        };
        shared.announce(Event::new(Severity::Warning, refused));
        result
    }

    /// Hands it to the IMU task, which answers.
    pub(super) fn calibrate(&mut self, asked: Calibration) -> Result<(), MavResult> {
        let refused = if self.shared.is_armed() {
            "Calibration: only while disarmed"
        } else if self.shared.hil().is_raised() {
            "Calibration: a simulator has the sensors"
        } else {
            return self.shared.calibrations().put(asked).map_err(|_| MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
        };
        self.shared.announce(Event::new(Severity::Warning, refused));
        Err(MavResult::MAV_RESULT_DENIED)
    }
}
