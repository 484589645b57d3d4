//! A receiver fed with frames, and everything it may change.

use super::{GROUND, v2};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use estimation::estimator::PoseMeasurement;
use firmware::link::acknowledgement::{Acknowledgement, Order};
use firmware::link::frame::Parser;
use firmware::link::receive::Receiver;
use firmware::shared::{Reply, Report, Shared, Text};
use flight::{Mode, Stamped};
use mavlink::MessageData;
use mavlink::dialects::common::{COMMAND_LONG_DATA, MavCmd, MavResult};

/// What a single-threaded test shares.
pub type Local = Shared<NoopRawMutex>;

/// A receiver with its parser.
pub struct Fed<'a> {
    parser: Parser,
    receiver: Receiver<'a, NoopRawMutex>,
    sequence: u8,
}

impl<'a> Fed<'a> {
    /// Nothing received yet.
    pub fn new(shared: &'a Local) -> Self {
        Self { parser: Parser::new(), receiver: Receiver::new(shared.for_receive()), sequence: 0 }
    }

    /// Receives bytes at `now`, us.
    pub fn bytes(&mut self, bytes: &[u8], now: u64) {
        for &byte in bytes {
            let mut next = self.parser.push(byte, now);
            while let Some(frame) = next {
                self.receiver.take(&frame);
                next = self.parser.next_frame();
            }
        }
    }

    /// Receives a message at `now`, us.
    pub fn message<D: MessageData>(&mut self, message: &D, now: u64) {
        self.sequence = self.sequence.wrapping_add(1);
        self.bytes(&v2(self.sequence, message), now);
    }
}

/// Events announced so far, taken away.
pub fn texts(shared: &Local) -> Vec<String> {
    std::iter::from_fn(|| shared.events.take()).map(|event| Text::new(event).as_str().to_owned()).collect()
}

/// The last of the poses that wait for control, taken away with the others.
pub fn newest(shared: &Local) -> Option<Stamped<PoseMeasurement>> {
    std::iter::from_fn(|| shared.poses.take()).last()
}

/// Control's report, in this mode.
pub fn report(shared: &Local, mode: Mode, time: u64) {
    shared.report.put(Report { mode, ..Report::NONE }, time);
}

/// A command for the vehicle with these parameters.
pub fn command(command: MavCmd, parameters: [f32; 5]) -> COMMAND_LONG_DATA {
    let [param1, param2, param3, param4, param5] = parameters;
    COMMAND_LONG_DATA { param1, param2, param3, param4, param5, command, target_system: 1, ..Default::default() }
}

/// The same, as its answer identifies it: the ground station's, in [`whichever`] frame.
pub const fn ordered(command: MavCmd) -> Order {
    Order { command: command as u16, sender: (GROUND.system_id as u8, GROUND.component_id), frame: 0 }
}

/// An order, whichever frame it came in.
pub const fn whichever(order: Order) -> Order {
    Order { frame: 0, ..order }
}

/// A reply, whichever frame requested it.
fn answering_whichever(reply: Reply) -> Reply {
    match reply {
        Reply::Command(Acknowledgement { order, result }) => Reply::Command(whichever(order).answered(result)),
        Reply::Requested(kind, order) => Reply::Requested(kind, whichever(order)),
        other => other,
    }
}

/// Control's answers that wait, taken away.
pub fn answers(shared: &Local) -> Vec<Reply> {
    std::iter::from_fn(|| shared.answers.take()).map(answering_whichever).collect()
}

/// A disarm command with force.
pub fn disarm() -> COMMAND_LONG_DATA {
    command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [0.0, 21196.0, 0.0, 0.0, 0.0])
}

/// The replies that wait, taken away.
pub fn replies(shared: &Local) -> Vec<Reply> {
    std::iter::from_fn(|| shared.replies.take()).map(answering_whichever).collect()
}

/// The answer to a command that is not put to control.
pub fn answer(message: &COMMAND_LONG_DATA, mode: Mode) -> MavResult {
    let shared = Local::new();
    report(&shared, mode, 0);
    Fed::new(&shared).message(message, 0);
    assert!(shared.requests.take().is_none());
    match replies(&shared)[..] {
        [Reply::Command(Acknowledgement { order, result })] if order == ordered(message.command) => result,
        ref other => panic!("{other:?}"),
    }
}
