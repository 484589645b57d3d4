//! Boot, ticks, the port, and the way into the bootloader.

use crate::sessions::first_flight::judge::BootReport;
use crate::sessions::first_flight::outcome::Outcome;
use crate::sessions::first_flight::vehicle::Stop;
use crate::sessions::first_flight::walk::Walk;
use mavlink::dialects::common::{HIGHRES_IMU_DATA, MavCmd, MavResult, NAMED_VALUE_FLOAT_DATA};
use scenario::board;
use std::time::Duration;

/// How long a report of some thirty lines takes, at 20 ms each, and the queue before it.
const REPORT_TIMEOUT: Duration = Duration::from_secs(5);

/// How long a vehicle may take to be heard: certifying takes seconds on a board.
const BOOT_TIMEOUT: Duration = Duration::from_secs(30);

/// How long ticks are watched.
const WATCHED: Duration = Duration::from_secs(10);

/// The part of its period that a tick may take at most.
const TICK_SHARE_MAX: f32 = 0.7;

/// What rests on a table, rad/s, before the gyro is calibrated; and gravity's error, m/s^2.
const REST_RATE_MAX_RAD_PER_S: f32 = 0.06;
const REST_FORCE_ERROR_MAX_M_PER_S2: f32 = 0.6;

/// The report on the boot, against the file's certificate.
pub fn report(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    if walk.vehicle.wait(BOOT_TIMEOUT, |vehicle| vehicle.heartbeat())?.is_none() {
        return Ok(Outcome::Failed("no heartbeat: wiring, baud rate, or it does not boot".to_owned()));
    }
    walk.vehicle.texts();
    let answer = walk.vehicle.command(MavCmd::MAV_CMD_RUN_PREARM_CHECKS, [0.0; 7])?;
    if answer != MavResult::MAV_RESULT_ACCEPTED {
        return Ok(Outcome::Failed(format!("command 401: {answer:?}; disarm it first")));
    }
    let mut texts = Vec::new();
    let report = walk.vehicle.wait(REPORT_TIMEOUT, |vehicle| {
        texts.extend(vehicle.texts());
        Some(BootReport::read(&texts)).filter(|report| report.has_ended)
    })?;
    let Some(report) = report else { return Ok(Outcome::Failed(format!("the report did not end: {texts:?}"))) };
    if let Some(started) = &report.started
        && !started.contains(walk.board.title)
    {
        return Ok(Outcome::Failed(format!("started by {started}, and not a {}", walk.board.title)));
    }
    if report.scenario.as_deref() != Some(&walk.scenario.name) {
        let found = report.scenario.unwrap_or_default();
        return Ok(Outcome::Failed(format!("built with {found:?}, the file is {:?}", walk.scenario.name)));
    }
    if let Some(difference) = report.difference(&walk.verdict) {
        return Ok(Outcome::Failed(format!("another configuration than the file's: {difference}")));
    }
    if !report.is_certified {
        return Ok(Outcome::Failed("not certified: see `host-sim certify`".to_owned()));
    }
    let (built, file) = (walk.vehicle.parameter("CFG_ID")?, board::identity(walk.scenario) as f32);
    // Zero until something of the configuration is set on the vehicle.
    if built != 0.0 && built != file {
        return Ok(Outcome::Failed(format!("CFG_ID {built}, the file's is {file}")));
    }
    let started = report.started.unwrap_or_else(|| "a desk".to_owned());
    Ok(Outcome::Passed(format!("{} inequalities as in the file, certified; started by {started}", report.rows.len())))
}

