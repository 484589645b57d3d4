//! Axes, calibration, and the thrusts with which the law would level the vehicle.

use crate::sessions::first_flight::judge::{Hold, wrong_share};
use crate::sessions::first_flight::outcome::Outcome;
use crate::sessions::first_flight::vehicle::Stop;
use crate::sessions::first_flight::walk::{HAND_TIMEOUT, Walk};
use mavlink::dialects::common::{HIGHRES_IMU_DATA, MavCmd, MavResult, NAMED_VALUE_FLOAT_DATA};
use nalgebra::Vector3;
use std::time::Duration;

/// How long something must be shown.
const SHOWN_FOR: Duration = Duration::from_millis(400);

/// How long a calibration of six sides may take, and one of a second.
const SIDES_TIMEOUT: Duration = Duration::from_secs(360);
const REST_TIMEOUT: Duration = Duration::from_secs(10);

/// Waits until a hold is shown for a while; what was felt then, and the last if it never was.
fn shown(walk: &mut Walk<'_>, hold: Hold) -> Result<Result<Vector3<f32>, String>, Stop> {
    walk.person.tell(&format!("axes.{}", hold.name()), hold.instruction());
    let (mut turned, mut last, mut since) = (Vector3::zeros(), None, None);
    let mut felt = Vector3::zeros();
    let found = walk.vehicle.wait(HAND_TIMEOUT, |vehicle| {
        let (time, force, rate) = vehicle.imu_sample()?;
        if let Some(before) = last
            && time > before
        {
            turned += rate * ((time - before) as f32 * 1e-6);
        }
        last = Some(time);
        felt = force;
        if !hold.is_shown(&force, &turned) {
            since = None;
            return None;
        }
        let since = *since.get_or_insert_with(|| vehicle.now());
        (vehicle.now() - since >= SHOWN_FOR).then_some(force)
    })?;
    let was = format!(
        "{}: force {:.1} {:.1} {:.1} m/s^2, turned {:.2} {:.2} {:.2} rad",
        hold.name(),
        felt.x,
        felt.y,
        felt.z,
        turned.x,
        turned.y,
        turned.z
    );
    Ok(found.ok_or(was))
}

/// Four ways to hold it.
pub fn axes(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    walk.vehicle.stream::<HIGHRES_IMU_DATA>(20_000.0)?;
    let mut figures = Vec::new();
    for hold in Hold::ALL {
        match shown(walk, hold)? {
            Ok(force) => figures.push(format!("{} {:.1} {:.1} {:.1}", hold.name(), force.x, force.y, force.z)),
            Err(was) => {
                return Ok(Outcome::Failed(format!("{was}: the mounting in the board's file is not this board's")));
            }
        }
        if hold != Hold::ALL[3] {
            let text = "Lay it flat again.";
            walk.person.tell(&format!("axes.{}.back", hold.name()), text);
            walk.vehicle.wait(HAND_TIMEOUT, |vehicle| {
                let (_, force, rate) = vehicle.imu_sample()?;
                (Hold::Flat.is_shown(&force, &Vector3::zeros()) && rate.norm() < 0.1).then_some(())
            })?;
        }
    }
    Ok(Outcome::Passed(format!("{} m/s^2", figures.join("; "))))
}

/// A calibration, to its end; the last words about it where it fails.
fn calibrated(walk: &mut Walk<'_>, parameters: [f32; 7], timeout: Duration) -> Result<Result<(), String>, Stop> {
    const COMMAND: MavCmd = MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION;
    walk.vehicle.texts();
    let mut result = walk.vehicle.command(COMMAND, parameters)?;
    let end = walk.vehicle.now() + timeout;
    let mut words = String::new();
    while result == MavResult::MAV_RESULT_IN_PROGRESS && walk.vehicle.now() < end {
        walk.vehicle.serve()?;
        for text in walk.vehicle.texts() {
            walk.person.tell("calibration.progress", &text);
            words = text;
        }
        result = walk.vehicle.answer(COMMAND).unwrap_or(result);
    }
    Ok(if result == MavResult::MAV_RESULT_ACCEPTED { Ok(()) } else { Err(format!("{result:?}: {words}")) })
}

