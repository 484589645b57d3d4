//! What a policy demands of the law: it takes the place of the position law's feedback ubar.
//!
//! | demand | ubar, before it is cut to the envelope |
//! |---|---|
//! | an acceleration a | a - d + kappa v_h: with it the vehicle accelerates with a, wind and drag included |
//! | an attitude with the thrust axis b, and a thrust T | (T / m) b - g e3 |
//!
//! From ubar on everything is as always: filters, turning limit, attitude law, thrust floor and ceiling. So a demand
//! comes out as late as the law's own feedback does, and within the same limits.
//!
//! Speeds of the rotors are the third kind. They take the place of the wrench itself: [`super::rotor_speeds`] makes
//! one of them, and [`Controller::step_on_rotors`](super::controller::Controller::step_on_rotors) flies it.

use crate::error::InputError;
use crate::reference::DERIVATIVE_RANGE;
use crate::state::{check_vectors, is_rotation};
use nalgebra::{Quaternion, Vector3};

/// One demand. SI units, world frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Demand {
    /// Accelerate, and turn about the vertical.
    Acceleration {
        /// m/s^2.
        acceleration: Vector3<f32>,
        /// rad/s.
        yaw_rate: f32,
    },
    /// Point the thrust, and the heading, as an attitude has them.
    Attitude {
        /// Body to world.
        attitude: Quaternion<f32>,
        /// N.
        thrust: f32,
    },
    /// Turn the rotors of an X of four; a [`Shield`](crate::shield::Shield) alone flies it.
    Rotors {
        /// From -1, the least speed of a rotor, to 1, its greatest; what is beyond is cut. Front right, back right,
        /// back left, front left.
        speeds: [f32; 4],
    },
}

impl Demand {
    /// Whether the law can use it.
    ///
    /// # Errors
    /// Names the field that is not finite, out of range or not a rotation.
    pub fn check(&self) -> Result<(), InputError> {
        match self {
            Self::Acceleration { acceleration, yaw_rate } => check_vectors(&[
                (acceleration, DERIVATIVE_RANGE, "demand.acceleration"),
                (&Vector3::repeat(*yaw_rate), DERIVATIVE_RANGE, "demand.yaw_rate"),
            ]),
            Self::Attitude { attitude, thrust } => {
                let field = "demand.attitude";
                check_vectors(&[
                    (&attitude.imag(), DERIVATIVE_RANGE, field),
                    (&Vector3::repeat(attitude.w), DERIVATIVE_RANGE, field),
                    (&Vector3::repeat(*thrust), DERIVATIVE_RANGE, "demand.thrust"),
                ])?;
                if is_rotation(attitude) { Ok(()) } else { Err(InputError::NotARotation { field }) }
            }
            Self::Rotors { speeds: [first, second, third, fourth] } => {
                let field = "demand.speeds";
                check_vectors(&[
                    (&Vector3::new(*first, *second, *third), DERIVATIVE_RANGE, field),
                    (&Vector3::repeat(*fourth), DERIVATIVE_RANGE, field),
                ])
            }
        }
    }
}
