//! What answers packets: the link's echo, port 15, channel 0.

use super::packet::{ReceivePackets, SendPackets};
use crate::hardware::Clock;
use embassy_futures::select::select;

/// The link's own port, and its channel of echoes.
const LINK_PORT: u8 = 15;
const ECHO_CHANNEL: u8 = 0;

/// The longest wait for the line.
const SEND_TIMEOUT_US: u64 = 100_000;

/// Answers for ever.
pub async fn run<R: ReceivePackets, S: SendPackets>(mut receiver: R, mut sender: S, clock: &impl Clock) -> ! {
    loop {
        let packet = receiver.receive().await;
        if (packet.port, packet.channel) == (LINK_PORT, ECHO_CHANNEL) {
            let end = clock.now().saturating_add(SEND_TIMEOUT_US);
            select(sender.send(&packet), clock.until(end)).await;
        }
    }
}
