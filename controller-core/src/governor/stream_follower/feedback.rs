//! Feedback: with e the stream less the head, l the stiffness and J the quarter turn by which a stream at rate w turns,
//!
//! e'''' = -(4 m e''' + 6 m^2 e'' + 4 m^3 e' + m^4 e),  m = l - w J  (m = l along the vertical),
//!
//! which is (d/dt - w J + l)^4 e = 0: an error that turns with the stream, as that of averages does, or of a head at
//! rest in the middle of a circle, shrinks without changing direction, and needs next to no acceleration of its own. l
//! begins at what the error allows, and grows as it shrinks.

use super::StreamFollower;
use crate::governor::stream::{Point, StreamTarget, quarter};
use crate::math;
use nalgebra::Vector3;

/// The share of the bounds, less the stream's part, that feedback may command, and the least that is counted on.
const FEEDBACK_SHARE: f32 = 0.25;
const REMAINING_SHARE_MIN: f32 = 0.01;

/// The stiffness times the averages' span in the end; per tick at most; and its growth, l' = growth l^2.
const STIFFNESS_SPANS_MAX: f32 = 9.0;
const STIFFNESS_PERIODS_MAX: f32 = 0.2;
const STIFFNESS_GROWTH: f32 = 0.12;

/// The stiffness, over the rate of a turning stream, at which an error that turns with it needs no more than it leaves.
const TURNING_STIFFNESS_SHARE: f32 = 0.8;

impl StreamFollower {
    /// The stiffness a tick later.
    pub(super) fn next_stiffness(&self, stream: &StreamTarget, stiffness: f32) -> f32 {
        let grown = stiffness + STIFFNESS_GROWTH * stiffness * stiffness * self.period;
        grown.min(self.stiffness_within(stream, self.feedback_capacity(stream)))
    }

    /// A length with which lengths along the vertical count as much as the accelerations that undo them.
    pub(super) fn weighted_length(&self, y: &Vector3<f32>) -> f32 {
        let vertical = y.z * self.vertical_weight;
        math::sqrt(y.x * y.x + y.y * y.y + vertical * vertical)
    }

    /// How the error moves beside turning with the stream.
    pub(super) fn drift(stream: &StreamTarget) -> Vector3<f32> {
        stream.error.velocity - quarter(&stream.error.position) * stream.point.rate
    }

    /// How far off a stream is, with how far it goes off in a span, m.
    pub(super) fn distance(&self, stream: &StreamTarget) -> f32 {
        self.weighted_length(&stream.error.position) + self.span * self.weighted_length(&Self::drift(stream))
    }

    /// The acceleration that feedback may command, m/s^2: a share of the rest beside a head whose error turns with the
    /// stream.
    pub(super) fn feedback_capacity(&self, stream: &StreamTarget) -> f32 {
        let Point { acceleration, jerk, snap, rate, .. } = &stream.point;
        let turned = |y: &Vector3<f32>| quarter(y) * *rate;
        let bent = turned(&turned(&stream.error.position));
        let twisted = turned(&bent);
        let used = self.envelope.used([&(acceleration - bent), &(jerk - twisted), &(snap - turned(&twisted))]);
        FEEDBACK_SHARE * self.acceleration * math::clamp(1.0 - used, REMAINING_SHARE_MIN, 1.0)
    }

    /// The stiffness whose answer to the error is within the room.
    pub(super) fn stiffness_within(&self, stream: &StreamTarget, capacity: f32) -> f32 {
        let Point { position, .. } = &stream.error;
        let stiff = (STIFFNESS_SPANS_MAX / self.span).min(STIFFNESS_PERIODS_MAX / self.period);
        let within =
            |off: f32, stiff: f32| if off * stiff * stiff <= capacity { stiff } else { math::sqrt(capacity / off) };
        let turning = (TURNING_STIFFNESS_SHARE * stream.point.rate.abs()).min(stiff);
        let horizontal = within(math::sqrt(position.xy().norm_squared()), stiff).max(turning);
        within((position.z * self.vertical_weight).abs(), horizontal)
    }

    /// Whether what the error does beside turning with the stream is answered within the room.
    pub(super) fn is_near(&self, stream: &StreamTarget, stiffness: f32, capacity: f32) -> bool {
        let Point { velocity, acceleration, .. } = &stream.error;
        let drift = Self::drift(stream);
        let bend = acceleration - (quarter(velocity) + quarter(&drift)) * stream.point.rate;
        2.0 * stiffness * self.weighted_length(&drift) <= capacity && self.weighted_length(&bend) <= capacity
    }

    /// The stream's snap and the feedback, m/s^2 per tick squared.
    pub(super) fn commanded_snap(&self, stream: &StreamTarget, stiffness: f32) -> Vector3<f32> {
        let Point { position, velocity, acceleration, jerk, .. } = &stream.error;
        let rate = stream.point.rate;
        // m y.
        let m = |y: Vector3<f32>| y * stiffness - quarter(&y) * rate;
        let feedback = m(m(m(m(*position) + velocity * 4.0) + acceleration * 6.0) + jerk * 4.0);
        (stream.point.snap + feedback) * (self.period * self.period)
    }
}