/// Tick times and samples, at rest.
pub fn ticks(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    walk.vehicle.stream::<HIGHRES_IMU_DATA>(50_000.0)?;
    walk.vehicle.stream::<NAMED_VALUE_FLOAT_DATA>(50_000.0)?;
    walk.vehicle.forget_named();
    let mut worst = (0.0f32, 0.0f32, 0u32);
    walk.vehicle.wait(WATCHED, |vehicle| {
        if let Some((_, force, rate)) = vehicle.imu_sample() {
            worst = (worst.0.max(rate.norm()), worst.1.max((force.norm() - 9.806_65).abs()), worst.2 + 1);
        }
        None::<()>
    })?;
    let named = ["TICK_MAX", "TICK_LATE", "TICK_MISS", "IMU_GAPS"].map(|name| walk.vehicle.named(name));
    let [Some(longest), Some(late), Some(missed), Some(gaps)] = named else {
        return Ok(Outcome::Failed("no tick times: no report from control".to_owned()));
    };
    let period = walk.scenario.timing.period_us as f32;
    let (rate, force, seen) = worst;
    let figures = format!(
        "longest tick {longest} of {period} us, late {late} us, missed {missed}, IMU gaps {gaps}; at rest {rate:.3} \
         rad/s, gravity off by {force:.2} m/s^2"
    );
    let is_well = seen > 0
        && missed == 0.0
        && longest <= TICK_SHARE_MAX * period
        && rate <= REST_RATE_MAX_RAD_PER_S
        && force <= REST_FORCE_ERROR_MAX_M_PER_S2;
    Ok(if is_well { Outcome::Passed(figures) } else { Outcome::Failed(figures) })
}

/// USB pulled out and put in again: ticks go on.
pub fn port(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    if !walk.confirm("usb", "Is this link USB?")? {
        return Ok(Outcome::Skipped("the link is no USB".to_owned()));
    }
    walk.person.tell("usb.out", "Pull the plug out. (The board needs its battery for this, motors' supply off.)");
    if walk.vehicle.wait(BOOT_TIMEOUT, |vehicle| (!vehicle.is_connected()).then_some(()))?.is_none() {
        return Ok(Outcome::Failed("the port did not go away".to_owned()));
    }
    walk.person.tell("usb.in", "Put it in again.");
    walk.vehicle.forget_named();
    let missed = walk.vehicle.wait(BOOT_TIMEOUT, |vehicle| {
        vehicle.named("TICK_MISS").filter(|_| vehicle.is_connected() && vehicle.heartbeat().is_some())
    })?;
    Ok(match missed {
        Some(0.0) => Outcome::Passed("came back; no tick missed".to_owned()),
        Some(missed) => Outcome::Failed(format!("{missed} ticks missed")),
        None => Outcome::Failed("did not come back".to_owned()),
    })
}

/// Into the chip's bootloader, and back.
pub fn bootloader(walk: &mut Walk<'_>) -> Result<Outcome, Stop> {
    let text = "Try the way into the chip's bootloader? The motors' supply must be OFF. Not behind a kept bootloader.";
    if !walk.confirm("bootloader", text)? {
        return Ok(Outcome::Skipped("not tried".to_owned()));
    }
    let answer =
        walk.vehicle.command(MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, [3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])?;
    if answer != MavResult::MAV_RESULT_ACCEPTED {
        return Ok(Outcome::Failed(format!("command 246: {answer:?}")));
    }
    let listed = walk.confirm("bootloader.listed", "Does `dfu-util -l` list a device 0483:df11?")?;
    let back = if listed { "Leave it (`dfu-util … :leave`)" } else { "Take power off and on" };
    walk.person.tell("bootloader.back", &format!("{back}; the vehicle is awaited."));
    walk.vehicle.pass(Duration::from_secs(3))?;
    let is_back = walk.vehicle.wait(2 * BOOT_TIMEOUT, |vehicle| vehicle.heartbeat())?.is_some();
    Ok(match (listed, is_back) {
        (true, true) => Outcome::Passed("listed as 0483:df11; came back".to_owned()),
        (false, _) => Outcome::Failed("not listed".to_owned()),
        (true, false) => Outcome::Failed("did not come back within a minute".to_owned()),
    })
}
