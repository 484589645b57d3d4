//! A point and a heading, at rest.

use super::{Reference, ReferenceBounds, Trajectory};
use crate::error::{ParameterError, require_finite};
use crate::heading::Heading;
use nalgebra::Vector3;

/// Holds a position (m, world) and a heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hover {
    position: Vector3<f32>,
    heading: Heading,
}

impl Hover {
    /// At the world's origin, along world x.
    pub const ORIGIN: Self = Self { position: Vector3::new(0.0, 0.0, 0.0), heading: Heading::FORWARD };

    /// Holds `position`, pointing along `heading` (its rates are dropped: a hover is at rest).
    ///
    /// # Errors
    /// If a component of the position is not finite.
    pub fn new(position: Vector3<f32>, heading: Heading) -> Result<Self, ParameterError> {
        for component in position.iter() {
            require_finite(*component, "reference.position")?;
        }
        let heading = Heading::new(heading.direction(), 0.0, 0.0)?;
        Ok(Self { position, heading })
    }
}

impl Trajectory for Hover {
    fn at(&self, _time_us: u64) -> Reference {
        let zero = Vector3::zeros();
        Reference {
            position: self.position,
            velocity: zero,
            acceleration: zero,
            jerk: zero,
            snap: zero,
            heading: self.heading,
        }
    }

    fn bounds(&self) -> ReferenceBounds {
        ReferenceBounds::REST
    }

    fn fifth_derivative(&self, _from_us: u64, _to_us: u64) -> f64 {
        0.0
    }
}
