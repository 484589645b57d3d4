//! Memories that a client reads and writes: one for trajectories. The vehicle carries no deck and no lighthouse.
//!
//! | channel | question | answer |
//! |---|---|---|
//! | 0 | 1 | 1, how many there are |
//! | 0 | 2, memory | 2, memory, kind, bytes (4), serial number (8); without the rest if there is none |
//! | 1 | memory, address (4), count | memory, address, error or 0, bytes |
//! | 2 | memory, address (4), bytes | memory, address, error or 0 |

use super::errors::{BUSY, FAILED};
use super::fields::Fields;
use super::packet::{DATA_MAX_BYTES, Packet};
use super::pieces::Pieces;
use super::ports;

/// The memory of trajectories: its number, and its kind.
const TRAJECTORIES: u8 = 0;
const KIND_TRAJECTORIES: u8 = 0x12;

/// The channel on which a client writes.
pub const WRITE: u8 = 2;

/// Bytes beside the data of an answer.
const ANSWER_HEAD_BYTES: usize = 6;

/// The answer to a packet. Nothing is written while `is_flown`, nor where a client may not write.
pub fn answer(packet: &Packet, pieces: &mut Pieces<'_>, is_flown: bool, may_write: bool) -> Option<Packet> {
    let mut fields = Fields::new(packet.data());
    let first = fields.u8()?;
    let answer = Packet::new(ports::MEMORY, packet.channel).with(&[first]);
    match packet.channel {
        0 => match first {
            1 => Some(answer.with(&[1])),
            2 => {
                let memory = fields.u8()?;
                let answer = answer.with(&[memory]);
                let described = [KIND_TRAJECTORIES];
                let size = pieces.size().to_le_bytes();
                Some(if memory == TRAJECTORIES { answer.with(&described).with(&size).with(&[0; 8]) } else { answer })
            }
            _ => None,
        },
        1 => {
            let address = fields.u32()?;
            let count = fields.u8()?;
            let answer = answer.with(&address.to_le_bytes());
            let fits = usize::from(count) <= DATA_MAX_BYTES - ANSWER_HEAD_BYTES && first == TRAJECTORIES;
            let bytes = pieces.read(address as usize, count.into()).filter(|_| fits);
            Some(match bytes {
                Some(bytes) => answer.with(&[0]).with(bytes),
                None => answer.with(&[FAILED]),
            })
        }
        WRITE => {
            let address = fields.u32()?;
            let answer = answer.with(&address.to_le_bytes());
            let error = if is_flown {
                BUSY
            } else if may_write && first == TRAJECTORIES && pieces.write(address as usize, fields.rest()) {
                0
            } else {
                FAILED
            };
            Some(answer.with(&[error]))
        }
        _ => None,
    }
}
