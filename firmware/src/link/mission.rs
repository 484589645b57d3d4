//! The mission's items, as they are kept and as they go over the line.
//!
//! | item | uses | refused |
//! |---|---|---|
//! | 16 NAV_WAYPOINT | 1 time to hold, s; 2 acceptance radius, m (NaN or 0: [`flight::ACCEPTANCE_RADIUS_M`]); 4 yaw from north, degrees (NaN keeps); place | 3, other than 0: no passing by |
//! | 22 NAV_TAKEOFF, the first only | 4; altitude. Straight up | |
//! | 21 NAV_LAND, the last only | 4; place, at the altitude that it has | 2, other than 0: no precision landing |
//! | 20 NAV_RETURN_TO_LAUNCH, the last only | nothing | |
//!
//! | frame | place |
//! |---|---|
//! | 1 LOCAL_NED; 4 LOCAL_ENU | m, as it is |
//! | 0, 5 GLOBAL(_INT); 3, 6 GLOBAL_RELATIVE_ALT(_INT) | from the [origin](super::origin), the altitude above the sea, or above where the vehicle was armed |
//! | any other | refused: where the vehicle is when it is to be flown is not known when it is sent |
//!
//! What is kept of a time is tenths of a second, of a radius centimetres, of a yaw hundredths of a degree. So an item
//! takes 20 bytes, and that is what a download gives back. A mission goes on by itself from item to item, whatever
//! `autocontinue` says.

#![expect(deprecated, reason = "superseded messages and frames: clients still send them")]

use super::origin::{Origin, Place};
use crate::frames;
use controller_core::governor::HeadingSetpoint;
use core::fmt;
use flight::{ACCEPTANCE_RADIUS_M, Leg, MissionItem, MissionRefusal};
use mavlink::dialects::common::{MISSION_ITEM_DATA, MISSION_ITEM_INT_DATA, MavCmd, MavFrame, MavMissionResult};
use nalgebra::Vector3;

/// How many there may be.
pub const MISSION_CAPACITY: usize = 64;

/// A yaw that is not a number.
const NO_YAW: i16 = i16::MIN;

/// Units of a local place in MISSION_ITEM_INT, and of a degree, which is also what is kept.
const UNITS_PER_M: f64 = 1e4;
const UNITS_PER_DEG: f64 = 1e7;

/// The farthest place.
const DISTANCE_MAX_M: f32 = 10_000.0;

/// How a place is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Axes {
    /// North, east, down.
    Ned = 1,
    /// Latitude, longitude, altitude above the sea.
    Global = 0,
    /// The same by a newer number.
    GlobalInt = 5,
    /// Latitude, longitude, altitude above where the vehicle was armed.
    Relative = 3,
    /// The same by a newer number.
    RelativeInt = 6,
    /// East, north, up.
    Enu = 4,
    /// No place.
    None = 2,
}

/// An item as it is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Item {
    /// Units of a degree, or of a local place.
    x: i32,
    y: i32,
    /// m.
    z: f32,
    /// Hundredths of a degree from north, or none.
    yaw: i16,
    /// Tenths of a second.
    hold: u16,
    /// Centimetres; 0 for the usual one.
    radius: u16,
    leg: Leg,
    axes: Axes,
}

const _: () = assert!(size_of::<Item>() <= 20, "an item takes more room than budgets.toml has for it");

/// Why an item is not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ItemRefusal {
    /// No such command is flown.
    Command(u16),
    /// It is not the first, or not the last.
    Place(&'static str),
    /// The frame is not one of those above.
    Frame(u8),
    /// One of its numbers, counted from 1, is out of range.
    Parameter(u8, &'static str),
    /// The vehicle may not fly it.
    Flight(MissionRefusal),
}

impl fmt::Display for ItemRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Command(number) => write!(f, "command {number} is not flown"),
            Self::Place(words) => f.write_str(words),
            Self::Frame(number) => write!(f, "frame {number} is not used"),
            Self::Parameter(number, words) => write!(f, "parameter {number}, {words}"),
            Self::Flight(refusal) => refusal.fmt(f),
        }
    }
}

impl ItemRefusal {
    /// MAVLink's number.
    pub fn result(&self) -> MavMissionResult {
        match self {
            Self::Command(_) | Self::Place(_) => MavMissionResult::MAV_MISSION_UNSUPPORTED,
            Self::Frame(_) => MavMissionResult::MAV_MISSION_UNSUPPORTED_FRAME,
            Self::Parameter(1, _) => MavMissionResult::MAV_MISSION_INVALID_PARAM1,
            Self::Parameter(2, _) => MavMissionResult::MAV_MISSION_INVALID_PARAM2,
            Self::Parameter(3, _) => MavMissionResult::MAV_MISSION_INVALID_PARAM3,
            Self::Parameter(4, _) => MavMissionResult::MAV_MISSION_INVALID_PARAM4,
            Self::Parameter(5, _) => MavMissionResult::MAV_MISSION_INVALID_PARAM5_X,
            Self::Parameter(6, _) => MavMissionResult::MAV_MISSION_INVALID_PARAM6_Y,
            Self::Parameter(..) => MavMissionResult::MAV_MISSION_INVALID_PARAM7,
            Self::Flight(_) => MavMissionResult::MAV_MISSION_INVALID,
        }
    }
}