/// Gyro, six sides, level.
pub fn calibration(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    let steps = [
        ("gyro", "Leave it lying still, then answer.", [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], REST_TIMEOUT),
        (
            "sides",
            "Six sides, in any order, each held still for a second or two (flat, on its back, on each edge). Ready?",
            [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            SIDES_TIMEOUT,
        ),
        (
            "level",
            "Stand it level, as before a take-off: what is level now is what it will hover by. Ready?",
            [0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0],
            REST_TIMEOUT,
        ),
    ];
    for (name, text, parameters, timeout) in steps {
        let answer = walk.choose(&format!("calibration.{name}"), text, &["ready", "kept"])?;
        if answer == "kept" {
            continue;
        }
        if let Err(words) = calibrated(walk, parameters, timeout)? {
            return Ok(Outcome::Failed(format!("{name}: {words}")));
        }
    }
    walk.vehicle.stream::<NAMED_VALUE_FLOAT_DATA>(50_000.0)?;
    walk.vehicle.forget_named();
    let names = ["CAL_GYRO", "CAL_ACCEL", "CAL_LEVEL"];
    let found = walk.vehicle.wait(Duration::from_secs(10), |vehicle| {
        names.iter().map(|name| vehicle.named(name)).collect::<Option<Vec<f32>>>()
    })?;
    Ok(match found.as_deref() {
        Some([1.0, 1.0, 1.0]) => Outcome::Passed("gyro, accelerometer and level".to_owned()),
        Some(found) => Outcome::Failed(format!("gyro, accelerometer, level: {found:?}; 0 is not calibrated")),
        None => Outcome::Failed("the calibration's state does not come".to_owned()),
    })
}

/// Which rotors would speed up.
pub fn levelling(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    let Some(rotors) = walk.scenario.configuration.rotors().cloned() else {
        return Ok(Outcome::Failed("the file has no rotors".to_owned()));
    };
    walk.vehicle.stream::<HIGHRES_IMU_DATA>(20_000.0)?;
    walk.vehicle.stream::<NAMED_VALUE_FLOAT_DATA>(10_000.0)?;
    let mut figures = Vec::new();
    for hold in [Hold::NoseUp, Hold::LeftUp, Hold::TurnedLeft] {
        walk.person.tell(&format!("tilt.{}", hold.name()), hold.instruction());
        let mut last = String::new();
        let mut held = None;
        let found = walk.vehicle.wait(HAND_TIMEOUT, |vehicle| {
            let (_, force, rate) = vehicle.imu_sample()?;
            if !hold.is_held(&force, &rate) {
                // Shares of another hold.
                vehicle.forget_named();
                held = None;
                return None;
            }
            let since = *held.get_or_insert_with(|| vehicle.now());
            let names = ["LEVEL_M1", "LEVEL_M2", "LEVEL_M3", "LEVEL_M4"];
            let shares = names.iter().map(|name| vehicle.named(name)).collect::<Option<Vec<f32>>>()?;
            let words: Vec<_> = shares.iter().map(|share| format!("{share:.3}")).collect();
            last = words.join(" ");
            let is_right = wrong_share(hold, &rotors, &shares).is_none();
            (is_right && vehicle.now() - since >= SHOWN_FOR).then_some(())
        })?;
        if found.is_none() {
            let last = if last.is_empty() { "not held, or no shares came".to_owned() } else { last };
            return Ok(Outcome::Failed(format!("{}: {last}; rotors of the file, mounting", hold.name())));
        }
        figures.push(format!("{} {last}", hold.name()));
    }
    Ok(Outcome::Passed(format!("thrusts of M1 to M4 over their mean: {}", figures.join("; "))))
}
