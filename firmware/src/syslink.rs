//! Syslink: the line to a radio chip that carries [packets](crate::crtp::packet) and measures the battery, as the
//! nRF51822 of a Crazyflie Bolt does. 1,000,000 baud, eight bits, no parity, one stop bit.
//!
//! A frame:
//!
//! | byte | holds |
//! |---|---|
//! | 0, 1 | 0xBC, 0xCF |
//! | 2 | its kind |
//! | 3 | how many bytes of data follow, at most 64 |
//! | 4 on | the data |
//! | last two | the sums of RFC 1146 (Fletcher's, modulo 256) over kind, length and data |
//!
//! The kinds that are used:
//!
//! | kind | what | from the chip | to the chip |
//! |---|---|---|---|
//! | 0x00 | a packet of the vehicle's own address | one came: one may be sent | one to send |
//! | 0x01 | the channel, MHz above 2,400 | confirmed | set |
//! | 0x02 | the data rate: 0 250 kbit/s, 1 1 Mbit/s, 2 2 Mbit/s | confirmed | set |
//! | 0x03 | a bare carrier, for tests: 0 off | confirmed | off |
//! | 0x04 | how strong the last packet was, -dBm | 100 times a second | |
//! | 0x05 | the address, five bytes, the last one first | confirmed | set |
//! | 0x06 | a packet of everybody's address | one came | |
//! | 0x0B | this side is ready, and the radio may begin; else it does after 3 s | confirmed, by newer chips | said |
//! | 0x13 | the battery: flags, volts, charging current, as a byte and floats | 100 times a second | |
//! | 0x14 | send 0x04 and 0x13 from now on | | asked |
//! | 0x15 | the button was pressed: power goes, after 1 s at the latest | said | |
//! | 0x16 | it may go | | said |
//!
//! - The chip says nothing before it has understood a frame.
//! - It has room for few packets and tells nobody that it dropped one: one is sent for each that came, no more.
//! - Its receiver holds six bytes. A pin is high while there is room for no more than four of them, and what is sent
//!   then may be lost. See [`mod@transmit`].
//! - What it is told at boot it forgets with its power only, which is this chip's power too: see [`boot_order`].
//!
//! The line's task is not the one that answers packets: a task that waits until it may send must go on receiving, since
//! what it receives is what lets it send. So [`Wire`] is between them. Without a chip, or with one that falls silent,
//! nothing else of the vehicle waits or changes.

pub mod battery;
pub mod boot_order;
pub mod frame;
pub mod message;
pub mod parser;
pub mod receive;
pub mod transmit;
pub mod wire;

pub use wire::Wire;

use crate::hardware::Clock;
use crate::shared::PacketRadioView;
use boot_order::Settings;
use embassy_futures::join::join;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_hal_async::digital::Wait;
use embedded_io_async::{Read, Write};
use receive::receive;
use transmit::{Transmitter, transmit};

/// Receives and sends for ever. `stop` is high while the chip takes no bytes.
pub async fn run<R: Read, W: Write, P: Wait, C: Clock, M: RawMutex>(
    line: (R, W),
    stop: P,
    clock: &C,
    wire: &Wire<M>,
    shared: PacketRadioView<'_, M>,
) -> ! {
    let settings = Settings::from_parameters(|name| shared.parameters().get(name));
    let transmitter = Transmitter::new(line.1, stop, clock);
    let (never, _) = join(receive(line.0, clock, wire), transmit(transmitter, clock, wire, settings, shared)).await;
    never
}
