//! The vehicle's output: to clients, to its camera, and to the terminal.
//!
//! Frames go to the port as they are. A TIMESYNC question is answered by the camera's clock too, and texts are kept to
//! be shown.

use super::clock::SimClock;
use super::faults::{Faults, Part};
use super::world::World;
use crate::sessions::ports::Port;
use embedded_io_async::{ErrorType, Write};
use firmware::hardware::Clock;
use firmware::link::frame::{Frame, Parser};
use mavlink::MessageData;
use mavlink::dialects::common::{STATUSTEXT_DATA, TIMESYNC_DATA};
use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

/// The line out of the vehicle.
pub struct Voice {
    pub clock: SimClock,
    pub faults: Faults,
    pub port: Rc<RefCell<Port>>,
    pub world: World,
    /// Texts with their times, us.
    pub texts: Rc<RefCell<Vec<(u64, String)>>>,
    pub parser: Parser,
}

impl ErrorType for Voice {
    type Error = Infallible;
}

impl Write for Voice {
    async fn write(&mut self, frame: &[u8]) -> Result<usize, Infallible> {
        let now = self.clock.now();
        if !self.faults.has(Part::GroundStation, now) {
            self.port.borrow_mut().send(frame);
        }
        let (world, texts) = (&self.world, &self.texts);
        self.parser.feed(frame, now, &mut |frame| follow(frame, world, now, texts));
        Ok(frame.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

fn follow(frame: &Frame<'_>, world: &World, now: u64, texts: &RefCell<Vec<(u64, String)>>) {
    world.receive(frame);
    match frame.message {
        TIMESYNC_DATA::ID => {
            if let Some(TIMESYNC_DATA { tc1: 0, ts1 }) = frame.decode() {
                world.answer_time_sync(ts1);
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
