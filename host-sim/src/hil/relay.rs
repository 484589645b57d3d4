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
use crate::interrupt::Interrupt;
use crate::sitl::port::{Port, Ports};
use firmware::link::frame::{Frame, Parser, Version};
use mavlink::MessageData;
use mavlink::dialects::common::{HEARTBEAT_DATA, MavState, STATUSTEXT_DATA};
use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Pause between looks at who has sent something.
const PAUSE: Duration = Duration::from_millis(1);

/// The longest that the flight controller may take no byte of what clients send; it is lost after that, as on any line.
const FULL: Duration = Duration::from_millis(100);

/// Bytes of a version 2 frame around its payload: ten before it, a checksum behind.
const AROUND: usize = 12;

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
        let clients = Port::open(ports).map_err(|error| RelayError::Clients(error.to_string()))?;
        let address = Address::Connect(address.to_owned());
        let line = connected(&address, patience, interrupt).map_err(RelayError::Line)?;
        let ready = || {
            line.set_nodelay(true)?;
            line.set_read_timeout(Some(PAUSE))?;
            line.set_write_timeout(Some(FULL))
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
fn serve(mut line: TcpStream, mut clients: Port, received: &Mutex<Received>, over: &AtomicBool) {
    let mut frames = Frames::default();
    let mut chunk = [0; 4096];
    while !over.load(Ordering::Relaxed) {
        match line.read(&mut chunk) {
            Ok(0) => break,
            Ok(count) => frames.take(chunk.get(..count).unwrap_or(&chunk), |bytes, frame| {
                // First, so that a client that has the frame finds its text here.
                follow(frame, received);
                clients.send(bytes);
            }),
            Err(error) if is_a_pause(&error) => {}
            Err(_) => break,
        }
        // Bytes that find no room are lost; a line that is gone shows at the next read.
        clients.receive(|datagram| drop(line.write_all(datagram)));
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

/// Cuts a stream into frames of version 2, bytes and all; other bytes are left out.
struct Frames {
    parser: Parser,
    /// The bytes since the last frame's end, or the newest of them.
    bytes: Vec<u8>,
}

impl Default for Frames {
    fn default() -> Self {
        Self { parser: Parser::new(), bytes: Vec::new() }
    }
}

impl Frames {
    fn take(&mut self, stream: &[u8], mut act: impl FnMut(&[u8], &Frame<'_>)) {
        for &byte in stream {
            self.bytes.push(byte);
            // Time does not matter here: a stream neither loses nor ages anything.
            let Some(frame) = self.parser.push(byte, 0).filter(|frame| frame.version == Version::V2) else { continue };
            // A frame is complete with its last byte, and nothing of it is signed.
            let begin = self.bytes.len().checked_sub(frame.payload.len() + AROUND);
            if let Some(bytes) = begin.and_then(|begin| self.bytes.get(begin..)) {
                act(bytes, &frame);
            }
            self.bytes.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::{Ipv4Addr, TcpListener, UdpSocket};
    use std::time::Instant;

    const LONG: Duration = Duration::from_secs(10);

    fn frame(sequence: u8, message: &impl MessageData) -> Vec<u8> {
        let mut frame = mavlink::MAVLinkV2MessageRaw::new();
        frame.serialize_message_data(mavlink::MavHeader { system_id: 1, component_id: 1, sequence }, message);
        frame.raw_bytes().to_vec()
    }

    fn client() -> (UdpSocket, u16) {
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        socket.set_read_timeout(Some(LONG)).unwrap();
        let port = socket.local_addr().unwrap().port();
        (socket, port)
    }

    #[test]
    fn a_stream_with_noise_comes_out_as_its_frames() {
        let (one, two) = (frame(1, &HEARTBEAT_DATA::default()), frame(2, &STATUSTEXT_DATA::default()));
        let stream = [&[7, 7, 7][..], &one, &two, &[1, 2, 3], &one].concat();
        for pieces in [1, 7, stream.len()] {
            let (mut frames, mut found) = (Frames::default(), Vec::new());
            stream.chunks(pieces).for_each(|piece| frames.take(piece, |bytes, _| found.push(bytes.to_vec())));
            assert_eq!(found, [one.clone(), two.clone(), one.clone()], "{pieces} at once");
        }
    }

    #[test]
    fn clients_and_the_line_receive_each_others_frames_and_texts_are_kept() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let ((offboard, first), (ground, second)) = (client(), client());
        let local = client().1;
        let ports = Ports { offboard: first, ground: second, local };
        let relay = Relay::open(&address, &ports, LONG, &Interrupt::default()).unwrap();
        let mut board = listener.accept().unwrap().0;
        board.set_read_timeout(Some(LONG)).unwrap();

        let state = HEARTBEAT_DATA { system_status: MavState::MAV_STATE_STANDBY, ..Default::default() };
        let said = STATUSTEXT_DATA { text: "Armed: idling".into(), ..Default::default() };
        let (state, said) = (frame(1, &state), frame(2, &said));
        board.write_all(&[&state[..], &said].concat()).unwrap();
        for socket in [&offboard, &ground] {
            for expected in [&state, &said] {
                let mut datagram = [0; 300];
                let length = socket.recv(&mut datagram).unwrap();
                assert_eq!(&datagram[..length], &expected[..]);
            }
        }
        assert_eq!((relay.state(), relay.texts(), relay.texts()), ("ready", vec!["Armed: idling".to_owned()], vec![]));

        offboard.send_to(b"a command", (Ipv4Addr::LOCALHOST, local)).unwrap();
        let mut bytes = [0; 9];
        board.read_exact(&mut bytes).unwrap();
        assert_eq!(&bytes, b"a command");
        let started = Instant::now();
        drop(relay);
        assert!(started.elapsed() < LONG);
        assert_eq!(board.read(&mut bytes).unwrap(), 0);
    }
}
