//! The attitude that points body z along a force and body x near a heading, with its angular velocity and acceleration.
//!
//! World frame z up, body x forward, y left, z up; R_d = [x y z] is body to world. With z = u / |u| and the heading nu:
//!
//! | rule | axes | who builds it so |
//! |---|---|---|
//! | [`HeadingRule::Projected`] | y = z x nu / \|z x nu\|, x = y x z | Lee (2010), Mellinger (2011), Martins (2024) |
//! | [`HeadingRule::Horizontal`] | x = c x z / \|c x z\| with c = e3 x nu, y = z x x | PX4's `bodyzToAttitude`; the paper, after Basso (2022) |
//!
//! The first projects the heading onto the plane across z: the nose's compass direction is nu in level flight only. The
//! second keeps the nose's horizontal part on nu. R_d' = R_d \[omega_d\]x gives
//!
//! ```text
//! omega_d = (z . y', x . z', y . x')      each of them differentiated once more for omega_d'
//! ```

use super::jet::Jet;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// The rule for the nose's direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeadingRule {
    /// The heading's projection onto the plane across the thrust.
    Projected,
    /// The heading itself, seen from above.
    Horizontal,
}

/// A desired attitude and its motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// R_d, body to world.
    pub attitude: UnitQuaternion<f64>,
    /// omega_d, rad/s, axes of the desired body frame.
    pub rate: Vector3<f64>,
    /// omega_d', rad/s^2, likewise.
    pub acceleration: Vector3<f64>,
}

/// A force per mass shorter than this points nowhere; an x or y axis shorter than the other has no direction.
const FORCE_MIN_M_PER_S2: f64 = 1e-2;
const AXIS_MIN_SHARE: f64 = 1e-2;
/// An axis shorter than this has no direction.
const AXIS_LENGTH_MIN: f64 = 1e-9;

impl Frame {
    /// For the force per mass `force`, m/s^2, and the heading's unit vector, both world, with their derivatives.
    #[must_use]
    pub fn new(force: &Jet, heading: &Jet, rule: HeadingRule) -> Self {
        // Free fall asks for no direction: upright is as good as any.
        let force = if force.0[0].norm() < FORCE_MIN_M_PER_S2 { Jet::constant(Vector3::z()) } else { *force };
        let z = force.unit(FORCE_MIN_M_PER_S2);
        let (x, y) = match rule {
            HeadingRule::Projected => {
                let y = z.cross(heading).unit(AXIS_MIN_SHARE);
                (y.cross(&z), y)
            }
            HeadingRule::Horizontal => {
                let x = Jet::constant(Vector3::z()).cross(heading).cross(&z).unit(AXIS_MIN_SHARE);
                (x, z.cross(&x))
            }
        };
        let turning = |a: &Jet, b: &Jet| {
            let [a, b] = [a.0, b.0];
            [a[0].dot(&b[1]), a[1].dot(&b[1]) + a[0].dot(&b[2])]
        };
        let [roll, pitch, yaw] = [turning(&z, &y), turning(&x, &z), turning(&y, &x)];
        Self {
            attitude: UnitQuaternion::from_rotation_matrix(&nearest(&x.0[0], &y.0[0], &z.0[0])),
            rate: Vector3::new(roll[0], pitch[0], yaw[0]),
            acceleration: Vector3::new(roll[1], pitch[1], yaw[1]),
        }
    }
}

