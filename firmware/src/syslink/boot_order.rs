//! What the chip is told at boot, and again after it was silent.
//!
//! | step | what | goes on once |
//! |---|---|---|
//! | 1 | no bare carrier | it is confirmed |
//! | 2 | the channel, `RADIO_CHAN` | it is confirmed |
//! | 3 | the data rate, `RADIO_RATE` | it is confirmed |
//! | 4 | the address, `RADIO_ADDR` | it is confirmed |
//! | 5 | this side is ready | it is sent: older chips confirm nothing |
//! | 6 | report battery and strength | it is sent: the reports are the confirmation |
//!
//! A step is repeated every [`CONFIRMATION_TIMEOUT_US`], [`TRIES_MAX`] times at most; then the next one comes all the
//! same.

use super::frame::Frame;
use super::message::kind;
use crate::parameters::table::Name;

/// How long the chip may take to confirm a setting. It takes less than a millisecond.
pub const CONFIRMATION_TIMEOUT_US: u64 = 100_000;

/// How often a step is sent at most.
pub const TRIES_MAX: u8 = 5;

/// How many steps there are.
pub const STEPS: usize = 6;

/// All of the address but its last byte.
const ADDRESS_HEAD: u8 = 0xE7;

/// How the radio is to be set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// MHz above 2,400, at most 125: the chip takes more, and then no other channel any more.
    pub channel: u8,
    /// 0 250 kbit/s, 1 1 Mbit/s, 2 2 Mbit/s.
    pub data_rate: u8,
    /// The last byte of the address, whose others are 0xE7.
    pub address: u8,
}

impl Settings {
    /// As parameters have it. Their rows have the ranges.
    pub fn from_parameters(value: impl Fn(Name) -> f32) -> Self {
        Self {
            channel: value(Name::RadioChannel) as u8,
            data_rate: value(Name::RadioDataRate) as u8,
            address: value(Name::RadioAddress) as u8,
        }
    }

    /// A step's kind and data; none behind the last one.
    fn step(&self, number: usize) -> Option<Frame> {
        match number {
            0 => Frame::new(kind::CARRIER, &[0]),
            1 => Frame::new(kind::CHANNEL, &[self.channel]),
            2 => Frame::new(kind::DATA_RATE, &[self.data_rate]),
            3 => Frame::new(kind::ADDRESS, &[self.address, ADDRESS_HEAD, ADDRESS_HEAD, ADDRESS_HEAD, ADDRESS_HEAD]),
            4 => Frame::new(kind::READY, &[]),
            5 => Frame::new(kind::REPORTS, &[]),
            _ => None,
        }
    }
}

/// How far it has got.
pub struct BootOrder {
    settings: Settings,
    /// The present step.
    number: usize,
    tries: u8,
    /// When it is to be sent, us.
    due: u64,
    /// Whether every step so far was confirmed that can be.
    is_confirmed: bool,
    /// When the last step was sent, us.
    done: Option<u64>,
}

impl BootOrder {
    /// Begins now, us.
    pub const fn new(settings: Settings, now: u64) -> Self {
        Self { settings, number: 0, tries: 0, due: now, is_confirmed: true, done: None }
    }

    /// The frame that is to be sent now, us, if there is one. It counts as sent.
    pub fn next(&mut self, now: u64) -> Option<Frame> {
        if now < self.due {
            return None;
        }
        if self.tries >= TRIES_MAX {
            self.is_confirmed = false;
            self.advance(now);
        }
        let frame = self.settings.step(self.number)?;
        if matches!(frame.kind, kind::READY | kind::REPORTS) {
            self.advance(now);
        } else {
            self.tries += 1;
            self.due = now.saturating_add(CONFIRMATION_TIMEOUT_US);
        }
        Some(frame)
    }

    /// Takes a setting that the chip says it has now, us.
    pub fn confirm(&mut self, setting: &Frame, now: u64) {
        if self.tries > 0 && self.settings.step(self.number).as_ref() == Some(setting) {
            self.advance(now);
        }
    }

    fn advance(&mut self, now: u64) {
        (self.number, self.tries, self.due) = (self.number + 1, 0, now);
        if self.number == STEPS {
            self.done = Some(now);
        }
    }

    /// When there is something to do next, us; none once all is sent.
    pub fn due(&self) -> Option<u64> {
        self.done.is_none().then_some(self.due)
    }

    /// When all was sent, us.
    pub const fn done(&self) -> Option<u64> {
        self.done
    }

    /// Whether every setting so far was confirmed.
    pub const fn is_confirmed(&self) -> bool {
        self.is_confirmed
    }
}
