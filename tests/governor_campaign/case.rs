//! The conditions of a stream: bounds, limits, tick rate and where the reference starts, all drawn from a seed.

use controller_core::governor::{Governor, GovernorLimits, Memory, Motion, Setpoint, Turn};
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
                horizontal_acceleration: 2.5,
                vertical_acceleration: 0.5,
                jerk: 4.0,
                snap: 10.0,
                heading_rate: 1.3,
                heading_second_derivative: 1.8,
            }
        } else {
            ReferenceBounds {
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
        let period = [0.01, 0.01, 0.02, 0.005][random.below(4) as usize];
        Self { bounds, limits, period }
    }

    /// The lengths of the two long averages, as anyone can work them out, in ticks.
    pub fn windows(&self) -> [u32; 2] {
        let b = &self.bounds;
        let diameter = 2.0 * b.horizontal_acceleration.hypot(b.vertical_acceleration);
        let first = (diameter / b.jerk).max((2.0 * diameter / b.snap).sqrt());
        let second = 2.0 * diameter / (b.snap * first);
        [first, second].map(|window| (window / self.period).ceil() as u32)
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

    /// Where a governor is that was sent about at random for a while, from a rest.
    pub fn interrupted(&self, random: &mut Random, resting: &Reference) -> Reference {
        let mut memory = Memory::EMPTY;
        let governor = Governor::new(&self.bounds, &self.limits, self.period, &mut memory).unwrap();
        governor.start(&resting.position, &resting.velocity, &resting.heading).unwrap();
        let mut last = governor.tick();
        for _ in 0..1 + random.below(3) {
            let motion = Motion::Velocity(random.vector(5.0));
            governor.accept(&Setpoint { motion, turn: Turn::Rate(random.between(-2.0, 2.0)) }).unwrap();
            for _ in 0..random.below(100) {
                last = governor.tick();
            }
        }
        last
    }

    /// A moment of an ellipse in space, somewhere up to its bounds, with a heading that turns and swings.
    pub fn orbiting(&self, random: &mut Random) -> Reference {
        let b = &self.bounds;
        let rate = random.sized(0.2, 6.0);
        let (cosine, sine) = (random.vector(1.0), random.vector(1.0));
        let horizontal = cosine.xy().norm().hypot(sine.xy().norm());
        let vertical = cosine.z.hypot(sine.z);
        let all = cosine.norm().hypot(sine.norm());
        let size = (b.horizontal_acceleration / (horizontal * rate.powi(2)))
            .min(b.vertical_acceleration / (vertical * rate.powi(2)))
            .min(b.jerk / (all * rate.powi(3)))
            .min(b.snap / (all * rate.powi(4)))
            .min(6.0 / (all * rate))
            * random.between(0.0, 0.999);
        let (sin, cos) = random.between(-PI, PI).sin_cos();
        let wave = (cosine * cos + sine * sin) * size;
        let slope = (sine * cos - cosine * sin) * (size * rate);
        // psi' = r cos, psi'' = -r w sin, with r^4 + (r w)^2 within the bound.
        let share = random.between(0.0, 0.99);
        let swing = (b.heading_rate * share).min((0.9 * b.heading_second_derivative * share).sqrt());
        let left = (b.heading_second_derivative.powi(2) * share - swing.powi(4)).max(0.0).sqrt();
        let (sin, cos) = random.between(-PI, PI).sin_cos();
        Reference {
            position: random.vector(20.0),
            velocity: slope,
            acceleration: -wave * rate.powi(2),
            jerk: -slope * rate.powi(2),
            snap: wave * rate.powi(4),
            heading: Heading::new(random.heading(), swing * cos, -left * sin).unwrap(),
        }
    }
}
