//! Battery, frames, each motor, and the ways to stop one on the bench.

use crate::sessions::first_flight::judge::{direction, place};
use crate::sessions::first_flight::outcome::Outcome;
use crate::sessions::first_flight::vehicle::Stop;
use crate::sessions::first_flight::walk::Walk;
use mavlink::dialects::common::{MavCmd, MavModeFlag, MavResult, VIBRATION_DATA};
use std::time::Duration;

/// The part by which two readings of a battery may differ.
const VOLTAGE_ERROR_MAX: f64 = 0.05;

/// Levels at which a motor is tried, from the lowest on, parts of the command's range.
const LEVELS: [f32; 6] = [0.03, 0.05, 0.07, 0.09, 0.12, 0.15];

/// How long a motor turns in a test, s: the longest that the vehicle grants.
const TEST_S: f32 = 2.0;

/// ArduPilot's limit of a healthy vibration, m/s^2.
const VIBRATION_MAX_M_PER_S2: f32 = 15.0;

/// How long a motor may take to stop.
const STOP_TIMEOUT: Duration = Duration::from_secs(3);

/// How long a person may take at a switch.
const SWITCH_TIMEOUT: Duration = Duration::from_secs(30);

/// Where a person may say that a motor is.
const PLACES: [&str; 10] =
    ["front left", "front right", "rear right", "rear left", "front", "rear", "left", "right", "none", "again"];

/// The voltage, against a meter.
pub fn battery(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    if !walk.board.is_h743 {
        return Ok(Outcome::Skipped("this board measures none".to_owned()));
    }
    let Some(meter) = walk.number("battery.meter", "What does a meter show at the battery, V? (skip: none)")? else {
        return Ok(Outcome::Skipped("no meter".to_owned()));
    };
    let shown = walk.vehicle.wait(STOP_TIMEOUT, |vehicle| {
        vehicle.status().map(|status| status.voltage_battery).filter(|millivolts| *millivolts != u16::MAX)
    })?;
    let Some(millivolts) = shown else { return Ok(Outcome::Failed("the vehicle shows no voltage".to_owned())) };
    let volts = f64::from(millivolts) * 1e-3;
    let figures = format!("{volts:.2} V, the meter {meter:.2} V");
    let is_near = (volts - meter).abs() <= VOLTAGE_ERROR_MAX * meter;
    Ok(if is_near { Outcome::Passed(figures) } else { Outcome::Failed(format!("{figures}: a wrong divider")) })
}

/// The motors' line.
pub fn frames(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    Ok(match walk.choose("frames", "Are the frames so?", &["yes", "no", "skip"])?.as_str() {
        "yes" => Outcome::Passed("as described".to_owned()),
        "no" => Outcome::Failed("the frames differ".to_owned()),
        _ => Outcome::Skipped("no oscilloscope".to_owned()),
    })
}

/// Turns a motor, from 1, for so many s; what was answered.
fn turn(walk: &mut Walk<'_>, motor: usize, level: f32, seconds: f32) -> Result<MavResult, Stop> {
    walk.vehicle.command(MavCmd::MAV_CMD_ACTUATOR_TEST, [level, seconds, 0.0, 0.0, motor as f32, 0.0, 0.0])
}

/// Whether a motor test is under way, by the heartbeat: asked for until it says so, or the other.
fn awaited(walk: &mut Walk<'_>, turns: bool, timeout: Duration) -> Result<bool, Stop> {
    let found = walk.vehicle.wait(timeout, |vehicle| {
        (vehicle.heartbeat().is_some() && vehicle.has(MavModeFlag::MAV_MODE_FLAG_TEST_ENABLED) == turns).then_some(())
    })?;
    Ok(found.is_some())
}

