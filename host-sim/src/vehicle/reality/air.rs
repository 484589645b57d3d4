//! The air's forces and moments on rotors and frame.
//!
//! Body frame (x forward, y left, z up). V is the velocity of the body's *centre of mass* relative to the air, omega
//! the body rate, w_i the speed of rotor i at p_i, r_c the centre of mass, both from the body's origin; d_i = p_i -
//! r_c.
//!
//! ```text
//! V_i = V + omega x d_i                                                     at rotor i
//! T_i = (1 + c_g) c_i k_eta w_i^2 + k_h (V_ix^2 + V_iy^2)                   thrust and translational lift, N
//! 1 + c_g = 1 / (1 - (R / 4z)^2)                                            ground effect, z above the ground
//! H_i = -w_i diag(k_d, k_d, k_z) V_i                                        rotor drag, N
//! tau_i = d_i x (T_i e3 + H_i) + s_i c_i k_m w_i^2 e3 - k_flap w_i V_i x e3     N m
//! V_o = V - omega x r_c                                                     at the origin
//! D = -|V_o| diag(c_D) V_o - diag(c) V_o,   tau_D = -r_c x D                frame drag, linear drag
//! F = sum (T_i e3 + H_i) + D,   tau = sum tau_i + tau_D
//! ```
//!
//! c_i is what the rotor delivers of its model. With r_c = 0 and c = 0 these are the equations of RotorPy's multirotor,
//! so its parameters give its forces: S. Folk, J. Paulos, V. Kumar, *RotorPy*, 2023, arXiv:2306.04485, section III. Its
//! rotor drag is that of P. Martin, E. Salaun, *The True Role of Accelerometer Feedback in Quadrotor Control*, ICRA
//! 2010; linear drag of the whole vehicle, the same at hover with c = (sum w_i) k_d, is that of M. Faessler, A.
//! Franchi, D. Scaramuzza, *Differential Flatness of Quadrotor Dynamics Subject to Rotor Drag*, RA-L 3(2), 2018.
//!
//! The ground effect is that of I. C. Cheeseman, W. E. Bennett, *The effect of the ground on a helicopter rotor in
//! forward flight*, ARC R&M 3021, 1955, the same for all rotors, which stand R / 2 above the ground.
//!
//! Without rotors thrust and torque act at the origin. There is no vortex ring in a fast descent.

use super::propulsion::Delivered;
use controller_core::allocation::geometry::ROTORS_MAX;
use controller_core::allocation::{Rotor, Rotors, Spin};
use nalgebra::Vector3;
use scenario::reality::drag::Drag;
use scenario::reality::truth::Truth;

/// How a body moves relative to the air, body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flow {
    /// Of the centre of mass, m/s.
    pub airspeed: Vector3<f64>,
    /// rad/s.
    pub angular_velocity: Vector3<f64>,
    /// c_g.
    pub ground_effect: f64,
}

/// c_g of rotors with this radius, m, of a vehicle this far above where it stands, m.
pub fn ground_effect(radius: f64, above: f64) -> f64 {
    let ratio = radius / (4.0 * (above.max(0.0) + 0.5 * radius));
    if radius > 0.0 { 1.0 / (1.0 - ratio * ratio) - 1.0 } else { 0.0 }
}

/// One rotor as it really is.
#[derive(Debug, Clone, Copy)]
struct RealRotor {
    /// d_i, m.
    arm: Vector3<f64>,
    /// c_i k_eta, N/(rad/s)^2.
    thrust: f64,
    /// s_i c_i k_m, N m/(rad/s)^2.
    drag_torque: f64,
}

/// Rotors and frame.
#[derive(Debug, Clone)]
pub struct Air {
    rotors: Vec<RealRotor>,
    drag: Drag,
    /// Whether the air does anything to the rotors beyond their thrust in still air.
    drags_rotors: bool,
    /// c_i where there are no rotors.
    thrust_scale: f64,
    /// r_c, m.
    centre_of_mass: Vector3<f64>,
}

impl Air {
    /// Air around a vehicle with these rotors, if it has any.
    pub fn new(rotors: Option<&Rotors>, truth: &Truth, drag: &Drag) -> Self {
        let real = |(index, rotor): (usize, &Rotor)| {
            let scale = truth.thrust_scale * truth.rotor_scales.get(index).copied().unwrap_or(1.0);
            let sign = if rotor.spin == Spin::Clockwise { 1.0 } else { -1.0 };
            RealRotor {
                arm: rotor.position.map(f64::from) - truth.centre_of_mass,
                thrust: scale * f64::from(rotor.thrust_coefficient),
                drag_torque: sign * scale * f64::from(rotor.drag_coefficient),
            }
        };
        Self {
            rotors: rotors.map_or_else(Vec::new, |rotors| rotors.iter().enumerate().map(real).collect()),
            drag: *drag,
            drags_rotors: [drag.rotor_across, drag.rotor_along, drag.translational_lift, drag.flapping] != [0.0; 4],
            thrust_scale: truth.thrust_scale,
            centre_of_mass: truth.centre_of_mass,
        }
    }

    /// The rotors' thrusts at these speeds, rad/s, in still air, N.
    pub fn thrusts(&self, speeds: &[f64; ROTORS_MAX]) -> Vec<f64> {
        self.rotors.iter().zip(speeds).map(|(rotor, speed)| rotor.thrust * speed * speed).collect()
    }

    /// Force, N, and torque about the centre of mass, N m.
    pub fn act(&self, flow: &Flow, delivered: &Delivered) -> (Vector3<f64>, Vector3<f64>) {
        let (force, torque) = match delivered {
            Delivered::Wrench { thrust, torque } => {
                let force = Vector3::z() * (self.thrust_scale * thrust);
                (force, torque * self.thrust_scale - self.centre_of_mass.cross(&force))
            }
            Delivered::Speeds(speeds) => self.rotors(flow, speeds),
        };
        let at_origin = flow.airspeed - flow.angular_velocity.cross(&self.centre_of_mass);
        let quadratic = self.drag.frame.component_mul(&at_origin) * at_origin.norm();
        let drag = -quadratic - self.drag.linear.component_mul(&at_origin);
        (force + drag, torque - self.centre_of_mass.cross(&drag))
    }

    fn rotors(&self, flow: &Flow, speeds: &[f64; ROTORS_MAX]) -> (Vector3<f64>, Vector3<f64>) {
        let drag = &self.drag;
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for (rotor, &speed) in self.rotors.iter().zip(speeds) {
            let mut hub = Vector3::z() * ((1.0 + flow.ground_effect) * rotor.thrust * speed * speed);
            torque.z += rotor.drag_torque * speed * speed;
            if self.drags_rotors {
                let local = flow.airspeed + flow.angular_velocity.cross(&rotor.arm);
                hub.z += drag.translational_lift * local.xy().norm_squared();
                hub -=
                    Vector3::new(drag.rotor_across, drag.rotor_across, drag.rotor_along).component_mul(&local) * speed;
                torque -= local.cross(&Vector3::z()) * (drag.flapping * speed);
            }
            force += hub;
            torque += rotor.arm.cross(&hub);
        }
        (force, torque)
    }
}

#[cfg(test)]
mod tests;
