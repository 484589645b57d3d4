//! Tables of contents: what there is to log and to set, by numbers that a client learns once.
//!
//! | question | answer |
//! |---|---|
//! | 3 | 3, how many there are (2 bytes), CRC-32 of all that follows from asking for each (4 bytes) |
//! | 2, number (2 bytes) | 2, number, kind (1 byte), group, 0, name, 0; without the number, and what follows it, if there is none |
//!
//! A client that has met a table of that CRC asks for nothing else: as long as one byte of it changes, so does the CRC.

use super::fields::Fields;
use super::packet::Packet;
use crc::{CRC_32_ISO_HDLC, Crc, Table};

/// The commands of the second version of the protocol; the first has numbers of one byte and is not spoken any more.
const ITEM: u8 = 2;
const INFORMATION: u8 = 3;

const CHECKSUM: Crc<u32, Table<0>> = Crc::<u32, Table<0>>::new(&CRC_32_ISO_HDLC);

/// An entry: its kind, its group and its name.
pub type Entry = (u8, &'static str, &'static str);

/// Something with such a table.
pub trait Contents {
    /// How many entries there are.
    const COUNT: usize;

    /// What follows the checksum, about the room there is.
    const ROOM: &'static [u8];

    /// One of them.
    fn entry(index: usize) -> Option<Entry>;
}

/// The answer to a question about the contents, on the same port and channel; none to what is no question.
pub fn answer<C: Contents>(question: &Packet) -> Option<Packet> {
    let mut fields = Fields::new(question.data());
    let answer = Packet::new(question.port, question.channel);
    match fields.u8()? {
        INFORMATION => {
            let count = (C::COUNT as u16).to_le_bytes();
            let checksum = checksum::<C>().to_le_bytes();
            Some(answer.with(&[INFORMATION]).with(&count).with(&checksum).with(C::ROOM))
        }
        ITEM => {
            let number = fields.u16()?;
            let Some(entry) = C::entry(number.into()) else { return Some(answer.with(&[ITEM])) };
            Some(with_entry(answer.with(&[ITEM]).with(&number.to_le_bytes()), entry))
        }
        _ => None,
    }
}

/// An entry as it is sent.
fn with_entry(packet: Packet, (kind, group, name): Entry) -> Packet {
    packet.with(&[kind]).with(group.as_bytes()).with(&[0]).with(name.as_bytes()).with(&[0])
}

/// Of every entry as it is sent.
fn checksum<C: Contents>() -> u32 {
    let mut digest = CHECKSUM.digest();
    for entry in (0..C::COUNT).filter_map(C::entry) {
        digest.update(with_entry(Packet::new(0, 0), entry).data());
    }
    digest.finalize()
}
