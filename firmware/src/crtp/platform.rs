//! What the vehicle is, and whether it is there.
//!
//! | port, channel | question | answer |
//! |---|---|---|
//! | 15, 0 | anything | the same |
//! | 15, 1 | anything | the words by which clients know that versions can be asked for |
//! | 13, 1 | 0 | 0, the protocol's version (4 bytes) |
//! | 13, 1 | 1 | 1, the firmware's version in words |
//! | 13, 1 | 2 | 2, the device's name in words |

use super::packet::Packet;
use super::ports;

/// The version of the protocol: the first with a port for the supervisor.
const PROTOCOL_VERSION: u32 = 12;

/// What vehicles of this protocol say to a client that asks who is there.
const GREETING: &[u8] = b"Bitcraze Crazyflie";

/// What clients call the device: a Bolt 1.1.
const DEVICE_NAME: &[u8] = b"CB11";

/// The answer to a question about the link or the platform's versions.
pub fn answer(question: &Packet) -> Option<Packet> {
    let answer = Packet::new(question.port, question.channel);
    match (question.port, question.channel) {
        (ports::LINK, 0) => Some(question.clone()),
        (ports::LINK, 1) => Some(answer.with(GREETING)),
        (ports::PLATFORM, 1) => {
            let &command = question.data().first()?;
            let answer = answer.with(&[command]);
            Some(match command {
                0 => answer.with(&PROTOCOL_VERSION.to_le_bytes()),
                1 => answer.with(env!("CARGO_PKG_VERSION").as_bytes()),
                2 => answer.with(DEVICE_NAME),
                _ => return None,
            })
        }
        _ => None,
    }
}
