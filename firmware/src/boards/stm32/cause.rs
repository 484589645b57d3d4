//! Why the chip started, the first thing to read after something went wrong.

/// What made the chip start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, defmt::Format)]
pub enum Cause {
    /// Power came.
    Power,
    /// Power fell below the brown-out level, and came back.
    BrownOut,
    /// The reset pin: a button or a debug probe.
    Pin,
    /// The firmware itself, after a panic or a fault.
    Software,
    /// The watchdog: the control task did not come back.
    Watchdog,
    /// None of these.
    Unknown,
}

/// The chip's flags for why it started. Every restart also pulls the reset pin, and power raises more of them still.
#[derive(Debug, Clone, Copy)]
pub struct Flags {
    /// The independent watchdog.
    pub watchdog: bool,
    /// The firmware.
    pub software: bool,
    /// Power came.
    pub power: bool,
    /// Power fell below the brown-out level and came back.
    pub brown_out: bool,
    /// The reset pin.
    pub pin: bool,
}

impl Cause {
    /// The most telling of the flags.
    pub fn first(flags: Flags) -> Self {
        match flags {
            Flags { power: true, .. } => Self::Power,
            Flags { brown_out: true, .. } => Self::BrownOut,
            Flags { watchdog: true, .. } => Self::Watchdog,
            Flags { software: true, .. } => Self::Software,
            Flags { pin: true, .. } => Self::Pin,
            _ => Self::Unknown,
        }
    }

    /// Whether the memory has been without power, or may have been.
    pub fn is_power(self) -> bool {
        matches!(self, Self::Power | Self::BrownOut)
    }

    /// It, in a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Power => "Power",
            Self::BrownOut => "BrownOut",
            Self::Pin => "Pin",
            Self::Software => "Software",
            Self::Watchdog => "Watchdog",
            Self::Unknown => "Unknown",
        }
    }

    /// The report where no words were kept.
    pub fn words(self) -> Option<&'static str> {
        match self {
            Self::BrownOut => Some("brown-out, supply too low"),
            Self::Watchdog => Some("watchdog, control did not come back"),
            Self::Power | Self::Pin | Self::Software | Self::Unknown => None,
        }
    }
}
