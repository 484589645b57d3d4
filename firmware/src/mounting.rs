//! How a sensor sits in the vehicle.

use nalgebra::Vector3;

/// How a sensor sits in the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mounting {
    /// The sensor's axes are the body's: x forward, y left, z up.
    Aligned,
    /// The sensor's x points left, its y back, its z up.
    XLeft,
}

impl Mounting {
    /// From the sensor's axes to the body's.
    #[must_use]
    pub fn to_body(self, sensor: Vector3<f32>) -> Vector3<f32> {
        match self {
            Self::Aligned => sensor,
            Self::XLeft => Vector3::new(-sensor.y, sensor.x, sensor.z),
        }
    }
}
