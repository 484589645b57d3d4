//! `[reference]`: the vehicle's trajectory, one per `kind`. Left out: hover where the flight
//! starts, or 1 m above the origin if `[initial]` does not say where that is, facing world x.

use crate::initial::read_position;
use crate::resolution;
use crate::section::{FieldError, Section};
use crate::trajectory::{self, Allowed, Directory, Route, stretch};
use controller_core::certificate::path::FORCE_KEPT_M_PER_S2;
use controller_core::error::{ParameterError, Reason};
use controller_core::heading::Heading;
use controller_core::reference::Trajectory;
use controller_core::reference::harmonic::{Harmonic, HarmonicParameters, HeadingParameters};
use controller_core::reference::hover::Hover;
use nalgebra::{Vector2, Vector3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// How far a flight may stray from its reference once it is there, if the file does not say, m.
pub const TOLERANCE: f64 = 0.5;

/// Where to hover if the file says nothing of it, m.
const DEFAULT_POSITION: Vector3<f64> = Vector3::new(0.0, 0.0, 1.0);

/// What to do about a place that is too far away.
const COUNT_FROM_NEAR: &str = "count all positions from an origin nearby";

/// The greatest angle of a harmonic, turns.
const MOST_TURNS: f64 = 2.0;

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
            let position = read_position(root)?.unwrap_or(DEFAULT_POSITION);
            return Ok(Self::Hover { position, heading: 0.0 });
        };
        match section.text("kind")? {
            "hover" => read_hover(&section),
            "harmonic" => read_harmonic(&section).map(Self::Harmonic),
            "waypoints" => trajectory::read_waypoints(&section, directory, allow).map(Self::Route),
            "trajectory" => trajectory::read_trajectory(&section, directory, allow).map(Self::Route),
            other => {
                let allowed = "must be \"hover\", \"harmonic\", \"waypoints\" or \"trajectory\"";
                Err(FieldError::new(section.path_of("kind"), format!("{allowed}, found {other:?}")))
            }
        }
    }

    /// Reads `tolerance` of `[reference]`, m: how far a flight may stray once it is there.
    ///
    /// # Errors
    /// Names the field if it is no positive number.
    pub fn tolerance(root: &Section) -> Result<f64, FieldError> {
        let Some(section) = root.optional_section("reference")? else { return Ok(TOLERANCE) };
        section.positive_or("tolerance", TOLERANCE)
    }

    /// Reads `force_kept` of `[reference]`, m/s^2: the force per mass, in any direction, that is kept free along it.
    ///
    /// # Errors
    /// Names the field if it is negative or no number.
    pub fn force_kept(root: &Section) -> Result<f32, FieldError> {
        let Some(section) = root.optional_section("reference")? else { return Ok(FORCE_KEPT_M_PER_S2) };
        let force = section.number_or("force_kept", f64::from(FORCE_KEPT_M_PER_S2))?;
        if force >= 0.0 {
            return Ok(force as f32);
        }
        Err(FieldError::new(section.path_of("force_kept"), format!("must not be negative, found {force}")))
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
    section.allow(&["kind", "tolerance", "force_kept", "position", "heading_deg"])?;
    let position = section.vector("position")?;
    resolution::check(&section.path_of("position"), &position, COUNT_FROM_NEAR)?;
    let heading = section.number_or("heading_deg", 0.0)?.to_radians();
    Ok(ReferenceKind::Hover { position, heading })
}

/// `phase` and `heading`, or fields of it, are zero where they are left out.
fn read_harmonic(section: &Section) -> Result<HarmonicParameters, FieldError> {
    section.allow(&["kind", "tolerance", "force_kept", "center", "amplitude", "frequency", "phase", "heading"])?;
    let mut heading = HeadingParameters { offset: 0.0, rate: 0.0, amplitude: 0.0, frequency: 0.0 };
    if let Some(section) = section.optional_section("heading")? {
        section.allow(&["offset", "rate", "amplitude", "frequency"])?;
        heading.offset = section.number_or("offset", 0.0)?;
        check_radians(&section, "offset", heading.offset)?;
        heading.rate = section.number_or("rate", 0.0)?;
        heading.amplitude = section.number_or("amplitude", 0.0)?;
        heading.frequency = section.number_or("frequency", 0.0)?;
    }
    let (center, amplitude) = (section.vector("center")?, section.vector("amplitude")?);
    resolution::check(&section.path_of("center"), &center, COUNT_FROM_NEAR)?;
    resolution::check(&section.path_of("amplitude"), &amplitude, "fly a smaller one")?;
    let phase = section.vector_or("phase", Vector3::zeros())?;
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
    if angle.abs() < MOST_TURNS * TAU {
        return Ok(());
    }
    let problem = format!("is in rad, and at most {MOST_TURNS} turns, found {angle}; degrees are rad times 57.3");
    Err(FieldError::new(section.path_of(key), problem))
}
