//! What a tick of a simulated flight adds to its recording.

use super::drawing::{pose, transform, vector};
use super::{Recording, Topic};
use crate::flight::Tick;
use crate::recording::schemas::{ESTIMATES, FRAME_TRANSFORM, LAW, POSE_IN_FRAME, ROTORS, SCENE_UPDATE};
use serde_json::json;
use std::io::{self, Write};

/// What a flight is recorded as.
pub const TOPICS: &[Topic] = &[
    ("/vehicle", POSE_IN_FRAME),
    ("/reference", POSE_IN_FRAME),
    ("/told", POSE_IN_FRAME),
    ("/tf", FRAME_TRANSFORM),
    ("/scene", SCENE_UPDATE),
    ("/law", LAW),
    ("/rotors", ROTORS),
    ("/estimates", ESTIMATES),
];

impl<W: Write> Recording<W> {
    /// Adds a tick.
    ///
    /// # Errors
    /// As the writer's.
    pub fn take(&mut self, tick: &Tick) -> io::Result<()> {
        let (now, s, d) = (tick.time_us, &tick.state, &tick.diagnostics);
        self.message("/vehicle", now, &pose(now, &s.position, &s.attitude))?;
        self.message("/tf", now, &transform(now, &s.position, &s.attitude))?;
        self.message("/reference", now, &pose(now, &tick.reference.position.cast(), &d.desired_attitude.cast()))?;
        if let Some(told) = &tick.measured {
            self.message("/told", now, &pose(now, &told.position.cast(), &told.attitude.cast()))?;
        }
        let law = json!({
            "thrust": tick.wrench.thrust,
            "torque": vector(&tick.wrench.torque.cast()),
            "position_error": d.position_error.norm(),
            "attitude_error": d.mrp.norm(),
            "lift_sign": d.lift_sign,
            "feedback": vector(&d.feedback.cast()),
            "clipped": tick.clipped,
        });
        self.message("/law", now, &law)?;
        if !tick.rotors.is_empty() {
            self.message("/rotors", now, &json!({ "thrust": tick.rotors }))?;
        }
        if let Some(estimates) = &tick.estimates {
            let estimates = json!({
                "force": vector(&estimates.force.value.cast()),
                "torque": vector(&estimates.torque.cast()),
                "thrust_scale": estimates.scale,
            });
            self.message("/estimates", now, &estimates)?;
        }
        Ok(())
    }
}