/// The rotation nearest to three axes across each other, of which the first two are equally long, and shorter than one
/// where the heading hardly says where they point.
fn nearest(x: &Vector3<f64>, y: &Vector3<f64>, z: &Vector3<f64>) -> Rotation3<f64> {
    let length = x.norm();
    if length > AXIS_LENGTH_MIN {
        return Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x / length, y / length, *z]));
    }
    // Without a heading: of all attitudes with this z, one near level.
    let matrix = Matrix3::from_columns(&[*x, *y, *z]);
    Rotation3::from_matrix_eps(&matrix, AXIS_LENGTH_MIN, 50, Rotation3::identity())
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller_core::attitude_reference::attitude_reference;
    use controller_core::heading::Heading;

    /// A force and a heading in motion.
    fn moving() -> (Jet, Jet, Heading) {
        let force = Jet([Vector3::new(2.0, -3.0, 9.0), Vector3::new(1.0, 0.5, -2.0), Vector3::new(-4.0, 3.0, 1.0)]);
        let heading = Heading::from_derivatives(
            nalgebra::Vector2::new(0.6, 0.8),
            nalgebra::Vector2::new(-0.8, 0.6) * 0.7,
            nalgebra::Vector2::new(-0.8, 0.6) * -0.4 - nalgebra::Vector2::new(0.6, 0.8) * 0.49,
        )
        .unwrap();
        let flat = |v: nalgebra::Vector2<f32>| Vector3::new(f64::from(v.x), f64::from(v.y), 0.0);
        let jet = Jet([flat(heading.direction()), flat(heading.first_derivative()), flat(heading.second_derivative())]);
        (force, jet, heading)
    }

    #[test]
    fn a_horizontal_heading_gives_the_papers_frame_and_its_motion() {
        let (force, jet, heading) = moving();
        let ours = attitude_reference(
            &force.0[0].map(|x| x as f32),
            &force.0[1].map(|x| x as f32),
            &force.0[2].map(|x| x as f32),
            &heading,
        );
        let frame = Frame::new(&force, &jet, HeadingRule::Horizontal);
        let dot = frame.attitude.coords.dot(&ours.attitude.coords.map(f64::from)).abs();
        assert!(dot > 1.0 - 1e-6, "{dot}");
        assert!((frame.rate - ours.angular_velocity.map(f64::from)).amax() < 1e-5);
        assert!((frame.acceleration - ours.angular_acceleration.map(f64::from)).amax() < 1e-4);
    }

    #[test]
    fn a_projected_heading_leaves_the_nose_beside_it_when_tilted_only() {
        let (force, jet, _) = moving();
        let nose = |frame: Frame| frame.attitude * Vector3::x();
        let off = |nose: Vector3<f64>| {
            let nu = jet.0[0];
            (nu.x * nose.y - nu.y * nose.x).atan2(nu.dot(&nose)).abs()
        };
        let projected = Frame::new(&force, &jet, HeadingRule::Projected);
        assert!(off(nose(projected)) > 0.01, "{}", off(nose(projected)));
        assert!(off(nose(Frame::new(&force, &jet, HeadingRule::Horizontal))) < 1e-6);
        let level = Jet::constant(Vector3::z() * 9.81);
        assert!(off(nose(Frame::new(&level, &jet, HeadingRule::Projected))) < 1e-6);
    }

    #[test]
    fn axes_without_a_direction_become_a_rotation_all_the_same() {
        let forward = Jet::constant(Vector3::x());
        // Along the heading, where the nose's direction is undefined; next to it, where it is nearly so; and far from
        // it.
        for across in [0.0, 1e-12, 1e-6, 1e-3, 0.1, 5.0] {
            for rule in [HeadingRule::Projected, HeadingRule::Horizontal] {
                let force = Vector3::new(9.0, across, 0.0);
                let attitude = Frame::new(&Jet::constant(force), &forward, rule).attitude;
                let up = attitude * Vector3::z();
                assert!(
                    (attitude.norm() - 1.0).abs() < 1e-12 && (up - force.normalize()).amax() < 1e-8,
                    "{across} {rule:?}"
                );
            }
        }
    }

    #[test]
    fn its_motion_is_that_of_differences() {
        let (force, heading, _) = moving();
        let at = |t: f64| {
            let moved = |jet: &Jet| {
                let [a, b, c] = jet.0;
                Jet([a + b * t + c * (0.5 * t * t), b + c * t, c])
            };
            Frame::new(&moved(&force), &moved(&heading), HeadingRule::Projected)
        };
        let h = 1e-4;
        let [before, now, after] = [-h, 0.0, h].map(at);
        let turned = (before.attitude.inverse() * after.attitude).scaled_axis() / (2.0 * h);
        assert!((turned - now.rate).amax() < 1e-5, "{turned} {}", now.rate);
        let turned = (after.rate - before.rate) / (2.0 * h);
        assert!((turned - now.acceleration).amax() < 1e-5, "{turned} {}", now.acceleration);
    }
}
