//! The list of rivals: their names, the names of their gains, and how each is built from them.

use super::cascade::{self, Cascade};
use super::continuous::{self, Continuous};
use super::indi::{self, Indi};
use super::lee::{self, Lee};
use super::mellinger::{self, Mellinger};
use super::memoryless::{self, Memoryless};
use super::nested::{self, Nested};
use super::pilot::model;
use super::quaternion_feedback::QuaternionFeedback;
use super::rival::Rival;
use super::start::{Pace, Start};
use scenario::Scenario;

/// About x and y, of a vehicle that the starts serve: the Hummingbird's.
const START_INERTIA_KG_M2: f64 = 3.665e-3;

/// A rival.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RivalKind {
    /// [`lee`].
    Lee,
    /// [`cascade`].
    Cascade,
    /// [`mellinger`].
    Mellinger,
    /// [`indi`].
    Indi,
    /// [`nested`].
    Nested,
    /// [`continuous`].
    Continuous,
    /// [`memoryless`].
    Memoryless,
}

impl RivalKind {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Lee, Self::Cascade, Self::Mellinger, Self::Indi, Self::Nested, Self::Continuous, Self::Memoryless];

    /// Its name in tables and in the file of gains.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Lee => "lee",
            Self::Cascade => "px4",
            Self::Mellinger => "mellinger",
            Self::Indi => "indi",
            Self::Nested => "nested",
            Self::Continuous => "continuous",
            Self::Memoryless => "memoryless",
        }
    }

    /// Its description, in a line.
    #[must_use]
    pub fn about(self) -> &'static str {
        match self {
            Self::Lee => "geometric tracking on SE(3): Lee, Leok, McClamroch, 2010",
            Self::Cascade => {
                "P and PID loops as PX4 flies them, around a quaternion law: Brescianini, Hehn, D'Andrea, 2013"
            }
            Self::Mellinger => "geometric tracking with feed-forward torque: Mellinger, Kumar, 2011",
            Self::Indi => "incremental nonlinear dynamic inversion: Smeur, Chu, de Croon, 2016; Tal, Karaman, 2021",
            Self::Nested => "nested saturations around the paper's attitude law: Martins, Cardeira, Oliveira, 2024",
            Self::Continuous => "continuous quaternion feedback: Wie, Weiss, Arapostathis, 1989",
            Self::Memoryless => "the same, always the nearer quaternion: Fjellstad, Fossen, 1994",
        }
    }

    /// The rival of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Its gains' names.
    #[must_use]
    pub fn gains(self) -> &'static [&'static str] {
        match self {
            Self::Lee => &lee::NAMES,
            Self::Cascade => &cascade::NAMES,
            Self::Mellinger => &mellinger::NAMES,
            Self::Indi => &indi::NAMES,
            Self::Nested => &nested::NAMES,
            Self::Continuous => &continuous::NAMES,
            Self::Memoryless => &memoryless::NAMES,
        }
    }

    /// Where a search for its gains starts on the vehicle of `scenario`.
    #[must_use]
    pub fn start(self, scenario: &Scenario) -> Start {
        let (gains, paces): (&[f64], &[Pace]) = match self {
            Self::Lee => (&lee::START_GAINS, &lee::GAIN_PACES),
            Self::Cascade => (&cascade::START_GAINS, &cascade::GAIN_PACES),
            Self::Mellinger => (&mellinger::START_GAINS, &mellinger::GAIN_PACES),
            Self::Indi => (&indi::START_GAINS, &indi::GAIN_PACES),
            Self::Nested => (&nested::START_GAINS, &nested::GAIN_PACES),
            Self::Continuous => (&continuous::START_GAINS, &continuous::GAIN_PACES),
            Self::Memoryless => (&memoryless::START_GAINS, &memoryless::GAIN_PACES),
        };
        Start { gains, paces, inertia: model(scenario).inertia.xy().mean() / START_INERTIA_KG_M2 }
    }

    /// The law with `gains`, each in the place of its name, on the vehicle of `scenario`; `None` if there are
    /// too many or too few, or if the law is undefined.
    #[must_use]
    pub fn build(self, scenario: &Scenario, gains: &[f64]) -> Option<Box<dyn Rival>> {
        let model = model(scenario);
        let feedback = |gains: &[f64]| Some(QuaternionFeedback::new(model, gains.try_into().ok()?));
        Some(match self {
            Self::Lee => Box::new(Lee::new(model, gains.try_into().ok()?)),
            Self::Cascade => Box::new(Cascade::new(model, gains.try_into().ok()?)),
            Self::Mellinger => Box::new(Mellinger::new(model, gains.try_into().ok()?)),
            Self::Indi => Box::new(Indi::new(model, gains.try_into().ok()?)),
            Self::Nested => Box::new(Nested::new(model, scenario.configuration.vehicle(), gains.try_into().ok()?)?),
            Self::Continuous => Box::new(Continuous::new(feedback(gains)?)),
            Self::Memoryless => Box::new(Memoryless(feedback(gains)?)),
        })
    }
}
