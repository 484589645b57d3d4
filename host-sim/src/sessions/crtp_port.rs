//! Clients that speak CRTP: a packet in each datagram, as cflib's driver for simulations has it.
//!
//! One client at a time. Another one is heard once the first has been silent for `CLIENT_TIMEOUT`, or at once where it
//! asks what clients ask first, what the vehicle is: that begins a connection. A datagram of one byte without meaning,
//! with which clients look for vehicles, is answered where it came from, and the client that there is stays. What is no
//! packet is dropped.

use firmware::crtp::packet::{DATA_MAX_BYTES, Packet, ReceivePackets, SendPackets};
use firmware::crtp::ports;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::future::poll_fn;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::rc::Rc;
use std::task::{Poll, Waker};
use std::time::{Duration, Instant};

/// The address at which cflib looks first; it looks at nine more ports behind it.
pub const DEFAULT_ADDRESS: &str = "127.0.0.1:19850";

/// What a client sends that looks for vehicles.
const PROBE: [u8; 1] = [0xFF];

/// How long a client is silent until another is heard.
const CLIENT_TIMEOUT: Duration = Duration::from_secs(1);

/// A flood must not stop time.
const DATAGRAMS_AT_ONCE_MAX: usize = 64;

/// Packets that wait for the vehicle; what finds no room is lost, as in a socket.
const WAITING_MAX: usize = 256;

/// Where clients find a vehicle; clones are the same port.
#[derive(Debug, Clone)]
pub struct CrtpPort(Rc<RefCell<Inner>>);

#[derive(Debug)]
struct Inner {
    socket: UdpSocket,
    /// The client, and when it last sent.
    client: Option<(SocketAddr, Instant)>,
    waiting: VecDeque<Packet>,
    reader: Option<Waker>,
    /// Whether nothing gets through.
    is_silent: bool,
}

impl CrtpPort {
    /// Opens it.
    ///
    /// # Errors
    /// In words, if the address cannot be used.
    pub fn open(address: SocketAddr) -> Result<Self, String> {
        let open = || {
            let socket = UdpSocket::bind(address)?;
            socket.set_nonblocking(true)?;
            Ok(socket)
        };
        let socket = open().map_err(|error: io::Error| {
            let advice = match error.kind() {
                io::ErrorKind::AddrInUse => {
                    "; end the other program that has it, perhaps another sitl, or choose another port"
                }
                _ => "",
            };
            format!("--crtp {address}: cannot be used: {error}{advice}")
        })?;
        let waiting = VecDeque::new();
        Ok(Self(Rc::new(RefCell::new(Inner { socket, client: None, waiting, reader: None, is_silent: false }))))
    }

    /// Takes what clients have sent; drops it, and what the vehicle sends from now on, where nothing `is_silent`.
    pub fn receive(&self, is_silent: bool) {
        let mut inner = self.0.borrow_mut();
        inner.is_silent = is_silent;
        // One more than a packet has: what is longer is none.
        let mut datagram = [0; DATA_MAX_BYTES + 2];
        for _ in 0..DATAGRAMS_AT_ONCE_MAX {
            match inner.socket.recv_from(&mut datagram) {
                Ok((count, from)) if datagram[..count] == PROBE && !is_silent => {
                    let _ = inner.socket.send_to(&PROBE, from);
                }
                Ok((count, from)) => {
                    let packet = Packet::from_bytes(&datagram[..count]).filter(|_| !is_silent);
                    if let Some(packet) = packet.filter(|packet| inner.hears(packet, from)) {
                        inner.client = Some((from, Instant::now()));
                        inner.waiting.push_back(packet);
                    }
                }
                // An address without a listener shows as an error of the next call that receives.
                Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {}
                Err(_) => break,
            }
        }
        if !inner.waiting.is_empty() {
            inner.reader.take().into_iter().for_each(Waker::wake);
        }
    }
}

