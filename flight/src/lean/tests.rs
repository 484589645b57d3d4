use super::*;
use nalgebra::UnitQuaternion;

#[test]
fn the_attitude_leads_what_is_felt_to_up_with_no_more_of_a_turn_than_that() {
    for (x, y, z) in [(0.0, 0.0, 9.81), (3.0, 0.0, 9.3), (0.0, -6.0, 7.7), (4.0, 4.0, -8.0), (-9.8, 0.1, 0.0)] {
        let force = Vector3::new(x, y, z);
        let lean = Lean::felt(&force, &Vector3::new(0.1, 0.2, 0.3)).unwrap();
        let q = UnitQuaternion::new_unchecked(lean.attitude);
        assert!((q.norm() - 1.0).abs() < 1e-5, "{force:?}");
        assert!((q * force.normalize() - Vector3::z()).norm() < 1e-3, "{force:?}");
        assert!((q.angle() - force.angle(&Vector3::z())).abs() < 1e-3, "{force:?}");
        assert_eq!(lean.angular_velocity, Vector3::new(0.1, 0.2, 0.3));
    }
}

#[test]
fn upside_down_it_is_still_a_rotation() {
    for x in [0.0, 1e-4, 0.02, 0.3] {
        let lean = Lean::felt(&Vector3::new(x, 0.0, -9.81), &Vector3::zeros()).unwrap();
        let q = UnitQuaternion::new_unchecked(lean.attitude);
        assert!((q.norm() - 1.0).abs() < 1e-3 && (q * Vector3::z()).z < -0.99, "{x}: {q:?}");
    }
}

#[test]
fn a_vehicle_that_is_thrown_or_falls_has_no_lean() {
    for force in [0.0, 5.0, 20.0, f32::NAN, f32::INFINITY] {
        assert_eq!(Lean::felt(&Vector3::new(0.0, 0.0, force), &Vector3::zeros()), None, "{force}");
    }
}
