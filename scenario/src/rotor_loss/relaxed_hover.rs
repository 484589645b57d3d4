//! The relaxed hover of a vehicle without one of its four rotors: it turns steadily, and everything balances.
//!
//! It turns at Omega about the law's axis n, which stands upright. With omega = Omega n, d_i a rotor's place, w_i its
//! speed and f_i = k_eta w_i^2, body frame:
//!
//! ```text
//! V_i = omega x d_i                                               the air at a hub
//! F_i = (f_i + k_h |V_i,xy|^2) e3 - w_i diag(k_d, k_d, k_z) V_i   N
//! n . sum F_i = m g
//! sum d_i x F_i + s_i (k_m / k_eta) f_i e3 - k_flap w_i V_i x e3 = omega x J omega
//! ```
//!
//! Four equations for three thrusts and Omega. Thrust and the tilt's torques give the thrusts at a given Omega,
//! linearly but for the air's small part, which is put in anew until it stands; yaw gives Omega, by halving. For
//! n = z cos phi + sin phi a and J_1 = J_2 the tilt's torque is (J_3 - J_1) Omega^2 sin phi cos phi, that of the rotor
//! opposite the failed one; so it turns faster until that rotor's drag, with the hubs', balances the other two's.
//!
//! Left out: the circle that its centre makes, g tan(phi) / Omega^2 in radius (2 cm at 13 rad/s), and what the least
//! thrust of a rotor forbids.

use crate::reality::drag::Drag;
use controller_core::allocation::{Rotor, Rotors};
use controller_core::vehicle::Vehicle;
use nalgebra::{Matrix3, Vector3, Vector4};

/// The rotors left, of four.
const ROTORS_LEFT: usize = 3;

/// The fastest turning that is looked for, rad/s, and how often that is halved.
const RATE_MAX_RAD_PER_S: f64 = 500.0;
const RATE_HALVINGS: u32 = 60;

/// How often the air's part is put in anew: it shrinks by the drag's small share each time.
const DRAG_ROUNDS: u32 = 50;

/// A relaxed hover.
#[derive(Debug, Clone, PartialEq)]
pub struct RelaxedHover {
    /// Omega, rad/s; positive counter-clockwise, seen from above.
    pub rate: f64,
    /// n, in the body.
    pub axis: Vector3<f64>,
    /// Each rotor's, N; zero of the one that is gone.
    pub thrusts: [f64; ROTORS_LEFT + 1],
}

/// Why there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoHover {
    /// Two rotors hold this much of the weight.
    TooLittleThrust(f64),
    /// Nothing keeps it from turning faster.
    Unbounded,
    /// Its tilt cannot be balanced: the rotors left are not like those of a quadrotor.
    Unbalanced,
}