impl Inner {
    /// Whether a packet from an address is the client's, or begins a connection; and whether there is room for it.
    fn hears(&self, packet: &Packet, from: SocketAddr) -> bool {
        let begins = matches!((packet.port, packet.channel), (ports::LINK, 1) | (ports::PLATFORM, 1));
        let is_free = self.client.is_none_or(|(client, last)| client == from || last.elapsed() > CLIENT_TIMEOUT);
        (is_free || begins) && self.waiting.len() < WAITING_MAX
    }
}

impl ReceivePackets for CrtpPort {
    async fn receive(&mut self) -> Packet {
        poll_fn(|context| {
            let mut inner = self.0.borrow_mut();
            match inner.waiting.pop_front() {
                Some(packet) => Poll::Ready(packet),
                None => {
                    inner.reader = Some(context.waker().clone());
                    Poll::Pending
                }
            }
        })
        .await
    }
}

impl SendPackets for CrtpPort {
    async fn send(&mut self, packet: &Packet) {
        let inner = self.0.borrow();
        if let Some((client, _)) = inner.client.filter(|_| !inner.is_silent) {
            // What does not go out is lost, as on any radio.
            let _ = inner.socket.send_to(&packet.to_bytes(), client);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures::FutureExt;
    use std::net::Ipv4Addr;

    /// A client on a port that the system chooses.
    fn client() -> UdpSocket {
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        socket.set_read_timeout(Some(Duration::from_secs(2))).unwrap();
        socket
    }

    fn port() -> (CrtpPort, SocketAddr) {
        let port = CrtpPort::open((Ipv4Addr::LOCALHOST, 0).into()).unwrap();
        let address = port.0.borrow().socket.local_addr().unwrap();
        (port, address)
    }

    /// The packets that have come.
    fn taken(port: &mut CrtpPort) -> Vec<Packet> {
        std::thread::sleep(Duration::from_millis(50));
        CrtpPort::receive(port, false);
        std::iter::from_fn(|| ReceivePackets::receive(port).now_or_never()).collect()
    }

    fn received(client: &UdpSocket) -> Vec<u8> {
        let mut datagram = [0; 64];
        let count = client.recv(&mut datagram).unwrap();
        datagram[..count].to_vec()
    }

    #[test]
    fn a_probe_is_answered_where_it_came_from_and_the_client_stays() {
        let ((mut port, address), pilot, scanner) = (port(), client(), client());
        pilot.send_to(&[0xF0, 7], address).unwrap();
        assert_eq!(taken(&mut port), [Packet::new(15, 0).with(&[7])]);
        scanner.send_to(&PROBE, address).unwrap();
        assert_eq!(taken(&mut port), []);
        assert_eq!(received(&scanner), PROBE);
        port.send(&Packet::new(15, 0).with(&[8])).now_or_never().unwrap();
        assert_eq!(received(&pilot), [0xFC, 8]);
    }

    #[test]
    fn what_is_no_packet_is_dropped_and_the_next_client_takes_over_by_asking_who_is_there() {
        let ((mut port, address), first, second) = (port(), client(), client());
        first.send_to(&[0x20; 32], address).unwrap();
        first.send_to(&[], address).unwrap();
        first.send_to(&[0x20; 31], address).unwrap();
        assert_eq!(taken(&mut port), [Packet::new(2, 0).with(&[0x20; 30])]);
        second.send_to(&[0x50], address).unwrap();
        assert_eq!(taken(&mut port), []);
        second.send_to(&[0xF1], address).unwrap();
        second.send_to(&[0x50], address).unwrap();
        assert_eq!(taken(&mut port), [Packet::new(15, 1), Packet::new(5, 0)]);
        port.send(&Packet::new(5, 0)).now_or_never().unwrap();
        assert_eq!(received(&second), [0x5C]);
        // And without a word, once it has been silent.
        std::thread::sleep(CLIENT_TIMEOUT);
        first.send_to(&[0x50], address).unwrap();
        assert_eq!(taken(&mut port), [Packet::new(5, 0)]);
    }

    #[test]
    fn an_address_that_is_taken_is_named_with_a_way_out() {
        let (_taken, address) = port();
        let refused = CrtpPort::open(address).unwrap_err();
        assert!(refused.starts_with(&format!("--crtp {address}: ")) && refused.contains("choose another"), "{refused}");
    }
}
