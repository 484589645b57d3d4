//! The checks, in the order in which one rests on another: `docs/boards.md`, first flash, and `docs/first-flight.md`,
//! sections 3 and 4.
//!
//! | module | checks |
//! |---|---|
//! | `boot` | what started, the certificate, ticks, the port |
//! | `sensors` | axes, calibration, the levelling thrusts |
//! | `motors` | battery, frames, motors, and every way to stop them on the bench |
//! | `ready` | settings, poses, arming |

mod boot;
mod motors;
mod ready;
mod sensors;

use super::outcome::Outcome;
use super::vehicle::Stop;
use super::walk::Walk;

/// A check.
pub struct Check {
    /// Its name on the command line, and in the record.
    pub id: &'static str,
    /// Its line on the page.
    pub title: &'static str,
    /// What it is about, to be read before it begins.
    pub about: &'static str,
    pub(super) run: fn(&mut Walk<'_>) -> Result<Outcome, Stop>,
}

/// All of them.
pub const CHECKS: [Check; 15] = [
    Check {
        id: "boot",
        title: "The right image, certified as the file is",
        about: "The vehicle says why it started, what it will fly, and every inequality of its certificate.",
        run: boot::report,
    },
    Check {
        id: "ticks",
        title: "Ticks on time, sensor at rest",
        about: "Leave it alone on a table for ten seconds.",
        run: boot::ticks,
    },
    Check { id: "usb", title: "USB pulled out and put in", about: "Only where the link is USB.", run: boot::port },
    Check {
        id: "axes",
        title: "Axes of accelerometer and gyro",
        about: "In your hand, slowly: four ways to hold it. One sign that differs: nothing may be flown.",
        run: sensors::axes,
    },
    Check {
        id: "calibration",
        title: "Gyro, accelerometer, level",
        about: "Gyro at rest; accelerometer on each of six sides; then level, as it will stand before take-off.",
        run: sensors::calibration,
    },
    Check {
        id: "tilt",
        title: "The right rotors would speed up",
        about: "No motor turns: the vehicle says which rotors the law would speed up for the tilt that you make.",
        run: sensors::levelling,
    },
    Check {
        id: "battery",
        title: "Battery against a meter",
        about: "Connect the motors' supply, propellers off. The controllers play the tones of a signal found.",
        run: motors::battery,
    },
    Check {
        id: "frames",
        title: "Motor frames on an oscilloscope",
        about: "16 pulses each millisecond, 3.33 us apart, 1.25 us wide for a 0, 2.5 us for a 1, low in between.",
        run: motors::frames,
    },
    Check {
        id: "motors",
        title: "Each motor: place, direction, least level, vibration",
        about: "One motor after the other turns slowly for 2 s.",
        run: motors::each,
    },
    Check {
        id: "stop",
        title: "A disarm command stops a motor",
        about: "A motor turns; this program disarms.",
        run: motors::disarm,
    },
    Check {
        id: "kill",
        title: "The kill switch stops a motor, and keeps it stopped",
        about: "Channel 7 of the radio. Try it before you rely on it.",
        run: motors::kill,
    },
    Check {
        id: "radio",
        title: "Radio loss is seen",
        about: "Turn the transmitter off: the receiver must fall silent, or say that it lost it.",
        run: motors::radio,
    },
    Check {
        id: "bootloader",
        title: "Into the chip's bootloader and back",
        about: "The motors' supply OFF: in a bootloader their lines float.",
        run: boot::bootloader,
    },
    Check {
        id: "settings",
        title: "Settings of a first flight",
        about: "Small fence, low take-off, gentle landing, slow motions, the battery's limits.",
        run: ready::settings,
    },
    Check {
        id: "arming",
        title: "Poses; armed and disarmed in every way, propellers off",
        about: "Poses on. The vehicle will arm: four motors turn slowly.",
        run: ready::arming,
    },
];
