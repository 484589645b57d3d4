//! The vehicle's output: to clients, to its camera, and to the terminal.
//!
//! Frames go to the port as they are. A TIMESYNC question is answered by the camera's clock too, and texts are kept to
//! be shown.

use super::clock::SimClock;
use super::faults::{Faults, FaultyPart};
use super::simulated_hardware::SimulatedHardware;
use crate::sessions::ports::ClientPort;
use embedded_io_async::{ErrorType, Write};
use firmware::hardware::Clock;
use firmware::link::frame::{Frame, Parser};
use mavlink::MessageData;
use mavlink::dialects::common::{STATUSTEXT_DATA, TIMESYNC_DATA};
use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

/// The line out of the vehicle.
pub struct Downlink {
    pub clock: SimClock,
    pub faults: Faults,
    pub port: Rc<RefCell<ClientPort>>,
    pub hardware: SimulatedHardware,
    /// Texts with their times, us.
    pub texts: Rc<RefCell<Vec<(u64, String)>>>,
    pub parser: Parser,
}

impl ErrorType for Downlink {
    type Error = Infallible;
}

impl Write for Downlink {
    async fn write(&mut self, frame: &[u8]) -> Result<usize, Infallible> {
        let now = self.clock.now();
        if !self.faults.has(FaultyPart::GroundStation, now) {
            self.port.borrow_mut().send(frame);
        }
        let (hardware, texts) = (&self.hardware, &self.texts);
        self.parser.feed(frame, now, &mut |frame| follow(frame, hardware, now, texts));
        Ok(frame.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

fn follow(frame: &Frame<'_>, hardware: &SimulatedHardware, now: u64, texts: &RefCell<Vec<(u64, String)>>) {
    hardware.receive(frame);
    match frame.message {
        TIMESYNC_DATA::ID => {
            if let Some(TIMESYNC_DATA { tc1: 0, ts1 }) = frame.decode() {
                hardware.answer_time_sync(ts1);
            }
        }
        STATUSTEXT_DATA::ID => {
            if let Some(STATUSTEXT_DATA { text, .. }) = frame.decode() {
                texts.borrow_mut().push((now, text.to_str().unwrap_or_default().to_owned()));
            }
        }
        _ => {}
    }
}
