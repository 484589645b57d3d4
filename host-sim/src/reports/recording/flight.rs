//! The messages of one tick of a simulated flight.

use super::drawing::{pose, vector};
use super::schemas::ESTIMATES_SCHEMA;
use super::{Recording, Topic};
use crate::flight::Tick;
use serde_json::json;
use std::io::{self, Write};

/// The topics of a flight besides the common ones.
pub const FLIGHT_TOPICS: &[Topic] = &[("/estimates", ESTIMATES_SCHEMA)];

impl<W: Write> Recording<W> {
    /// Adds a tick.
    ///
    /// # Errors
    /// As the writer's.
    pub fn take(&mut self, tick: &Tick) -> io::Result<()> {
        let (now, s, d) = (tick.time_us, &tick.state, &tick.diagnostics);
        self.truth(now, s)?;
        self.message("/reference", now, &pose(now, &tick.reference.position.cast(), &d.desired_attitude.cast()))?;
        if let Some(measured) = &tick.measured {
            self.message("/told", now, &pose(now, &measured.position.cast(), &measured.attitude.cast()))?;
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
                "force": vector(&estimates.force.cast()),
                "torque": vector(&estimates.torque.cast()),
                "thrust_scale": estimates.scale,
            });
            self.message("/estimates", now, &estimates)?;
        }
        Ok(())
    }
}
