//! `[reference]`: the vehicle's trajectory, one per `kind`. Left out: hover where the flight
//! starts, or 1 m above the origin if `[initial]` does not say where that is, facing world x.

use crate::initial::read_position;
use crate::key::{Bounds, Key, Layout, Values};
use crate::resolution;
use crate::section::{FieldError, Section};
use crate::trajectory::{self, Allowed, Directory, FORCE_KEPT, Route, TOLERANCE, kind, stretch};
use controller_core::error::{ParameterError, Reason};
use controller_core::heading::Heading;
use controller_core::reference::Trajectory;
use controller_core::reference::harmonic::{Harmonic, HarmonicParameters, HeadingParameters};
use controller_core::reference::hover::Hover;
use nalgebra::{Vector2, Vector3};
use std::f64::consts::TAU;
use std::sync::Arc;

const DEFAULT_POSITION_M: Vector3<f64> = Vector3::new(0.0, 0.0, 1.0);

/// What to do about a place that is too far away.
const COUNT_FROM_NEAR: &str = "count all positions from an origin nearby";

const ANGLE_MAX_TURNS: f64 = 2.0;

/// The keys of `[reference]`, by its kind.
pub const LAYOUTS: [&Layout; 4] = [&HOVER, &HARMONIC, &trajectory::WAYPOINTS, &trajectory::TRAJECTORY];

const HOVER: Layout = Layout {
    name: "reference",
    about: "A point and a heading, at rest.",
    keys: &[
        kind(&["hover"]),
        TOLERANCE,
        FORCE_KEPT,
        Key::vector("position", Bounds::any("m"), "World."),
        Key::number("heading_deg", Bounds::any("degrees"), "From world x.").or(0.0),
    ],
};

const HARMONIC: Layout = Layout {
    name: "reference",
    about: "A cosine on each axis, a heading that rotates and swings.",
    keys: &[
        kind(&["harmonic"]),
        TOLERANCE,
        FORCE_KEPT,
        Key::vector("center", Bounds::any("m"), "World."),
        Key::vector("amplitude", Bounds::any("m"), "Of each axis."),
        Key::vector("frequency", Bounds::any("rad/s"), "Of each axis."),
        Key::vector("phase", Bounds::any("rad"), "Of each axis.").or(0.0),
        Key::table(&HEADING),
    ],
};

const HEADING: Layout = Layout {
    name: "heading",
    about: "offset + rate t + amplitude cos(frequency t), from world x.",
    keys: &[
        Key::number("offset", Bounds::any("rad"), "At the start.").or(0.0),
        Key::number("rate", Bounds::any("rad/s"), "Of the rotation.").or(0.0),
        Key::number("amplitude", Bounds::any("rad"), "Of the swing.").or(0.0),
        Key::number("frequency", Bounds::any("rad/s"), "Of the swing.").or(0.0),
    ],
};

/// A reference as the file describes it, double precision.
#[derive(Debug, Clone, PartialEq)]
pub enum ReferenceKind {
    /// A point and a heading, at rest.
    Hover {
        /// m, world.
        position: Vector3<f64>,
        /// rad from world x.
        heading: f64,
    },
    /// A cosine on each axis, a heading that turns and swings.
    Harmonic(HarmonicParameters),
    /// A path through or near points.
    Route(Route),
}

