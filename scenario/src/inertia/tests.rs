//! Inertia as files may have it, and what is said of one that they may not have.

use super::*;
use crate::body::attitude_from_euler;
use crate::{PAPER, Scenario};
use controller_core::vehicle::VehicleParameters;
use nalgebra::{Rotation3, UnitQuaternion};

/// The paper's scenario with another inertia.
fn with(inertia: &str) -> Result<Vector3<f32>, String> {
    let line = PAPER.lines().find(|line| line.starts_with("inertia = ")).unwrap();
    let text = PAPER.replace(line, &format!("inertia = {inertia}"));
    let read = Scenario::parse(&text, "f").map_err(|error| error.what)?;
    Ok(read.configuration.vehicle().inertia)
}

/// A matrix as TOML has it.
fn written(matrix: &Matrix3<f64>) -> String {
    let row = |k: usize| format!("[{:e}, {:e}, {:e}]", matrix[(k, 0)], matrix[(k, 1)], matrix[(k, 2)]);
    format!("[{}, {}, {}]", row(0), row(1), row(2))
}

/// `moments` about axes turned by these angles, degrees.
fn turned(moments: Vector3<f64>, angles: [f64; 3]) -> Matrix3<f64> {
    let [roll, pitch, yaw] = angles.map(f64::to_radians);
    let attitude = UnitQuaternion::from_quaternion(attitude_from_euler(roll, pitch, yaw));
    let axes = *Rotation3::from(attitude).matrix();
    axes * Matrix3::from_diagonal(&moments) * axes.transpose()
}

#[test]
fn three_moments_and_their_diagonal_matrix_are_the_same() {
    let moments = with("[2.24e-3, 2.9e-3, 5.3e-3]").unwrap();
    for matrix in [
        "[[2.24e-3, 0, 0], [0, 2.9e-3, 0], [0, 0, 5.3e-3]]",
        // What a program prints of one.
        "[[2.24e-3, 1e-12, -4e-9], [1e-12, 2.9e-3, 0.0], [-4e-9, 0.0, 5.3e-3]]",
    ] {
        assert_eq!(with(matrix), Ok(moments), "{matrix}");
    }
}

#[test]
fn products_of_inertia_are_refused_with_the_moments_and_angles_to_take() {
    let moments = Vector3::new(2e-3, 3e-3, 4.5e-3);
    let refused = with(&written(&turned(moments, [0.0, 0.0, 12.5]))).unwrap_err();
    assert!(refused.starts_with("vehicle.inertia: must be diagonal, found principal moments "), "{refused}");
    for words in
        ["[2.00000e-3, 3.00000e-3, 4.50000e-3]", "a yaw of 12.50 degrees: turn the body axes", "rotors.position"]
    {
        assert!(refused.contains(words), "{refused}");
    }
    let refused = with(&written(&turned(moments, [3.0, -2.0, -20.0]))).unwrap_err();
    for words in ["roll 3.00, pitch -2.00, yaw -20.00 degrees (as initial.euler_deg)", "balance the vehicle"] {
        assert!(refused.contains(words), "{refused}");
    }
    assert_eq!(with("[2.00000e-3, 3.00000e-3, 4.50000e-3]"), Ok(moments.cast()));
}

#[test]
fn the_principal_axes_are_the_nearest_to_the_body_axes() {
    let moments = Vector3::new(4.5e-3, 2e-3, 3e-3);
    for angles in [[10.0, -30.0, 35.0], [-35.0, 5.0, -20.0], [0.0, 0.0, 44.0], [0.0, 0.0, -44.0], [1e-3, 0.0, 0.0]] {
        let inertia = turned(moments, angles);
        let (found, axes) = principal(&inertia).unwrap();
        assert!((found - moments).amax() < 1e-9 * moments.amax(), "{angles:?}: {found}");
        let back = euler_deg(&axes);
        assert!(back.iter().zip(angles).all(|(back, angle)| (back - angle).abs() < 1e-6), "{angles:?}: {back:?}");
    }
    // Two moments alike: any axes across the third will do, and they are right-handed.
    let (found, axes) = principal(&turned(Vector3::new(1e-3, 1e-3, 2e-3), [20.0, 0.0, 0.0])).unwrap();
    assert!((found - Vector3::new(1e-3, 1e-3, 2e-3)).amax() < 1e-12, "{found}");
    assert!((axes.determinant() - 1.0).abs() < 1e-9);
    assert!(principal(&Matrix3::repeat(f64::from(f32::MAX))).is_some());
}

#[test]
fn what_is_no_matrix_of_inertia_is_refused_by_its_element() {
    for (inertia, field, words) in [
        ("[[1e-3, 0, 0], [0, 1e-3, 0]]", "vehicle.inertia", "a matrix of three rows, found 2"),
        ("[[1e-3, 0, 0], [0, 1e-3], [0, 0, 1e-3]]", "vehicle.inertia[1]", "a list of three numbers, found 2"),
        ("[[1e-3, 0, 0], 1e-3, [0, 0, 1e-3]]", "vehicle.inertia[1]", "a list of three numbers, found float"),
        ("[[1e-3, 0, 0], [0, nan, 0], [0, 0, 1e-3]]", "vehicle.inertia[1][1]", "finite"),
        (
            "[[1e-3, 1e-4, 0], [-1e-4, 1e-3, 0], [0, 0, 1e-3]]",
            "vehicle.inertia",
            "symmetric, found [0][1] = 0.0001 and",
        ),
        ("[[1e-3, 2e-3, 0], [2e-3, 1e-3, 0], [0, 0, 1e-3]]", "vehicle.inertia", "which no body has"),
        ("[[0, 1e-3, 0], [1e-3, 0, 0], [0, 0, 0]]", "vehicle.inertia", "which no body has"),
        ("[[0, 0, 0], [0, 0, 0], [0, 0, 0]]", "vehicle.inertia[0]", "greater than zero"),
        ("[[3e38, 3e38, 3e38], [3e38, 3e38, 3e38], [3e38, 3e38, 3e38]]", "vehicle.inertia", "must be diagonal"),
        ("[2.24e-3, 2.9e-3]", "vehicle.inertia", "a list of three numbers, found 2"),
        ("5.3e-3", "vehicle.inertia", "a list of three numbers, found float"),
    ] {
        let refused = with(inertia).unwrap_err();
        assert!(refused.starts_with(&format!("{field}: ")) && refused.contains(words), "{inertia}: {refused}");
        assert_eq!(refused.lines().count(), 1);
    }
}

/// The published inertia of two vehicles of a well-known simulator; and the paper's, which measuring explains.
#[test]
fn moments_that_no_body_has_are_refused_with_the_sum_to_take() {
    let refused = with("[0.0347563, 0.0458929, 0.0977]").unwrap_err();
    assert!(refused.starts_with("vehicle.inertia: violates the triangle inequality"), "{refused}");
    for words in ["[2] = 0.0977 is 21.1 % above 0.0347563 + 0.0458929", "5 % are let pass", "take the sum, 0.0806492"] {
        assert!(refused.contains(words), "{refused}");
    }
    assert!(with("[0.0347563, 0.0458929, 0.0806492]").is_ok());
    assert!(with("[2.24e-3, 2.9e-3, 5.3e-3]").is_ok());
    let parameters = VehicleParameters { mass: 1.0, inertia: Vector3::new(-1.0, 1.0, 1.0), gravity: 9.81 };
    let other = Vehicle::new(parameters).unwrap_err();
    assert_eq!(impossible("vehicle.inertia", &Vector3::repeat(1.0), &other), None);
}
