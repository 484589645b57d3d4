//! Bytes to and from the vehicle: by TCP, by UDP, or by a serial port, USB's among them.
//!
//! A line that breaks off, as USB does when it is pulled out, is opened again at the next use.

use serial2::SerialPort;
use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream, ToSocketAddrs, UdpSocket};
use std::str::FromStr;
use std::time::Duration;

/// How long one look at what has come may take.
const READ_TIMEOUT: Duration = Duration::from_millis(10);

/// How long bytes may wait for a line that takes none.
const WRITE_TIMEOUT: Duration = Duration::from_millis(200);

/// How long a vehicle may take to be reached by TCP.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);

/// The link's rate unless SER_BAUD says otherwise; over USB any serves.
const BAUD_RATE: u32 = 921_600;

/// Where the vehicle is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Address {
    /// A serial port, and its baud rate.
    Serial(String, u32),
    /// A port that listens, as HOST:PORT.
    Tcp(String),
    /// A local port to listen on, as HOST:PORT; the vehicle's is the one that sends there.
    Udp(String),
}

impl FromStr for Address {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let form = "must be serial:/dev/ttyACM0, serial:COM3@57600, tcp:HOST:PORT or udp:HOST:PORT";
        let (kind, rest) = text.split_once(':').ok_or(form)?;
        let is_place =
            rest.rsplit_once(':').is_some_and(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok());
        match (kind, rest.rsplit_once('@')) {
            ("serial", Some((path, rate))) => {
                let rate = rate.parse().map_err(|_| format!("{form}; the rate behind @ is not a number: {rate}"))?;
                Ok(Self::Serial(path.to_owned(), rate))
            }
            ("serial", None) if !rest.is_empty() => Ok(Self::Serial(rest.to_owned(), BAUD_RATE)),
            ("tcp", _) if is_place => Ok(Self::Tcp(rest.to_owned())),
            ("udp", _) if is_place => Ok(Self::Udp(rest.to_owned())),
            _ => Err(form.to_owned()),
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(path, rate) => write!(f, "serial:{path}@{rate}"),
            Self::Tcp(place) => write!(f, "tcp:{place}"),
            Self::Udp(place) => write!(f, "udp:{place}"),
        }
    }
}

enum Open {
    Serial(SerialPort),
    Tcp(TcpStream),
    /// And who has sent last.
    Udp(UdpSocket, Option<SocketAddr>),
}

/// A line to the vehicle, open or to be opened.
pub struct Line {
    address: Address,
    open: Option<Open>,
}

impl Line {
    /// Opens the line.
    ///
    /// # Errors
    /// In words: the address, and why it cannot be had.
    pub fn open(address: Address) -> Result<Self, String> {
        let mut line = Self { address, open: None };
        line.reopen().map_err(|error| format!("--link {}: {error}", line.address))?;
        Ok(line)
    }

    fn reopen(&mut self) -> io::Result<()> {
        self.open = Some(match &self.address {
            Address::Serial(path, rate) => {
                let mut port = SerialPort::open(path, *rate)?;
                port.set_read_timeout(READ_TIMEOUT)?;
                port.set_write_timeout(WRITE_TIMEOUT)?;
                // USB's sign that a program has it open; a line without that sign works as well.
                let _ = port.set_dtr(true);
                Open::Serial(port)
            }
            Address::Tcp(place) => {
                let address = place.to_socket_addrs()?.next().ok_or(ErrorKind::AddrNotAvailable)?;
                let stream = TcpStream::connect_timeout(&address, CONNECT_TIMEOUT)?;
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(READ_TIMEOUT))?;
                stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
                Open::Tcp(stream)
            }
            Address::Udp(place) => {
                let socket = UdpSocket::bind(place)?;
                socket.set_read_timeout(Some(READ_TIMEOUT))?;
                Open::Udp(socket, None)
            }
        });
        Ok(())
    }

    /// Whether it is there: false from the moment it broke off until it was opened again.
    pub fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Bytes that have come, within some 10 ms; none where there are none, or no line.
    pub fn receive(&mut self, chunk: &mut [u8]) -> usize {
        if self.open.is_none() && self.reopen().is_err() {
            std::thread::sleep(READ_TIMEOUT);
            return 0;
        }
        let read = match &mut self.open {
            Some(Open::Serial(port)) => port.read(chunk),
            Some(Open::Tcp(stream)) => stream.read(chunk),
            Some(Open::Udp(socket, sender)) => socket.recv_from(chunk).map(|(count, from)| {
                *sender = Some(from);
                count
            }),
            None => Ok(0),
        };
        match read {
            // A stream that has ended. A datagram may be empty.
            Ok(0) if matches!(self.open, Some(Open::Tcp(_) | Open::Serial(_))) => self.open = None,
            Ok(count) => return count,
            Err(error) if is_a_pause(&error) => {}
            Err(_) => self.open = None,
        }
        0
    }

    /// Sends a frame; one that finds no line, or no room, is lost, as on any line.
    pub fn send(&mut self, frame: &[u8]) {
        let sent = match &mut self.open {
            Some(Open::Serial(port)) => port.write_all(frame),
            Some(Open::Tcp(stream)) => stream.write_all(frame),
            Some(Open::Udp(socket, Some(vehicle))) => socket.send_to(frame, *vehicle).map(drop),
            Some(Open::Udp(_, None)) | None => Ok(()),
        };
        if sent.is_err_and(|error| !is_a_pause(&error)) {
            self.open = None;
        }
    }
}

/// An address without a listener shows as an error of the next call that receives.
fn is_a_pause(error: &io::Error) -> bool {
    use ErrorKind::{ConnectionRefused, Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), WouldBlock | TimedOut | Interrupted | ConnectionRefused)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_as_they_are_written_and_others_are_refused() {
        for (text, address) in [
            ("serial:/dev/ttyACM0", Address::Serial("/dev/ttyACM0".to_owned(), 921_600)),
            ("serial:COM3@57600", Address::Serial("COM3".to_owned(), 57_600)),
            ("tcp:127.0.0.1:5760", Address::Tcp("127.0.0.1:5760".to_owned())),
            ("udp:127.0.0.1:14550", Address::Udp("127.0.0.1:14550".to_owned())),
        ] {
            let read: Address = text.parse().unwrap();
            assert_eq!(read, address);
            assert_eq!(read.to_string().parse(), Ok(address));
        }
        for text in ["", "serial:", "serial:x@fast", "tcp:5760", "tcp:here:x", "udp::1", "usb:1", "/dev/ttyACM0"] {
            assert!(text.parse::<Address>().unwrap_err().contains("serial:/dev/ttyACM0"), "{text}");
        }
    }
}
