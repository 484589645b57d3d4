//! The connection to the flight controller: TCP, every wait bounded and every wait ended by an interrupt.

use crate::output::interrupt::Interrupt;
use crate::sessions::answer::Answer;
use crate::sessions::messages::{Controls, Encoder};
use firmware::link::frame::Parser;
use std::fmt;
use std::io::{self, BufRead, BufReader, ErrorKind, Write};
use std::net::{TcpListener, TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

/// Between attempts to connect or accept, and between checks for a signal.
const POLL_PERIOD: Duration = Duration::from_millis(20);

/// The system itself would try for minutes where no answer comes at all. Long enough for any line.
const CONNECT_TIMEOUT: Duration = Duration::from_millis(500);

/// Where the other side is to be found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Address {
    /// It listens there.
    Connect(String),
    /// It will come here.
    Listen(String),
}

/// Why there is no connection, or none any more.
#[derive(Debug)]
pub enum PortError {
    /// No connection came about in time.
    NoConnection(Address, Duration, Option<io::Error>),
    /// The address cannot be used.
    Address(String, io::Error),
    /// The other side said nothing for so long.
    Silent(Duration),
    /// The connection broke.
    Broken(io::Error),
    /// Interrupted by this signal.
    Interrupted(u8),
}

impl fmt::Display for PortError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoConnection(Address::Connect(address), waited, error) => {
                write!(f, "--connect: no listener on {address} for {} s", waited.as_secs_f64())?;
                error.as_ref().map_or(Ok(()), |error| write!(f, ": {error}"))
            }
            Self::NoConnection(Address::Listen(address), waited, _) => {
                write!(f, "--listen: no connection to {address} for {} s", waited.as_secs_f64())
            }
            Self::Address(address, error) => write!(f, "{address}: cannot be used: {error}"),
            Self::Silent(waited) => write!(f, "no motor command for {} s", waited.as_secs_f64()),
            Self::Broken(error) => write!(f, "the connection broke: {error}"),
            Self::Interrupted(signal) => write!(f, "interrupted by signal {signal}"),
        }
    }
}

/// A connected flight controller.
pub struct SimulatorPort {
    reader: BufReader<TcpStream>,
    parser: Parser,
    writer: TcpStream,
    patience: Duration,
    interrupt: Interrupt,
    encoder: Encoder,
    bytes: Vec<u8>,
}

impl SimulatorPort {
    /// Finds the other side; `patience` bounds this and every later wait.
    ///
    /// # Errors
    /// [`PortError`] if the other side does not come in time or the address cannot be used.
    pub fn open(address: &Address, patience: Duration, interrupt: &Interrupt) -> Result<Self, PortError> {
        let stream = connected(address, patience, interrupt)?;
        Self::new(stream, patience, interrupt.clone()).map_err(PortError::Broken)
    }

    fn new(stream: TcpStream, patience: Duration, interrupt: Interrupt) -> io::Result<Self> {
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(POLL_PERIOD.min(patience)))?;
        stream.set_write_timeout(Some(patience))?;
        let writer = stream.try_clone()?;
        let reader = BufReader::new(stream);
        let (parser, encoder, bytes) = (Parser::new(), Encoder::default(), Vec::new());
        Ok(Self { reader, parser, writer, patience, interrupt, encoder, bytes })
    }

    /// The next command; none when the other side has gone. Other messages, and noise, are skipped.
    ///
    /// # Errors
    /// [`PortError`] if no byte comes in time or the connection breaks.
    pub fn receive(&mut self) -> Result<Option<Controls>, PortError> {
        let mut last = Instant::now();
        loop {
            interrupted(&self.interrupt)?;
            let bytes = match self.reader.fill_buf() {
                Ok([]) => return Ok(None),
                Ok(bytes) => bytes,
                Err(error) => match error.kind() {
                    ErrorKind::ConnectionReset => return Ok(None),
                    ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => {
                        if last.elapsed() >= self.patience {
                            return Err(PortError::Silent(self.patience));
                        }
                        continue;
                    }
                    _ => return Err(PortError::Broken(error)),
                },
            };
            last = Instant::now();
            for (taken, byte) in (1..).zip(bytes) {
                // Time does not matter here: a stream neither loses nor ages anything.
                if let Some(controls) = self.parser.push(*byte, 0).and_then(|frame| Controls::from_frame(&frame)) {
                    self.reader.consume(taken);
                    return Ok(Some(controls));
                }
            }
            let taken = bytes.len();
            self.reader.consume(taken);
        }
    }

    /// Answers a command.
    ///
    /// # Errors
    /// [`PortError`] if the connection breaks; a side that has gone is for [`Self::receive`] to find.
    pub fn answer(&mut self, answer: &Answer) -> Result<(), PortError> {
        self.bytes.clear();
        self.encoder.answer(answer, &mut self.bytes);
        match self.writer.write_all(&self.bytes) {
            Err(error) if !matches!(error.kind(), ErrorKind::BrokenPipe | ErrorKind::ConnectionReset) => {
                Err(PortError::Broken(error))
            }
            _ => Ok(()),
        }
    }
}

fn interrupted(interrupt: &Interrupt) -> Result<(), PortError> {
    interrupt.signal().map_or(Ok(()), |signal| Err(PortError::Interrupted(signal)))
}

/// A connection to `address`, made within `patience`.
pub(super) fn connected(address: &Address, patience: Duration, interrupt: &Interrupt) -> Result<TcpStream, PortError> {
    match address {
        Address::Connect(to) => connect(to, address, patience, interrupt),
        Address::Listen(on) => listen(on, address, patience, interrupt),
    }
}

fn connect(to: &str, address: &Address, patience: Duration, interrupt: &Interrupt) -> Result<TcpStream, PortError> {
    let started = Instant::now();
    loop {
        let (candidates, mut failed) = match to.to_socket_addrs() {
            Ok(candidates) => (candidates.collect(), None),
            Err(error) if error.kind() == ErrorKind::InvalidInput => return Err(PortError::Address(to.into(), error)),
            Err(error) => (Vec::new(), Some(error)),
        };
        for candidate in candidates {
            interrupted(interrupt)?;
            let left = patience.saturating_sub(started.elapsed()).max(POLL_PERIOD);
            match TcpStream::connect_timeout(&candidate, left.min(CONNECT_TIMEOUT)) {
                Ok(stream) => return Ok(stream),
                Err(error) if error.kind() == ErrorKind::InvalidInput => {
                    return Err(PortError::Address(to.into(), error));
                }
                Err(error) => failed = Some(error),
            }
        }
        interrupted(interrupt)?;
        if started.elapsed() >= patience {
            return Err(PortError::NoConnection(address.clone(), patience, failed));
        }
        std::thread::sleep(POLL_PERIOD);
    }
}

fn listen(on: &str, address: &Address, patience: Duration, interrupt: &Interrupt) -> Result<TcpStream, PortError> {
    let refuse = |error| PortError::Address(on.to_owned(), error);
    let listener = TcpListener::bind(on).map_err(refuse)?;
    listener.set_nonblocking(true).map_err(refuse)?;
    let started = Instant::now();
    loop {
        interrupted(interrupt)?;
        match listener.accept() {
            Ok((stream, _)) => return Ok(stream),
            Err(error) if error.kind() != ErrorKind::WouldBlock => return Err(PortError::Broken(error)),
            Err(_) if started.elapsed() >= patience => {
                return Err(PortError::NoConnection(address.clone(), patience, None));
            }
            Err(_) => std::thread::sleep(POLL_PERIOD),
        }
    }
}

#[cfg(test)]
mod tests;
