use super::*;
use proptest::prelude::*;

/// Packed by cflib 0.1.34's `compress_quaternion`, x y z w.
#[test]
fn the_bits_are_those_that_cflib_packs() {
    for ([x, y, z, w], bits) in [
        ([0.0, 0.0, 0.0, 1.0], 0xC000_0000),
        ([1.0, 0.0, 0.0, 0.0], 0x0000_0000),
        ([0.5, -0.5, 0.5, -0.5], 0x3695_A769),
        ([0.1, 0.2, -0.3, 0.927_361_85], 0xC482_46D9),
    ] {
        assert_eq!(packed(&Quaternion::new(w, x, y, z)), bits, "{x} {y} {z} {w}");
    }
}

proptest! {
    #[test]
    fn a_rotation_survives_within_the_bits_steps(parts in prop::array::uniform4(-1.0_f32..1.0)) {
        let [w, x, y, z] = parts;
        let q = Quaternion::new(w, x, y, z);
        prop_assume!(q.norm() > 0.1);
        let q = q / q.norm();
        let back = unpacked(packed(&q));
        let apart = (back - q).norm().min((back + q).norm());
        prop_assert!(apart < 3e-3 && (back.norm() - 1.0).abs() < 1e-6, "{apart}");
    }

    #[test]
    fn any_bits_are_a_rotation_or_are_refused_as_a_pose(bits: u32) {
        prop_assert!(unpacked(bits).coords.iter().all(|component| component.is_finite()));
    }
}