/// Each motor: where it is, which way it turns, and from which level on.
pub fn each(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    let Some(rotors) = walk.scenario.configuration.rotors().cloned() else {
        return Ok(Outcome::Failed("the file has no rotors".to_owned()));
    };
    if !walk.has_no_propellers()? {
        return Ok(Outcome::Failed("propellers off first".to_owned()));
    }
    walk.vehicle.stream::<VIBRATION_DATA>(100_000.0)?;
    let clipped_before = walk.vehicle.vibration().map_or(0, |(_, clipped)| clipped);
    let (mut greatest, mut shaken, mut clipped) = (0.0f32, None::<f32>, clipped_before);
    for (index, rotor) in rotors.iter().enumerate() {
        let motor = index + 1;
        let (expected, way) = (place(rotor), direction(rotor));
        let mut levels = LEVELS.iter().copied().peekable();
        let found = loop {
            let Some(level) = levels.peek().copied() else {
                return Ok(Outcome::Failed(format!("motor {motor} does not turn at {:.0} %", 100.0 * LEVELS[5])));
            };
            walk.person
                .tell(&format!("motors.{motor}"), &format!("Motor {motor} turns at {:.0} % for 2 s.", 100.0 * level));
            let answer = turn(walk, motor, level, TEST_S)?;
            if answer != MavResult::MAV_RESULT_ACCEPTED {
                let words = walk.vehicle.texts().pop().unwrap_or_default();
                return Ok(Outcome::Failed(format!("motor {motor}: {answer:?}: {words}")));
            }
            let end = walk.vehicle.now() + Duration::from_secs_f32(TEST_S);
            while walk.vehicle.now() < end {
                walk.vehicle.serve()?;
                if let Some((level, count)) = walk.vehicle.vibration() {
                    (shaken, clipped) = (Some(shaken.unwrap_or(0.0).max(level.max())), clipped.max(count));
                }
            }
            let answer = walk.choose(&format!("motors.{motor}.place"), "Which motor turned?", &PLACES)?;
            match answer.as_str() {
                "again" => {}
                "none" => drop(levels.next()),
                _ => break (answer, level),
            }
        };
        let (answer, level) = found;
        if answer != expected {
            return Ok(Outcome::Failed(format!(
                "motor {motor} is {answer}, in the file {expected}: MOT_ORDER, or wires"
            )));
        }
        let turned = walk.choose(&format!("motors.{motor}.way"), "Which way, seen from above?", &["cw", "ccw"])?;
        if turned != way {
            let remedy = format!("command 311 (parameter 1 = 5, parameter 5 = {motor}), or swap two of its wires");
            return Ok(Outcome::Failed(format!("motor {motor} turns {turned}, in the file {way}: {remedy}")));
        }
        greatest = greatest.max(level);
    }
    let idle = walk.vehicle.parameter("MOT_IDLE")?;
    let Some(shaken) = shaken else { return Ok(Outcome::Failed("VIBRATION does not come".to_owned())) };
    let figures = format!(
        "each in its place, each the right way; all turn at {:.0} %, MOT_IDLE {:.1} %; vibration {shaken:.1} m/s^2, {} \
         samples at full scale",
        100.0 * greatest,
        100.0 * idle,
        clipped - clipped_before
    );
    if idle < greatest {
        return Ok(Outcome::Failed(format!("{figures}: MOT_IDLE must be {:.0} % or more", 100.0 * greatest)));
    }
    let is_calm = shaken <= VIBRATION_MAX_M_PER_S2 && clipped == clipped_before;
    Ok(if is_calm { Outcome::Passed(figures) } else { Outcome::Failed(format!("{figures}: too much")) })
}

/// A disarm command, while a motor turns.
pub fn disarm(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    if !walk.has_no_propellers()? {
        return Ok(Outcome::Failed("propellers off first".to_owned()));
    }
    let level = walk.vehicle.parameter("MOT_IDLE")?.max(LEVELS[0]);
    if turn(walk, 1, level, TEST_S)? != MavResult::MAV_RESULT_ACCEPTED {
        return Ok(Outcome::Failed("the motor test was refused".to_owned()));
    }
    walk.vehicle.texts();
    let begin = walk.vehicle.now();
    let answer = walk.vehicle.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [0.0; 7])?;
    let has_said = walk.vehicle.wait(STOP_TIMEOUT, |vehicle| vehicle.has_said("Disarmed by command").then_some(()))?;
    let took = (walk.vehicle.now() - begin).as_millis();
    Ok(match (answer, has_said) {
        (MavResult::MAV_RESULT_ACCEPTED, Some(())) => Outcome::Passed(format!("disarmed, heard after {took} ms")),
        _ => Outcome::Failed(format!("{answer:?}, and \"Disarmed by command\" was not said")),
    })
}

