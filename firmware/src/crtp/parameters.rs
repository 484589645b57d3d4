//! Parameters: ours by names of this protocol, and those that people's scripts set before they fly.
//!
//! | channel | question | answer |
//! |---|---|---|
//! | 1 | number (2 bytes) | number, 0, value; or number, error |
//! | 2 | number, value | number, the value that it has then; or number, error |
//! | 3 | 0, group, 0, name, 0, kind, value | 0, group, 0, name, 0, error or 0 |
//! | 3 | 2 or 7, number | the same, and that it has no further type |
//! | 3 | 6 or 8, number | the same, and its default value |
//!
//! A value that is refused stays as it was, and the reason is on the console. Ours are floats: `GAIN_ATT_P` is
//! `GAIN.ATT_P` here, up to the first underscore its group; those without one are in the group `VEHICLE`. They outlast a
//! restart by themselves. Of the others some are kept until the restart, and some are what they are.

use super::contents::{Contents, Entry};
use super::errors::{INVALID, NOT_THERE, READ_ONLY, UNKNOWN_COMMAND};
use super::fields::Fields;
use super::packet::Packet;
use super::ports;
use crate::parameters::table::{Name, PARAMETERS};
use crate::shared::{CrtpView, Event, Severity};
use embassy_sync::blocking_mutex::raw::RawMutex;

/// Kinds as the table of contents has them, and the bit of one that cannot be set.
const U8: u8 = 0x08;
const FLOAT: u8 = 0x06;
const CANNOT_BE_SET: u8 = 0x40;

/// Channels.
const READ: u8 = 1;
const WRITE: u8 = 2;
const MISCELLANEOUS: u8 = 3;

/// What becomes of a parameter that is not ours.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Use {
    /// It is always that, and a client may read it.
    Is(u8),
    /// Whether the vehicle knows where it is: scripts ask for a deck that measures it.
    KnowsItsPlace,
    /// It is always that: the same value is taken, another refused.
    Only(u8),
    /// Any value is taken, and nothing follows from it.
    Taken,
    /// Kept until the restart, from `min` to `max`.
    Kept(Kept, f32, f32),
    /// One of ours.
    Ours(Name),
}

/// Which of [`Settings`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kept {
    Group,
    TakeOffSpeed,
    LandingSpeed,
    PositionDeviation,
    AttitudeDeviation,
}

/// What a client sets until the restart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The groups of vehicles that it belongs to, a bit each.
    pub group: f32,
    /// How fast it takes off by a command that names neither duration nor speed, m/s.
    pub take_off_speed: f32,
    /// And how fast it goes down.
    pub landing_speed: f32,
    /// The poses' deviations, m and rad; 0 for those of the estimator's settings.
    pub position_deviation: f32,
    /// See [`Self::position_deviation`].
    pub attitude_deviation: f32,
}

impl Settings {
    /// As at boot.
    pub const DEFAULT: Self =
        Self { group: 0.0, take_off_speed: 0.5, landing_speed: 0.5, position_deviation: 0.0, attitude_deviation: 0.0 };

    fn place(&mut self, kept: Kept) -> &mut f32 {
        match kept {
            Kept::Group => &mut self.group,
            Kept::TakeOffSpeed => &mut self.take_off_speed,
            Kept::LandingSpeed => &mut self.landing_speed,
            Kept::PositionDeviation => &mut self.position_deviation,
            Kept::AttitudeDeviation => &mut self.attitude_deviation,
        }
    }
}

/// A row that is not one of ours by its own name.
struct Row {
    group: &'static str,
    name: &'static str,
    kind: u8,
    purpose: Use,
}

const fn row(group: &'static str, name: &'static str, kind: u8, purpose: Use) -> Row {
    Row { group, name, kind, purpose }
}

