//! Commands that name a place and a time, as a client sends them.
//!
//! | command | data behind the group |
//! |---|---|
//! | 0 | (the group that this vehicle belongs to) |
//! | 1, 2 | take off to, land at a height (m), within (s) |
//! | 7, 8 | the same: height, yaw (rad), whether the present yaw instead, within |
//! | 9, 10 | the same: height, whether that is from here, yaw, whether the present one, at a speed (m/s) |
//! | 3 | stop |
//! | 4 | go to: whether from here, p (m), yaw, within |
//! | 12 | the same: whether from here, whether straight, p, yaw, within |
//! | 5 | a trajectory: whether from here, whether reversed, its number, how many times as slow |
//! | 13 | the same: whether from here, whether turned to the present yaw, reversed, number, how many times as slow |
//! | 6 | (no group) defines one: number, 1, kind, address (4 bytes), pieces |
//!
//! Command 11, a spiral, is not flown. A command is for every vehicle if its group is 0, and else for those that belong to one of its groups. The answer
//! repeats its first three bytes, with 0 or an error behind.

use super::fields::Fields;
use nalgebra::Vector3;

/// How long something may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// s.
    Within(f32),
    /// m/s.
    At(f32),
}

/// How high, and which way to point then.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertical {
    /// m.
    pub height: f32,
    /// Whether that is from here.
    pub is_relative: bool,
    /// rad; none for the present one.
    pub yaw: Option<f32>,
    /// How long that may take.
    pub pace: Pace,
}

/// A command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// Belong to these groups.
    SetGroup(u8),
    /// Go straight up.
    TakeOff(Vertical),
    /// Go straight down, and land.
    Land(Vertical),
    /// Stop the motors, if that is safe.
    Stop,
    /// Go to a place and rest there.
    GoTo {
        /// Whether place and yaw are from here.
        is_relative: bool,
        /// Whether on a straight line at one speed.
        is_straight: bool,
        /// m.
        place: Vector3<f32>,
        /// rad.
        yaw: f32,
        /// s.
        duration: f32,
    },
    /// Fly a trajectory that was defined.
    Start {
        /// Whether it begins here.
        is_shifted: bool,
        /// Whether its yaw begins with the present one.
        is_turned: bool,
        /// Whether it is flown from its end.
        is_reversed: bool,
        /// Which.
        number: u8,
        /// How many times as long it is to take.
        timescale: f32,
    },
    /// Define one.
    Define {
        /// Its number.
        number: u8,
        /// How its pieces are written.
        kind: u8,
        /// Where they begin in memory.
        address: u32,
        /// How many there are.
        count: u8,
    },
}

/// The command in some data, and for whom it is; none where the data are cut short or are no command.
pub fn read(data: &[u8]) -> Option<(u8, Command)> {
    let mut fields = Fields::new(data);
    let command = fields.u8()?;
    if command == 6 {
        let number = fields.u8()?;
        // Where the pieces are: 1 is the memory, and there is no other place.
        let (1, kind) = (fields.u8()?, fields.u8()?) else { return None };
        return Some((0, Command::Define { number, kind, address: fields.u32()?, count: fields.u8()? }));
    }
    let group = fields.u8()?;
    let command = match command {
        0 => return Some((0, Command::SetGroup(group))),
        1 => Command::TakeOff(vertical_within(&mut fields, false)?),
        2 => Command::Land(vertical_within(&mut fields, false)?),
        7 => Command::TakeOff(vertical_within(&mut fields, true)?),
        8 => Command::Land(vertical_within(&mut fields, true)?),
        9 => Command::TakeOff(vertical_at(&mut fields)?),
        10 => Command::Land(vertical_at(&mut fields)?),
        3 => Command::Stop,
        4 => go_to(fields.flag()?, false, &mut fields)?,
        12 => go_to(fields.flag()?, fields.flag()?, &mut fields)?,
        5 => start(fields.flag()?, false, &mut fields)?,
        13 => start(fields.flag()?, fields.flag()?, &mut fields)?,
        _ => return None,
    };
    Some((group, command))
}

/// A finite number.
fn number(fields: &mut Fields<'_>) -> Option<f32> {
    fields.f32().filter(|number| number.is_finite())
}

/// A yaw, rad; none inside where the present one is meant.
fn yaw(fields: &mut Fields<'_>) -> Option<Option<f32>> {
    let yaw = number(fields)?;
    Some(if fields.flag()? { None } else { Some(yaw) })
}

fn vertical_within(fields: &mut Fields<'_>, has_yaw: bool) -> Option<Vertical> {
    let height = number(fields)?;
    let yaw = if has_yaw { yaw(fields)? } else { None };
    Some(Vertical { height, is_relative: false, yaw, pace: Pace::Within(number(fields)?) })
}

fn vertical_at(fields: &mut Fields<'_>) -> Option<Vertical> {
    let (height, is_relative) = (number(fields)?, fields.flag()?);
    Some(Vertical { height, is_relative, yaw: yaw(fields)?, pace: Pace::At(number(fields)?) })
}

fn go_to(is_relative: bool, is_straight: bool, fields: &mut Fields<'_>) -> Option<Command> {
    let place = Vector3::new(number(fields)?, number(fields)?, number(fields)?);
    Some(Command::GoTo { is_relative, is_straight, place, yaw: number(fields)?, duration: number(fields)? })
}

fn start(is_shifted: bool, is_turned: bool, fields: &mut Fields<'_>) -> Option<Command> {
    let (is_reversed, trajectory) = (fields.flag()?, fields.u8()?);
    Some(Command::Start { is_shifted, is_turned, is_reversed, number: trajectory, timescale: number(fields)? })
}
