//! The supervisor: what the vehicle may do, arming, and the emergency stop.
//!
//! | channel | question | answer |
//! |---|---|---|
//! | 0 | 1 to 11: one bit; 12: all of them | the same with 128 added, and the bit (1 byte) or the bits (2 bytes) |
//! | 1 | 1, arm or not | 129, whether it was done, whether the vehicle is armed |
//! | 1 | 2: an inspection after a crash is over | 130, whether it was done, whether it may arm again |
//! | 1 | 3; 4 | none: an emergency stop; its watchdog is fed |
//!
//! Bits: 0 may be armed, 1 armed, 2 arms by itself, 3 can fly, 4 flies, 5 lies on its side or back, 6 locked, 7 crashed,
//! 8 flies a command of a place and a time, 9 has flown it to its end, 10 such commands are off.

use crate::shared::Report;
use flight::Mode;
use nalgebra::{UnitQuaternion, Vector3};

/// The number of the question for all bits, and what is added to a question's number in its answer.
pub const ALL_BITS: u8 = 12;
/// See [`ALL_BITS`].
pub const ANSWERED: u8 = 0x80;

/// Commands on channel 1: arm, or disarm.
pub const ARM: u8 = 1;
/// The inspection after a crash is over.
pub const RECOVER: u8 = 2;
/// Stop the motors.
pub const EMERGENCY_STOP: u8 = 3;
/// Stop them unless this comes again in time.
pub const FEED_WATCHDOG: u8 = 4;

/// The cosine of the lean from which on a vehicle lies on its side.
const TUMBLED_COSINE: f32 = 0.5;

/// The bits of a vehicle that did this in its last tick; and how far such a command is flown: none, under way or over.
pub fn bits(report: Option<&Report>, path: Option<bool>) -> u16 {
    let Some(report) = report else { return 0 };
    let attitude = report.state.map(|state| state.attitude).or(report.lean.map(|lean| lean.attitude));
    let up = attitude.map(|attitude| (UnitQuaternion::new_unchecked(attitude) * Vector3::z()).z);
    let is_tumbled = !report.is_airborne && up.is_some_and(|up| up < TUMBLED_COSINE);
    [
        (0, report.ready),
        (1, report.mode.is_armed()),
        (3, report.mode.is_armed() && report.mode != Mode::Descending),
        (4, report.is_airborne),
        (5, is_tumbled),
        (6, report.mode == Mode::Locked),
        (7, report.mode == Mode::Stopped),
        (8, path == Some(false)),
        (9, path == Some(true)),
    ]
    .into_iter()
    .filter(|(_, is_set)| *is_set)
    .fold(0, |bits, (bit, _)| bits | 1 << bit)
}
