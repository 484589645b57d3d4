//! The messages of a session with the firmware: the true vehicle, its estimate, and its texts.

use super::drawing::{pose, stamp, vector};
use super::schemas::{LOG_SCHEMA, STATE_SCHEMA};
use super::{Recording, Topic};
use firmware::shared::Report;
use scenario::body::{BodyState, attitude_from_euler};
use serde_json::json;
use std::io::{self, Write};

/// The topics of a session besides the common ones.
pub const SESSION_TOPICS: &[Topic] = &[("/state", STATE_SCHEMA), ("/log", LOG_SCHEMA)];

/// Foxglove's.
const INFORMATION_LEVEL: u8 = 2;

/// One moment of a session.
#[derive(Debug, Clone)]
pub struct SessionMoment {
    /// The vehicle's time, us.
    pub now: u64,
    /// Where it really is.
    pub truth: BodyState,
    /// Its rotors' true thrusts, N.
    pub rotors: Vec<f64>,
    /// The report of the last control tick, if any.
    pub report: Option<Report>,
    /// The battery as it is measured, V, if it is.
    pub voltage: Option<f32>,
}

impl<W: Write> Recording<W> {
    /// Adds a moment.
    ///
    /// # Errors
    /// As the writer's.
    pub fn moment(&mut self, moment: &SessionMoment) -> io::Result<()> {
        let SessionMoment { now, truth, rotors, report, voltage } = moment;
        let now = *now;
        self.truth(now, truth)?;
        self.message("/rotors", now, &json!({ "thrust": rotors }))?;
        let Some(report) = report else { return Ok(()) };
        if let Some(measured) = &report.state {
            self.message("/told", now, &pose(now, &measured.position.cast(), &measured.attitude.cast()))?;
        }
        if let Some(reference) = &report.reference {
            let ahead = reference.heading.direction();
            let level = attitude_from_euler(0.0, 0.0, f64::from(ahead.y).atan2(f64::from(ahead.x)));
            self.message("/reference", now, &pose(now, &reference.position.cast(), &level))?;
        }
        if let (Some(wrench), Some(reference), Some(measured)) = (&report.wrench, &report.reference, &report.state) {
            let law = json!({
                "thrust": wrench.thrust,
                "torque": vector(&wrench.torque.cast()),
                "position_error": (measured.position - reference.position).norm(),
            });
            self.message("/law", now, &law)?;
        }
        let state = json!({
            "mode": report.mode.text(),
            "ready": report.ready,
            "airborne": report.is_airborne,
            "battery": voltage,
            "pose_age": report.health.pose_age.map(|age| age as f64 * 1e-6),
            "thrust_scale": report.thrust_scale,
            "missed_ticks": report.timing.missed,
        });
        self.message("/state", now, &state)
    }

    /// Adds a text that the vehicle said at `time`, us.
    ///
    /// # Errors
    /// As the writer's.
    pub fn write_text(&mut self, time: u64, text: &str) -> io::Result<()> {
        let log = json!({
            "timestamp": stamp(time),
            "level": INFORMATION_LEVEL,
            "message": text,
            "name": "vehicle",
            "file": "",
            "line": 0,
        });
        self.message("/log", time, &log)
    }
}
