use super::*;
use nalgebra::UnitQuaternion;

fn attitudes() -> impl Iterator<Item = UnitQuaternion<f32>> {
    (0..500).map(|k| {
        let k = k as f32;
        UnitQuaternion::from_euler_angles(0.31 * k, 0.17 * k, 0.53 * k)
    })
}

#[test]
fn north_east_and_down_are_where_mavlink_has_them() {
    assert_eq!(world(&Vector3::new(1.0, 2.0, 3.0)), Vector3::new(2.0, 1.0, -3.0));
    assert_eq!(body(&Vector3::new(1.0, 2.0, 3.0)), Vector3::new(1.0, -2.0, -3.0));
}

#[test]
fn vectors_come_back_from_a_round_trip() {
    let v = Vector3::new(0.3, -7.0, 11.0);
    assert_eq!(world(&world(&v)), v);
    assert_eq!(body(&body(&v)), v);
}

#[test]
fn a_vehicle_that_faces_north_has_no_rotation_in_mavlink() {
    let facing_north = UnitQuaternion::from_euler_angles(0.0, 0.0, FRAC_PI_2);
    let q = attitude(&facing_north);
    assert!((q.w.abs() - 1.0).abs() < 1e-6 && q.imag().norm() < 1e-6, "{q}");
}

#[test]
fn a_turned_body_vector_is_the_same_in_both_conventions() {
    let v = Vector3::new(0.4, -0.9, 1.7);
    for q in attitudes() {
        let turned = UnitQuaternion::new_unchecked(attitude(&q)) * body(&v);
        assert!((turned - world(&(q * v))).norm() < 4e-6, "{q}");
    }
}

#[test]
fn an_attitude_comes_back_from_a_round_trip() {
    for q in attitudes() {
        assert!((attitude(&attitude(&q)).coords - q.coords).norm() < 1e-6, "{q}");
    }
}

#[test]
fn a_heading_is_the_yaw_of_the_same_attitude() {
    for k in -31..=31 {
        let psi = 0.1 * k as f32;
        let q = UnitQuaternion::new_unchecked(attitude(&UnitQuaternion::from_euler_angles(0.0, 0.0, psi)));
        let difference = q.euler_angles().2 - heading(psi);
        assert!(difference.sin().abs() < 1e-5 && difference.cos() > 0.0, "{psi} {difference}");
        assert!((-PI..=PI).contains(&heading(psi)));
    }
    assert_eq!(heading_rate(0.5), -0.5);
}
