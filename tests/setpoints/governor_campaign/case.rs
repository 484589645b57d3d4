//! The conditions of a stream: bounds, limits, tick rate and where the reference starts, all drawn from a seed.

use controller_core::governor::GovernorLimits;
use controller_core::prelude::{Heading, Reference, ReferenceBounds, Vector2, Vector3};
use core::f32::consts::PI;

/// Xorshift: the same streams on every machine.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 >> 16
    }

    /// One of 0..count.
    pub fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }

    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.below(1 << 24) as f32 / 16_777_216.0)
    }

    /// Log-uniform.
    pub fn sized(&mut self, low: f32, high: f32) -> f32 {
        low * (high / low).powf(self.between(0.0, 1.0))
    }

    pub fn vector(&mut self, size: f32) -> Vector3<f32> {
        Vector3::new(self.between(-size, size), self.between(-size, size), self.between(-size, size))
    }

    pub fn heading(&mut self) -> Vector2<f32> {
        let (sin, cos) = self.between(-PI, PI).sin_cos();
        Vector2::new(cos, sin)
    }
}

/// The conditions of one stream.
pub struct Case {
    pub bounds: ReferenceBounds,
    pub limits: GovernorLimits,
    pub period: f32,
}

impl Case {
    pub fn draw(random: &mut Random) -> Self {
        let typical = random.below(2) == 0;
        let bounds = if typical {
            ReferenceBounds {
                horizontal_speed: 5.0,
                horizontal_acceleration: 2.5,
                vertical_acceleration: 0.5,
                jerk: 4.0,
                snap: 10.0,
                heading_rate: 1.3,
                heading_second_derivative: 1.8,
            }
        } else {
            ReferenceBounds {
                horizontal_speed: 5.0,
                horizontal_acceleration: random.sized(0.5, 6.0),
                vertical_acceleration: random.sized(0.3, 4.0),
                jerk: random.sized(1.0, 30.0),
                snap: random.sized(4.0, 200.0),
                heading_rate: random.sized(0.3, 4.0),
                heading_second_derivative: random.sized(0.4, 8.0),
            }
        };
        let limits = GovernorLimits {
            horizontal_speed: random.sized(1.0, 10.0),
            vertical_speed: random.sized(0.5, 4.0),
            ..GovernorLimits::default()
        };
        let period = [0.01, 0.01, 0.02, 0.005, 0.004, 0.002, 0.001][random.below(7) as usize];
        Self { bounds, limits, period }
    }

    /// The time between two knots, s: a hundredth of a second, or the next whole number of ticks.
    pub fn knots(&self) -> f32 {
        (0.00999 / self.period).ceil() * self.period
    }

    /// The lengths of the two long averages, as anyone can work them out, in knots.
    pub fn windows(&self) -> [u32; 2] {
        let b = &self.bounds;
        let diameter = 2.0 * b.horizontal_acceleration.hypot(b.vertical_acceleration);
        let first = (diameter / b.jerk).max((2.0 * diameter / b.snap).sqrt());
        let second = 2.0 * diameter / (b.snap * first);
        [first, second].map(|window| (window / self.knots()).ceil() as u32)
    }

    pub fn resting(&self, random: &mut Random) -> Reference {
        let zero = Vector3::zeros();
        Reference {
            position: random.vector(20.0),
            velocity: zero,
            acceleration: zero,
            jerk: zero,
            snap: zero,
            heading: Heading::new(random.heading(), 0.0, 0.0).unwrap(),
        }
    }

    /// How long stopping from `velocity` and coming back takes without haste, s.
    pub fn returning(&self, velocity: &Vector3<f32>) -> f32 {
        let time = |speed: f32, acceleration: f32, limit: f32| speed / acceleration * (1.0 + 0.5 * speed / limit);
        let across = time(velocity.xy().norm(), self.bounds.horizontal_acceleration, self.limits.horizontal_speed);
        across + time(velocity.z.abs(), self.bounds.vertical_acceleration, self.limits.vertical_speed)
    }
}