impl ReferenceKind {
    /// Reads `[reference]`; the default if it is missing. Files that it names lie in `directory`; points that come
    /// with a speed only are passed as the vehicle is to `allow`.
    ///
    /// # Errors
    /// Names the field that is missing, unknown, or no number.
    pub fn read(root: &Section, directory: Directory, allow: Allowed) -> Result<Self, FieldError> {
        let Some(section) = root.optional_section("reference")? else {
            let position = read_position(root)?.unwrap_or(DEFAULT_POSITION_M);
            return Ok(Self::Hover { position, heading: 0.0 });
        };
        match section.text("kind")? {
            "hover" => read_hover(&section.with(&HOVER)?),
            "harmonic" => read_harmonic(&section.with(&HARMONIC)?).map(Self::Harmonic),
            "waypoints" => {
                trajectory::read_waypoints(&section.with(&trajectory::WAYPOINTS)?, directory, allow).map(Self::Route)
            }
            "trajectory" => {
                trajectory::read_trajectory(&section.with(&trajectory::TRAJECTORY)?, directory, allow).map(Self::Route)
            }
            other => {
                let allowed = "must be \"hover\", \"harmonic\", \"waypoints\" or \"trajectory\"";
                Err(FieldError::new(section.path_of("kind"), format!("{allowed}, found {other:?}")))
            }
        }
    }

    /// Reads a number that every kind of `[reference]` may have: [`TOLERANCE`] or [`FORCE_KEPT`].
    ///
    /// # Errors
    /// Names the field if it is not a number or outside its bounds.
    pub fn number(root: &Section, key: &Key) -> Result<f64, FieldError> {
        match (root.optional_section("reference")?, key.values) {
            (Some(section), Values::Number(bounds)) if section.has(key.name) => {
                bounds.check(section.path_of(key.name), section.number(key.name)?)
            }
            _ => Ok(key.default()),
        }
    }

    /// The trajectory itself.
    ///
    /// # Errors
    /// If the trajectory's own constructor refuses a number, naming the field.
    pub fn build(&self) -> Result<Arc<dyn Trajectory + Send + Sync>, ParameterError> {
        Ok(match self {
            Self::Hover { position, heading } => {
                let direction = Vector2::new(heading.cos() as f32, heading.sin() as f32);
                Arc::new(Hover::new(position.map(|value| value as f32), Heading::new(direction, 0.0, 0.0)?)?)
            }
            Self::Harmonic(parameters) => Arc::new(Harmonic::new(*parameters)?),
            Self::Route(route) => match stretch::path(&route.knots)? {
                Some(path) => Arc::new(path),
                None => return Err(ParameterError { field: "reference.points", reason: Reason::TooFew(1) }),
            },
        })
    }
}

fn read_hover(section: &Section) -> Result<ReferenceKind, FieldError> {
    let position = section.vector("position")?;
    resolution::check(&section.path_of("position"), &position, COUNT_FROM_NEAR)?;
    let heading = section.number("heading_deg")?.to_radians();
    Ok(ReferenceKind::Hover { position, heading })
}

fn read_harmonic(section: &Section) -> Result<HarmonicParameters, FieldError> {
    let mut heading = HeadingParameters { offset: 0.0, rate: 0.0, amplitude: 0.0, frequency: 0.0 };
    if let Some(section) = section.open(&HEADING)? {
        heading.offset = section.number("offset")?;
        check_radians(&section, "offset", heading.offset)?;
        heading.rate = section.number("rate")?;
        heading.amplitude = section.number("amplitude")?;
        heading.frequency = section.number("frequency")?;
    }
    let (center, amplitude) = (section.vector("center")?, section.vector("amplitude")?);
    resolution::check(&section.path_of("center"), &center, COUNT_FROM_NEAR)?;
    resolution::check(&section.path_of("amplitude"), &amplitude, "fly a smaller one")?;
    let phase = section.vector("phase")?;
    check_radians(section, "phase", phase.amax())?;
    Ok(HarmonicParameters {
        center: center.into(),
        amplitude: amplitude.into(),
        frequency: section.vector("frequency")?.into(),
        phase: phase.into(),
        heading,
    })
}

/// Refuses an angle of so many turns that it is probably in degrees.
fn check_radians(section: &Section, key: &str, angle: f64) -> Result<(), FieldError> {
    if angle.abs() < ANGLE_MAX_TURNS * TAU {
        return Ok(());
    }
    let problem = format!("is in rad, and at most {ANGLE_MAX_TURNS} turns, found {angle}; degrees are rad times 57.3");
    Err(FieldError::new(section.path_of(key), problem))
}
