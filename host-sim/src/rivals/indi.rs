//! Incremental nonlinear dynamic inversion: E. J. J. Smeur, Q. Chu, G. C. H. E. de Croon: *Adaptive incremental
//! nonlinear dynamic inversion for attitude control of micro air vehicles*, Journal of Guidance, Control, and Dynamics
//! 39, 2016; outer loop and feed-forward after E. Tal, S. Karaman: *Accurate tracking of aggressive quadrotor
//! trajectories using incremental nonlinear dynamic inversion and differential flatness*, IEEE Transactions on Control
//! Systems Technology 29, 2021.
//!
//! ```text
//! tau = tau_f + J (alpha_c - w_f')                                     both: the acting torque, and the missing one
//! alpha_c = w_ref' + K_w (w_ref - w) + K_q q_e                         q_e: the rotation vector of the error
//! (tau b_z)_c = (tau b_z)_f + a_c - a_f                                Tal: the same for the force per mass
//! a_c = a_d + K_p (p_d - p) + K_v (v_d - v)                            Tal, without its K_a
//! ```
//!
//! _f is one low-pass for measurement and actuators alike, so that both are late alike (Smeur). The acting torque is
//! the command that the rotors could deliver, through the model's delay and lag, as the mean over the last period.
//! Linear acceleration is differenced from the velocity: ours estimates forces from the same. w_ref and w_ref' are the
//! reference's, by flatness. Gains stand before accelerations.
//!
//! Home: known actuators, unknown forces and torques; wind, drag and a shifted centre of mass leave no offset.

use super::frame::{Frame, HeadingRule};
use super::jet::Jet;
use super::low_pass::LowPass;
use super::rival::{Commanded, Model, Rival, Seen, Wanted, paired};
use super::start::{Pace, STIFFNESS_AND_DAMPING};
use nalgebra::{Vector3, Vector4};
use std::collections::VecDeque;

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
pub const START: [f64; 10] = [4.0, 3.3, 5.0, 4.0, 200.0, 18.0, 12.0, 5.0, 50.0, 30.0];
/// The quantity that each gain scales with.
pub const PACES: [Pace; 10] = {
    let [p_a, v_a, p_v, v_v, q_t, w_t, q_y, w_y] = STIFFNESS_AND_DAMPING;
    [p_a, v_a, p_v, v_v, q_t, w_t, q_y, w_y, Pace::Kept, Pace::Kept]
};

/// The law and its memory.
#[derive(Debug, Clone)]
pub struct Indi {
    model: Model,
    k_p: Vector3<f64>,
    k_v: Vector3<f64>,
    k_q: Vector3<f64>,
    k_w: Vector3<f64>,
    rate: LowPass,
    torque: LowPass,
    velocity: LowPass,
    force: LowPass,
    actuators: Actuators,
    before: Option<Seen>,
}

impl Indi {
    /// With gains as in [`NAMES`].
    #[must_use]
    pub fn new(model: Model, [p_a, v_a, p_v, v_v, q_t, w_t, q_y, w_y, cut_rate, cut_force]: [f64; 10]) -> Self {
        let [rate, torque] = [cut_rate; 2].map(|cut| LowPass::new(cut, model.period));
        let [velocity, force] = [cut_force; 2].map(|cut| LowPass::new(cut, model.period));
        Self {
            k_p: paired(p_a, p_v),
            k_v: paired(v_a, v_v),
            k_q: paired(q_t, q_y),
            k_w: paired(w_t, w_y),
            rate,
            torque,
            velocity,
            force,
            actuators: Actuators::new(&model),
            model,
            before: None,
        }
    }

    /// After the filters: w', rad/s^2; the torque that acts, N m; v', m/s^2; the force per mass that acts, m/s^2,
    /// world.
    fn measured(&mut self, seen: &Seen) -> [Vector3<f64>; 4] {
        let acted = self.actuators.mean;
        let before = self.before.replace(*seen).unwrap_or(*seen);
        let axis = before.attitude.slerp(&seen.attitude, 0.5) * Vector3::z();
        let (_, angular) = self.rate.take(&seen.rate);
        let (torque, _) = self.torque.take(&acted.fixed_rows::<3>(1).into_owned());
        let (_, linear) = self.velocity.take(&seen.velocity);
        let (force, _) = self.force.take(&(axis * (acted.x / self.model.mass)));
        [angular, torque, linear, force]
    }
}

/// The commands that act, with their delay and lag.
#[derive(Debug, Clone)]
struct Actuators {
    /// exp(-h / lag), and the share of the old command in the mean over a period.
    left: f64,
    mean_left: f64,
    waiting: VecDeque<Vector4<f64>>,
    /// Thrust and torque at the end of the last period, and their mean over it.
    acts: Vector4<f64>,
    mean: Vector4<f64>,
}

impl Actuators {
    fn new(model: &Model) -> Self {
        let ratio = model.period / model.lag.max(1e-9);
        let left = (-ratio).exp();
        let hover = Vector4::new(model.mass * model.gravity, 0.0, 0.0, 0.0);
        let delay = (model.delay / model.period).round() as usize;
        Self { left, mean_left: (1.0 - left) / ratio, waiting: vec![hover; delay].into(), acts: hover, mean: hover }
    }

    /// A command is given; it, or one before it, acts over the period that begins.
    fn take(&mut self, command: Vector4<f64>) {
        self.waiting.push_back(command);
        let due = self.waiting.pop_front().unwrap_or(command);
        let off = self.acts - due;
        self.mean = due + off * self.mean_left;
        self.acts = due + off * self.left;
    }
}

impl Rival for Indi {
    fn step(&mut self, seen: &Seen, wanted: &Wanted) -> Commanded {
        let [angular, torque, linear, force] = self.measured(seen);
        let gravity = Vector3::z() * self.model.gravity;
        // The measured acceleration includes drag, so the commanded one is the motion's own.
        let commanded = wanted.motion
            + self.k_p.component_mul(&(wanted.position - seen.position))
            + self.k_v.component_mul(&(wanted.velocity - seen.velocity));
        let force = force + commanded - linear;

        let desired =
            Frame::new(&Jet::constant(force), &Jet::constant(wanted.heading.0[0]), HeadingRule::Horizontal).attitude;
        let needed = wanted.acceleration.plus(&Jet::constant(gravity));
        let reference = Frame::new(&needed, &wanted.heading, HeadingRule::Horizontal);
        let back = seen.attitude.inverse() * reference.attitude;
        let error = seen.attitude.inverse() * desired;
        let turn = error.scaled_axis();
        let turning = back * reference.acceleration
            + self.k_w.component_mul(&(back * reference.rate - seen.rate))
            + self.k_q.component_mul(&turn);
        Commanded {
            thrust: self.model.mass * force.dot(&(seen.attitude * Vector3::z())),
            torque: torque + self.model.inertia.component_mul(&(turning - angular)),
            desired,
            desired_rate: reference.rate,
        }
    }

    fn delivered(&mut self, thrust: f64, torque: &Vector3<f64>, _cut: bool) {
        self.actuators.take(Vector4::new(thrust, torque.x, torque.y, torque.z));
    }

    fn boxed(&self) -> Box<dyn Rival> {
        Box::new(self.clone())
    }
}
