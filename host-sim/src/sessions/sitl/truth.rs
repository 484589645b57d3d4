//! Where the vehicle really is, for a bridge that is tried on it: 100 lines of JSON a second, a datagram each.
//!
//! ```text
//! {"t":1760000012.34,"position":[1.0,0.0,0.5],"quaternion":[1.0,0.0,0.0,0.0]}
//! ```
//!
//! The time is this machine's, s since 1970, as a motion capture on it would stamp what it sees. Metres and a
//! quaternion of body to world, scalar first, both with z up: x east, y north; x ahead, y left.

use scenario::body::BodyState;
use std::net::{Ipv4Addr, UdpSocket};

const LINE_PERIOD_US: u64 = 10_000;

/// The socket, and when the next is due, us.
pub struct Truth {
    socket: UdpSocket,
    port: u16,
    due: u64,
}

impl Truth {
    /// For a listener at a port of this machine, which need not be there.
    ///
    /// # Errors
    /// In words.
    pub fn open(port: u16) -> Result<Self, String> {
        if port == 0 {
            return Err("--truth-port: must be from 1 to 65535, found 0".to_owned());
        }
        let open = || UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).and_then(|it| it.set_nonblocking(true).map(|()| it));
        let socket = open().map_err(|error| format!("--truth-port {port}: cannot be used: {error}"))?;
        Ok(Self { socket, port, due: 0 })
    }

    /// When the next line is due, us.
    pub fn due(&self) -> u64 {
        self.due
    }

    /// Sends a line of the vehicle at `now`, us, if one is due; by the desk's clock that is `desk_time`, s.
    pub fn write_when_due(&mut self, now: u64, desk_time: f64, state: &BodyState) {
        if now < self.due {
            return;
        }
        self.due = now - now % LINE_PERIOD_US + LINE_PERIOD_US;
        let [x, y, z] = <[f64; 3]>::from(state.position);
        let q = state.attitude;
        let line = format!(
            "{{\"t\":{desk_time:.6},\"position\":[{x},{y},{z}],\"quaternion\":[{},{},{},{}]}}",
            q.w, q.i, q.j, q.k
        );
        // There may be no listener.
        let _ = self.socket.send_to(line.as_bytes(), (Ipv4Addr::LOCALHOST, self.port));
    }
}