/// What scripts and clients ask for by name.
const KNOWN: [Row; 30] = [
    row("commander", "enHighLevel", U8, Use::Only(1)),
    row("stabilizer", "estimator", U8, Use::Only(2)),
    row("stabilizer", "controller", U8, Use::Only(0)),
    row("kalman", "resetEstimation", U8, Use::Taken),
    row("flightmode", "althold", U8, Use::Only(1)),
    row("flightmode", "poshold", U8, Use::Only(1)),
    row("flightmode", "posSet", U8, Use::Only(0)),
    row("flightmode", "stabModeRoll", U8, Use::Only(1)),
    row("flightmode", "stabModePitch", U8, Use::Only(1)),
    row("flightmode", "stabModeYaw", U8, Use::Only(0)),
    row("hlCommander", "groupmask", U8, Use::Kept(Kept::Group, 0.0, 255.0)),
    row("hlCommander", "vtoff", FLOAT, Use::Kept(Kept::TakeOffSpeed, 0.1, 2.0)),
    row("hlCommander", "vland", FLOAT, Use::Kept(Kept::LandingSpeed, 0.1, 2.0)),
    row("locSrv", "extPosStdDev", FLOAT, Use::Kept(Kept::PositionDeviation, 0.0, 1.0)),
    row("locSrv", "extQuatStdDev", FLOAT, Use::Kept(Kept::AttitudeDeviation, 0.0, 1.0)),
    row("pm", "lowVoltage", FLOAT, Use::Ours(Name::BatteryLow)),
    row("pm", "criticalLowVoltage", FLOAT, Use::Ours(Name::BatteryCritical)),
    row("deck", "bcDWM1000", U8, Use::Is(0)),
    row("deck", "bcFlow", U8, Use::Is(0)),
    row("deck", "bcFlow2", U8, Use::KnowsItsPlace),
    row("deck", "bcLighthouse4", U8, Use::Is(0)),
    row("deck", "bcLoco", U8, Use::Is(0)),
    row("deck", "bcMultiranger", U8, Use::Is(0)),
    row("deck", "bcUSD", U8, Use::Is(0)),
    row("deck", "bcZRanger", U8, Use::Is(0)),
    row("deck", "bcZRanger2", U8, Use::Is(0)),
    row("firmware", "modified", U8, Use::Is(1)),
    row("imu_tests", "MPU6500", U8, Use::Is(1)),
    row("imu_sensors", "BMP388", U8, Use::Is(0)),
    row("system", "selftestPassed", U8, Use::Is(1)),
];

/// A parameter of the table: its kind, its group and name, and what it is for.
fn entry(index: usize) -> Option<(Entry, Use)> {
    if let Some(Row { group, name, kind, purpose }) = KNOWN.get(index) {
        let kind = kind | if matches!(purpose, Use::Is(_) | Use::KnowsItsPlace) { CANNOT_BE_SET } else { 0 };
        return Some(((kind, group, name), *purpose));
    }
    let name = Name::from_index(index - KNOWN.len())?;
    let kind = FLOAT | if name == Name::TunedOn { CANNOT_BE_SET } else { 0 };
    let (group, rest) = name.row().name.split_once('_').unwrap_or(("VEHICLE", name.row().name));
    Some(((kind, group, rest), Use::Ours(name)))
}

/// What there is to set.
pub struct Settable;

impl Contents for Settable {
    const COUNT: usize = KNOWN.len() + PARAMETERS.len();
    const ROOM: &'static [u8] = &[];

    fn entry(index: usize) -> Option<Entry> {
        entry(index).map(|(entry, _)| entry)
    }
}

/// Reads and sets them for a client.
pub struct Desk<'a, M: RawMutex> {
    shared: CrtpView<'a, M>,
    /// What was set until the restart.
    pub settings: Settings,
}

impl<'a, M: RawMutex> Desk<'a, M> {
    /// Nothing set.
    pub const fn new(shared: CrtpView<'a, M>) -> Self {
        Self { shared, settings: Settings::DEFAULT }
    }

    /// Does as a packet says; the answer, if it is one that is answered. Where `may_set` is not, nothing is set.
    pub fn act(&mut self, packet: &Packet, may_set: bool) -> Option<Packet> {
        let mut fields = Fields::new(packet.data());
        let answer = Packet::new(ports::PARAMETERS, packet.channel);
        if packet.channel == MISCELLANEOUS {
            return self.miscellaneous(fields, answer, may_set);
        }
        let number = fields.u16()?;
        let answer = answer.with(&number.to_le_bytes());
        let Some((entry, purpose)) = entry(number.into()) else { return Some(answer.with(&[NOT_THERE])) };
        match packet.channel {
            READ => Some(self.with_value(answer.with(&[0]), entry, purpose)),
            WRITE => {
                if may_set {
                    self.set(entry, purpose, read(entry.0, &mut fields)?);
                }
                Some(self.with_value(answer, entry, purpose))
            }
            _ => None,
        }
    }

