//! Settings of a first flight, and arming with propellers off.

use super::motors::stands;
use crate::sessions::first_flight::outcome::Outcome;
use crate::sessions::first_flight::vehicle::{Stop, Vehicle};
use crate::sessions::first_flight::walk::Walk;
use mavlink::dialects::common::{MavCmd, MavModeFlag, MavResult, MavSysStatusSensor};
use nalgebra::Vector3;
use std::time::Duration;

/// Settings, and what they are for a first flight.
const SETTINGS: [(&str, f32); 7] = [
    ("FENCE_RADIUS", 2.0),
    ("FENCE_HEIGHT", 2.0),
    ("TKO_ALT", 0.5),
    ("LAND_SPEED", 0.3),
    ("GOV_SPEED_XY", 0.5),
    ("GOV_SPEED_Z", 0.5),
    ("TRACK_ERR", 0.5),
];

/// How long a vehicle may take to be carried, or to get ready.
const CARRY_TIMEOUT: Duration = Duration::from_secs(60);

/// How far it is carried at least, m, and how far it may stray meanwhile.
const CARRIED_MIN_M: f32 = 0.5;

/// How long a vehicle idles by itself, and what a word may take.
const IDLING_TIMEOUT: Duration = Duration::from_secs(13);
const WORD_TIMEOUT: Duration = Duration::from_secs(4);

/// The number that forces, in parameter 2.
const FORCE_NUMBER: f32 = 21196.0;

const ARM_DISARM: MavCmd = MavCmd::MAV_CMD_COMPONENT_ARM_DISARM;

/// Set, read back, kept from the next boot on.
pub fn settings(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    let mut wrong = Vec::new();
    for (name, wanted) in SETTINGS {
        let found = walk.vehicle.parameter(name)?;
        if (found - wanted).abs() > 1e-3 {
            wrong.push((name, wanted, found));
        }
    }
    if !wrong.is_empty() {
        let list: Vec<_> = wrong.iter().map(|(name, wanted, found)| format!("{name} {found} -> {wanted}")).collect();
        if walk.confirm("settings", &format!("Set these? {}", list.join(", ")))? {
            for (name, wanted, _) in &wrong {
                let found = walk.vehicle.set_parameter(name, *wanted)?;
                if (found - wanted).abs() > 1e-3 {
                    return Ok(Outcome::Failed(format!("{name} stays {found}")));
                }
            }
            // The governor's count from the next boot on.
            walk.vehicle.pass(Duration::from_secs(2))?;
            let restart = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            let answer = walk.vehicle.command(MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, restart)?;
            if answer != MavResult::MAV_RESULT_ACCEPTED {
                return Ok(Outcome::Failed(format!("restart: {answer:?}")));
            }
            walk.vehicle.pass(Duration::from_secs(3))?;
            for (name, wanted, _) in &wrong {
                let found = walk.vehicle.parameter(name)?;
                if (found - wanted).abs() > 1e-3 {
                    return Ok(Outcome::Failed(format!("{name} is {found} after the restart")));
                }
            }
        } else {
            return Ok(Outcome::Failed(list.join(", ")));
        }
    }
    for (name, key, what) in [("BAT_LOW", "settings.low", "low"), ("BAT_CRIT", "settings.critical", "almost empty")] {
        if walk.board.is_h743
            && walk.vehicle.parameter(name)? == 0.0
            && let Some(volts) = walk.number(key, &format!("{name}: below how many V is the battery {what}? (skip)"))?
        {
            walk.vehicle.set_parameter(name, volts as f32)?;
        }
    }
    let low = walk.vehicle.parameter("BAT_LOW")?;
    let critical = walk.vehicle.parameter("BAT_CRIT")?;
    if walk.board.is_h743 && !(critical > 0.0 && low > critical) {
        return Ok(Outcome::Failed(format!("BAT_LOW {low} V, BAT_CRIT {critical} V: set both, your battery's")));
    }
    let list: Vec<_> = SETTINGS.iter().map(|(name, wanted)| format!("{name} {wanted}")).collect();
    Ok(Outcome::Passed(format!("{}; BAT_LOW {low} V, BAT_CRIT {critical} V", list.join(", "))))
}

/// Carries it one way, m, in MAVLink's axes; how far off it was seen, if it was not.
fn carried(walk: &mut Walk<'_>, key: &str, text: &str, way: Vector3<f32>) -> Result<Result<(), String>, Stop> {
    let Some(from) = walk.vehicle.wait(CARRY_TIMEOUT, |vehicle| vehicle.position())? else {
        return Ok(Err("no position: poses on?".to_owned()));
    };
    walk.person.tell(key, text);
    let mut moved = Vector3::zeros();
    let found = walk.vehicle.wait(CARRY_TIMEOUT, |vehicle| {
        moved = vehicle.position()? - from;
        let along = moved.dot(&way);
        (along > CARRIED_MIN_M && along > 0.8 * moved.norm()).then_some(())
    })?;
    let seen =
        format!("{key}: moved {:.2} {:.2} {:.2} m north, east, down: frames of the bridge", moved.x, moved.y, moved.z);
    Ok(found.ok_or(seen))
}

