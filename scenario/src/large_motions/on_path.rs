//! The model along the file's own reference: how far it is off, and how far its heading lags.
//!
//! A known path certifies whatever heading it asks for ([`controller_core::certificate::path`]), and the desired frame
//! turns about a tilted thrust axis even where the heading stands still. Yaw follows as fast as it can: here is how far
//! behind that leaves the heading. The model has the drag across that the law counts with, and starts on the reference.
//! A motion that repeats is measured once it has flown for `SETTLING_TIME_S`.

use super::{AT_REST, NotArrived, Start};
use crate::model::Model;
use crate::sampled_loop::LoopTiming;
use controller_core::certificate::certified::Certified;
use controller_core::configuration::LawParameters;
use controller_core::error::ParameterError;
use controller_core::law::Law;
use controller_core::reference::Trajectory;
use std::fmt;

/// s.
const SETTLING_TIME_S: f64 = 15.0;

/// The longest that is flown of one reference, s.
const FLIGHT_DURATION_MAX_S: f64 = 120.0;

/// The name of the start.
const START_NAME: &str = "its own reference";

/// How far off the model is along its reference, at most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnPath {
    /// From where the reference is, m.
    pub distance: f64,
    /// From the reference's heading, rad.
    pub turned: f64,
}

/// A reference to fly: until `end_us`, microseconds, where it rests, or with which it repeats.
pub struct Path<'a> {
    /// The reference.
    pub trajectory: &'a dyn Trajectory,
    /// Its end, or its period.
    pub end_us: u64,
    /// Whether it goes on as it began.
    pub repeats: bool,
    /// How far the model may be off, m.
    pub tolerance: f64,
}

impl Path<'_> {
    /// How `certified` flies it, or where it was when it was farther off than it may be.
    ///
    /// # Errors
    /// If the law refuses the period or the delay.
    pub fn flown(
        &self,
        certified: &Certified,
        timing: &LoopTiming,
    ) -> Result<Result<OnPath, NotArrived>, ParameterError> {
        let mut law = Law::new(certified, timing.period as f32)?;
        let begin = self.trajectory.at(0);
        let [x, y] = begin.heading.direction().map(f64::from).into();
        let start = Start {
            name: START_NAME,
            position: begin.position.map(f64::from).into(),
            velocity: begin.velocity.map(f64::from).into(),
            turned: [0.0, 0.0, y.atan2(x)],
            ..AT_REST
        };
        let mut model = Model::new(certified.configuration().vehicle(), timing, start.body());
        if let LawParameters::Extended(law) = certified.configuration().law() {
            model.drag_across = f64::from(law.parameters.drag_across);
        }
        let settled = if self.repeats { SETTLING_TIME_S } else { 0.0 };
        let end = (settled + self.end_us as f64 * 1e-6).min(FLIGHT_DURATION_MAX_S);
        let mut farthest = OnPath { distance: 0.0, turned: 0.0 };
        for tick in 0..(end / timing.period).ceil() as u64 {
            let time = tick as f64 * timing.period;
            let reference = self.trajectory.at((time * 1e6).round() as u64);
            let distance = (model.body.position - reference.position.map(f64::from)).norm();
            let turned = model.body.heading_error(&reference.heading);
            let lost = time >= settled && distance > self.tolerance;
            let (Ok(command), false) = (law.command(&model.body.measured(), &reference), lost) else {
                return Ok(Err(NotArrived { start: START_NAME, time, distance, turned }));
            };
            if time >= settled {
                farthest = OnPath { distance: farthest.distance.max(distance), turned: farthest.turned.max(turned) };
            }
            model.advance(&command.wrench);
        }
        Ok(Ok(farthest))
    }
}

impl fmt::Display for OnPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { distance, turned } = self;
        write!(f, "at most {:.0} mm and {:.0} degrees of heading off", 1e3 * distance, turned.to_degrees())
    }
}

#[cfg(test)]
mod tests;
