//! Wrench to rotor thrusts while they fit: f = B+ w, the thrusts of least sum of squares.
//!
//! The certificate bounds every rotor's b . w, row b of B+, for every state and every reference inside Omega_r, from a
//! reset on ([`crate::certificate`]); the governor's references are inside, and levelling is a reset onto a hover (the
//! `flight` crate). So in flight B+ w never leaves the rotors' ranges, not even by the rounding of this module: its f32
//! arithmetic is in the bound ([`super::support::TICK_ROUNDING_SHARE`]), as the law's is. What to give up where a
//! vehicle is not what it was certified as is [`Mixer`](super::Mixer)'s question, which starts from here.
//!
//! Each thrust is clipped to its rotor's range nevertheless: nothing beyond leaves this module, whatever it is given.

use super::collected;
use super::geometry::{ROTORS_MAX, Rotor, Rotors};
use crate::error::InputError;
use crate::state::{STATE_RANGE, Wrench, check_vectors, sum_of_squares};
use heapless::Vec;
use nalgebra::{Vector3, Vector4};

/// Rotor thrusts, N, in the rotors' order.
pub type Thrusts = Vec<f32, ROTORS_MAX>;

/// A rotor as the tick needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Actuator {
    /// Its column of B.
    pub(super) column: Vector4<f32>,
    /// Its row of B+.
    share: Vector4<f32>,
    min: f32,
    max: f32,
}

impl Actuator {
    fn new(rotor: &Rotor, column: &Vector4<f64>, share: &Vector4<f64>) -> Self {
        let single = |v: &Vector4<f64>| v.map(|x| x as f32);
        Self { column: single(column), share: single(share), min: rotor.thrust_min, max: rotor.thrust_max }
    }

    /// `thrust` moved into the rotor's range.
    pub(super) fn clip(&self, thrust: f32) -> f32 {
        // Not `max` and `min`, which are calls; a NaN becomes the least.
        let thrust = if thrust > self.min { thrust } else { self.min };
        if thrust < self.max { thrust } else { self.max }
    }
}

/// The rotors' command, and the wrench it delivers.
#[derive(Debug, Clone, PartialEq)]
pub struct Delivered {
    /// Thrust of each rotor, N, within its range.
    pub thrusts: Thrusts,
    /// Whether a thrust of B+ w was outside its rotor's range. Never in a certified flight.
    pub clipped: bool,
}

/// The rows of B+, the columns of B and the rotors' ranges, in single precision.
#[derive(Debug, Clone, PartialEq)]
pub struct MinimumNorm {
    actuators: Vec<Actuator, ROTORS_MAX>,
}

impl MinimumNorm {
    /// Of no rotors.
    pub(super) const NONE: Self = Self { actuators: Vec::new() };

    /// For `rotors`; configuration time.
    pub fn new(rotors: &Rotors) -> Self {
        let all = rotors.iter().zip(rotors.effectiveness()).zip(rotors.pseudo_inverse());
        Self { actuators: collected(all.map(|((rotor, column), share)| Actuator::new(rotor, column, share))) }
    }

    /// Thrusts for `wrench`, N and N m, body frame.
    ///
    /// # Errors
    /// Refuses a wrench that is not finite or beyond [`STATE_RANGE`]; the law's own never are.
    #[inline]
    pub fn allocate(&self, wrench: &Wrench) -> Result<Delivered, InputError> {
        let thrust = Vector3::new(wrench.thrust, 0.0, 0.0);
        // One comparison where all is well; a NaN compares false.
        let usual = sum_of_squares(&[&thrust, &wrench.torque]) <= STATE_RANGE * STATE_RANGE;
        if !usual {
            check_vectors(&[(&thrust, STATE_RANGE, "wrench.thrust"), (&wrench.torque, STATE_RANGE, "wrench.torque")])?;
        }
        let asked = components(wrench);
        let (mut thrusts, mut clipped) = (Thrusts::new(), false);
        // Rotor by rotor, what `preferred` and `clip` do in two passes.
        for actuator in &self.actuators {
            let wanted = actuator.share.dot(&asked);
            let thrust = actuator.clip(wanted);
            // Also true for a NaN.
            clipped |= thrust != wanted;
            // There is room for as many as there are.
            let _ = thrusts.push(thrust);
        }
        Ok(Delivered { thrusts, clipped })
    }

    /// The wrench that thrusts, N, in the rotors' order, act on the body with.
    pub fn wrench(&self, thrusts: &[f32]) -> Wrench {
        let sum = self.sum(thrusts);
        Wrench { thrust: sum.x, torque: Vector3::new(sum.y, sum.z, sum.w) }
    }

    /// The rotors, in their order.
    pub(super) fn actuators(&self) -> &[Actuator] {
        &self.actuators
    }

    /// B+ w.
    pub(super) fn preferred(&self, wrench: &Vector4<f32>) -> Thrusts {
        collected(self.actuators.iter().map(|actuator| actuator.share.dot(wrench)))
    }

    /// B f.
    pub(super) fn sum(&self, thrusts: &[f32]) -> Vector4<f32> {
        self.actuators.iter().zip(thrusts).map(|(actuator, thrust)| actuator.column * *thrust).sum()
    }

    /// Moves thrusts into their rotors' ranges; whether one was outside.
    pub(super) fn clip(&self, thrusts: &mut Thrusts) -> bool {
        let mut clipped = false;
        for (thrust, actuator) in thrusts.iter_mut().zip(&self.actuators) {
            let allowed = actuator.clip(*thrust);
            // Also true for a NaN.
            if allowed != *thrust {
                *thrust = allowed;
                clipped = true;
            }
        }
        clipped
    }
}

/// (T, tau) as one vector.
pub(super) fn components(wrench: &Wrench) -> Vector4<f32> {
    Vector4::new(wrench.thrust, wrench.torque.x, wrench.torque.y, wrench.torque.z)
}
