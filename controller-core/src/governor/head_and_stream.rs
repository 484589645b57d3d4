//! Where the head is, and where the stream is that it follows: both at the head's time, which is ahead of the knot's.
//!
//! Between the head and the knot lie the last average, N_3 ticks, and the spline. The head's acceleration is known, as
//! integers; its velocity and place follow from the knot's by the time between, (N_3 + 1)/2 ticks, with an acceleration
//! that changes evenly. They make a turn at w smaller by 1 - w^2 sigma^2/2, so the head is commanded that much more.

use super::envelope::{Bounds, Cylinder, Envelope, HeadMotion};
use super::smoother::Knot;
use super::stream::{Point, StreamTarget};
use super::windows::Windows;
use super::{Governor, GovernorLimits};
use crate::math::i64_to_f32;
use crate::reference::ReferenceBounds;

impl Governor {
    /// Prepares the following of streams.
    pub(super) fn design_follower(
        &mut self,
        windows: &Windows,
        bounds: &ReferenceBounds,
        limits: &GovernorLimits,
        period: f32,
    ) {
        let last = windows.lengths[2] as f32;
        let [horizontal, vertical] =
            [windows.horizontal, windows.vertical].map(|level| level / (windows.per_metre * period * period));
        self.ahead = 0.5 * (last + 1.0) * period;
        self.spread = ((last * last - 1.0) / 24.0 + 1.0 / 6.0) * period * period;
        self.per_snap = windows.per_metre * windows.head() as f32 * period * period;
        let bounds = Bounds {
            speed: Cylinder {
                horizontal: limits.horizontal_speed.min(bounds.horizontal_speed),
                vertical: limits.vertical_speed,
            },
            acceleration: Cylinder { horizontal, vertical },
            jerk: bounds.jerk,
            snap: bounds.snap,
        };
        // Between the knot and the head acceleration may leave its chord by half of what jerk makes of that time.
        let blur = 0.25 * bounds.jerk * self.ahead * self.ahead;
        let envelope = Envelope::new(&bounds, blur, period);
        self.follower.design(
            envelope,
            [horizontal, vertical],
            windows.span() as u32,
            windows.lengths[2] as u32,
            period,
        );
    }

    /// The head at hand: its acceleration is known, its velocity follows from the knot's.
    pub(super) fn head_motion(&self) -> HeadMotion {
        let scale = 1.0 / self.per_snap;
        let head = self.smoother.head();
        let acceleration = head.map(|head| i64_to_f32(head.acceleration) * scale);
        HeadMotion {
            velocity: self.knot.velocity + (self.knot.acceleration + acceleration) * (0.5 * self.ahead),
            acceleration,
            difference: head.map(|head| i64_to_f32(head.jerk) * scale),
        }
    }

    /// The stream that is followed, if there is one, where the head is in time, and by how much that is ahead of the
    /// `head`.
    pub(super) fn stream_target(&self, head: &HeadMotion) -> Option<StreamTarget> {
        if !self.goal.is_point() || self.goal_age > self.timeout {
            return None;
        }
        let (t, ahead, spread) = (self.period, self.ahead, self.spread);
        let age = (self.goal_age as f32 - 1.0) * self.tick + self.goal_late;
        let point = self.goal.stream.ahead(age + ahead);
        let Knot { velocity, acceleration, .. } = &self.knot;
        // The knot's control point is beside it; the head has gone on from there.
        let away = (self.goal.position - self.smoother.place()).map(|units| i64_to_f32(units) / self.windows.per_metre);
        let gone = velocity * ahead
            + (acceleration * 2.0 + head.acceleration) * (ahead * ahead / 6.0)
            + acceleration * (0.25 * t * t);
        // What lies between makes turns smaller.
        let gain = 1.0 + point.rate * point.rate * spread;
        let error = Point {
            position: away + point.position - gone,
            velocity: point.velocity - head.velocity,
            acceleration: point.acceleration - point.snap * spread - head.acceleration,
            // The difference is half a tick old.
            jerk: point.jerk * gain - head.difference / t - point.snap * (0.5 * t),
            ..point
        };
        Some(StreamTarget { point: Point { snap: point.snap * gain, ..point }, error })
    }
}

#[cfg(test)]
mod tests;
