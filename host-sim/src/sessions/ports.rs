//! The clients: MAVLink over UDP on this machine's loopback, whole frames in each datagram.
//!
//! Each datagram is parsed by itself. What it leaves unfinished is dropped, and so is whatever is no frame: nothing
//! that one client sends can swallow a frame of another's.
//!
//! Every frame goes to two fixed addresses, and to each other client that has sent within the last `CLIENT_TIMEOUT`.
//! Nothing from outside this machine gets in.

use firmware::link::frame::Parser;
use std::fmt;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

/// How long after its last datagram a client still gets frames.
const CLIENT_TIMEOUT: Duration = Duration::from_secs(10);

/// Beside the two addresses.
const CLIENTS_MAX: usize = 8;

/// A flood must not stop time.
const DATAGRAMS_AT_ONCE_MAX: usize = 64;

/// The ports, all on 127.0.0.1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ports {
    /// Where a companion computer's software listens.
    pub offboard: u16,
    /// Where a ground station listens.
    pub ground: u16,
    /// From which all is sent.
    pub local: u16,
}

/// PX4's, by which clients know a simulated vehicle.
impl Default for Ports {
    fn default() -> Self {
        Self { offboard: 14540, ground: 14550, local: 14580 }
    }
}

/// The local port cannot be had.
#[derive(Debug)]
pub struct PortTaken(u16, io::Error);

impl fmt::Display for PortTaken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(port, error) = self;
        write!(f, "--local-port {port}: cannot be used: {error}")?;
        if error.kind() == io::ErrorKind::AddrInUse {
            write!(f, "; end the other program that has it, perhaps another sitl, or choose another port")?;
        }
        Ok(())
    }
}

/// The socket and the clients' addresses.
#[derive(Debug)]
pub struct ClientPort {
    socket: UdpSocket,
    fixed: [SocketAddr; 2],
    /// The others, and when each last sent.
    clients: Vec<(SocketAddr, Instant)>,
}

impl ClientPort {
    /// Opens the local port.
    ///
    /// # Errors
    /// [`PortTaken`].
    pub fn open(ports: &Ports) -> Result<Self, PortTaken> {
        let here = |port| SocketAddr::from((Ipv4Addr::LOCALHOST, port));
        let open = || {
            let socket = UdpSocket::bind(here(ports.local))?;
            socket.set_nonblocking(true)?;
            Ok(socket)
        };
        let socket = open().map_err(|error| PortTaken(ports.local, error))?;
        Ok(Self { socket, fixed: [here(ports.offboard), here(ports.ground)], clients: Vec::new() })
    }

    /// Hands over the frames that have come, one by one.
    pub fn receive(&mut self, mut take: impl FnMut(&[u8])) {
        let mut datagram = [0; 65_536];
        for _ in 0..DATAGRAMS_AT_ONCE_MAX {
            match self.socket.recv_from(&mut datagram) {
                Ok((length, from)) => {
                    self.remember(from);
                    Parser::new().feed(&datagram[..length], 0, &mut |frame| take(frame.bytes));
                }
                // An address without a listener shows as an error of the next call that receives.
                Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {}
                Err(_) => break,
            }
        }
    }

    /// Sends one frame to every address. What does not go out is lost, as on any radio.
    pub fn send(&mut self, frame: &[u8]) {
        self.clients.retain(|(_, last)| last.elapsed() < CLIENT_TIMEOUT);
        let others = self.clients.iter().map(|(address, _)| *address);
        for address in self.fixed.into_iter().chain(others) {
            let _ = self.socket.send_to(frame, address);
        }
    }

    fn remember(&mut self, from: SocketAddr) {
        let now = Instant::now();
        if let Some((_, last)) = self.clients.iter_mut().find(|(address, _)| *address == from) {
            *last = now;
        } else if !self.fixed.contains(&from) && self.clients.len() < CLIENTS_MAX {
            self.clients.push((from, now));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavlink::dialects::common::HEARTBEAT_DATA;
    use mavlink::{MAVLinkV2MessageRaw, MavHeader};

    /// A socket on a port that the system chooses.
    fn client() -> (UdpSocket, u16) {
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        socket.set_read_timeout(Some(Duration::from_secs(2))).unwrap();
        let port = socket.local_addr().unwrap().port();
        (socket, port)
    }

    fn received(socket: &UdpSocket) -> Vec<u8> {
        let mut datagram = [0; 64];
        let length = socket.recv(&mut datagram).unwrap();
        datagram[..length].to_vec()
    }

    fn heartbeat(sequence: u8) -> Vec<u8> {
        let mut frame = MAVLinkV2MessageRaw::new();
        let header = MavHeader { system_id: 255, component_id: 190, sequence };
        frame.serialize_message_data(header, &HEARTBEAT_DATA::DEFAULT);
        frame.raw_bytes().to_vec()
    }

    /// What has arrived at the port.
    fn taken(port: &mut ClientPort) -> Vec<Vec<u8>> {
        std::thread::sleep(Duration::from_millis(50));
        let mut frames = Vec::new();
        port.receive(|frame| frames.push(frame.to_vec()));
        frames
    }

    #[test]
    fn fragments_and_noise_swallow_no_frame_of_another_client_nor_of_the_same() {
        let ((good, _), (bad, _)) = (client(), client());
        let mut port = ClientPort::open(&Ports { local: 0, ..Ports::default() }).unwrap();
        let address = port.socket.local_addr().unwrap();
        let frames: Vec<Vec<u8>> = (0..20).map(heartbeat).collect();
        let longest = [0xFD, 0xFF, 0, 0, 0, 255, 190, 0, 0, 0];
        for frame in &frames {
            for fragment in [&frame[..10], &frame[10..], &longest, &[0xFE; 3], &[0; 7]] {
                bad.send_to(fragment, address).unwrap();
                good.send_to(fragment, address).unwrap();
            }
            good.send_to(frame, address).unwrap();
        }
        let first = taken(&mut port);
        let all: Vec<Vec<u8>> = first.into_iter().chain((0..4).flat_map(|_| taken(&mut port))).collect();
        assert_eq!(all, frames);
        // Several to a datagram, with something else before and behind.
        good.send_to(&[&frames[0][..], &frames[1], &frames[2][..9]].concat(), address).unwrap();
        assert_eq!(taken(&mut port), frames[..2]);
    }

    #[test]
    fn both_addresses_receive_everything_and_each_sender_is_answered() {
        let ((offboard, first), (ground, second), (other, _)) = (client(), client(), client());
        let mut port = ClientPort::open(&Ports { offboard: first, ground: second, local: 0 }).unwrap();
        port.send(b"one");
        assert_eq!((received(&offboard), received(&ground)), (b"one".to_vec(), b"one".to_vec()));
        let here = heartbeat(0);
        other.send_to(&here, port.socket.local_addr().unwrap()).unwrap();
        assert_eq!(taken(&mut port), [here]);
        port.send(b"two");
        assert_eq!((received(&other), received(&ground)), (b"two".to_vec(), b"two".to_vec()));
    }

    #[test]
    fn a_port_that_is_taken_is_named_with_a_way_out() {
        let (_taken, local) = client();
        let refused = ClientPort::open(&Ports { local, ..Ports::default() }).unwrap_err().to_string();
        assert!(
            refused.starts_with(&format!("--local-port {local}: ")) && refused.contains("choose another"),
            "{refused}"
        );
    }
}
