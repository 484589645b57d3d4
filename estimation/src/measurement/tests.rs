use super::*;
use core::f32::consts::FRAC_1_SQRT_2;

const STILL: Velocity = Velocity::World(Vector3::new(0.0, 0.0, 0.0));
const LEVEL: Quaternion<f32> = Quaternion::new(1.0, 0.0, 0.0, 0.0);

fn pose(position: [f32; 3], velocity: [f32; 3], attitude: [f32; 4]) -> Result<Pose, PoseError> {
    let [w, i, j, k] = attitude;
    Pose::new(position.into(), Velocity::World(velocity.into()), Quaternion::new(w, i, j, k))
}

#[test]
fn no_number_of_a_pose_may_be_nan_or_infinite() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for place in 0..10 {
            let mut numbers = [1.0, 2.0, 3.0, 0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0];
            numbers[place] = bad;
            let [x, y, z, u, v, w, q0, q1, q2, q3] = numbers;
            let field = ["position", "velocity", "attitude", "attitude"][place / 3];
            assert_eq!(pose([x, y, z], [u, v, w], [q0, q1, q2, q3]), Err(PoseError::NotFinite(field)), "{place} {bad}");
            let body = Pose::new([x, y, z].into(), Velocity::Body([u, v, w].into()), Quaternion::new(q0, q1, q2, q3));
            assert_eq!(body, Err(PoseError::NotFinite(field)), "{place} {bad}");
        }
    }
}

#[test]
fn a_pose_is_near_and_slow_enough_to_be_believed() {
    let corner = |length: f32| Vector3::new(0.6, 0.0, -0.8) * length;
    for (distance, taken) in [(0.999 * DISTANCE_MAX_M, true), (1.001 * DISTANCE_MAX_M, false), (f32::MAX, false)] {
        assert_eq!(Pose::new(corner(distance), STILL, LEVEL).is_ok(), taken, "{distance} m");
    }
    for (speed, taken) in [(0.999 * SPEED_RANGE_M_PER_S, true), (1.001 * SPEED_RANGE_M_PER_S, false), (f32::MAX, false)]
    {
        for velocity in [Velocity::World(corner(speed)), Velocity::Body(corner(speed))] {
            assert_eq!(Pose::new(Vector3::zeros(), velocity, LEVEL).is_ok(), taken, "{speed} m/s");
        }
    }
    assert_eq!(pose([2e4, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0, 0.0]), Err(PoseError::OutOfRange("position")));
    assert_eq!(pose([0.0; 3], [0.0, 300.0, 0.0], [1.0, 0.0, 0.0, 0.0]), Err(PoseError::OutOfRange("velocity")));
}

#[test]
fn an_attitude_near_a_rotation_is_made_one_and_any_other_is_refused() {
    for (scale, taken) in [(0.96, true), (1.04, true), (-1.0, true), (0.94, false), (1.06, false), (0.0, false)] {
        let given = [0.5 * scale, -0.5 * scale, 0.5 * scale, 0.5 * scale];
        let pose = pose([0.0; 3], [0.0; 3], given);
        assert_eq!(pose.is_ok(), taken, "{scale}");
        assert!(pose.is_ok_and(|pose| (pose.attitude().norm() - 1.0).abs() < 2e-7) || !taken);
    }
    let far = Quaternion::new(f32::MAX, f32::MAX, 0.0, 0.0);
    assert_eq!(Pose::new(Vector3::zeros(), STILL, far), Err(PoseError::NotARotation));
}

#[test]
fn a_velocity_of_the_body_is_turned_into_the_world() {
    // Facing world y: forward is along y, left along -x.
    let facing_y = Quaternion::new(FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2) * 1.04;
    let pose = Pose::new(Vector3::zeros(), Velocity::Body(Vector3::new(1.0, 2.0, 3.0)), facing_y).unwrap();
    assert!((pose.velocity() - Vector3::new(-2.0, 1.0, 3.0)).norm() < 1e-6, "{}", pose.velocity());
}

#[test]
fn a_future_time_stamp_is_not_fresh() {
    assert!(is_fresh(STAMP_LEAD_MAX_US, 0, 0) && !is_fresh(STAMP_LEAD_MAX_US + 1, u64::MAX, 0));
    assert!(is_fresh(u64::MAX, 0, u64::MAX) && is_fresh(5, 10, 15) && !is_fresh(5, 10, 16));
}
