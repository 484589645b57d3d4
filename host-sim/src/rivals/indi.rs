//! Incremental nonlinear dynamic inversion, with accelerometer and rotor speeds: E. J. J. Smeur, Q. Chu, G. C. H. E. de
//! Croon: *Adaptive incremental nonlinear dynamic inversion for attitude control of micro air vehicles*, Journal of
//! Guidance, Control, and Dynamics 39, 2016; E. Tal, S. Karaman: *Accurate tracking of aggressive quadrotor
//! trajectories using incremental nonlinear dynamic inversion and differential flatness*, IEEE Transactions on Control
//! Systems Technology 29, 2021.
//!
//! ```text
//! tau = tau_f + J (alpha_c - w_f')                                     both: the acting torque, and the missing one
//! alpha_c = w_ref' + K_w (w_ref - w) + K_q q_e                         q_e: the shortest turn of body z, then about it
//! F_c = F_f + a_c - a_f                                                Tal: the same for the force per mass
//! a_c = a_d + K_p (p_d - p) + K_v (v_d - v)                            Tal, without its K_a
//! ```
//!
//! _f is one low-pass for measurement and actuators alike, so that both are late alike (Smeur). w' is differenced from
//! the gyro; a is the accelerometer's specific force, turned into the world, less gravity; tau and F are those of the
//! rotors at their measured speeds. All four are means over the last period. w_ref and w_ref' are the reference's, by
//! flatness. Gains stand before accelerations.
//!
//! Home: rotors that turn as commanded, unknown forces and torques; wind, drag, weak rotors and a shifted centre of
//! mass leave no offset. Rotors that turn more slowly than commanded leave one: it has no integral.

use super::frame::{Frame, HeadingRule};
use super::jet::Jet;
use super::low_pass::LowPass;
use super::rival::{Commanded, Rival, RivalModel, RivalReference, RivalState, paired};
use super::start::{Pace, STIFFNESS_AND_DAMPING};
use nalgebra::{UnitQuaternion, Vector3};

/// The gains' names.
pub const NAMES: [&str; 10] = [
    "k_p_across",
    "k_v_across",
    "k_p_vertical",
    "k_v_vertical",
    "k_q_tilt",
    "k_w_tilt",
    "k_q_yaw",
    "k_w_yaw",
    "cut_off_rate",
    "cut_off_force",
];
/// Where a search starts, on a vehicle like the Hummingbird.
pub const START_GAINS: [f64; 10] = [4.0, 3.3, 5.0, 4.0, 200.0, 18.0, 12.0, 5.0, 50.0, 30.0];
/// The quantity that each gain scales with.
pub const GAIN_PACES: [Pace; 10] = {
    let [p_a, v_a, p_v, v_v, q_t, w_t, q_y, w_y] = STIFFNESS_AND_DAMPING;
    [p_a, v_a, p_v, v_v, q_t, w_t, q_y, w_y, Pace::Attitude(1), Pace::Attitude(1)]
};

/// The law and its memory.
#[derive(Debug, Clone)]
pub struct Indi {
    model: RivalModel,
    k_p: Vector3<f64>,
    k_v: Vector3<f64>,
    k_q: Vector3<f64>,
    k_w: Vector3<f64>,
    rate: LowPass,
    torque: LowPass,
    acceleration: LowPass,
    force: LowPass,
    /// At the last tick.
    attitude: Option<UnitQuaternion<f64>>,
}

impl Indi {
    /// With gains as in [`NAMES`].
    pub fn new(model: RivalModel, [p_a, v_a, p_v, v_v, q_t, w_t, q_y, w_y, cut_rate, cut_force]: [f64; 10]) -> Self {
        let [rate, torque] = [cut_rate; 2].map(|cut| LowPass::new(cut, model.period));
        let [acceleration, force] = [cut_force; 2].map(|cut| LowPass::new(cut, model.period));
        Self {
            model,
            k_p: paired(p_a, p_v),
            k_v: paired(v_a, v_v),
            k_q: paired(q_t, q_y),
            k_w: paired(w_t, w_y),
            rate,
            torque,
            acceleration,
            force,
            attitude: None,
        }
    }

    /// After the filters: w', rad/s^2; the torque that acts, N m; the acceleration, m/s^2, and the rotors' force per
    /// mass, m/s^2, both world.
    fn measured(&mut self, state: &RivalState) -> [Vector3<f64>; 4] {
        let halfway = self.attitude.replace(state.attitude).unwrap_or(state.attitude).slerp(&state.attitude, 0.5);
        let gravity = Vector3::z() * self.model.gravity;
        let (_, angular) = self.rate.take(&state.rate);
        let (torque, _) = self.torque.take(&state.sensed.wrench.fixed_rows::<3>(1).into());
        let (linear, _) = self.acceleration.take(&(halfway * state.sensed.specific_force - gravity));
        let (force, _) = self.force.take(&(halfway * Vector3::z() * (state.sensed.wrench.x / self.model.mass)));
        [angular, torque, linear, force]
    }
}

/// The rotation from `state` to `desired`, rad, body: the shortest that brings body z to its place, and about z the
/// rest.
fn turn(state: &UnitQuaternion<f64>, desired: &UnitQuaternion<f64>) -> Vector3<f64> {
    let error = state.inverse() * desired;
    let about = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 2.0 * error.k.atan2(error.w));
    (error * about.inverse()).scaled_axis() + about.scaled_axis()
}

impl Rival for Indi {
    fn step(&mut self, state: &RivalState, target: &RivalReference) -> Commanded {
        let [angular, torque, linear, force] = self.measured(state);
        let gravity = Vector3::z() * self.model.gravity;
        // The measured acceleration includes drag, so the commanded one is the motion's own.
        let commanded = target.motion
            + self.k_p.component_mul(&(target.position - state.position))
            + self.k_v.component_mul(&(target.velocity - state.velocity));
        let force = force + commanded - linear;

        let desired =
            Frame::new(&Jet::constant(force), &Jet::constant(target.heading.0[0]), HeadingRule::Horizontal).attitude;
        let needed = target.acceleration.plus(&Jet::constant(gravity));
        let reference = Frame::new(&needed, &target.heading, HeadingRule::Horizontal);
        let back = state.attitude.inverse() * reference.attitude;
        let turning = back * reference.acceleration
            + self.k_w.component_mul(&(back * reference.rate - state.rate))
            + self.k_q.component_mul(&turn(&state.attitude, &desired));
        Commanded {
            thrust: self.model.mass * force.dot(&(state.attitude * Vector3::z())),
            torque: torque + self.model.inertia.component_mul(&(turning - angular)),
            desired,
            desired_rate: reference.rate,
        }
    }

    fn boxed(&self) -> Box<dyn Rival> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests;
