//! A second, plain transcription of the extended law, in f64, from the headers of its modules, for the tests to compare
//! the core with.
//!
//! It shares no code with the core and takes the other road wherever there is one: rotation matrices instead of
//! quaternions, the thrust direction's turn in world axes, the heading's lag as an angle, omega_d and omega_d' by
//! differentiating the lagging frame numerically, filters in small Runge-Kutta steps. One tick, [`Law::evaluate`], is a
//! pure function of [`Tick`], so that its sensitivity to every rounding can be computed. Its pieces:
//!
//! - [`position`], [`turning`] and [`heading`]: the commanded force, and how the desired frame follows it;
//! - [`attitude`]: the torque of the attitude's errors;
//! - [`budget`]: what rotors and limits leave for either;
//! - [`estimates`]: what is learnt of the forces; [`acting`]: what rotors still do of earlier commands;
//! - [`net`]: what catches a vehicle whose drives are changed without end.

pub mod acting;
pub mod attitude;
pub mod budget;
pub mod estimates;
pub mod heading;
pub mod net;
pub mod position;
pub mod tick;
pub mod turning;

use crate::support::oracle::desired::{Command, velocity};
use crate::support::oracle::lifting::Lift;
use crate::support::oracle::skew;
use budget::{Rotor, Row};
use controller_core::allocation::Rotors;
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::vehicle::{Limits, Vehicle};
use nalgebra::{Matrix3, Vector3};
use position::Envelope;
use tick::{Answer, Tick};
use turning::{TURNED, Turn};

/// The law in f64, under the headers' symbols.
pub struct Law {
    pub p: ExtendedParameters,
    pub mass: f64,
    pub gravity: f64,
    pub inertia: Matrix3<f64>,
    pub rotors: Vec<Rotor>,
    pub period: f64,
    /// T.
    pub late: f64,
    thrust_max: f64,
    rows: Vec<Row>,
    /// N_0, and L.
    floor: [f64; 2],
    /// What bias and yaw take of the greatest thrust.
    taken: f64,
}

fn double(x: f32) -> f64 {
    f64::from(x)
}

fn axes(across: f32, vertical: f32) -> Vector3<f64> {
    Vector3::new(across, across, vertical).cast()
}

fn cut(x: f64, level: f64) -> f64 {
    x.clamp(-level, level)
}

fn about_z(angle: f64) -> Matrix3<f64> {
    let (sin, cos) = angle.sin_cos();
    Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
}

/// s(x; M).
fn saturate(x: f64, level: f64) -> f64 {
    level * x / level.hypot(x)
}

impl Law {
    pub fn new(
        vehicle: &Vehicle,
        limits: &Limits,
        p: &ExtendedParameters,
        rotors: Option<&Rotors>,
        late: f32,
        period: f32,
    ) -> Self {
        let rows = rotors.into_iter().flat_map(|rotors| rotors.iter().zip(rotors.pseudo_inverse()));
        let rotors = rows.map(|(rotor, row)| Rotor {
            least: double(rotor.thrust_min),
            greatest: double(rotor.thrust_max),
            row: *row,
        });
        let mut law = Self {
            p: *p,
            mass: double(vehicle.mass),
            gravity: double(vehicle.gravity),
            inertia: Matrix3::from_diagonal(&vehicle.inertia.cast()),
            rotors: rotors.collect(),
            period: double(period),
            late: double(late),
            thrust_max: double(limits.thrust_max),
            rows: Vec::new(),
            floor: [0.0; 2],
            taken: 0.0,
        };
        law.spend(&limits.torque_max.cast());
        law
    }

    fn moments(&self) -> Vector3<f64> {
        self.inertia.diagonal()
    }

