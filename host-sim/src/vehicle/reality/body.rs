//! The rigid body under forces that depend on its motion, in double precision.
//!
//! ```text
//! p' = v                     v' = -g e3 + R(q) F/m                   centre of mass, world frame, z up
//! q' = q (0, omega) / 2      J omega' = (J omega) x omega + tau      body frame
//! ```
//!
//! with F, N, and tau, N m, about the centre of mass, both in the body frame and evaluated at every stage of the
//! classical fourth-order Runge-Kutta method. q is brought back to unit length after each step.
//!
//! The centre of mass c is at r_c from the body's origin o: p_o = p_c - R r_c, v_o = v_c - R (omega x r_c).
//!
//! Source: L. Martins, C. Cardeira, P. Oliveira, eq. (2); E. Hairer, S. P. Norsett, G. Wanner, *Solving Ordinary
//! Differential Equations I*, section II.1.

use nalgebra::{Quaternion, SVector, UnitQuaternion, Vector3};
use scenario::body::BodyState;
use scenario::reality::truth::Truth;

/// The times of the method's three distinct stages, in steps.
pub const STAGE_TIMES: [f64; 3] = [0.0, 0.5, 1.0];

/// p, v, q as stored (x, y, z, w), omega.
type Packed = SVector<f64, 13>;

#[derive(Debug, Clone)]
pub struct RigidBody {
    /// kg.
    mass: f64,
    /// Diagonal, about the centre of mass, kg m^2.
    inertia: Vector3<f64>,
    /// m/s^2.
    gravity: f64,
    /// r_c, m, body.
    centre_of_mass: Vector3<f64>,
    /// Of the centre of mass.
    state: BodyState,
}

impl RigidBody {
    /// A body whose origin moves as `origin` says; `gravity` in m/s^2.
    pub fn new(truth: &Truth, gravity: f64, origin: &BodyState) -> Self {
        let (mass, inertia, centre_of_mass) = (truth.mass, truth.inertia, truth.centre_of_mass);
        let mut body = Self { mass, inertia, gravity, centre_of_mass, state: *origin };
        body.place(origin);
        body
    }

    /// The motion of the centre of mass.
    pub fn state(&self) -> &BodyState {
        &self.state
    }

    /// The motion of the origin.
    pub fn origin(&self) -> BodyState {
        let (arm, turning) = self.arm(&self.state);
        BodyState { position: self.state.position - arm, velocity: self.state.velocity - turning, ..self.state }
    }

    /// Puts its origin elsewhere, as a contact does.
    pub fn place(&mut self, origin: &BodyState) {
        let (arm, turning) = self.arm(origin);
        self.state = BodyState { position: origin.position + arm, velocity: origin.velocity + turning, ..*origin };
    }

    /// R r_c and R (omega x r_c).
    fn arm(&self, state: &BodyState) -> (Vector3<f64>, Vector3<f64>) {
        let attitude = UnitQuaternion::new_unchecked(state.attitude);
        (attitude * self.centre_of_mass, attitude * state.angular_velocity.cross(&self.centre_of_mass))
    }

    /// One step of `step` s. `forces` gives F and tau at each of [`STAGE_TIMES`], by its index, for the state that the
    /// method supposes there.
    pub fn advance(&mut self, step: f64, forces: impl Fn(usize, &BodyState) -> (Vector3<f64>, Vector3<f64>)) {
        let derivative = |stage: usize, packed: &Packed| {
            let state = unpacked(packed);
            let (force, torque) = forces(stage, &state);
            self.derivative(&state, &force, &torque)
        };
        let start = packed(&self.state);
        let k_1 = derivative(0, &start);
        let k_2 = derivative(1, &(start + k_1 * (0.5 * step)));
        let k_3 = derivative(1, &(start + k_2 * (0.5 * step)));
        let k_4 = derivative(2, &(start + k_3 * step));
        let mut state = unpacked(&(start + (k_1 + (k_2 + k_3) * 2.0 + k_4) * (step / 6.0)));
        state.attitude /= state.attitude.norm();
        self.state = state;
    }

    fn derivative(&self, state: &BodyState, force: &Vector3<f64>, torque: &Vector3<f64>) -> Packed {
        let (q, omega) = (&state.attitude, &state.angular_velocity);
        let acceleration = UnitQuaternion::new_unchecked(*q) * force / self.mass - Vector3::z() * self.gravity;
        let turning = q * Quaternion::from_imag(omega * 0.5);
        let momentum = self.inertia.component_mul(omega);
        let angular_acceleration = (momentum.cross(omega) + torque).component_div(&self.inertia);
        packed(&BodyState {
            position: state.velocity,
            velocity: acceleration,
            attitude: turning,
            angular_velocity: angular_acceleration,
        })
    }
}

fn packed(state: &BodyState) -> Packed {
    let mut packed = Packed::zeros();
    packed.fixed_rows_mut::<3>(0).copy_from(&state.position);
    packed.fixed_rows_mut::<3>(3).copy_from(&state.velocity);
    packed.fixed_rows_mut::<4>(6).copy_from(&state.attitude.coords);
    packed.fixed_rows_mut::<3>(10).copy_from(&state.angular_velocity);
    packed
}

fn unpacked(packed: &Packed) -> BodyState {
    BodyState {
        position: packed.fixed_rows::<3>(0).into(),
        velocity: packed.fixed_rows::<3>(3).into(),
        attitude: Quaternion::from_vector(packed.fixed_rows::<4>(6).into()),
        angular_velocity: packed.fixed_rows::<3>(10).into(),
    }
}

#[cfg(test)]
mod tests;
