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
    #[must_use]
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
    #[must_use]
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
mod tests {
    use super::*;
    use nalgebra::{Rotation3, Unit};
    use proptest::prelude::*;

    fn rows(rotation: &Rotation3<f32>) -> [[f32; 3]; 3] {
        core::array::from_fn(|row| core::array::from_fn(|column| rotation.matrix()[(row, column)]))
    }

    proptest! {
        #[test]
        fn any_rotation_is_a_mounting_and_turns_as_it_does(
            [x, y, z] in [-1.0_f32..1.0, -1.0..1.0, -1.0..1.0],
            angle in -7.0_f32..7.0,
            sensor in [-4e4_f32..4e4, -4e4..4e4, -4e4..4e4],
        ) {
            prop_assume!(x * x + y * y + z * z > 1e-3);
            let rotation = Rotation3::from_axis_angle(&Unit::new_normalize(Vector3::new(x, y, z)), angle);
            let mounting = Mounting::new(rows(&rotation)).unwrap();
            let sensor = Vector3::from(sensor);
            prop_assert!((mounting.to_body(sensor) - rotation * sensor).norm() <= 1e-6 * sensor.norm());
        }

        #[test]
        fn what_is_no_rotation_is_no_mounting(
            angle in -7.0_f32..7.0,
            row in 0..3_usize,
            column in 0..3_usize,
            by in prop_oneof![0.01_f32..2.5, -2.5_f32..-0.01],
        ) {
            let rotation = Rotation3::from_euler_angles(angle, 0.7 * angle, 0.3 - angle);
            let mut skewed = rows(&rotation);
            skewed[row][column] += by;
            prop_assert_eq!(Mounting::new(skewed), None);
            let mut mirrored = rows(&rotation);
            mirrored[row] = mirrored[row].map(|component| -component);
            prop_assert_eq!(Mounting::new(mirrored), None);
            let mut no_number = rows(&rotation);
            no_number[row][column] = f32::NAN;
            prop_assert_eq!(Mounting::new(no_number), None);
        }
    }

    #[test]
    fn a_mounting_of_whole_axes_changes_no_number() {
        let mounting = Mounting::new([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]).unwrap();
        assert_eq!(mounting.to_body(Vector3::new(123.0, -32768.0, 0.1)), Vector3::new(32768.0, -123.0, -0.1));
        assert_eq!(Mounting::ALIGNED.to_body(Vector3::new(0.1, -0.2, 32767.0)), Vector3::new(0.1, -0.2, 32767.0));
    }
}
