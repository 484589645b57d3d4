//! T. Lee, M. Leok, N. H. McClamroch: *Geometric tracking control of a quadrotor UAV on SE(3)*, 49th IEEE Conference on
//! Decision and Control, 2010. Below in this project's frames (world z up; theirs is down, which turns the signs of f
//! and g).
//!
//! ```text
//! e_x = x - x_d, e_v = v - v_d
//! u = -k_x e_x - k_v e_v + g e3 + x_d'',  f = m u . R e3                            the thrust
//! e_R = 1/2 (R_d^T R - R^T R_d)^v,  e_W = W - R^T R_d W_d                           the errors
//! M = -k_R e_R - k_W e_W + W x J W - J (W^ R^T R_d W_d - R^T R_d W_d')              the moment
//! R_d: z along u, x along the heading's projection across it                        the commanded attitude
//! ```
//!
//! W_d and its derivative are those of R_d itself: u is differentiated along the motion, its v' and v'' those of the
//! model under the thrust f. Gains stand before accelerations here (k_x / m, k_R / J, in 1/s^2 and 1/s), so that they
//! carry from one vehicle to another, and tilt and yaw, across and vertical have their own: the paper's are scalars,
//! which would tie all to the weakest axis.
//!
//! Home: attitude error below 90 degrees (almost global: below 180) and thrust to spare. It saturates nothing.

use super::frame::{Frame, HeadingRule};
use super::jet::Jet;
use super::rival::{Commanded, Rival, RivalModel, RivalReference, RivalState, gyroscopic, paired};
use super::start::{Pace, STIFFNESS_AND_DAMPING};
use nalgebra::{UnitQuaternion, Vector3};

/// The gains' names.
pub const NAMES: [&str; 8] =
    ["k_x_across", "k_v_across", "k_x_vertical", "k_v_vertical", "k_r_tilt", "k_w_tilt", "k_r_yaw", "k_w_yaw"];
/// Where a search starts, on a vehicle like the Hummingbird.
pub const START_GAINS: [f64; 8] = [5.0, 3.8, 6.0, 4.5, 150.0, 20.0, 8.0, 5.0];
/// The quantity that each gain scales with.
pub const GAIN_PACES: [Pace; 8] = STIFFNESS_AND_DAMPING;

/// The law.
#[derive(Debug, Clone)]
pub struct Lee {
    model: RivalModel,
    k_x: Vector3<f64>,
    k_v: Vector3<f64>,
    k_r: Vector3<f64>,
    k_w: Vector3<f64>,
}

impl Lee {
    /// With gains as in [`NAMES`].
    #[must_use]
    pub fn new(model: RivalModel, [x_a, v_a, x_v, v_v, r_t, w_t, r_y, w_y]: [f64; 8]) -> Self {
        Self { model, k_x: paired(x_a, x_v), k_v: paired(v_a, v_v), k_r: paired(r_t, r_y), k_w: paired(w_t, w_y) }
    }

    /// u with its derivatives along the motion, and f / m.
    fn force(&self, state: &RivalState, target: &RivalReference) -> (Jet, f64) {
        let gravity = Vector3::z() * self.model.gravity;
        let [acceleration, jerk, snap] = target.acceleration.0;
        let feedback = |x: Vector3<f64>, v: Vector3<f64>| -(self.k_x.component_mul(&x) + self.k_v.component_mul(&v));
        let (x, v) = (state.position - target.position, state.velocity - target.velocity);
        let axis = state.attitude * Vector3::z();
        let axis_rate = state.attitude * state.rate.cross(&Vector3::z());

        let u = feedback(x, v) + gravity + acceleration;
        let thrust = u.dot(&axis);
        let a = axis * thrust - gravity - acceleration;
        let u_rate = feedback(v, a) + jerk;
        let thrust_rate = u_rate.dot(&axis) + u.dot(&axis_rate);
        let j = axis * thrust_rate + axis_rate * thrust - jerk;
        (Jet([u, u_rate, feedback(a, j) + snap]), thrust)
    }
}

/// e_R: half of the vector of R_d^T R - R^T R_d, which is 2 q_0 q_v of their quaternion.
#[must_use]
pub fn attitude_error(desired: &UnitQuaternion<f64>, attitude: &UnitQuaternion<f64>) -> Vector3<f64> {
    let error = desired.inverse() * attitude;
    error.imag() * (2.0 * error.w)
}

impl Rival for Lee {
    fn step(&mut self, state: &RivalState, target: &RivalReference) -> Commanded {
        let (force, thrust) = self.force(state, target);
        let frame = Frame::new(&force, &target.heading, HeadingRule::Projected);
        let back = state.attitude.inverse() * frame.attitude;
        let rate = back * frame.rate;
        let feedback = self.k_r.component_mul(&attitude_error(&frame.attitude, &state.attitude))
            + self.k_w.component_mul(&(state.rate - rate));
        let forward = back * frame.acceleration - state.rate.cross(&rate);
        let inertia = &self.model.inertia;
        Commanded {
            thrust: self.model.mass * thrust,
            torque: inertia.component_mul(&(forward - feedback)) + gyroscopic(inertia, &state.rate),
            desired: frame.attitude,
            desired_rate: frame.rate,
        }
    }

    fn boxed(&self) -> Box<dyn Rival> {
        Box::new(self.clone())
    }
}
