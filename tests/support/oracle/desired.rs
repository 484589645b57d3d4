//! R_d from eq. (DesiredRotationMatrix) as printed, and its angular velocity and acceleration by finite differences.

use nalgebra::{Matrix3, Vector3};

/// What R_d(t) depends on, to second order in time: u(t + e) = u + u' e + u'' e^2/2 and likewise psi.
///
/// Higher derivatives do not enter omega_d and omega_d', so the expansion is exact for them.
#[derive(Debug, Clone, Copy)]
pub struct Command {
    pub u: Vector3<f64>,
    pub u_dot: Vector3<f64>,
    pub u_ddot: Vector3<f64>,
    /// psi, psi', psi''.
    pub heading: [f64; 3],
}

impl Command {
    /// R_d at `e` seconds from now.
    pub fn desired_attitude(&self, e: f64) -> Matrix3<f64> {
        let u = self.u + self.u_dot * e + self.u_ddot * (e * e / 2.0);
        let psi = self.heading[0] + self.heading[1] * e + self.heading[2] * e * e / 2.0;
        let rho = u / u.norm();
        let (nu_x, nu_y) = (psi.cos(), psi.sin());
        let nu_star = Vector3::new(nu_x, nu_y, 0.0);
        let varpi = rho.z.signum() * Vector3::new(rho.z * nu_x, rho.z * nu_y, -rho.dot(&nu_star));
        let upsilon = varpi / varpi.norm();
        Matrix3::from_columns(&[upsilon, rho.cross(&upsilon), rho])
    }

    /// The motion's fastest time scale, 1/s: R_d is singular where u_z vanishes, so u_z sets it.
    pub fn fastest(&self) -> f64 {
        let vertical = self.u.z.abs();
        (self.u_dot.norm() / vertical)
            .max((self.u_ddot.norm() / vertical).sqrt())
            .max(self.heading[1].abs())
            .max(self.heading[2].abs().sqrt())
            .max(1e-3)
    }

    /// R_d, omega_d and omega_d' with [omega_d]_x = R_d^T dR_d/dt, differentiated numerically, twice.
    ///
    /// Sixth-order central differences at 1/200 of the motion's fastest time scale: the truncation is about
    /// 36 (1/200)^6 = 6e-13 of that scale's rate and the rounding of f64 about 5e-14; the second differentiation
    /// multiplies both by 200. Both are far below single precision.
    pub fn differentiate(&self) -> (Matrix3<f64>, Vector3<f64>, Vector3<f64>) {
        differentiate(|e| self.desired_attitude(e), self.fastest())
    }
}

/// R and omega at zero of a `frame` that moves at the rate `fastest`, 1/s.
pub fn velocity(frame: impl Fn(f64) -> Matrix3<f64>, fastest: f64) -> (Matrix3<f64>, Vector3<f64>) {
    let now = frame(0.0);
    (now, unskew(&(now.transpose() * central_difference(frame, 1.0 / (200.0 * fastest)))))
}

/// R, omega and omega' at zero of a `frame` that moves at the rate `fastest`, 1/s.
pub fn differentiate(frame: impl Fn(f64) -> Matrix3<f64>, fastest: f64) -> (Matrix3<f64>, Vector3<f64>, Vector3<f64>) {
    let step = 1.0 / (200.0 * fastest);
    let rate = |e: f64| frame(e).transpose() * central_difference(|d| frame(e + d), step);
    (frame(0.0), unskew(&rate(0.0)), unskew(&central_difference(rate, step)))
}

/// f'(0) to sixth order in `h`.
fn central_difference(f: impl Fn(f64) -> Matrix3<f64>, h: f64) -> Matrix3<f64> {
    let difference = |k: f64| f(k * h) - f(-k * h);
    (45.0 * difference(1.0) - 9.0 * difference(2.0) + difference(3.0)) / (60.0 * h)
}

/// The x of [x]_x, from the antisymmetric part.
fn unskew(m: &Matrix3<f64>) -> Vector3<f64> {
    0.5 * Vector3::new(m[(2, 1)] - m[(1, 2)], m[(0, 2)] - m[(2, 0)], m[(1, 0)] - m[(0, 1)])
}