/// The kill switch, while a motor turns, and afterwards.
pub fn kill(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    if !walk.board.is_h743 {
        return Ok(Outcome::Skipped("this board has no radio receiver".to_owned()));
    }
    if !walk.confirm("kill", "Is there a radio, its transmitter on, its kill switch (channel 7) off?")? {
        return Ok(Outcome::Skipped("no radio".to_owned()));
    }
    if !walk.has_no_propellers()? {
        return Ok(Outcome::Failed("propellers off first".to_owned()));
    }
    let level = walk.vehicle.parameter("MOT_IDLE")?.max(LEVELS[0]);
    if turn(walk, 1, level, TEST_S)? != MavResult::MAV_RESULT_ACCEPTED {
        return Ok(Outcome::Failed("the motor test was refused: is the kill switch on?".to_owned()));
    }
    walk.vehicle.texts();
    walk.person.tell("kill.on", "Motor 1 turns until you move the kill switch: now.");
    let end = walk.vehicle.now() + SWITCH_TIMEOUT;
    let stopped = loop {
        // Each renews the one before: the motor turns on.
        let answer = turn(walk, 1, level, TEST_S)?;
        if walk
            .vehicle
            .wait(Duration::from_secs(1), |vehicle| vehicle.has_said("Stopped: kill switch").then_some(()))?
            .is_some()
        {
            break true;
        }
        if answer != MavResult::MAV_RESULT_ACCEPTED || walk.vehicle.now() >= end {
            break false;
        }
    };
    if !stopped {
        return Ok(Outcome::Failed("\"Stopped: kill switch\" was not said".to_owned()));
    }
    if turn(walk, 1, level, TEST_S)? == MavResult::MAV_RESULT_ACCEPTED {
        return Ok(Outcome::Failed("a motor turned while the kill switch was on".to_owned()));
    }
    if !walk.confirm("kill.stood", "Did the motor stop at once, and stand still?")? {
        return Ok(Outcome::Failed("the motor did not stop".to_owned()));
    }
    walk.person.tell("kill.off", "Move the kill switch back.");
    walk.vehicle.pass(Duration::from_secs(3))?;
    Ok(Outcome::Passed("stopped the motor; refused another test".to_owned()))
}

/// A transmitter that is turned off.
pub fn radio(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    if !walk.board.is_h743 {
        return Ok(Outcome::Skipped("this board has no radio receiver".to_owned()));
    }
    if !walk.confirm("radio", "Is there a radio, its transmitter on?")? {
        return Ok(Outcome::Skipped("no radio".to_owned()));
    }
    walk.vehicle.texts();
    walk.person.tell("radio.off", "Turn the transmitter off.");
    let begin = walk.vehicle.now();
    if walk.vehicle.wait(SWITCH_TIMEOUT, |vehicle| vehicle.has_said("Radio lost").then_some(()))?.is_none() {
        let what = "the receiver goes on sending: set it to send nothing when it hears nothing";
        return Ok(Outcome::Failed(format!(
            "\"Radio lost\" was not said within {} s: {what}",
            (walk.vehicle.now() - begin).as_secs()
        )));
    }
    walk.person.tell("radio.on", "Turn it on again.");
    let is_back = walk.vehicle.wait(SWITCH_TIMEOUT, |vehicle| vehicle.has_said("Radio received").then_some(()))?;
    Ok(match is_back {
        Some(()) => Outcome::Passed("lost, and received again".to_owned()),
        None => Outcome::Failed("\"Radio received\" was not said".to_owned()),
    })
}

/// Waits until no motor test runs any more.
pub fn stands(walk: &mut Walk<'_>) -> Result<bool, Stop> {
    awaited(walk, false, STOP_TIMEOUT)
}