/// What MISSION_ITEM and MISSION_ITEM_INT have, read byte by byte: the crate's types do not decode a command or a frame
/// that they do not know, and its sender is to be told which.
#[derive(Debug, Clone, Copy)]
pub struct SentItem {
    parameters: [f32; 4],
    place: [[u8; 4]; 2],
    z: f32,
    /// Its number in the list, from 0.
    pub sequence: u16,
    command: u16,
    /// Whom it is for: system and component.
    pub target: [u8; 2],
    frame: u8,
    /// MAV_MISSION_TYPE.
    pub list: u8,
    is_int: bool,
}

impl SentItem {
    /// The fields of such a payload. Zeros at its end are cut off.
    pub fn read(payload: &[u8], is_int: bool) -> Self {
        let byte = |place: usize| payload.get(place).copied().unwrap_or(0);
        let word = |place: usize| [0, 1, 2, 3].map(|next| byte(place + next));
        let number = |place: usize| f32::from_le_bytes(word(place));
        Self {
            parameters: [0, 4, 8, 12].map(number),
            place: [word(16), word(20)],
            z: number(24),
            sequence: u16::from_le_bytes([byte(28), byte(29)]),
            command: u16::from_le_bytes([byte(30), byte(31)]),
            target: [byte(32), byte(33)],
            frame: byte(34),
            list: byte(37),
            is_int,
        }
    }

    /// The item, the last of its list or not.
    /// Errors: what of it is not flown.
    pub fn item(&self, is_last: bool) -> Result<Item, ItemRefusal> {
        let leg = self.leg(is_last)?;
        let [hold, radius, pass, yaw] =
            self.parameters.map(|parameter| if parameter.is_nan() { 0.0 } else { parameter });
        let is_waypoint = leg == Leg::Waypoint;
        if is_waypoint && !(0.0..=6553.0).contains(&hold) {
            return Err(ItemRefusal::Parameter(1, "not 0 to 6553 s"));
        }
        if is_waypoint && radius != 0.0 && !(0.01..=655.0).contains(&radius) {
            return Err(ItemRefusal::Parameter(2, "not 0.01 to 655 m"));
        }
        if leg == Leg::Land && radius != 0.0 {
            return Err(ItemRefusal::Parameter(2, "no precision landing"));
        }
        if is_waypoint && pass != 0.0 {
            return Err(ItemRefusal::Parameter(3, "no passing by"));
        }
        let turns = leg != Leg::Return && !self.parameters[3].is_nan();
        if turns && !(-360.0..=360.0).contains(&yaw) {
            return Err(ItemRefusal::Parameter(4, "yaw, not -360 to 360"));
        }
        let (axes, [x, y, z]) = self.place(leg)?;
        // From -180 to 180.
        let yaw = if yaw > 180.0 { yaw - 360.0 } else { yaw };
        let yaw = if yaw < -180.0 { yaw + 360.0 } else { yaw };
        Ok(Item {
            x: x as i32,
            y: y as i32,
            z: z as f32,
            yaw: if turns { (yaw * 100.0) as i16 } else { NO_YAW },
            hold: if is_waypoint { (hold * 10.0 + 0.5) as u16 } else { 0 },
            radius: if is_waypoint { (radius * 100.0 + 0.5) as u16 } else { 0 },
            leg,
            axes,
        })
    }

    fn leg(&self, is_last: bool) -> Result<Leg, ItemRefusal> {
        let is = |command: MavCmd| self.command == command as u16;
        if is(MavCmd::MAV_CMD_NAV_WAYPOINT) {
            Ok(Leg::Waypoint)
        } else if is(MavCmd::MAV_CMD_NAV_TAKEOFF) {
            if self.sequence == 0 { Ok(Leg::TakeOff) } else { Err(ItemRefusal::Place("a take-off is the first item")) }
        } else if is(MavCmd::MAV_CMD_NAV_LAND) || is(MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH) {
            let leg = if is(MavCmd::MAV_CMD_NAV_LAND) { Leg::Land } else { Leg::Return };
            if is_last { Ok(leg) } else { Err(ItemRefusal::Place("a landing is the last item")) }
        } else {
            Err(ItemRefusal::Command(self.command))
        }
    }

