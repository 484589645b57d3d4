//! Section 5: the heading that lags, as an angle.

use super::{Law, about_z, cut, double};
use crate::support::oracle::desired::{Command, differentiate};
use nalgebra::Vector3;

impl Law {
    /// Section 5: the frame's motion that lags in heading, and chi and W a period later.
    pub fn lagging(
        &self,
        [chi, turn]: [f64; 2],
        command: &Command,
        nudge: f64,
    ) -> (Vector3<f64>, Vector3<f64>, [f64; 2]) {
        let (p, h) = (&self.p, self.period);
        let (_, papers, papers_rate) = command.differentiate();
        let chi_rate = turn - papers.z;
        let wanted = papers_rate.z - double(p.c_2) * chi_rate - 2.0 * double(p.c_1) * (chi / 2.0).sin();
        let reached = cut(turn + cut(wanted, double(p.yaw_acceleration)) * h, double(p.yaw_rate));
        let turn_rate = (reached - turn) / h + nudge;
        let chi_second = turn_rate - papers_rate.z;
        let frame = |e: f64| command.desired_attitude(e) * about_z(chi + chi_rate * e + chi_second * e * e / 2.0);
        let scale = command.fastest().max(chi_rate.abs()).max(chi_second.abs().sqrt());
        let (_, omega_d, omega_d_dot) = differentiate(frame, scale);
        // The half angle moves along its tangent and is brought back to the circle.
        let next = chi + 2.0 * (0.5 * h * chi_rate).atan();
        (omega_d, omega_d_dot, [next.sin().atan2(next.cos()), turn + turn_rate * h])
    }
}