    fn miscellaneous(&mut self, mut fields: Fields<'_>, answer: Packet, may_set: bool) -> Option<Packet> {
        let command = fields.u8()?;
        if command == 0 {
            return self.set_by_name(fields, answer, may_set);
        }
        let number = fields.u16()?;
        let answer = answer.with(&[command]).with(&number.to_le_bytes());
        let Some((entry, purpose)) = entry(number.into()) else { return Some(answer.with(&[NOT_THERE])) };
        Some(match command {
            2 => answer.with(&[0]),
            7 => answer.with(&[0, 0]),
            6 | 8 => match default(purpose) {
                None => answer.with(&[NOT_THERE]),
                Some(value) if command == 8 => written(answer.with(&[0]), entry.0, value),
                Some(value) => written(answer, entry.0, value),
            },
            // To be kept, no more kept, and whether it is kept.
            3..=5 => answer.with(&[NOT_THERE]),
            _ => answer.with(&[UNKNOWN_COMMAND]),
        })
    }

    fn set_by_name(&mut self, mut fields: Fields<'_>, answer: Packet, may_set: bool) -> Option<Packet> {
        let names = fields.rest();
        let mut parts = names.splitn(3, |byte| *byte == 0);
        let (group, name, rest) = (parts.next()?, parts.next()?, parts.next()?);
        let answer = answer.with(&[0]).with(names.get(..group.len() + name.len() + 2)?);
        fields = Fields::new(rest);
        let kind = fields.u8()?;
        let is_it =
            |((_, its_group, its_name), _): &(Entry, Use)| (its_group.as_bytes(), its_name.as_bytes()) == (group, name);
        let error = match (0..Settable::COUNT).filter_map(entry).find(is_it) {
            None => NOT_THERE,
            Some(((its_kind, ..), _)) if its_kind & !CANNOT_BE_SET != kind => INVALID,
            Some((_, Use::Is(_) | Use::KnowsItsPlace)) => READ_ONLY,
            Some((entry, purpose)) => {
                let value = read(kind, &mut fields)?;
                if may_set {
                    self.set(entry, purpose, value);
                }
                if self.value(purpose) == value || purpose == Use::Taken { 0 } else { INVALID }
            }
        };
        Some(answer.with(&[error]))
    }

    /// Sets a value, or says why not.
    fn set(&mut self, (_, group, name): Entry, purpose: Use, value: f32) {
        let refuse = |words: core::fmt::Arguments<'_>| {
            self.shared.announce(Event::new(Severity::Warning, format_args!("{group}.{name}: {words}")));
        };
        match purpose {
            Use::Ours(name) => self.shared.set_parameter(name, value),
            Use::Taken => {}
            Use::KnowsItsPlace => refuse(format_args!("is read-only")),
            Use::Only(only) if value == f32::from(only) => {}
            Use::Is(only) | Use::Only(only) => refuse(format_args!("only {only} here")),
            Use::Kept(kept, min, max) if (min..=max).contains(&value) => *self.settings.place(kept) = value,
            Use::Kept(_, min, max) => refuse(format_args!("allowed are {min} to {max}")),
        }
    }

    fn value(&self, purpose: Use) -> f32 {
        match purpose {
            Use::Is(value) | Use::Only(value) => value.into(),
            Use::Taken => 0.0,
            Use::KnowsItsPlace => f32::from(self.knows_its_place()),
            Use::Kept(kept, ..) => *{ self.settings }.place(kept),
            Use::Ours(name) => self.shared.parameters().get(name),
        }
    }

    fn knows_its_place(&self) -> u8 {
        self.shared.report().get().is_some_and(|report| report.value.state.is_some()).into()
    }

    fn with_value(&self, packet: Packet, (kind, ..): Entry, purpose: Use) -> Packet {
        written(packet, kind, self.value(purpose))
    }
}

/// As at boot; none of one of ours that is as built, which no number says.
fn default(purpose: Use) -> Option<f32> {
    Some(match purpose {
        Use::Is(value) | Use::Only(value) => value.into(),
        Use::Taken | Use::KnowsItsPlace => 0.0,
        Use::Kept(kept, ..) => *{ Settings::DEFAULT }.place(kept),
        Use::Ours(name) => Some(name.row().default).filter(|default| default.is_finite())?,
    })
}

/// The packet with a value of that kind behind it.
fn written(packet: Packet, kind: u8, value: f32) -> Packet {
    match kind & !CANNOT_BE_SET {
        U8 => packet.with(&[value as u8]),
        _ => packet.with(&value.to_le_bytes()),
    }
}

/// A value of that kind.
fn read(kind: u8, fields: &mut Fields<'_>) -> Option<f32> {
    match kind & !CANNOT_BE_SET {
        U8 => fields.u8().map(f32::from),
        _ => fields.f32(),
    }
}
