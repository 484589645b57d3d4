//! Two lines, one link: the serial line, or a computer's USB port while a program there has it open.
//!
//! One at a time. So there is one receiver, which holds the commander, and one place where answers go; input on the
//! other line is ignored, poses included. The link moves when the port is opened or closed, never while a motor turns:
//! who flies over one line keeps it, and a cable that is pulled is a ground station that falls silent. Every move is
//! reported, on the line that it leads to.

use crate::hardware::{Clock, Port};
use crate::shared::{self, Event, Flag, PortView, Severity};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::{Error, ErrorKind, ErrorType, Read, Write};

/// The interval of polls whether the port is open.
pub const PORT_POLL_INTERVAL_US: u64 = 100_000;

/// One direction of the link, on whichever line it is.
pub struct Line<'a, S, P> {
    /// The serial line.
    pub serial: S,
    /// The port, where there is one.
    pub port: Option<P>,
    /// Whether the link is on the port: [`shared::Values::on_port`].
    pub on_port: shared::Read<'a, Flag>,
}

impl<S, P> ErrorType for Line<'_, S, P> {
    type Error = ErrorKind;
}

impl<S: Read, P: Read> Read for Line<'_, S, P> {
    /// A task that waits on one line does not notice a move to the other, and has to retry within bounded time, as the
    /// link does.
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
        match self.port.as_mut().filter(|_| self.on_port.is_raised()) {
            Some(port) => port.read(bytes).await.map_err(|error| error.kind()),
            None => {
                let count = self.serial.read(bytes).await.map_err(|error| error.kind())?;
                // The port may have been opened meanwhile, and this was not sent there.
                let is_heard = self.port.is_none() || !self.on_port.is_raised();
                Ok(if is_heard { count } else { 0 })
            }
        }
    }
}

impl<S: Write, P: Write> Write for Line<'_, S, P> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        match self.port.as_mut().filter(|_| self.on_port.is_raised()) {
            Some(port) => port.write(bytes).await.map_err(|error| error.kind()),
            None => self.serial.write(bytes).await.map_err(|error| error.kind()),
        }
    }

    async fn flush(&mut self) -> Result<(), ErrorKind> {
        match self.port.as_mut().filter(|_| self.on_port.is_raised()) {
            Some(port) => port.flush().await.map_err(|error| error.kind()),
            None => self.serial.flush().await.map_err(|error| error.kind()),
        }
    }
}

/// Moves the link to the port while that is open, and back, for ever.
pub async fn watch<M: RawMutex>(port: &impl Port, clock: &impl Clock, shared: PortView<'_, M>) -> ! {
    loop {
        let is_open = port.is_open();
        if is_open != shared.on_port().is_raised() && !shared.is_turning() {
            let words = if is_open {
                shared.on_port().raise();
                "Link: on USB, the serial line is ignored"
            } else {
                shared.on_port().lower();
                "Link: on the serial line"
            };
            shared.announce(Event::new(Severity::Information, words));
        }
        clock.until(clock.now().saturating_add(PORT_POLL_INTERVAL_US)).await;
    }
}