/// Arms; what was said instead, if it did not.
fn armed(walk: &mut Walk<'_>) -> Result<Result<(), String>, Stop> {
    walk.vehicle.texts();
    let answer = walk.vehicle.command(ARM_DISARM, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])?;
    let is_armed = walk.vehicle.wait(WORD_TIMEOUT, |vehicle| vehicle.has_said("Armed: idling").then_some(()))?;
    let words = walk.vehicle.texts().pop().unwrap_or_default();
    Ok(is_armed.ok_or_else(|| format!("arming: {answer:?}: {words}")))
}

/// Waits for a word, and that the vehicle is disarmed then.
fn ended(walk: &mut Walk<'_>, word: &str, timeout: Duration) -> Result<Result<(), String>, Stop> {
    let has_said = walk.vehicle.wait(timeout, |vehicle| vehicle.has_said(word).then_some(()))?.is_some();
    let is_armed = |vehicle: &mut Vehicle| (!vehicle.has(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED)).then_some(());
    let is_disarmed = walk.vehicle.wait(WORD_TIMEOUT, is_armed)?.is_some();
    Ok(if has_said && is_disarmed { Ok(()) } else { Err(format!("\"{word}\" was not said")) })
}

/// Poses carried, then armed and disarmed in every way.
pub fn arming(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    if !walk.confirm("arming", "Poses on, supply on? (no: this check is left for later)")? {
        return Ok(Outcome::Skipped("no poses yet".to_owned()));
    }
    if !walk.has_no_propellers()? || !stands(walk)? {
        return Ok(Outcome::Failed("propellers off first".to_owned()));
    }
    for (key, text, way) in [
        ("arming.north", "Carry it 1 m north, and set it down.", Vector3::x()),
        ("arming.east", "Carry it 1 m east, and set it down.", Vector3::y()),
        ("arming.up", "Lift it 1 m up, and hold it there.", -Vector3::z()),
    ] {
        if let Err(words) = carried(walk, key, text, way)? {
            return Ok(Outcome::Failed(words));
        }
    }
    walk.person.tell("arming.down", "Set it down, level, and step back.");
    let is_ready = walk.vehicle.wait(CARRY_TIMEOUT, |vehicle| {
        let health = vehicle.status()?.onboard_control_sensors_health;
        health.contains(MavSysStatusSensor::MAV_SYS_STATUS_PREARM_CHECK).then_some(())
    })?;
    if is_ready.is_none() {
        let words = walk.vehicle.texts().pop().unwrap_or_default();
        return Ok(Outcome::Failed(format!("not ready to arm: {words}")));
    }
    if let Err(words) = armed(walk)? {
        return Ok(Outcome::Failed(words));
    }
    if !walk.confirm("arming.idle", "Do all four motors turn, slowly, each its way? (It disarms by itself.)")? {
        walk.vehicle.command(ARM_DISARM, [0.0, FORCE_NUMBER, 0.0, 0.0, 0.0, 0.0, 0.0])?;
        return Ok(Outcome::Failed("not all motors idle".to_owned()));
    }
    if let Err(words) = ended(walk, "Disarmed: nothing commanded for 10 s", IDLING_TIMEOUT)? {
        return Ok(Outcome::Failed(words));
    }
    for force in [0.0, FORCE_NUMBER] {
        if let Err(words) = armed(walk)? {
            return Ok(Outcome::Failed(words));
        }
        walk.vehicle.command(ARM_DISARM, [0.0, force, 0.0, 0.0, 0.0, 0.0, 0.0])?;
        if let Err(words) = ended(walk, "Disarmed by command", WORD_TIMEOUT)? {
            return Ok(Outcome::Failed(words));
        }
    }
    if let Err(words) = armed(walk)? {
        return Ok(Outcome::Failed(words));
    }
    walk.vehicle.speak(false);
    let lost = ended(walk, "Disarmed: ground station lost", WORD_TIMEOUT);
    walk.vehicle.speak(true);
    Ok(match lost? {
        Ok(()) => Outcome::Passed(
            "carried as told; armed; disarmed by itself, by command, by force, without heartbeats".to_owned(),
        ),
        Err(words) => Outcome::Failed(format!("{words}: another ground station, or a radio, still speaks")),
    })
}
