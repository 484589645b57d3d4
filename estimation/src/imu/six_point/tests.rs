use super::*;
use nalgebra::UnitQuaternion;

const OFFSET: Vector3<f64> = Vector3::new(0.25, -0.4, 0.6);
const SCALE: Vector3<f64> = Vector3::new(1.012, 0.991, 1.03);

fn rest(force: &Vector3<f64>) -> StandstillMeans {
    StandstillMeans { angular_velocity: Vector3::zeros(), specific_force: force.map(|x| x as f32) }
}

/// The means of an accelerometer with these errors at rest, where `up` is up.
fn rest_at(up: &Vector3<f64>, offset: &Vector3<f64>, scale: &Vector3<f64>) -> StandstillMeans {
    rest(&((up * 9.81).component_div(scale) + offset))
}

/// Six faces, each put down askew by up to eight degrees.
fn faces() -> [Vector3<f64>; 6] {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z(), -Vector3::x(), -Vector3::y(), -Vector3::z()];
    let mut n = 0.0;
    axes.map(|axis| {
        n += 1.0_f64;
        UnitQuaternion::from_scaled_axis(Vector3::new(n.sin(), (2.0 * n).cos(), (3.0 * n).sin()) * 0.1) * axis
    })
}

#[test]
fn offsets_and_scales_come_out_though_no_face_is_level() {
    let mut six = SixPoint::default();
    for up in faces() {
        assert_eq!(six.solve(9.81), Err(SixPointError::FaceMissing));
        six.add(&rest_at(&up, &OFFSET, &SCALE), 9.81).unwrap();
    }
    let (offset, scale) = six.solve(9.81).unwrap();
    assert!((offset.cast::<f64>() - OFFSET).norm() < 1e-4, "{offset}");
    assert!((scale.cast::<f64>() - SCALE).norm() < 1e-5, "{scale}");
}

#[test]
fn what_is_no_face_or_no_accelerometer_is_refused() {
    let mut six = SixPoint::default();
    six.add(&rest_at(&Vector3::z(), &OFFSET, &SCALE), 9.81).unwrap();
    assert_eq!(six.add(&rest_at(&Vector3::z(), &OFFSET, &SCALE), 9.81), Err(SixPointError::FaceTwice));
    let askew = Vector3::new(1.0, 1.0, 0.0).normalize();
    for force in [askew * 9.81, Vector3::zeros(), Vector3::repeat(f64::NAN)] {
        assert_eq!(six.add(&rest(&force), 9.81), Err(SixPointError::NoFace));
    }
    for (offset, scale) in [(Vector3::new(1.0, 0.0, 0.0), SCALE), (OFFSET, Vector3::new(1.0, 1.0, 0.95))] {
        let mut six = SixPoint::default();
        faces().iter().for_each(|up| six.add(&rest_at(up, &offset, &scale), 9.81).unwrap());
        assert_eq!(six.solve(9.81), Err(SixPointError::Implausible));
    }
}
