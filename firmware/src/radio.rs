//! The operator's radio transmitter: an ExpressLRS or Crossfire receiver on a line of its own (CRSF, 420,000 baud).
//!
//! | channel | what | low | middle | high |
//! |---|---|---|---|---|
//! | 1, 2, 4 | sticks: right, forward, yaw to the right | | rest | |
//! | 3 | stick: up | down | rest | up |
//! | 5 | arm | disarm, on the ground | | arm |
//! | 6 | who flies | clients on the link | hold | the sticks |
//! | 7 | kill switch | | | every motor stops |
//!
//! - A switch counts once several frames in a row say the same ([`debounced`]): a corrupted frame moves none. What the
//!   sticks request (to begin a flight, to take it over, to land) counts in the same way.
//! - A switch acts when it is moved, not where it is found: a transmitter that is turned on arms nothing. The kill
//!   switch alone acts as it stands, and keeps its last received position when the receiver falls silent.
//! - The sticks command velocities in the frame of the vehicle's heading ([`sticks`]), through the governor, as
//!   setpoints; those of the link are then refused. On the ground they begin a flight when the stick is pushed up.
//! - A transmitter counts as a ground station until it has been silent for [`RADIO_TIMEOUT_US`]. If its sticks flew,
//!   the vehicle then holds, and nothing takes over by itself: setpoints of the link stay refused until a client
//!   requests to fly them, or the radio is received again and its switch selects the link.
//! - A receiver that goes on with the last or with set positions when it has lost its transmitter says so in its link
//!   statistics: an uplink quality of 0. That counts as silence.

pub mod debounced;
pub mod sticks;

use crate::hardware::Clock;
use crate::shared::{Event, QueuedRequest, RadioView, Severity};
use debounced::Debounced;
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::Read;
use flight::{Mode, Request};
use sticks::{Push, Sticks};
use uf_crsf::CrsfParser;
use uf_crsf::packets::{CrsfPacket, LinkStatistics, RcChannelsPacked};

/// How long a receiver may be silent. It sends 50 frames a second or more, and none when it does not receive its
/// transmitter.
pub const RADIO_TIMEOUT_US: u64 = 500_000;

/// The longest wait for bytes, and the wait after a line that failed.
const READ_TIMEOUT_US: u64 = 100_000;
const RETRY_DELAY_US: u64 = 10_000;

/// Bytes read at once.
const READ_CHUNK_BYTES: usize = 64;

/// Channel values at -1, 0 and 1.
const CHANNEL_MIN: f32 = 172.0;
const CHANNEL_CENTRE: f32 = 992.0;
const CHANNEL_MAX: f32 = 1811.0;

/// Where a switch stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Switch {
    Low,
    Middle,
    High,
}

impl Switch {
    fn at(value: f32) -> Self {
        match value {
            value if value < -0.5 => Self::Low,
            value if value > 0.5 => Self::High,
            _ => Self::Middle,
        }
    }
}

/// A frame of channels.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Frame {
    sticks: Sticks,
    arm: Switch,
    flies: Switch,
    killed: bool,
}

impl Frame {
    fn read(channels: &[u16; 16]) -> Self {
        let [right, forward, up, yaw, arm, flies, kill, ..] = channels.map(scaled);
        let sticks = Sticks { forward, right, up, yaw };
        Self { sticks, arm: Switch::at(arm), flies: Switch::at(flies), killed: Switch::at(kill) == Switch::High }
    }
}

/// -1 to 1.
fn scaled(value: u16) -> f32 {
    let from_centre = f32::from(value) - CHANNEL_CENTRE;
    let most = if from_centre < 0.0 { CHANNEL_CENTRE - CHANNEL_MIN } else { CHANNEL_MAX - CHANNEL_CENTRE };
    (from_centre / most).clamp(-1.0, 1.0)
}

/// Receives for ever.
pub async fn receive<R: Read, M: RawMutex>(mut line: R, clock: &impl Clock, shared: RadioView<'_, M>) -> ! {
    let mut radio = Radio::new(shared);
    let mut chunk = [0; READ_CHUNK_BYTES];
    loop {
        let wake = clock.now().saturating_add(READ_TIMEOUT_US);
        match select(line.read(&mut chunk), clock.until(wake)).await {
            Either::First(Ok(count @ 1..)) => {
                radio.feed(chunk.get(..count).unwrap_or(&chunk), clock.now());
            }
            Either::First(_) => clock.until(clock.now().saturating_add(RETRY_DELAY_US)).await,
            Either::Second(()) => {}
        }
        radio.check_silence(clock.now());
    }
}

/// What the transmitter says.
pub struct Radio<'a, M: RawMutex> {
    parser: CrsfParser,
    shared: RadioView<'a, M>,
    arm: Debounced<Switch>,
    flies: Debounced<Switch>,
    killed: Debounced<bool>,
    push: Debounced<Push>,
    /// Whether the receiver hears its transmitter, by its own statistics.
    is_linked: Debounced<bool>,
    /// When the last frame of channels came, us; none after silence.
    heard: Option<u64>,
}

