//! One flight: the law flies a [model](scenario::model) from a start, and what that showed.

use super::start::{FLIGHT_DURATION_S, Sets, Start};
use controller_core::certificate::certified::Certified;
use controller_core::error::ParameterError;
use controller_core::heading::Heading;
use controller_core::law::Law;
use controller_core::reference::Reference;
use controller_core::vehicle::Vehicle;
use nalgebra::Vector3;
use scenario::body::BodyState;
use scenario::model::Model;
use scenario::sampled_loop::LoopTiming;

/// What a flight showed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// How far below its reference the vehicle came, m.
    pub height_lost: f64,
    /// When that was, s.
    pub lowest_at: f64,
    /// From when on it stayed within the radius to the flight's end, s; none if it is not there at the end.
    pub settled_after: Option<f64>,
    /// How far away it was on the way, m.
    pub farthest: f64,
    /// How far at the end, m.
    pub distance_at_end: f64,
    /// Whether the law's fallback came.
    pub fell_back: bool,
    /// Whether the law took a rotor that turns for a lost one.
    pub blamed_a_rotor: bool,
}

impl Outcome {
    /// Of a flight that has just begun, at its reference.
    const BEGUN: Self = Self {
        height_lost: 0.0,
        lowest_at: 0.0,
        settled_after: Some(0.0),
        farthest: 0.0,
        distance_at_end: 0.0,
        fell_back: false,
        blamed_a_rotor: false,
    };

    /// Takes in where the vehicle was at a time, s, the reference at the origin.
    fn see(&mut self, time: f64, position: &Vector3<f64>, radius: f64) {
        if -position.z > self.height_lost {
            (self.height_lost, self.lowest_at) = (-position.z, time);
        }
        self.distance_at_end = position.norm();
        let within = self.distance_at_end <= radius;
        self.settled_after = within.then(|| self.settled_after.unwrap_or(time));
        self.farthest = self.farthest.max(self.distance_at_end);
    }
}

/// What every flight has in common.
pub struct Flyer {
    law: Law,
    vehicle: Vehicle,
    timing: LoopTiming,
    sets: Sets,
    radius: f64,
}

impl Flyer {
    /// Flights under the law of `certified`, at its reference once within `radius`, m.
    ///
    /// # Errors
    /// If the law refuses the period or the delay.
    pub fn new(certified: &Certified, timing: &LoopTiming, sets: &Sets, radius: f64) -> Result<Self, ParameterError> {
        let law = Law::new(certified, timing.period as f32)?;
        Ok(Self { law, vehicle: *certified.configuration().vehicle(), timing: *timing, sets: *sets, radius })
    }

    /// What the law flies.
    #[must_use]
    pub fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// Of the law, s.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.timing.period
    }

    /// What the starts are from.
    #[must_use]
    pub fn sets(&self) -> &Sets {
        &self.sets
    }

    /// The flight from `start`.
    #[must_use]
    pub fn flown(&self, start: &Start) -> Outcome {
        let mut outcome = Outcome::BEGUN;
        let ticks = (FLIGHT_DURATION_S / self.timing.period).ceil() as u64;
        let gust = (0..ticks).map(|tick| start.gust.at(tick as f64 * self.timing.period));
        let mut flown = 0;
        let law = self.fly(start, gust, |position| {
            flown += 1;
            outcome.see(flown as f64 * self.timing.period, position, self.radius);
        });
        outcome.settled_after = outcome.settled_after.filter(|_| flown == ticks);
        outcome.fell_back = law.fallback_times() > 0;
        outcome.blamed_a_rotor = law.lost().is_some();
        outcome
    }

    /// Flies from `start`, and in `gust` instead of the start's: a share of the greatest force for each tick. Shows
    /// each tick's last position, m. Returns the law as the flight left it, or as it was when it refused the state.
    pub fn fly(
        &self,
        start: &Start,
        gust: impl IntoIterator<Item = Vector3<f64>>,
        mut see: impl FnMut(&Vector3<f64>),
    ) -> Law {
        let reference = Reference::resting(Vector3::zeros(), Heading::FORWARD);
        let timing = LoopTiming { rotor_lag: self.timing.rotor_lag * start.lag, ..self.timing };
        let body = BodyState {
            position: Vector3::zeros(),
            velocity: start.velocity,
            attitude: start.attitude,
            angular_velocity: start.rates,
        };
        let (mut law, mut model) = (self.law.clone(), Model::new(&self.vehicle, &timing, body));
        model.inertia.component_mul_assign(&start.inertia);
        for share in gust {
            let Ok(command) = law.command(&model.body.measured(), &reference) else { break };
            model.push = share * self.sets.gust;
            // As in flight: rotors are asked for what delivers the wrench by the law's estimate of the thrust.
            model.advance(&command.wrench.scaled(1.0 / law.thrust_scale()));
            see(&model.body.position);
        }
        law
    }
}

#[cfg(test)]
mod tests;
