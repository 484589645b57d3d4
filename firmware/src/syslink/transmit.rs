//! The line's sending half: the order of boot, packets in their turn, and the pin by which the chip stops it.
//!
//! The pin is looked at before every [`BURST_BYTES`], once the bytes before them are out: so many the chip still takes
//! after the pin rises, and none are on their way when it is looked at. A frame that is stopped goes on where it was. A
//! chip that stops it for [`STOP_TIMEOUT_US`] costs the frame, and the next one, whose beginning it takes for the rest
//! of this one.

use super::boot_order::{BootOrder, Settings};
use super::frame::Frame;
use super::message::{self, kind};
use super::wire::{Next, REPORT_TIMEOUT_US, Wire};
use crate::hardware::{Clock, Fault};
use crate::shared::{Event, PacketRadioView, Severity};
use embassy_futures::select::{Either, Either4, select, select4};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_hal_async::digital::Wait;
use embedded_io_async::Write;

/// Bytes that are sent between two looks at the pin.
pub const BURST_BYTES: usize = 4;

/// How long the chip may stop a frame. It does for as long as an interrupt of its own takes.
pub const STOP_TIMEOUT_US: u64 = 20_000;

/// How long these bytes may take. They take 40 us.
const BURST_TIMEOUT_US: u64 = 2_000;

/// How long a chip that was told everything may report no battery. Its first report may take a second.
pub const SILENCE_TIMEOUT_US: u64 = 2 * REPORT_TIMEOUT_US;

/// The longest wait before silence is looked for.
const LOOK_INTERVAL_US: u64 = 100_000;

/// What goes to the chip.
pub struct Transmitter<'c, W, P, C> {
    line: W,
    stop: P,
    clock: &'c C,
}

impl<'c, W: Write, P: Wait, C: Clock> Transmitter<'c, W, P, C> {
    /// `stop` is high while the chip takes no bytes.
    pub const fn new(line: W, stop: P, clock: &'c C) -> Self {
        Self { line, stop, clock }
    }

    /// Sends a frame's bytes.
    /// Errors: [`Fault`] if the chip stops it for too long, or the line fails.
    async fn send(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        for burst in bytes.chunks(BURST_BYTES) {
            let (line, end) = (&mut self.line, self.clock.now().saturating_add(STOP_TIMEOUT_US));
            match select(self.stop.wait_for_low(), self.clock.until(end)).await {
                Either::First(Ok(())) => {}
                _ => return Err(Fault),
            }
            let out = async {
                line.write_all(burst).await?;
                line.flush().await
            };
            let end = self.clock.now().saturating_add(BURST_TIMEOUT_US);
            match select(out, self.clock.until(end)).await {
                Either::First(Ok(())) => {}
                _ => return Err(Fault),
            }
        }
        Ok(())
    }
}

/// How the chip does.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Chip {
    /// It was not heard yet, and not missed.
    Expected,
    /// It was missed.
    Silent,
    /// It reports, but came too late to confirm its settings: it is told again.
    ToldAgain,
    Answers,
}

/// Sends for ever.
pub async fn transmit<W: Write, P: Wait, C: Clock, M: RawMutex>(
    mut transmitter: Transmitter<'_, W, P, C>,
    clock: &impl Clock,
    wire: &Wire<M>,
    settings: Settings,
    shared: PacketRadioView<'_, M>,
) -> ! {
    let mut order = BootOrder::new(settings, clock.now());
    let mut chip = Chip::Expected;
    let mut has_turn = false;
    loop {
        let now = clock.now();
        if let Some(done) = order.done() {
            let reported = wire.voltage().map_or(0, |voltage| voltage.time);
            if now.saturating_sub(done.max(reported)) > SILENCE_TIMEOUT_US {
                if chip != Chip::Silent {
                    shared.announce(Event::new(Severity::Warning, "Radio chip does not answer"));
                }
                (order, chip, has_turn) = (BootOrder::new(settings, now), Chip::Silent, false);
            } else if reported >= done && chip != Chip::Answers {
                if chip == Chip::Silent {
                    shared.announce(Event::new(Severity::Information, "Radio chip answers again"));
                }
                if order.is_confirmed() {
                    chip = Chip::Answers;
                } else if chip == Chip::ToldAgain {
                    shared.announce(Event::new(Severity::Warning, "Radio chip does not take its settings"));
                    chip = Chip::Answers;
                } else {
                    (order, chip) = (BootOrder::new(settings, now), Chip::ToldAgain);
                }
            }
        }
        let frame = match order.next(now) {
            Some(frame) => Some(frame),
            None => {
                let look = now.saturating_add(LOOK_INTERVAL_US);
                let wake = order.due().map_or(look, |due| due.min(look));
                match select4(wire.setting(), wire.switching_off(), wire.next(has_turn), clock.until(wake)).await {
                    Either4::First(setting) => {
                        order.confirm(&setting, clock.now());
                        None
                    }
                    Either4::Second(()) => {
                        shared.announce(Event::new(Severity::Warning, "Switched off by the button"));
                        // Armed it goes off as well, a second later.
                        if shared.is_armed() { None } else { Frame::new(kind::MAY_SWITCH_OFF, &[]) }
                    }
                    Either4::Third(Next::Turn) => {
                        has_turn = true;
                        None
                    }
                    Either4::Third(Next::Packet(packet)) => {
                        has_turn = false;
                        message::packet(&packet)
                    }
                    Either4::Fourth(()) => None,
                }
            }
        };
        // One that does not go out is lost: a step is repeated, a packet is for the packets' own protocol.
        if let Some(bytes) = frame.map(|frame| frame.to_bytes()) {
            let _ = transmitter.send(&bytes).await;
        }
    }
}
