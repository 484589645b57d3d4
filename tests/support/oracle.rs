//! A second, deliberately plain transcription of the paper's law, in f64, for the tests to compare the core with.
//!
//! It shares no code with the core and takes the other road wherever there is one: rotation matrices instead of
//! quaternions, R_d from eq. (DesiredRotationMatrix) with varpi as printed, omega_d and omega_d' by differentiating R_d
//! numerically along the reference's Taylor expansion, filters integrated in many small Runge-Kutta steps. Only the
//! known slips of the paper are put right (docs: "where the paper must not be copied literally").
//!
//! World z up, body-to-world rotations, SI units, scalar-first quaternions as 4-vectors.

pub mod desired;
pub mod lifting;
pub mod rounding;

use controller_core::{gains::Gains, vehicle::Vehicle};
use desired::Command;
use lifting::Lift;
use nalgebra::{Matrix3, Vector3, Vector4};

/// Vehicle and gains in f64, under the paper's symbols.
#[derive(Debug, Clone, Copy)]
pub struct Law {
    pub mass: f64,
    pub gravity: f64,
    pub inertia: Matrix3<f64>,
    pub k_p: f64,
    pub k_v: f64,
    pub k_f: f64,
    pub k_s: f64,
    pub k_theta: f64,
    pub k_omega: f64,
    pub m_p: f64,
    pub m_theta: f64,
    pub m_omega: f64,
    pub delta: f64,
    pub alpha: f64,
    /// The floor of the thrust projection where that is on, N; the paper has none.
    pub thrust_floor: Option<f64>,
}

/// What the law looks at, at one instant. Errors rather than absolute positions: only those enter the law.
#[derive(Debug, Clone, Copy)]
pub struct Situation {
    pub position_error: Vector3<f64>,
    pub velocity_error: Vector3<f64>,
    pub rotation: Matrix3<f64>,
    pub angular_velocity: Vector3<f64>,
    pub acceleration: Vector3<f64>,
    pub jerk: Vector3<f64>,
    pub snap: Vector3<f64>,
    /// psi, psi', psi''.
    pub heading: [f64; 3],
    pub u_f: Vector3<f64>,
    pub u_s: Vector3<f64>,
}

/// The position law and what the filters make of it.
#[derive(Debug, Clone, Copy)]
pub struct Translation {
    /// ubar_p.
    pub feedback: Vector3<f64>,
    /// u, u', u'' with the heading: all that R_d depends on.
    pub command: Command,
}

/// The law up to the choice of a lift.
#[derive(Debug, Clone, Copy)]
pub struct Evaluation {
    pub translation: Translation,
    pub thrust: f64,
    pub desired: Matrix3<f64>,
    pub omega_d: Vector3<f64>,
    pub omega_d_dot: Vector3<f64>,
    /// R~ = R_d^T R.
    pub error: Matrix3<f64>,
    /// omega~ = omega - R~^T omega_d.
    pub rate_error: Vector3<f64>,
}

impl Law {
    pub fn new(vehicle: &Vehicle, gains: &Gains) -> Self {
        Self {
            mass: vehicle.mass.into(),
            gravity: vehicle.gravity.into(),
            inertia: Matrix3::from_diagonal(&vehicle.inertia.cast()),
            k_p: gains.k_p.into(),
            k_v: gains.k_v.into(),
            k_f: gains.k_f.into(),
            k_s: gains.k_s.into(),
            k_theta: gains.k_theta.into(),
            k_omega: gains.k_omega.into(),
            m_p: gains.m_p.into(),
            m_theta: gains.m_theta.into(),
            m_omega: gains.m_omega.into(),
            delta: gains.delta.into(),
            alpha: gains.alpha.into(),
            thrust_floor: None,
        }
    }

    /// sigma_p(y): componentwise M tanh(y/M).
    pub fn saturate(&self, y: Vector3<f64>) -> Vector3<f64> {
        y.map(|component| self.m_p * (component / self.m_p).tanh())
    }

    /// Section IV: z coordinates, saturated feedback, command u with its two derivatives from the filters.
    pub fn translation(&self, s: &Situation) -> Translation {
        let z_1 = s.position_error
            + (1.0 / self.k_f + 1.0 / self.k_s) * s.velocity_error
            + 1.0 / (self.k_s * self.k_f) * s.u_f;
        let z_2 = s.velocity_error + 1.0 / self.k_f * s.u_f + 1.0 / self.k_s * s.u_s;
        let feedback = -self.saturate(self.k_p * z_1 + self.k_v * z_2);
        let u_f_dot = -self.k_f * (s.u_f - s.u_s);
        let u_s_dot = -self.k_s * (s.u_s - feedback);
        let u_f_ddot = -self.k_f * (u_f_dot - u_s_dot);
        let command = Command {
            u: s.u_f + Vector3::new(0.0, 0.0, self.gravity) + s.acceleration,
            u_dot: u_f_dot + s.jerk,
            u_ddot: u_f_ddot + s.snap,
            heading: s.heading,
        };
        Translation { feedback, command }
    }