    /// The place in units, and the altitude or height, m.
    fn place(&self, leg: Leg) -> Result<(Axes, [f64; 3]), ItemRefusal> {
        let axes = match self.frame {
            _ if leg == Leg::Return => return Ok((Axes::None, [0.0; 3])),
            0 => Axes::Global,
            1 => Axes::Ned,
            3 => Axes::Relative,
            4 => Axes::Enu,
            5 => Axes::GlobalInt,
            6 => Axes::RelativeInt,
            other => return Err(ItemRefusal::Frame(other)),
        };
        let is_local = matches!(axes, Axes::Ned | Axes::Enu);
        let unit = if is_local { UNITS_PER_M } else { UNITS_PER_DEG };
        let number = |place: [u8; 4]| match self.is_int {
            true => f64::from(i32::from_le_bytes(place)),
            false => f64::from(f32::from_le_bytes(place)) * unit,
        };
        let [x, y] = if leg == Leg::TakeOff { [0.0; 2] } else { self.place.map(number) };
        let limits = if is_local { [f64::from(DISTANCE_MAX_M); 2] } else { [85.0, 180.0] };
        // Written so that NaN is refused.
        for (number, value, limit) in [(5, x, limits[0]), (6, y, limits[1])] {
            if !((-limit * unit)..=(limit * unit)).contains(&value) {
                return Err(ItemRefusal::Parameter(number, "not a place"));
            }
        }
        if !(-DISTANCE_MAX_M..=DISTANCE_MAX_M).contains(&self.z) {
            return Err(ItemRefusal::Parameter(7, "not a height"));
        }
        Ok((axes, [x, y, f64::from(self.z)]))
    }
}

impl Item {
    /// As the pilot flies it, with the local frame at `origin` and armed at `home`, m, NED.
    pub fn placed(&self, origin: &Origin, home: &Vector3<f32>) -> MissionItem {
        let local = [self.x, self.y].map(|units| units as f32 / UNITS_PER_M as f32);
        let on_the_globe =
            |above: f32| origin.local(&Place { latitude: self.x, longitude: self.y, altitude: above + self.z });
        let ned = match self.axes {
            Axes::None => Vector3::zeros(),
            Axes::Ned => Vector3::new(local[0], local[1], self.z),
            Axes::Enu => Vector3::new(local[1], local[0], -self.z),
            Axes::Global | Axes::GlobalInt => on_the_globe(0.0),
            Axes::Relative | Axes::RelativeInt => {
                let place = on_the_globe(0.0);
                Vector3::new(place.x, place.y, home.z - self.z)
            }
        };
        let turn = match self.yaw {
            NO_YAW => HeadingSetpoint::Keep,
            yaw => HeadingSetpoint::Angle { angle: frames::heading((f32::from(yaw) * 0.01).to_radians()), rate: 0.0 },
        };
        MissionItem {
            leg: self.leg,
            position: frames::world(&ned),
            turn,
            radius: if self.radius == 0 { ACCEPTANCE_RADIUS_M } else { f32::from(self.radius) * 0.01 },
            hold: u64::from(self.hold) * 100_000,
        }
    }

    /// As it goes out, the one of this number, to a client: system and component.
    pub fn message(&self, sequence: u16, (target_system, target_component): (u8, u8)) -> MISSION_ITEM_INT_DATA {
        let (command, frame) = (self.command(), self.frame());
        let [param1, param2, param3, param4] = self.parameters();
        MISSION_ITEM_INT_DATA {
            param1,
            param2,
            param3,
            param4,
            x: self.x,
            y: self.y,
            z: self.z,
            seq: sequence,
            command,
            target_system,
            target_component,
            frame,
            current: 0,
            autocontinue: 1,
        }
    }

    /// The same for clients that ask for MISSION_ITEM, with a place in single precision.
    pub fn old_message(&self, sequence: u16, target: (u8, u8)) -> MISSION_ITEM_DATA {
        let message = self.message(sequence, target);
        let unit = if matches!(self.axes, Axes::Ned | Axes::Enu) { UNITS_PER_M } else { UNITS_PER_DEG };
        let MISSION_ITEM_INT_DATA { param1, param2, param3, param4, z, seq, command, frame, .. } = message;
        let MISSION_ITEM_INT_DATA { target_system, target_component, current, autocontinue, .. } = message;
        let [x, y] = [self.x, self.y].map(|units| (f64::from(units) / unit) as f32);
        MISSION_ITEM_DATA {
            param1,
            param2,
            param3,
            param4,
            x,
            y,
            z,
            seq,
            command,
            target_system,
            target_component,
            frame,
            current,
            autocontinue,
        }
    }

    fn parameters(&self) -> [f32; 4] {
        let yaw = if self.yaw == NO_YAW { f32::NAN } else { f32::from(self.yaw) * 0.01 };
        [f32::from(self.hold) * 0.1, f32::from(self.radius) * 0.01, 0.0, yaw]
    }

    fn command(&self) -> MavCmd {
        match self.leg {
            Leg::Waypoint => MavCmd::MAV_CMD_NAV_WAYPOINT,
            Leg::TakeOff => MavCmd::MAV_CMD_NAV_TAKEOFF,
            Leg::Land => MavCmd::MAV_CMD_NAV_LAND,
            Leg::Return => MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH,
        }
    }

    fn frame(&self) -> MavFrame {
        match self.axes {
            Axes::Global => MavFrame::MAV_FRAME_GLOBAL,
            Axes::Ned => MavFrame::MAV_FRAME_LOCAL_NED,
            Axes::None => MavFrame::MAV_FRAME_MISSION,
            Axes::Relative => MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
            Axes::Enu => MavFrame::MAV_FRAME_LOCAL_ENU,
            Axes::GlobalInt => MavFrame::MAV_FRAME_GLOBAL_INT,
            Axes::RelativeInt => MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        }
    }
}
