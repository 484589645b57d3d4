use super::*;

#[test]
fn a_component_beyond_the_range_is_refused_on_either_side() {
    for far in [1.01 * STATE_RANGE, -1.01 * STATE_RANGE] {
        let vector = Vector3::new(0.0, far, 0.0);
        let field = "state.position";
        assert_eq!(check_vectors(&[(&vector, STATE_RANGE, field)]), Err(InputError::OutOfRange { field }));
    }
}

#[test]
fn a_quaternion_too_long_or_too_short_is_no_rotation() {
    for (length, rotates) in [(0.998, false), (0.9991, true), (1.0009, true), (1.002, false), (f32::NAN, false)] {
        assert_eq!(is_rotation(&(Quaternion::new(0.6, 0.0, 0.8, 0.0) * length)), rotates, "{length}");
    }
}
