//! The task: packets in, packets out, and the vehicle led along a command's path.
//!
//! Two halves share the session, so that a line that takes nothing does not keep poses from coming in.

use super::packet::{ReceivePackets, SendPackets};
use super::session::Session;
use crate::deadline::within;
use crate::hardware::Clock;
use crate::shared::CrtpView;
use core::cell::RefCell;
use embassy_futures::join::join;
use embassy_futures::select::select;
use embassy_sync::blocking_mutex::raw::{NoopRawMutex, RawMutex};
use embassy_sync::signal::Signal;

/// The longest a packet may take to be sent.
pub const SEND_TIMEOUT_US: u64 = 100_000;

/// The longest wait for a packet, or for room for its answer. Nothing hangs on it: it keeps the wait a bounded one.
const WAIT_MAX_US: u64 = 1_000_000;

/// Speaks to one client at a time, for ever. Its trajectories are uploaded to `memory`, of
/// [`MEMORY_BYTES`](super::pieces::MEMORY_BYTES) where there is room.
pub async fn run<R: ReceivePackets, S: SendPackets, M: RawMutex>(
    mut receiver: R,
    mut sender: S,
    clock: &impl Clock,
    shared: CrtpView<'_, M>,
    memory: &mut [u8],
) {
    let session = RefCell::new(Session::new(shared, memory));
    let (taken, sent) = (Signal::<NoopRawMutex, ()>::new(), Signal::<NoopRawMutex, ()>::new());
    let receive = async {
        loop {
            if !session.borrow().has_room() {
                let _ = within(clock, WAIT_MAX_US, sent.wait()).await;
                continue;
            }
            if let Ok(packet) = within(clock, WAIT_MAX_US, receiver.receive()).await {
                session.borrow_mut().take(&packet, clock.now());
                taken.signal(());
            }
        }
    };
    let send = async {
        loop {
            let now = clock.now();
            session.borrow_mut().lead(now);
            let packet = session.borrow_mut().next(now);
            if let Some(packet) = packet {
                // One that is given up is lost, as on any radio.
                let _ = within(clock, SEND_TIMEOUT_US, sender.send(&packet)).await;
                sent.signal(());
                continue;
            }
            let due = session.borrow().due(now).min(now.saturating_add(WAIT_MAX_US));
            select(clock.until(due), taken.wait()).await;
        }
    };
    join(receive, send).await;
}
