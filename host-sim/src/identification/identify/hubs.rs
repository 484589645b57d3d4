//! The air's forces at the rotors' hubs, as far as a flight near hover shows them.
//!
//! With tau_xy the rotors' torque about x and y, F their thrust over the mass, A the air's part of the acceleration,
//! body, V_b the velocity in it, c and m scale and mass, rotor i at p_i:
//!
//! ```text
//! a = (kappa_z A_z tau_xy - kappa_d (tau_xy . A) e3) / (2 F) - 2 (lambda m/c) omega_z sum (e3 x p_i)(e3 x p_i)' V_b        torque over c
//! l = n lambda (V_bx^2 + V_by^2)                                                       acceleration along e3
//! ```
//!
//! *kappa*: a rotor's drag -w_i diag(k_d, k_d, k_z) V goes with its own speed, and rotors that tilt the vehicle, or
//! hold a centre of mass that is beside the origin, turn unlike each other. With w_i = w + T_i/(2 c k w) for what it
//! gives beyond the mean and n c k w^2 = m F, all drag at the rotors makes kappa 1, and drag of the frame makes it
//! less. A is used, not V_b: a gust pulls at the rotors as a moving vehicle's own speed does, and what it does is known
//! ([`super::noise`]) where its speed is not. If gusts are left out of it, a centre of mass is found up to 40 % too
//! near; if F is g, as in a hover, by a sixth in winds that press the vehicle down.
//!
//! *lambda*, k_h/m: translational lift, k_h times the square of each hub's speed across. It carries the vehicle as
//! thrust does, and a rotor that moves into the wind as the vehicle yaws is lifted more than the one across from it.
//!
//! The forces are those of [`crate::vehicle::reality::air`].

use super::impulses::Impulse;
use controller_core::allocation::Rotors;
use nalgebra::{Matrix2, Vector2, Vector3};

/// Rotors that carry less hardly spin: the flight says nothing about them.
const IDLE_THRUST_M_PER_S2: f64 = 1.0;

/// Where the hubs are.
#[derive(Debug, Clone, Copy)]
pub struct Layout {
    /// n.
    count: f64,
    /// sum (e3 x p_i)(e3 x p_i)', m^2.
    levers: Matrix2<f64>,
}

impl Layout {
    /// Of a vehicle's rotors.
    #[must_use]
    pub fn of_rotors(rotors: &Rotors) -> Self {
        let lever = |position: &Vector3<f32>| Vector2::new(-f64::from(position.y), f64::from(position.x));
        let levers = rotors.iter().map(|rotor| lever(&rotor.position)).map(|lever| lever * lever.transpose());
        Self { count: rotors.len() as f64, levers: levers.sum() }
    }
}

/// Three unknowns.
#[derive(Debug, Clone, Copy)]
pub struct Hubs {
    /// kappa_z.
    pub along: f64,
    /// kappa_d.
    pub across: f64,
    /// lambda, 1/m.
    pub lift: f64,
}

impl Hubs {
    /// l, m/s^2, at an airspeed in m/s.
    #[must_use]
    pub fn lifted(&self, layout: &Layout, airspeed: &Vector3<f64>) -> f64 {
        layout.count * self.lift * airspeed.xy().norm_squared()
    }

    /// lambda's part of a c/m, N m/kg, at an airspeed in m/s and a rate about z in rad/s.
    #[must_use]
    pub fn torque(&self, layout: &Layout, airspeed: &Vector3<f64>, yaw_rate: f64) -> Vector3<f64> {
        let across = layout.levers * airspeed.xy() * (-2.0 * self.lift * yaw_rate);
        Vector3::new(across.x, across.y, 0.0)
    }

    /// kappa's part of a over the time of an impulse, N m s, where the rotors carry the vehicle with `carried`, F, and
    /// the air makes `air`, m/s^2.
    #[must_use]
    pub fn unlike(&self, impulse: &Impulse, carried: f64, air: &Vector3<f64>) -> Vector3<f64> {
        let tilting = Vector3::new(impulse.torque.x, impulse.torque.y, 0.0) / (2.0 * carried.max(IDLE_THRUST_M_PER_S2));
        tilting * (self.along * air.z) - Vector3::z() * (self.across * tilting.dot(air))
    }
}

#[cfg(test)]
mod tests;
