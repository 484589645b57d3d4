//! Poses that lie: what a source of poses says instead of the truth.

use estimation::estimator::PoseMeasurement;
use flight::{Pose, Stamped, Velocity};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::rngs::ChaCha8Rng;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use std::collections::VecDeque;
use verification::piloted::Meddler;

/// One kind of lie. Rates count from the moment at which the source begins to lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lie {
    /// Every heading is off by an angle, rad; positions are right.
    HeadingOff(f32),
    /// Every heading drifts away, rad/s; positions are right.
    HeadingDrifts(f32),
    /// Every attitude leans by an angle, rad, about world x.
    Leans(f32),
    /// Every position is off, m.
    Off(Vector3<f32>),
    /// Every position drifts away, m/s.
    Drifts(Vector3<f32>),
    /// Positions are so many times as far from the origin as they are.
    Scaled(f32),
    /// World y, or world x, points the other way; attitudes are right.
    Mirrored(bool),
    /// The same pose over and over.
    Freezes,
    /// Poses come for so long, then none for so long, s, and so on.
    Comes { for_seconds: f64, every: f64 },
    /// Poses are so much older than they say, in poses.
    Late(usize),
    /// Their positions have noise of so many metres, their attitudes of so many rad.
    Noisy(f32, f32),
    /// They are said to be good to so many metres and rad.
    Claims(f32, f32),
    /// Every so many poses one is of another body, off by so much, m.
    Second { every: u64, off: Vector3<f32> },
}

impl Lie {
    pub const NAMES: [&str; 13] = [
        "heading off",
        "heading drifts",
        "leans",
        "off",
        "drifts",
        "scaled",
        "mirrored",
        "freezes",
        "comes and goes",
        "late",
        "noisy",
        "claims",
        "two sources",
    ];

    pub fn name(&self) -> &'static str {
        Self::NAMES[match self {
            Self::HeadingOff(_) => 0,
            Self::HeadingDrifts(_) => 1,
            Self::Leans(_) => 2,
            Self::Off(_) => 3,
            Self::Drifts(_) => 4,
            Self::Scaled(_) => 5,
            Self::Mirrored(_) => 6,
            Self::Freezes => 7,
            Self::Comes { .. } => 8,
            Self::Late(_) => 9,
            Self::Noisy(..) => 10,
            Self::Claims(..) => 11,
            Self::Second { .. } => 12,
        }]
    }

    /// Whether it is not observable on board: its positions are those of another flight.
    pub fn is_undetectable(&self) -> bool {
        matches!(self, Self::Drifts(_) | Self::Scaled(_))
    }
}

/// A source that lies.
pub struct Liar {
    pub lies: Vec<Lie>,
    /// When it begins to lie, us; none before.
    pub since: Option<u64>,
    /// When it ends to, us.
    pub until: u64,
    count: u64,
    frozen: Option<Pose>,
    held: VecDeque<Pose>,
    random: ChaCha8Rng,
}

impl Liar {
    pub fn new(lies: &[Lie], random: ChaCha8Rng) -> Self {
        Self {
            lies: lies.to_vec(),
            since: None,
            until: u64::MAX,
            count: 0,
            frozen: None,
            held: VecDeque::new(),
            random,
        }
    }

    fn noise(&mut self, deviation: f32) -> Vector3<f32> {
        Vector3::from_fn(|_, _| {
            let drawn: f32 = StandardNormal.sample(&mut self.random);
            drawn * deviation
        })
    }
}

/// `attitude` turned in the world by a rotation vector, rad.
fn turned(attitude: Quaternion<f32>, by: Vector3<f32>) -> Quaternion<f32> {
    (UnitQuaternion::from_scaled_axis(by) * UnitQuaternion::new_normalize(attitude)).into_inner()
}

