//! Bodies put together: several that are fixed to each other are one, with one mass, centre of mass and inertia.

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

/// One rigid body, or several as one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub centre: Vector3<f64>,
    /// About the centre of mass, kg m^2.
    pub inertia: Matrix3<f64>,
}

impl Part {
    /// The same in the frame in which its own frame stands at `pose`.
    #[must_use]
    pub fn placed(&self, pose: &Isometry3<f64>) -> Self {
        let rotation = pose.rotation.to_rotation_matrix();
        let inertia = rotation.matrix() * self.inertia * rotation.matrix().transpose();
        Self { mass: self.mass, centre: pose.transform_point(&self.centre.into()).coords, inertia }
    }

    /// All `parts` as one; none if they weigh nothing.
    #[must_use]
    pub fn together(parts: &[Self]) -> Option<Self> {
        let mass: f64 = parts.iter().map(|part| part.mass).sum();
        if mass <= 0.0 {
            return None;
        }
        let centre = parts.iter().map(|part| part.centre * part.mass).sum::<Vector3<f64>>() / mass;
        let moved = |part: &Self| {
            let arm = part.centre - centre;
            part.inertia + part.mass * (arm.norm_squared() * Matrix3::identity() - arm * arm.transpose())
        };
        Some(Self { mass, centre, inertia: parts.iter().map(moved).sum() })
    }
}

/// A pose from a position, m, and the angles of Rz(yaw) Ry(pitch) Rx(roll), rad.
#[must_use]
pub fn pose([x, y, z]: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
}

/// A matrix of inertia from xx, yy, zz, xy, xz, yz.
#[must_use]
pub fn inertia([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// Where a rotor at `pose` stands.
///
/// # Errors
/// If it does not push along body z; `place` says whose pose that is.
pub fn upright(place: &str, pose: &Isometry3<f64>) -> Result<Vector3<f64>, String> {
    const TILT_MAX: f64 = 1e-3;
    let axis = pose.rotation * Vector3::z();
    let tilt = (axis - Vector3::z()).norm();
    if tilt <= TILT_MAX {
        return Ok(pose.translation.vector);
    }
    Err(format!(
        "{place}: pushes along [{:.4}, {:.4}, {:.4}], and rotors must push along body z, [0, 0, 1]: a tilted rotor \
         cannot be described",
        axis.x, axis.y, axis.z
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_balls_on_a_rod_have_the_inertia_of_a_dumbbell() {
        let ball = |x: f64| Part { mass: 2.0, centre: Vector3::new(x, 0.0, 0.0), inertia: Matrix3::zeros() };
        let both = Part::together(&[ball(1.0), ball(4.0)]).unwrap();
        assert_eq!((both.mass, both.centre), (4.0, Vector3::new(2.5, 0.0, 0.0)));
        assert!((both.inertia - Matrix3::from_diagonal(&Vector3::new(0.0, 9.0, 9.0))).amax() < 1e-12);

        let turned = both.placed(&pose([0.0, 0.0, 1.0], [0.0, 0.0, std::f64::consts::FRAC_PI_2]));
        assert!((turned.centre - Vector3::new(0.0, 2.5, 1.0)).amax() < 1e-12);
        assert!((turned.inertia - Matrix3::from_diagonal(&Vector3::new(9.0, 0.0, 9.0))).amax() < 1e-12);
    }
}
