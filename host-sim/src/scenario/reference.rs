//! `[reference]`: what the vehicle is asked to do, one kind of trajectory per `kind`.

use super::section::{FieldError, Section};
use controller_core::error::ParameterError;
use controller_core::heading::Heading;
use controller_core::reference::Trajectory;
use controller_core::reference::hover::Hover;
use nalgebra::{Vector2, Vector3};
use std::sync::Arc;

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
}

impl ReferenceKind {
    /// Reads `[reference]`.
    ///
    /// # Errors
    /// Names the field that is missing, unknown, or no number.
    pub fn read(root: &Section) -> Result<Self, FieldError> {
        let section = root.section("reference")?;
        match section.text("kind")? {
            "hover" => read_hover(&section),
            other => {
                let allowed = "must be \"hover\", \"harmonic\" or \"waypoints\"";
                Err(FieldError::new(section.path_of("kind"), format!("{allowed}, found {other:?}")))
            }
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
        })
    }
}

fn read_hover(section: &Section) -> Result<ReferenceKind, FieldError> {
    section.allow(&["kind", "position", "heading_deg"])?;
    let position = section.vector("position")?;
    let heading = section.number_or("heading_deg", 0.0)?.to_radians();
    Ok(ReferenceKind::Hover { position, heading })
}
