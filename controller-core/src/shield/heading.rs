//! A heading that turns as a policy wants it, within the certified bounds.
//!
//! The certificate holds for |psi'| <= K_nu' and sqrt(psi''^2 + psi'^4) <= K_nu''. With |psi'| at most R, psi'' may be
//! B = sqrt(K_nu''^2 - R^4). psi' goes to the wanted rate at once, as far as B and R let it. Towards an angle, with e
//! the sine of the angle left (one beyond a right angle), the wanted rate is the lesser of 3 e and sqrt(B e), along
//! which braking takes half of B.

use crate::extended::demand::Demand;
use crate::heading::{Heading, forwards};
use crate::math;
use crate::reference::ReferenceBounds;
use nalgebra::Vector2;

/// The part of the root of K_nu'' that the rate may take.
const RATE_SHARE: f32 = 0.8;

/// The rate per angle near its end, 1/s.
const HEADING_RATE_GAIN_PER_S: f32 = 3.0;

/// The heading at hand, and how it may turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HeadingGenerator {
    heading: Heading,
    /// R, rad/s, and the greatest psi'', rad/s^2.
    fastest: f32,
    strongest: f32,
    period: f32,
}

impl HeadingGenerator {
    /// At rest along world x, for steps of `period`, s.
    pub fn new(bounds: &ReferenceBounds, period: f32) -> Self {
        let second = bounds.heading_second_derivative;
        let fastest = math::min(bounds.heading_rate, RATE_SHARE * math::sqrt(second));
        let square = fastest * fastest;
        let strongest = math::sqrt(math::max(second * second - square * square, 0.0));
        Self { heading: Heading::FORWARD, fastest, strongest, period }
    }

    /// Starts at rest along `heading`.
    pub fn start(&mut self, heading: &Heading) {
        self.heading = heading.at_rest();
    }

    /// The heading of this tick.
    pub fn heading(&self) -> &Heading {
        &self.heading
    }

    /// One tick as a demand wants it.
    pub fn follow(&mut self, demand: &Demand) {
        let wanted = match demand {
            Demand::Acceleration { yaw_rate, .. } => *yaw_rate,
            Demand::Attitude { attitude, .. } => self.towards(&forwards(attitude)),
            Demand::Rotors { .. } => 0.0,
        };
        self.turn(wanted);
    }

    /// One tick towards a heading at rest.
    pub fn come_to_rest(&mut self) {
        self.turn(0.0);
    }

    /// The rate towards a direction of any length; none towards nothing.
    fn towards(&self, direction: &Vector2<f32>) -> f32 {
        let here = self.heading.direction();
        let (along, across) = (here.dot(direction), here.x * direction.y - here.y * direction.x);
        let length = math::sqrt(along * along + across * across);
        if length < 1e-3 {
            return 0.0;
        }
        let left = if along > 0.0 { across.abs() / length } else { 1.0 };
        math::min(HEADING_RATE_GAIN_PER_S * left, math::sqrt(self.strongest * left)).copysign(across)
    }

    fn turn(&mut self, wanted: f32) {
        let rate = self.heading.rate();
        let change = math::saturate(wanted, self.fastest) - rate;
        let acceleration = math::saturate(change / self.period, self.strongest);
        // The angle of this tick, of which half is enough for its tangent.
        let half = 0.5 * self.period * (rate + 0.5 * self.period * acceleration);
        let here = self.heading.direction();
        let across = Vector2::new(-here.y, here.x);
        let (cos, sin) = ((1.0 - half * half) / (1.0 + half * half), 2.0 * half / (1.0 + half * half));
        let turned = here * cos + across * sin;
        self.heading = Heading::near_unit(turned, rate + acceleration * self.period, acceleration);
    }
}
