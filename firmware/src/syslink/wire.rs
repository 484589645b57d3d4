//! What passes between the line's task and those that use it: packets both ways, and what the chip reports.

use super::frame::Frame;
use super::message::Received;
use super::parser::Dropped;
use crate::crtp::packet::{Packet, ReceivePackets, SendPackets};
use crate::shared::Latest;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::channel::Channel;
use embassy_sync::signal::Signal;
use flight::Stamped;

/// Packets that came and wait to be taken. What finds no room is dropped: its sender repeats what matters.
pub const RECEIVED_CAPACITY: usize = 4;

/// How long a report of the chip counts.
pub const REPORT_TIMEOUT_US: u64 = 1_000_000;

/// The values. A board keeps them in a static.
pub struct Wire<M: RawMutex> {
    received: Channel<M, Packet, RECEIVED_CAPACITY>,
    /// The packet that is to be sent next.
    waiting: Channel<M, Packet, 1>,
    /// A packet came, so one may be sent.
    turn: Signal<M, ()>,
    /// A setting that the chip says it has.
    setting: Signal<M, Frame>,
    switching_off: Signal<M, ()>,
    voltage: Latest<M, f32>,
    strength: Latest<M, i16>,
    dropped: Latest<M, Dropped>,
}

impl<M: RawMutex> Wire<M> {
    /// Nothing yet.
    pub const fn new() -> Self {
        Self {
            received: Channel::new(),
            waiting: Channel::new(),
            turn: Signal::new(),
            setting: Signal::new(),
            switching_off: Signal::new(),
            voltage: Latest::new(),
            strength: Latest::new(),
            dropped: Latest::new(),
        }
    }

    /// The half that receives packets.
    pub const fn receiver(&self) -> Receiver<'_, M> {
        Receiver(self)
    }

    /// The half that sends them.
    pub const fn sender(&self) -> Sender<'_, M> {
        Sender(self)
    }

    /// The battery, V, when it was reported.
    pub fn voltage(&self) -> Option<Stamped<f32>> {
        self.voltage.get()
    }

    /// How strong the last packet was, dBm, when that was reported.
    pub fn strength(&self) -> Option<Stamped<i16>> {
        self.strength.get()
    }

    /// What came and was no whole frame, since boot; none before the first bytes.
    pub fn dropped(&self) -> Option<Dropped> {
        self.dropped.get().map(|dropped| dropped.value)
    }

    /// Takes what the chip said at `now`, us.
    pub(super) fn take(&self, said: Received, now: u64) {
        match said {
            Received::Packet(packet) => {
                packet.into_iter().for_each(|packet| self.deliver(packet));
                self.turn.signal(());
            }
            Received::Broadcast(packet) => self.deliver(packet),
            Received::Setting(frame) => self.setting.signal(frame),
            Received::Strength(strength) => self.strength.put(strength, now),
            Received::Battery(voltage) => self.voltage.put(voltage, now),
            Received::SwitchingOff => self.switching_off.signal(()),
        }
    }

    fn deliver(&self, packet: Packet) {
        let _ = self.received.try_send(packet);
    }

    /// Says at `now`, us, what was no whole frame.
    pub(super) fn count(&self, dropped: Dropped, now: u64) {
        self.dropped.put(dropped, now);
    }

    /// Waits until a packet may be sent, where there is no turn yet, else for the packet.
    pub(super) async fn next(&self, has_turn: bool) -> Next {
        if has_turn {
            Next::Packet(self.waiting.receive().await)
        } else {
            self.turn.wait().await;
            Next::Turn
        }
    }

    /// Waits for a setting that the chip says it has.
    pub(super) async fn setting(&self) -> Frame {
        self.setting.wait().await
    }

    /// Waits until power is about to go.
    pub(super) async fn switching_off(&self) {
        self.switching_off.wait().await;
    }
}

/// What lets the sending half go on.
pub(super) enum Next {
    /// A packet may be sent.
    Turn,
    /// This one.
    Packet(Packet),
}

/// Packets that came over the radio.
pub struct Receiver<'a, M: RawMutex>(&'a Wire<M>);

impl<M: RawMutex> ReceivePackets for Receiver<'_, M> {
    async fn receive(&mut self) -> Packet {
        self.0.received.receive().await
    }
}

/// Packets on their way to the radio. One waits there until the radio takes it; the next one waits until then.
pub struct Sender<'a, M: RawMutex>(&'a Wire<M>);

impl<M: RawMutex> SendPackets for Sender<'_, M> {
    async fn send(&mut self, packet: &Packet) {
        self.0.waiting.send(packet.clone()).await;
    }
}
