//! MAVLink's file transfer: there are no files here, and a request is refused at once so that its client does not
//! retry.
//!
//! A request and its answer are FILE_TRANSFER_PROTOCOL, whose payload has a header of its own:
//!
//! | bytes | what |
//! |---|---|
//! | 0, 1 | sequence number; an answer's is the request's and one |
//! | 2 | session |
//! | 3 | operation; an answer's is success or failure |
//! | 4 | bytes of data |
//! | 5 | in an answer: the requested operation |
//! | 12 … | data; in a refusal: why |

use super::frame::Frame;
use mavlink::dialects::common::{FILE_TRANSFER_PROTOCOL_DATA, MavMessage};
use mavlink::error::ParserError;
use mavlink::{MavlinkVersion, MessageData};

/// The message's own fields before that header: network, system, component.
const FIELDS_BYTES: usize = 3;

/// Operations from here on are answers.
const FIRST_ANSWER: u8 = 128;
/// An answer: it did not go well.
const NEGATIVE_ANSWER: u8 = 129;
/// Why: no such operation here.
const UNKNOWN_OPERATION: u8 = 7;

/// A request, and the fields of its answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileRequest {
    /// The client: system and component.
    pub sender: (u8, u8),
    /// The sequence number of the request.
    pub sequence: u16,
    /// Its session.
    pub session: u8,
    /// The requested operation.
    pub operation: u8,
}

impl FileRequest {
    /// The request in a FILE_TRANSFER_PROTOCOL, with whom it is for: system, component. None if it is an answer, which
    /// must not be answered.
    pub fn read(frame: &Frame<'_>) -> Option<(Self, [u8; 2])> {
        // Zeros at the end are cut off.
        let byte = |place: usize| frame.payload.get(place).copied().unwrap_or(0);
        let sequence = u16::from_le_bytes([byte(FIELDS_BYTES), byte(FIELDS_BYTES + 1)]);
        let (session, operation) = (byte(FIELDS_BYTES + 2), byte(FIELDS_BYTES + 3));
        let sender = (frame.header.system, frame.header.component);
        let request = Self { sender, sequence, session, operation };
        (operation < FIRST_ANSWER).then_some((request, [byte(1), byte(2)]))
    }
}

/// The answer to a request: no.
#[derive(Debug, Clone, PartialEq)]
pub struct NoFiles(pub FileRequest);

impl MessageData for NoFiles {
    type Message = MavMessage;
    const ID: u32 = FILE_TRANSFER_PROTOCOL_DATA::ID;
    const NAME: &'static str = FILE_TRANSFER_PROTOCOL_DATA::NAME;
    const EXTRA_CRC: u8 = FILE_TRANSFER_PROTOCOL_DATA::EXTRA_CRC;
    const ENCODED_LEN: usize = FILE_TRANSFER_PROTOCOL_DATA::ENCODED_LEN;

    fn ser(&self, _: MavlinkVersion, payload: &mut [u8]) -> usize {
        let FileRequest { sender: (system, component), sequence, session, operation } = self.0;
        let [low, high] = sequence.wrapping_add(1).to_le_bytes();
        let header = [low, high, session, NEGATIVE_ANSWER, 1, operation, 0, 0, 0, 0, 0, 0];
        let bytes = [0, system, component].into_iter().chain(header).chain([UNKNOWN_OPERATION]);
        payload.iter_mut().zip(bytes).map(|(place, byte)| *place = byte).count()
    }

    /// It is sent and never read.
    fn deser(_: MavlinkVersion, _: &[u8]) -> Result<Self, ParserError> {
        Err(ParserError::UnknownMessage { id: Self::ID })
    }
}