impl Meddler for Liar {
    fn pose(&mut self, pose: Stamped<Pose>, now: u64) -> Option<Stamped<PoseMeasurement>> {
        let Stamped { value, time } = pose;
        let (mut position, mut attitude) = (value.position(), value.attitude());
        let mut claimed = None;
        let lying = self.since.filter(|since| (*since..self.until).contains(&now));
        if let Some(since) = lying {
            let seconds = now.saturating_sub(since) as f64 * 1e-6;
            self.count += 1;
            for lie in self.lies.clone() {
                match lie {
                    Lie::HeadingOff(angle) => attitude = turned(attitude, Vector3::z() * angle),
                    Lie::HeadingDrifts(rate) => attitude = turned(attitude, Vector3::z() * (rate * seconds as f32)),
                    Lie::Leans(angle) => attitude = turned(attitude, Vector3::x() * angle),
                    Lie::Off(by) => position += by,
                    Lie::Drifts(rate) => position += rate * seconds as f32,
                    Lie::Scaled(by) => position *= by,
                    Lie::Mirrored(x) => position[usize::from(!x)] *= -1.0,
                    Lie::Freezes => {
                        let frozen = *self.frozen.get_or_insert(value);
                        (position, attitude) = (frozen.position(), frozen.attitude());
                    }
                    Lie::Comes { for_seconds, every } if seconds % every >= for_seconds => return None,
                    Lie::Comes { .. } => {}
                    Lie::Late(poses) => {
                        self.held.push_back(value);
                        let held =
                            if self.held.len() > poses { self.held.pop_front() } else { self.held.front().copied() };
                        let held = held.unwrap_or(value);
                        (position, attitude) = (held.position(), held.attitude());
                    }
                    Lie::Noisy(metres, angle) => {
                        position += self.noise(metres);
                        let by = self.noise(angle);
                        attitude = turned(attitude, by);
                    }
                    Lie::Claims(metres, angle) => claimed = Some((metres, angle)),
                    Lie::Second { every, off } if self.count.is_multiple_of(every) => position += off,
                    Lie::Second { .. } => {}
                }
            }
        }
        let pose = Pose::new(position, Velocity::World(Vector3::zeros()), attitude).ok()?;
        let measured = PoseMeasurement::new(&pose);
        let value = claimed.map_or(measured, |(metres, angle)| measured.deviations(metres, angle));
        Some(Stamped { value, time })
    }
}

/// A source of one lie or two, drawn at random.
pub fn drawn(random: &mut impl Rng) -> Vec<Lie> {
    let count = if random.random_bool(0.3) { 2 } else { 1 };
    (0..count).map(|_| one(random)).collect()
}

fn one(random: &mut impl Rng) -> Lie {
    let mut between = |least: f32, most: f32| random.random_range(least..most);
    let sign = if between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
    let vector = |length: f32, around: f32, up: f32| {
        let across = (1.0 - up * up).max(0.0).sqrt();
        Vector3::new(across * around.cos(), across * around.sin(), up) * length
    };
    let kind = between(0.0, 13.0) as u32;
    let (around, up) = (between(0.0, std::f32::consts::TAU), between(-1.0, 1.0));
    match kind {
        0 => Lie::HeadingOff(sign * between(5.0, 180.0).to_radians()),
        1 => Lie::HeadingDrifts(sign * between(0.5, 20.0).to_radians()),
        2 => Lie::Leans(sign * between(1.0, 30.0).to_radians()),
        3 => Lie::Off(vector(10_f32.powf(between(-1.0, 1.0)), around, up)),
        4 => Lie::Drifts(vector(10_f32.powf(between(-1.5, 0.5)), around, up)),
        5 => Lie::Scaled(if sign > 0.0 { between(1.1, 3.0) } else { between(0.2, 0.9) }),
        6 => Lie::Mirrored(sign > 0.0),
        7 => Lie::Freezes,
        8 => Lie::Comes { for_seconds: between(0.02, 0.6).into(), every: between(0.7, 3.0).into() },
        9 => Lie::Late(between(2.0, 40.0) as usize),
        10 => Lie::Noisy(10_f32.powf(between(-2.5, -0.5)), between(0.5, 5.0).to_radians()),
        11 => Lie::Claims(10_f32.powf(between(-6.0, 0.5)), 10_f32.powf(between(-6.0, 0.0))),
        _ => Lie::Second { every: between(2.0, 10.0) as u64, off: vector(between(0.1, 3.0), around, up) },
    }
}
