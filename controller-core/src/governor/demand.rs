//! What a stream asks of the bounds, over the last seconds: how much slower it would have to be to keep them.
//!
//! f times slower, a motion has a velocity f times smaller, an acceleration f^2 times, a jerk f^3 and a snap f^4 times.
//! So f is the greatest of v/V, (a/K_a)^(1/2), (j/K_j)^(1/3) and (s/K_s)^(1/4). Kept is the greatest f^24, which needs
//! no roots.

use crate::math;

/// The greatest f that counts: so f^24 is finite.
const SLOWDOWN_MAX: f32 = 16.0;

/// Seconds after which what was asked is forgotten, at the latest after twice as long.
const MEMORY_S: f32 = 10.0;

/// What a stream asked, and how far off it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StreamDemand {
    /// The greatest f^24 of the present and of the last while, and how long the present one has lasted, s.
    present: f32,
    last: f32,
    lasted: f32,
    /// How far off the stream is, m.
    off: f32,
}

/// How a stream is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FollowingReport {
    /// How far the reference is from the stream, m.
    pub off: f32,
    demand: f32,
}

impl StreamDemand {
    /// No stream.
    pub const NONE: Self = Self { present: 0.0, last: 0.0, lasted: 0.0, off: 0.0 };

    /// With another tick of `period` seconds of a stream that is so far `off`, and the squares of the shares that it
    /// takes: of the greatest speed or rate of turning, and of the bounds on acceleration, jerk and snap.
    pub fn with(&self, speed: f32, [acceleration, jerk, snap]: [f32; 3], off: f32, period: f32) -> Self {
        let cubed = |x: f32| x * x * x;
        let squared = |x: f32| x * x;
        let most = squared(SLOWDOWN_MAX);
        let v = math::min(speed, most);
        let a = math::min(acceleration, squared(most));
        let j = math::min(jerk, cubed(most));
        let s = math::min(snap, squared(squared(most)));
        let max = [squared(squared(cubed(v))), squared(cubed(a)), squared(squared(j)), cubed(s)]
            .into_iter()
            .fold(0.0, math::max);
        let (present, last, lasted) = if self.lasted > MEMORY_S {
            (max, self.present, 0.0)
        } else {
            (math::max(self.present, max), self.last, self.lasted + period)
        };
        Self { present, last, lasted, off }
    }

    /// What there is to say of it, if there is a stream.
    pub fn following(&self) -> Option<FollowingReport> {
        let demand = math::max(self.present, self.last);
        (demand > 0.0).then_some(FollowingReport { off: self.off, demand })
    }
}

impl FollowingReport {
    /// How many times slower the stream of the last seconds would have to be to keep the bounds; one or less where it
    /// keeps them.
    pub fn slower(&self) -> f32 {
        let cube = math::sqrt(math::sqrt(math::sqrt(self.demand)));
        // Newton's steps for the cube root of at most 4096, from above; each takes a third off, then twice the digits.
        let mut root = 1.0 + cube / 3.0;
        for _ in 0..NEWTON_STEPS {
            root -= (root - cube / (root * root)) / 3.0;
        }
        root
    }
}

/// Enough for single precision.
const NEWTON_STEPS: u32 = 20;

#[cfg(test)]
mod tests;