impl RelaxedHover {
    /// That of a vehicle with four `rotors`, of which the one with the index `lost` is gone, about `axis`.
    ///
    /// # Errors
    /// [`NoHover`].
    pub fn new(
        vehicle: &Vehicle,
        rotors: &Rotors,
        drag: &Drag,
        lost: usize,
        axis: &Vector3<f64>,
    ) -> Result<Self, NoHover> {
        let left: Vec<(usize, &Rotor)> = rotors.iter().enumerate().filter(|(index, _)| *index != lost).collect();
        let left = <[(usize, &Rotor); ROTORS_LEFT]>::try_from(left).map_err(|_| NoHover::Unbalanced)?;
        let turning = Turning {
            rotors: left.map(|(_, rotor)| rotor),
            drag,
            axis,
            weight: f64::from(vehicle.mass) * f64::from(vehicle.gravity),
            inertia: vehicle.inertia.map(f64::from),
        };
        let (thrusts, torque) = turning.balanced(0.0).ok_or(NoHover::Unbalanced)?;
        let most = thrusts.iter().zip(&turning.rotors).filter(|(thrust, _)| **thrust > 0.0);
        let held = most.map(|(thrust, rotor)| f64::from(rotor.thrust_max) / thrust).fold(f64::INFINITY, f64::min);
        if held < 1.0 {
            return Err(NoHover::TooLittleThrust(held));
        }
        let sense = torque.signum();
        let goes_on = |rate: f64| turning.balanced(sense * rate).is_some_and(|(_, torque)| torque * sense > 0.0);
        if goes_on(RATE_MAX_RAD_PER_S) {
            return Err(NoHover::Unbounded);
        }
        let (mut slower, mut faster) = (0.0, RATE_MAX_RAD_PER_S);
        for _ in 0..RATE_HALVINGS {
            let middle = 0.5 * (slower + faster);
            if goes_on(middle) { slower = middle } else { faster = middle }
        }
        let rate = sense * slower;
        let (found, _) = turning.balanced(rate).ok_or(NoHover::Unbalanced)?;
        if found.iter().zip(&turning.rotors).any(|(thrust, rotor)| *thrust > f64::from(rotor.thrust_max)) {
            return Err(NoHover::Unbounded);
        }
        let mut thrusts = [0.0; ROTORS_LEFT + 1];
        for ((index, _), thrust) in left.into_iter().zip(found.iter()) {
            thrusts[index] = *thrust;
        }
        Ok(Self { rate, axis: *axis, thrusts })
    }
}

/// The rotors left, and what they have to balance.
struct Turning<'a> {
    rotors: [&'a Rotor; ROTORS_LEFT],
    drag: &'a Drag,
    axis: &'a Vector3<f64>,
    weight: f64,
    inertia: Vector3<f64>,
}

impl Turning<'_> {
    /// At Omega = `rate`: the thrusts that balance weight and tilt, and the yaw torque that is left, N m.
    fn balanced(&self, rate: f64) -> Option<(Vector3<f64>, f64)> {
        let omega = self.axis * rate;
        let gyroscopic = omega.cross(&self.inertia.component_mul(&omega));
        let required = Vector3::new(self.weight, gyroscopic.x, gyroscopic.y);
        let column = |rotor: &Rotor| Vector3::new(self.axis.z, rotor.position.y.into(), (-rotor.position.x).into());
        let inverse = Matrix3::from_columns(&self.rotors.map(column)).try_inverse()?;
        let mut thrusts = inverse * required;
        let mut of_air = Vector4::zeros();
        for _ in 0..DRAG_ROUNDS {
            of_air = self.air(&omega, &thrusts);
            thrusts = inverse * (required - of_air.xyz());
        }
        let own = self.rotors.iter().zip(thrusts.iter()).map(|(rotor, thrust)| {
            f64::from(rotor.spin.sign()) * f64::from(rotor.drag_coefficient / rotor.thrust_coefficient) * thrust
        });
        Some((thrusts, own.sum::<f64>() + of_air.w - gyroscopic.z))
    }

    /// The part of the air in n . F, N, and in the torque about x, y and z, N m.
    fn air(&self, omega: &Vector3<f64>, thrusts: &Vector3<f64>) -> Vector4<f64> {
        let drag = self.drag;
        let across = Vector3::new(drag.rotor_across, drag.rotor_across, drag.rotor_along);
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for (rotor, thrust) in self.rotors.iter().zip(thrusts.iter()) {
            let speed = (thrust.max(0.0) / f64::from(rotor.thrust_coefficient)).sqrt();
            let place = rotor.position.map(f64::from);
            let flow = omega.cross(&place);
            let lift = Vector3::z() * (drag.translational_lift * flow.xy().norm_squared());
            let hub = lift - across.component_mul(&flow) * speed;
            force += hub;
            torque += place.cross(&hub) - flow.cross(&Vector3::z()) * (drag.flapping * speed);
        }
        Vector4::new(self.axis.dot(&force), torque.x, torque.y, torque.z)
    }
}

#[cfg(test)]
mod tests;
