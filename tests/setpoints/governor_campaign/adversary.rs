//! Who sends the setpoints.

use super::case::{Case, Random};
use super::path::Path;
use controller_core::governor::{Governor, HeadingSetpoint, Motion, Setpoint};
use controller_core::prelude::{Reference, Vector3};
use core::f32::consts::{PI, TAU};

/// What is sent at each tick.
#[derive(Clone, Copy)]
pub enum Adversary {
    /// Anything, at 50 Hz.
    Jumps,
    /// Opposite accelerations in step with the averages' windows.
    Resonance { first: u32, second: u32 },
    /// A velocity reversed whenever it has been reached, or just not.
    Reversals { ticks: u32 },
    /// A million metres this way and that.
    Far,
    /// Micrometres.
    Tiny,
    /// Duplicates, gaps, NaN.
    Broken,
    /// Feed-forward true, false or absurd.
    Moving { kind: u64 },
    /// Angles on both sides of ±180 degrees, and rates.
    Antipodes,
    /// Along a path, at some rate: with jitter, with drop-outs, with other setpoints in between.
    Following { path: Path, every: u32, trouble: Trouble },
    /// One setpoint from the start.
    Constant,
}

/// What is wrong with a link.
#[derive(Clone, Copy)]
pub enum Trouble {
    /// Nothing.
    None,
    /// Setpoints come early and late.
    Jitter,
    /// Some are lost, sometimes for seconds.
    Dropouts,
    /// Others of another kind come in between, and the path jumps.
    Switches,
}

impl Adversary {
    pub fn draw(random: &mut Random, case: &Case, here: &Vector3<f32>) -> Self {
        let [first, second] = case.windows();
        match random.below(11) {
            0 => Self::Jumps,
            1 => Self::Resonance { first, second },
            2 => Self::Reversals { ticks: random.sized(1.0, 200.0) as u32 },
            3 => Self::Far,
            4 => Self::Tiny,
            5 => Self::Broken,
            6 => Self::Moving { kind: random.below(4) },
            7 => Self::Antipodes,
            8 | 9 => Self::Following {
                path: Path::draw(random, case, here),
                every: (random.sized(0.01, 0.1) / case.period).round().max(1.0) as u32,
                trouble: [Trouble::None, Trouble::Jitter, Trouble::Dropouts, Trouble::Switches]
                    [random.below(4) as usize],
            },
            _ => Self::Constant,
        }
    }

