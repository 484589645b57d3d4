//! What frames say.

use super::frame::Frame;
use crate::crtp::packet::Packet;

/// Kinds of frames.
pub mod kind {
    /// A packet of the vehicle's own address.
    pub const PACKET: u8 = 0x00;
    /// The channel.
    pub const CHANNEL: u8 = 0x01;
    /// The data rate.
    pub const DATA_RATE: u8 = 0x02;
    /// A bare carrier.
    pub const CARRIER: u8 = 0x03;
    /// How strong the last packet was.
    pub const STRENGTH: u8 = 0x04;
    /// The address.
    pub const ADDRESS: u8 = 0x05;
    /// A packet of everybody's address.
    pub const BROADCAST: u8 = 0x06;
    /// This side is ready.
    pub const READY: u8 = 0x0B;
    /// The battery.
    pub const BATTERY: u8 = 0x13;
    /// Battery and strength are asked for.
    pub const REPORTS: u8 = 0x14;
    /// The button was pressed.
    pub const SWITCHING_OFF: u8 = 0x15;
    /// Power may go.
    pub const MAY_SWITCH_OFF: u8 = 0x16;
}

/// What the chip says.
#[derive(Debug, Clone, PartialEq)]
pub enum Received {
    /// A packet came over the radio, and one may be sent. None where it was empty or too long for one.
    Packet(Option<Packet>),
    /// A packet for everybody came over the radio.
    Broadcast(Packet),
    /// A setting, as the chip has it now.
    Setting(Frame),
    /// How strong the last packet was, dBm.
    Strength(i16),
    /// The battery, V.
    Battery(f32),
    /// Power goes.
    SwitchingOff,
}

impl Received {
    /// What a frame says; none for one that says nothing here.
    pub fn from_frame(frame: Frame) -> Option<Self> {
        match (frame.kind, frame.data()) {
            (kind::PACKET, data) => Some(Self::Packet(Packet::from_bytes(data))),
            (kind::BROADCAST, data) => Packet::from_bytes(data).map(Self::Broadcast),
            (kind::CHANNEL | kind::DATA_RATE | kind::CARRIER | kind::ADDRESS, _) => Some(Self::Setting(frame)),
            (kind::STRENGTH, &[below_zero, ..]) => Some(Self::Strength(-i16::from(below_zero))),
            (kind::BATTERY, data) => battery(data).map(Self::Battery),
            (kind::SWITCHING_OFF, _) => Some(Self::SwitchingOff),
            _ => None,
        }
    }
}

/// Volts, behind the byte of flags.
fn battery(data: &[u8]) -> Option<f32> {
    let (volts, _) = data.get(1..)?.split_first_chunk()?;
    Some(f32::from_le_bytes(*volts)).filter(|volts| volts.is_finite() && *volts >= 0.0)
}

/// The frame that has a packet sent.
pub fn packet(packet: &Packet) -> Option<Frame> {
    Frame::new(kind::PACKET, &packet.to_bytes())
}
