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
