//! Quaternion feedback under a saturated position loop, common to the continuous and the memoryless law.
//!
//! ```text
//! u = -s(k_p p~ + k_v v~) + g e3 + p_d'',  T = m u . R e3
//! tau = J (w_ref' - 2 k_q q_v - k_w (w - w_ref)) + w x J w
//! ```
//!
//! q is the error R_d^T R as one of its two quaternions, of which q_v is the vector part; the two laws differ only in
//! which of the two they take. s keeps the direction and limits the length. B. Wie, H. Weiss, A. Arapostathis:
//! *Quaternion feedback regulator for spacecraft eigenaxis rotations*, Journal of Guidance, Control, and Dynamics 12,
//! 1989.

use super::frame::{Frame, HeadingRule};
use super::jet::Jet;
use super::rival::{Commanded, RivalModel, RivalReference, RivalState, gyroscopic, paired};
use super::start::{Pace, STIFFNESS_AND_DAMPING};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// The gains' names.
pub const NAMES: [&str; 7] = ["k_p", "k_v", "level", "k_q_tilt", "k_w_tilt", "k_q_yaw", "k_w_yaw"];
/// Where a search starts, on a vehicle like the Hummingbird.
pub const START_GAINS: [f64; 7] = [5.0, 3.8, 5.0, 150.0, 20.0, 8.0, 5.0];
/// The speed that each of them scales with.
pub const GAIN_PACES: [Pace; 7] = {
    let [k_p, k_v, _, _, q_t, w_t, q_y, w_y] = STIFFNESS_AND_DAMPING;
    [k_p, k_v, Pace::Kept, q_t, w_t, q_y, w_y]
};

/// The shared part.
#[derive(Debug, Clone)]
pub struct QuaternionFeedback {
    model: RivalModel,
    k_p: f64,
    k_v: f64,
    level: f64,
    k_q: Vector3<f64>,
    k_w: Vector3<f64>,
}

impl QuaternionFeedback {
    /// With gains as in [`NAMES`].
    #[must_use]
    pub fn new(model: RivalModel, [k_p, k_v, level, q_t, w_t, q_y, w_y]: [f64; 7]) -> Self {
        Self { model, k_p, k_v, level: level.min(0.9 * model.gravity), k_q: paired(q_t, q_y), k_w: paired(w_t, w_y) }
    }

    /// One tick; `choose` picks the error's quaternion, given one of the two.
    pub fn step(
        &self,
        state: &RivalState,
        target: &RivalReference,
        choose: impl FnOnce(Quaternion<f64>) -> Quaternion<f64>,
    ) -> Commanded {
        let needed = target.acceleration.plus(&Jet::constant(Vector3::z() * self.model.gravity));
        let commanded = (state.position - target.position) * self.k_p + (state.velocity - target.velocity) * self.k_v;
        let share = self.level / (self.level * self.level + commanded.norm_squared()).sqrt();
        let force = needed.0[0] - commanded * share;
        let (force_jet, heading) = (Jet::constant(force), Jet::constant(target.heading.0[0]));
        let desired: UnitQuaternion<f64> = Frame::new(&force_jet, &heading, HeadingRule::Horizontal).attitude;
        let reference = Frame::new(&needed, &target.heading, HeadingRule::Horizontal);
        let back = state.attitude.inverse() * reference.attitude;
        let error = choose((desired.inverse() * state.attitude).into_inner());
        let feedback =
            self.k_q.component_mul(&error.imag()) * 2.0 + self.k_w.component_mul(&(state.rate - back * reference.rate));
        let inertia = &self.model.inertia;
        Commanded {
            thrust: self.model.mass * force.dot(&(state.attitude * Vector3::z())),
            torque: inertia.component_mul(&(back * reference.acceleration - feedback))
                + gyroscopic(inertia, &state.rate),
            desired,
            desired_rate: reference.rate,
        }
    }
}
