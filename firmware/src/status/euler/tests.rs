use super::*;
use nalgebra::UnitQuaternion;

#[test]
fn the_angles_are_those_the_attitude_was_made_of() {
    for roll in -17..=17 {
        for pitch in -8..=8 {
            for yaw in -17..=17 {
                let made = [roll, pitch, yaw].map(|tens| 10.0 * tens as f32);
                let [r, p, y] = made.map(f32::to_radians);
                let q = *UnitQuaternion::from_euler_angles(r, p, y);
                let Euler { roll, pitch, yaw } = euler(&q);
                for (found, made) in [roll, pitch, yaw].into_iter().zip(made) {
                    assert!((found - made).abs() < 2.0, "{found} for {made} in {q}");
                }
            }
        }
    }
}