impl<'a, M: RawMutex> Radio<'a, M> {
    /// Nothing received yet.
    pub fn new(shared: RadioView<'a, M>) -> Self {
        Self {
            parser: CrsfParser::new(),
            shared,
            arm: Debounced::default(),
            flies: Debounced::default(),
            killed: Debounced::default(),
            push: Debounced::default(),
            is_linked: Debounced::default(),
            heard: None,
        }
    }

    /// Takes bytes that came at `now`, us, and acts on the frames of channels and of statistics that they complete.
    pub fn feed(&mut self, mut bytes: &[u8], now: u64) {
        const CHANNELS_PACKET: u8 = RcChannelsPacked::PACKET_TYPE as u8;
        const STATISTICS_PACKET: u8 = LinkStatistics::PACKET_TYPE as u8;
        // By its type, because reading every kind of packet would take 12 KB of flash.
        while let Some(packet) = self.parser.next_raw_packet(&mut bytes) {
            let Ok(packet) = packet else { continue };
            match (packet.raw_packet_type(), packet.payload()) {
                (CHANNELS_PACKET, payload) => {
                    if let Ok(channels) = RcChannelsPacked::from_bytes(payload) {
                        self.take(&channels.0, now);
                    }
                }
                (STATISTICS_PACKET, &[_, _, uplink_quality, ..]) => self.take_quality(uplink_quality, now),
                _ => {}
            }
        }
    }

    /// Acts on the part of its transmitter's frames, %, that the receiver says at `now`, us, that it receives.
    fn take_quality(&mut self, uplink_quality: u8, now: u64) {
        if self.is_linked.take(uplink_quality > 0, now) && uplink_quality == 0 {
            self.lose();
        }
    }

    /// Acts on channels that came at `now`, us.
    pub fn take(&mut self, channels: &[u16; 16], now: u64) {
        if self.is_linked.get() == Some(false) {
            return;
        }
        let frame = Frame::read(channels);
        self.heard = Some(now);
        if self.killed.take(frame.killed, now) {
            self.shared.killed().put(frame.killed, now);
        }
        // Switches act when they are moved while the radio is received.
        let before = self.arm.get();
        if self.arm.take(frame.arm, now) && before.is_some() {
            match frame.arm {
                Switch::High => self.request(Request::Arm),
                Switch::Low => self.request(Request::Disarm),
                Switch::Middle => {}
            }
        }
        let before = self.flies.get();
        if self.flies.take(frame.flies, now) {
            if before.is_none() {
                self.shared.announce(Event::new(Severity::Information, "Radio received"));
            } else if frame.flies == Switch::Middle {
                self.request(Request::Hold);
            }
        }
        self.push.take(frame.sticks.vertical_push(), now);
        let Some(flies) = self.flies.get() else { return };
        self.shared.ground_station().put((), now);
        self.shared.sticks().put(flies == Switch::High, now);
        if flies == Switch::High {
            self.steer(&frame.sticks, now);
        }
    }

    /// Reports the radio lost after silence, and holds if its sticks flew.
    pub fn check_silence(&mut self, now: u64) {
        if self.heard.is_some_and(|heard| now.saturating_sub(heard) > RADIO_TIMEOUT_US) {
            self.lose();
        }
    }

    fn lose(&mut self) {
        let was_received = self.flies.get().is_some();
        (self.arm, self.flies, self.push, self.heard) =
            (Debounced::default(), Debounced::default(), Debounced::default(), None);
        self.killed.interrupt();
        if !was_received {
            return;
        }
        self.shared.announce(Event::new(Severity::Warning, "Radio lost"));
        if self.is_flown() && self.shared.sticks().get().is_some_and(|sticks| sticks.value) {
            self.request(Request::Hold);
        }
    }

    /// Whether setpoints are flown, or may be next. What holds, lands or stands is left to do so.
    fn is_flown(&self) -> bool {
        let report = self.shared.report().get();
        report.is_some_and(|report| matches!(report.value.mode, Mode::Flying | Mode::TakingOff))
    }

    /// Puts down the sticks' setpoint. On the ground only a stick that is pushed up does.
    fn steer(&self, sticks: &Sticks, now: u64) {
        let Some(report) = self.shared.report().get().map(|report| report.value) else { return };
        let push = self.push.get().unwrap_or(Push::None);
        let begins = report.mode == Mode::Idling && push == Push::Up;
        if !(report.is_airborne || begins || report.mode == Mode::Flying) {
            return;
        }
        if let Some(setpoint) = report.state.as_ref().and_then(|state| sticks.setpoint(state)) {
            self.shared.setpoint().put(setpoint, now);
        }
        if begins || matches!(report.mode, Mode::Holding | Mode::TakingOff) && push != Push::None {
            self.request(Request::FlySetpoints);
        }
        if report.mode == Mode::Flying && push == Push::Down {
            self.request(Request::Land);
        }
    }

    fn request(&self, request: Request) {
        self.shared.request(QueuedRequest { request, order: None, setpoints: None });
    }
}