    /// Everything but the torque, which needs a lift of `error`.
    pub fn evaluate(&self, s: &Situation) -> Evaluation {
        let translation = self.translation(s);
        let (desired, omega_d, omega_d_dot) = translation.command.differentiate();
        let error = desired.transpose() * s.rotation;
        let u = translation.command.u;
        let thrust = match self.thrust_floor {
            None => self.mass * u.norm(),
            Some(floor) => (self.mass * u.dot(&s.rotation.column(2))).max(floor),
        };
        Evaluation {
            thrust,
            rate_error: s.angular_velocity - error.transpose() * omega_d,
            translation,
            desired,
            omega_d,
            omega_d_dot,
            error,
        }
    }

    /// s_theta(k_theta theta), the gain acting once.
    pub fn attitude_feedback(&self, theta: Vector3<f64>) -> Vector3<f64> {
        radial_saturation(self.m_theta, self.k_theta * theta)
    }

    /// s_omega(k_omega omega~), the gain acting once.
    pub fn rate_feedback(&self, rate_error: Vector3<f64>) -> Vector3<f64> {
        radial_saturation(self.m_omega, self.k_omega * rate_error)
    }

    /// Section V: the torque at MRP error theta~.
    pub fn torque(&self, e: &Evaluation, theta: Vector3<f64>) -> Vector3<f64> {
        let j = self.inertia;
        let rate = e.error.transpose() * e.omega_d;
        let acceleration = e.error.transpose() * e.omega_d_dot;
        let tau_c = skew(j * rate) * rate - j * acceleration;
        -(1.0 + theta.norm_squared()) / 4.0 * self.attitude_feedback(theta) - self.rate_feedback(e.rate_error) - tau_c
    }

    /// The filters after `duration` seconds of held feedback, by classical Runge-Kutta in small steps.
    pub fn filters_after(
        &self,
        mut x_f: [Vector3<f64>; 2],
        feedback: Vector3<f64>,
        duration: f64,
    ) -> [Vector3<f64>; 2] {
        let flow = |[u_f, u_s]: [Vector3<f64>; 2]| [-self.k_f * (u_f - u_s), -self.k_s * (u_s - feedback)];
        let along = |x: [Vector3<f64>; 2], k: [Vector3<f64>; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
        // A hundredth of the faster time constant: the step's relative error is 1e-10 / 120.
        let steps = (100.0 * duration * self.k_f.max(self.k_s)).ceil().max(4.0);
        let h = duration / steps;
        for _ in 0..steps as usize {
            let k1 = flow(x_f);
            let k2 = flow(along(x_f, k1, h / 2.0));
            let k3 = flow(along(x_f, k2, h / 2.0));
            let k4 = flow(along(x_f, k3, h));
            for i in 0..2 {
                x_f[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            }
        }
        x_f
    }
}

/// The controller with its memory, for sequences of ticks.
#[derive(Debug, Clone, Copy)]
pub struct Controller {
    pub law: Law,
    pub period: f64,
    /// u_f, u_s.
    pub x_f: [Vector3<f64>; 2],
    pub lift: Option<Lift>,
}

impl Controller {
    pub fn new(law: Law, period: f64) -> Self {
        Self { law, period, x_f: [Vector3::zeros(); 2], lift: None }
    }

    /// One tick: the output of the filters as they stand (those of `s` are not used), then the filters advance.
    /// Returns the evaluation, the lifted quaternion m* Phi, and the torque.
    pub fn tick(&mut self, s: &Situation) -> (Evaluation, Vector4<f64>, Vector3<f64>) {
        let evaluation = self.law.evaluate(&Situation { u_f: self.x_f[0], u_s: self.x_f[1], ..*s });
        let before = self.lift.unwrap_or_else(|| Lift::initial(&evaluation.error));
        let (lift, lifted) = before.advance(&evaluation.error, self.law.delta, self.law.alpha);
        self.lift = Some(lift);
        self.x_f = self.law.filters_after(self.x_f, evaluation.translation.feedback, self.period);
        let torque = self.law.torque(&evaluation, lifting::mrp(&lifted));
        (evaluation, lifted, torque)
    }
}

/// s(x) = M x / sqrt(M^2 + |x|^2).
fn radial_saturation(level: f64, x: Vector3<f64>) -> Vector3<f64> {
    level * x / (level * level + x.norm_squared()).sqrt()
}

/// [x]_x.
pub fn skew(x: Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -x.z, x.y, x.z, 0.0, -x.x, -x.y, x.x, 0.0)
}
