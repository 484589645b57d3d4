//! The flight controller's line for ground stations, handed to MAVLink clients on UDP, as `sitl` does.
//!
//! ```text
//! clients -- UDP --> relay -- TCP --> flight controller
//!         <-- a frame a datagram --
//! ```
//!
//! Frames go on as they are, both ways; nothing is added. Texts and the vehicle's state are kept to be shown. It runs
//! on a thread of its own, so that clients are served while the simulator waits for a command.

use super::port::{Address, PortError, connected};
use crate::output::interrupt::Interrupt;
use crate::sessions::ports::{ClientPort, Ports};
use firmware::link::frame::{Frame, Parser};
use mavlink::MessageData;
use mavlink::dialects::common::{HEARTBEAT_DATA, MavState, STATUSTEXT_DATA};
use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Between looks at who has sent something.
const POLL_PERIOD: Duration = Duration::from_millis(1);

/// For bytes that the flight controller does not take: they are lost then, as on any line.
const WRITE_TIMEOUT: Duration = Duration::from_millis(100);

/// The line cannot be served.
#[derive(Debug)]
pub enum RelayError {
    /// The flight controller's side.
    Line(PortError),
    /// The clients' side, in words.
    Clients(String),
}

impl fmt::Display for RelayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(error) => write!(f, "--ground: {error}"),
            Self::Clients(what) => f.write_str(what),
        }
    }
}

/// The vehicle's texts and state, as received.
#[derive(Debug, Default)]
struct Received {
    texts: Vec<String>,
    state: Option<MavState>,
}

/// A relay that runs until it is dropped.
pub struct Relay {
    received: Arc<Mutex<Received>>,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Relay {
    /// Connects to the line at `address` and opens the ports.
    ///
    /// # Errors
    /// [`RelayError`].
    pub fn open(address: &str, ports: &Ports, patience: Duration, interrupt: &Interrupt) -> Result<Self, RelayError> {
        let clients = ClientPort::open(ports).map_err(|error| RelayError::Clients(error.to_string()))?;
        let address = Address::Connect(address.to_owned());
        let line = connected(&address, patience, interrupt).map_err(RelayError::Line)?;
        let ready = || {
            line.set_nodelay(true)?;
            line.set_read_timeout(Some(POLL_PERIOD))?;
            line.set_write_timeout(Some(WRITE_TIMEOUT))
        };
        ready().map_err(|error| RelayError::Line(PortError::Broken(error)))?;
        let (received, over) = (Arc::<Mutex<Received>>::default(), Arc::<AtomicBool>::default());
        let (to_show, until) = (Arc::clone(&received), Arc::clone(&over));
        let thread = thread::spawn(move || serve(line, clients, &to_show, &until));
        Ok(Self { received, over, thread: Some(thread) })
    }

    /// The texts since the last time.
    #[must_use]
    pub fn texts(&self) -> Vec<String> {
        std::mem::take(&mut locked(&self.received).texts)
    }

    /// The vehicle's state by its last heartbeat.
    #[must_use]
    pub fn state(&self) -> &'static str {
        match locked(&self.received).state {
            None => "silent",
            Some(MavState::MAV_STATE_BOOT) => "boot",
            Some(MavState::MAV_STATE_CALIBRATING) => "checks",
            Some(MavState::MAV_STATE_STANDBY) => "ready",
            Some(MavState::MAV_STATE_ACTIVE) => "active",
            Some(_) => "emergency",
        }
    }
}

impl Drop for Relay {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn locked(received: &Mutex<Received>) -> MutexGuard<'_, Received> {
    received.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Hands on what comes, either way, until it is over or the line has ended.
fn serve(mut line: TcpStream, mut clients: ClientPort, received: &Mutex<Received>, over: &AtomicBool) {
    let mut parser = Parser::new();
    let mut chunk = [0; 4096];
    while !over.load(Ordering::Relaxed) {
        match line.read(&mut chunk) {
            Ok(0) => break,
            // Time does not matter here: a stream neither loses nor ages anything.
            Ok(count) => parser.feed(chunk.get(..count).unwrap_or(&chunk), 0, &mut |frame| {
                // First, so that a client that has the frame finds its text here.
                follow(frame, received);
                clients.send(frame.bytes);
            }),
            Err(error) if is_a_pause(&error) => {}
            Err(_) => break,
        }
        // Bytes that find no room are lost; a line that is gone shows at the next read.
        clients.receive(|frame| drop(line.write_all(frame)));
    }
}

fn is_a_pause(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

fn follow(frame: &Frame<'_>, received: &Mutex<Received>) {
    match frame.message {
        HEARTBEAT_DATA::ID => {
            if let Some(heartbeat) = frame.decode::<HEARTBEAT_DATA>() {
                locked(received).state = Some(heartbeat.system_status);
            }
        }
        STATUSTEXT_DATA::ID => {
            if let Some(STATUSTEXT_DATA { text, .. }) = frame.decode() {
                locked(received).texts.push(text.to_str().unwrap_or_default().to_owned());
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::{Ipv4Addr, TcpListener, UdpSocket};
    use std::time::Instant;

    const HANG_TIMEOUT: Duration = Duration::from_secs(10);

    fn frame(sequence: u8, message: &impl MessageData) -> Vec<u8> {
        let mut frame = mavlink::MAVLinkV2MessageRaw::new();
        frame.serialize_message_data(mavlink::MavHeader { system_id: 1, component_id: 1, sequence }, message);
        frame.raw_bytes().to_vec()
    }

    fn client() -> (UdpSocket, u16) {
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        socket.set_read_timeout(Some(HANG_TIMEOUT)).unwrap();
        let port = socket.local_addr().unwrap().port();
        (socket, port)
    }

    #[test]
    fn clients_and_the_line_receive_each_others_frames_and_texts_are_kept() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let ((offboard, first), (ground, second)) = (client(), client());
        let local = client().1;
        let ports = Ports { offboard: first, ground: second, local };
        let relay = Relay::open(&address, &ports, HANG_TIMEOUT, &Interrupt::default()).unwrap();
        let mut board = listener.accept().unwrap().0;
        board.set_read_timeout(Some(HANG_TIMEOUT)).unwrap();

        let state = HEARTBEAT_DATA { system_status: MavState::MAV_STATE_STANDBY, ..Default::default() };
        let said = STATUSTEXT_DATA { text: "Armed: idling".into(), ..Default::default() };
        let (state, said) = (frame(1, &state), frame(2, &said));
        // In pieces, with noise between them.
        for piece in [&[7, 7, 7][..], &state[..5], &state[5..], &[1, 2, 3], &said] {
            board.write_all(piece).unwrap();
        }
        for socket in [&offboard, &ground] {
            for expected in [&state, &said] {
                let mut datagram = [0; 300];
                let length = socket.recv(&mut datagram).unwrap();
                assert_eq!(&datagram[..length], &expected[..]);
            }
        }
        assert_eq!((relay.state(), relay.texts(), relay.texts()), ("ready", vec!["Armed: idling".to_owned()], vec![]));

        for datagram in [&said[..10], &state[..]] {
            offboard.send_to(datagram, (Ipv4Addr::LOCALHOST, local)).unwrap();
        }
        let mut bytes = vec![0; state.len()];
        board.read_exact(&mut bytes).unwrap();
        assert_eq!(bytes, state, "a fragment before it is left out");
        let started = Instant::now();
        drop(relay);
        assert!(started.elapsed() < HANG_TIMEOUT);
        assert_eq!(board.read(&mut bytes).unwrap(), 0);
    }
}