    /// One tick.
    pub fn evaluate(&self, t: &Tick) -> Answer {
        let (p, h) = (&self.p, self.period);
        let axis: Vector3<f64> = t.rotation.column(2).into();
        let averages = self.learnt(t, &axis);
        let scale = averages.scale;
        let across = averages.force.xy();
        let across = across * (double(p.force_across) / across.norm()).min(1.0);
        let d_z = averages.force.z.clamp(-double(p.force_down), double(p.force_up));
        let d = Vector3::new(across.x, across.y, d_z);
        let bias = averages.bias.zip_map(&axes(p.torque_tilt, p.torque_yaw), cut);

        let (net, caught) = t.net.catching();
        let filters = if caught { [-d; 3] } else { t.filters };
        let greatest = self.greatest(scale) * (1.0 + t.nudge.greatest);
        let most = if net.caught { self.net_level() } else { f64::INFINITY };
        let (errors, feedback) = self.feedback(t, &filters, &Envelope { d, greatest, most });
        let [c, x, y] = filters;
        let k_f = double(p.k_f);
        let c_rate = k_f * (x - c);
        let smoothed = feedback + (y - feedback) * (-double(p.k_d) * h).exp();
        let drive = (smoothed - x) * ((1.0 - (-double(p.k_s) * h).exp()) / h);
        let c_second = k_f * (drive - c_rate);

        let kappa = Vector3::new(1.0, 1.0, 0.0) * double(p.drag_across);
        let [v_d, a_d, j_d, s_d] = t.reference;
        let u = c + Vector3::new(0.0, 0.0, self.gravity) + a_d + kappa.component_mul(&v_d) + t.nudge.command[0];
        let u_dot = c_rate + j_d + kappa.component_mul(&a_d) + t.nudge.command[1];
        let u_ddot = c_second + s_d + kappa.component_mul(&j_d) + t.nudge.command[2];
        // Rates do not depend on u''.
        let command = Command { u, u_dot, u_ddot: Vector3::zeros(), heading: t.heading };
        let (papers, papers_rate) = velocity(|e| command.desired_attitude(e), command.fastest());
        let lag = t.lag.unwrap_or_else(|| [0.0, cut(papers_rate.z, double(p.yaw_rate))]);
        let [chi, turn] = lag;
        let across = about_z(chi).transpose() * papers_rate;
        let omega_d = Vector3::new(across.x, across.y, turn);
        let error = (papers * about_z(chi)).transpose() * t.rotation;
        let behind = t.omega - error.transpose() * omega_d;

        let (projected, projected_rate) = self.projected(t, &error, &behind, scale, &bias);
        let before = t.lift.unwrap_or_else(|| Lift::initial(&projected));
        let (lift, lifted) = before.advance(&projected, double(p.delta), double(p.alpha));
        let potential = self.potential(&lifted);
        let (damping, eased) = self.damping(&lifted, &potential, &projected_rate);
        let pull = potential + damping;

        let n = u.norm();
        let rho = u / n;
        let r = rho.dot(&u_dot);
        let rate = (u_dot - rho * r) / n;
        let along = rho.dot(&u_ddot);
        let wanted = Turn { rho, n, r, p: rate, q: (u_ddot - rho * along - rate * (2.0 * r)) / n, along };
        let cosine = error[(2, 2)];
        let sine = if cosine > 0.0 { error[(0, 2)].hypot(error[(1, 2)]) } else { 1.0 };
        let alpha = self.budget(n, pull.xy().norm(), sine).0 + t.nudge.budget;
        let vertical = [c.z, c_rate.z, c_second.z];
        let (change, limited) = self.limited(&wanted, turn, alpha, greatest, &vertical, &t.nudge.turn);
        let command = Command { u_ddot: u_ddot + change, ..command };

        let (omega_d, omega_d_dot, mut after) = self.lagging(lag, &command, t.nudge.heading);
        // What q leaves of alpha is W's at the next tick, with |p| to an eighth.
        let turning = papers.transpose() * wanted.p;
        let fastest = (1.0 - TURNED) * alpha.max(double(p.turn_reserve))
            / (turning.x.abs().max(turning.y.abs()) + 0.5 * turning.x.abs().min(turning.y.abs())).max(1e-3);
        let slowed = after[1].abs() > fastest;
        after[1] = cut(after[1], fastest);
        let (rate, turned) = (error.transpose() * omega_d, error.transpose() * omega_d_dot);
        let torque = self.inertia * turned - skew(self.inertia * rate) * rate - pull - bias;
        let wanted = self.mass * u.dot(&axis);
        let [least, ceiling] = self.thrusts(&torque, scale);
        let thrust = ceiling.min(least.max(wanted));
        let [rate, acceleration, whole, cone, swells, falls] = limited;
        Answer {
            thrust,
            torque,
            omega_d,
            omega_d_dot,
            filters: self.filtered([c, x], drive + change / k_f, smoothed),
            averages,
            lag: after,
            lifted,
            lift,
            net: net.after(&errors, limited.contains(&true) || thrust < wanted, h),
            wanted: turned,
            taken: [rate, acceleration, whole, cone, swells, falls, eased, wanted < least, wanted > ceiling, slowed],
        }
    }
}
