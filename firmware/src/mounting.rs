//! How a sensor sits in the vehicle: any rotation.

use nalgebra::Vector3;

/// A rotation from a sensor's axes to the body's, x forward, y left, z up. A board has it as a constant, so that the
/// compiler refuses any other matrix:
///
/// ```
/// # use firmware::mounting::Mounting;
/// /// The sensor's x points left, its y back, its z up: body x is its -y, body y its x.
/// const X_LEFT: Mounting =
///     Mounting::new([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]).expect("no rotation");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mounting([[f32; 3]; 3]);

/// How far products of rows may be from those of a rotation: six digits are enough for a board at 45 degrees.
const ROTATION_TOLERANCE: f32 = 1e-5;

impl Mounting {
    /// The sensor's axes are the body's.
    pub const ALIGNED: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// `rows` are the body's x, y and z axes in the sensor's. None unless they are as long as 1, at right angles to
    /// each other, and z is x cross y: a mirror image is no mounting.
    pub const fn new(rows: [[f32; 3]; 3]) -> Option<Self> {
        let [x, y, z] = rows;
        let is_rotation = is(dot(x, x), 1.0)
            && is(dot(y, y), 1.0)
            && is(dot(z, z), 1.0)
            && is(dot(x, y), 0.0)
            && is(dot(y, z), 0.0)
            && is(dot(z, x), 0.0)
            && is(dot(cross(x, y), z), 1.0);
        if is_rotation { Some(Self(rows)) } else { None }
    }

    /// From the sensor's axes to the body's.
    pub fn to_body(&self, sensor: Vector3<f32>) -> Vector3<f32> {
        self.0.map(|axis| dot(axis, sensor.into())).into()
    }
}

/// No number that is not finite is anything.
const fn is(product: f32, expected: f32) -> bool {
    (product - expected).abs() <= ROTATION_TOLERANCE
}

const fn dot([ax, ay, az]: [f32; 3], [bx, by, bz]: [f32; 3]) -> f32 {
    ax * bx + ay * by + az * bz
}

const fn cross([ax, ay, az]: [f32; 3], [bx, by, bz]: [f32; 3]) -> [f32; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

#[cfg(test)]
mod tests;
