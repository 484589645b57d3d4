//! D. Mellinger, V. Kumar: *Minimum snap trajectory generation and control for quadrotors*, IEEE International
//! Conference on Robotics and Automation, 2011, Section IV.
//!
//! ```text
//! F = -K_p e_p - K_v e_v + m g z_W + m r_T'',  u_1 = F . z_B
//! R_des: z along F, y across z and the heading
//! e_R = 1/2 (R_des^T R - R^T R_des)^v,  e_w = w - w_T
//! (u_2, u_3, u_4) = -K_R e_R - K_w e_w
//! ```
//!
//! w_T and its derivative are the *reference's* (differential flatness: the frame that the reference's own acceleration
//! asks for), not those of R_des: that is what sets it apart from [Lee's](super::lee). Added here, since ours has it:
//! the torque of the reference's angular acceleration and of the spin. Gains stand before accelerations, in 1/s^2 and
//! 1/s.
//!
//! Home: trajectories near their reference, moderate attitudes.

use super::frame::{Frame, HeadingRule};
use super::jet::Jet;
use super::lee::attitude_error;
use super::rival::{Commanded, Rival, RivalModel, RivalReference, RivalState, gyroscopic, paired};
use super::start::{Pace, STIFFNESS_AND_DAMPING};
use nalgebra::Vector3;

/// The gains' names.
pub const NAMES: [&str; 8] =
    ["k_p_across", "k_v_across", "k_p_vertical", "k_v_vertical", "k_r_tilt", "k_w_tilt", "k_r_yaw", "k_w_yaw"];
/// Where a search starts, on a vehicle like the Hummingbird.
pub const START_GAINS: [f64; 8] = [5.0, 3.8, 6.0, 4.5, 150.0, 20.0, 8.0, 5.0];
/// The speed that each of them scales with.
pub const GAIN_PACES: [Pace; 8] = STIFFNESS_AND_DAMPING;

/// The law.
#[derive(Debug, Clone)]
pub struct Mellinger {
    model: RivalModel,
    k_p: Vector3<f64>,
    k_v: Vector3<f64>,
    k_r: Vector3<f64>,
    k_w: Vector3<f64>,
}

impl Mellinger {
    /// With gains as in [`NAMES`].
    #[must_use]
    pub fn new(model: RivalModel, [p_a, v_a, p_v, v_v, r_t, w_t, r_y, w_y]: [f64; 8]) -> Self {
        Self { model, k_p: paired(p_a, p_v), k_v: paired(v_a, v_v), k_r: paired(r_t, r_y), k_w: paired(w_t, w_y) }
    }
}

impl Rival for Mellinger {
    fn step(&mut self, state: &RivalState, target: &RivalReference) -> Commanded {
        let needed = target.acceleration.plus(&Jet::constant(Vector3::z() * self.model.gravity));
        let force = needed.0[0]
            - self.k_p.component_mul(&(state.position - target.position))
            - self.k_v.component_mul(&(state.velocity - target.velocity));
        let desired = Frame::new(&Jet::constant(force), &Jet::constant(target.heading.0[0]), HeadingRule::Projected);
        let reference = Frame::new(&needed, &target.heading, HeadingRule::Projected);
        let back = state.attitude.inverse() * reference.attitude;
        let rate = back * reference.rate;
        let feedback = self.k_r.component_mul(&attitude_error(&desired.attitude, &state.attitude))
            + self.k_w.component_mul(&(state.rate - rate));
        let forward = back * reference.acceleration;
        let inertia = &self.model.inertia;
        Commanded {
            thrust: self.model.mass * force.dot(&(state.attitude * Vector3::z())),
            torque: inertia.component_mul(&(forward - feedback)) + gyroscopic(inertia, &state.rate),
            desired: desired.attitude,
            desired_rate: reference.rate,
        }
    }

    fn boxed(&self) -> Box<dyn Rival> {
        Box::new(self.clone())
    }
}