    pub fn send(self, tick: u32, random: &mut Random, governor: &mut Governor, now: &Reference, period: f32) {
        let often = (0.02 / period).round().max(1.0) as u32;
        let along = Vector3::new(0.8, -0.6, 1.0);
        let sided = |positive: bool| if positive { along } else { -along };
        let side = |positive: bool| if positive { 1.0 } else { -1.0 };
        let anywhere = |random: &mut Random| match random.below(4) {
            0 => Motion::Position(now.position + random.vector(10.0)),
            1 => Motion::Velocity(random.vector(8.0)),
            2 => Motion::Mixed {
                position: (now.position + random.vector(5.0)).data.0[0]
                    .map(|place| (random.below(2) > 0).then_some(place)),
                velocity: random.vector(5.0),
            },
            _ => Motion::PositionVelocityAcceleration {
                position: now.position + random.vector(5.0),
                velocity: random.vector(5.0),
                acceleration: random.vector(3.0),
            },
        };
        let turn = |random: &mut Random| match random.below(3) {
            0 => HeadingSetpoint::Keep,
            1 => HeadingSetpoint::Angle { angle: random.between(-10.0, 10.0), rate: random.between(-1.0, 1.0) },
            _ => HeadingSetpoint::Rate(random.between(-3.0, 3.0)),
        };
        let setpoint = match self {
            Self::Jumps if tick.is_multiple_of(often) => Setpoint { motion: anywhere(random), turn: turn(random) },
            Self::Resonance { first, second } => {
                // The signs that make snap's second difference greatest: windows' blocks alternate.
                let positive = (tick / second.max(1) + tick / first.max(1)).is_multiple_of(2);
                Setpoint {
                    motion: Motion::Velocity(sided(positive) * 100.0),
                    turn: HeadingSetpoint::Rate(side(positive) * 9.0),
                }
            }
            Self::Reversals { ticks } => {
                let positive = (tick / ticks).is_multiple_of(2);
                Setpoint {
                    motion: Motion::Velocity(sided(positive) * 100.0),
                    turn: HeadingSetpoint::Rate(side(positive) * 9.0),
                }
            }
            Self::Far if tick.is_multiple_of(often * 10) => {
                Setpoint { motion: Motion::Position(random.vector(1e6)), turn: turn(random) }
            }
            Self::Tiny if tick.is_multiple_of(often) => {
                let size = random.sized(1e-6, 1e-2);
                let angle = now.heading.direction().y.atan2(now.heading.direction().x) + random.between(-size, size);
                let motion = Motion::Position(now.position + random.vector(size));
                Setpoint { motion, turn: HeadingSetpoint::Angle { angle, rate: 0.0 } }
            }
            Self::Broken if random.below(20) == 0 => {
                let sent = Setpoint { motion: anywhere(random), turn: turn(random) };
                for _ in 0..random.below(4) {
                    governor.accept(&sent).unwrap();
                }
                let mut position = random.vector(3.0);
                position[random.below(3) as usize] = [f32::NAN, f32::INFINITY, 1e30][random.below(3) as usize];
                let refused =
                    governor.accept(&Setpoint { motion: Motion::Position(position), turn: HeadingSetpoint::Rate(1.0) });
                assert!(refused.is_err());
                return;
            }
            Self::Moving { kind } if tick.is_multiple_of(often) => {
                let (rate, time) = (TAU * 0.25, tick as f32 * period);
                let (sin, cos) = (rate * time).sin_cos();
                let (position, velocity) = (Vector3::new(cos, sin, 1.0), Vector3::new(-sin, cos, 0.0) * rate);
                let acceleration = Vector3::new(cos, sin, 0.0) * (-rate * rate);
                let motion = match kind {
                    0 => Motion::PositionVelocityAcceleration { position, velocity, acceleration },
                    1 => Motion::PositionVelocityAcceleration { position, velocity: -velocity, acceleration },
                    2 => Motion::PositionVelocityAcceleration {
                        position,
                        velocity: random.vector(1e6),
                        acceleration: random.vector(1e6),
                    },
                    _ => Motion::PositionVelocityAcceleration {
                        position: position * 0.0,
                        velocity: Vector3::zeros(),
                        acceleration: random.vector(20.0),
                    },
                };
                Setpoint { motion, turn: HeadingSetpoint::Angle { angle: rate * time, rate } }
            }
            Self::Following { path, every, trouble } => {
                let time = f64::from(tick) * f64::from(period);
                let (due, seconds) = (tick.is_multiple_of(every), time as u32);
                let motion = match trouble {
                    Trouble::None if due => path.motion(time),
                    Trouble::Jitter if random.below(u64::from(every)) == 0 => path.motion(time),
                    // Sent on time and lost, for a second now and then.
                    Trouble::Dropouts if due && random.below(4) > 0 && seconds % 7 != 6 => path.motion(time),
                    Trouble::Switches if due && seconds % 8 == 7 && tick.is_multiple_of(3) => anywhere(random),
                    Trouble::Switches if due => path.motion(time + f64::from(seconds / 11)),
                    _ => return,
                };
                Setpoint { motion, turn: HeadingSetpoint::Keep }
            }
            Self::Antipodes if tick.is_multiple_of(often) => {
                let here = now.heading.direction().y.atan2(now.heading.direction().x);
                let angle = here + PI + random.between(-0.01, 0.01);
                let rate = [0.0, 100.0, -100.0, 1e6][random.below(4) as usize];
                Setpoint { motion: anywhere(random), turn: HeadingSetpoint::Angle { angle, rate } }
            }
            _ => return,
        };
        governor.accept(&setpoint).unwrap();
    }
}
